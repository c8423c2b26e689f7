"""The inverse Jacobian and the velocity that it is given."""

from __future__ import annotations

from pydrake.systems.primitives import ConstantVectorSource, Sine

from drake_leg.compare.comparison import Item
from drake_leg.compare.correspondence import Correspondence
from drake_leg.compare.inverse import match_function
from drake_leg.compare.signals import Scalar, Signal, close
from drake_leg.simulink.model import Block
from drake_leg.systems.inverse_jacobian import InverseJacobian

SINE = (("Frequency", "rad/s"), ("Phase", "rad"), ("Amplitude", "m/s"))
STILL = ("Constant", "Ground")


def match_inverse_jacobian(c: Correspondence) -> None:
    """Compare the MATLAB Function that makes the joint rates, and its inputs.

    Parameters
    ----------
    c : Correspondence
        With the roles of the integrals; those of the function's outputs are noted there.
    """
    name = next(iter(c.live.of_type(InverseJacobian)), None)
    outputs = {
        atom
        for _, scalar in c.integrated().values()
        for atom in (scalar.terms if scalar else ())
        if atom.kind == "function"
    }
    if not outputs or name is None:
        return
    sids = sorted(atom.of for atom in outputs)
    sid = max(sids, key=sids.count)
    rates = sorted((a for a in outputs if a.of == sid), key=lambda a: (int(a.what), a.index))
    found = match_function(c.ours, sid, c.live.systems[name], rates, _commanded(c))
    c.names |= found.names
    for parameter, ours, live in found.findings:
        c.findings.differ(sid, c.block(sid).name, parameter, ours, live)
    c.stands_for(sid, [name], unit_of_length_m=found.unit)
    _compare_positions(c, sid, name, found.joints_from)
    live_velocity = c.live_role(c.live.input(name, "v"))
    _compare_velocity(c, sid, found.velocity, live_velocity)
    _match_sources(c, sid, found.velocity, live_velocity)


def _commanded(c: Correspondence) -> dict[int, Scalar]:
    """Joint -> the scalar that is commanded to it, in the converter's unit."""
    found = {}
    for sid, joint in c.network.joints.items():
        converter = c.ours.converter(sid)
        signal = c.ours.input(converter.sid, 1) if converter else None
        if signal and any(atom.kind == "integral" for atom in signal[0].terms):
            found[joint] = signal[0]
    return found


def _compare_positions(c: Correspondence, sid: str, name: str, joints_from: dict[int, str]) -> None:
    for joint, scalar in enumerate(c.live_role(c.live.input(name, "q")), start=1):
        live = "sensed" if any(atom.kind == "sensed" for atom in scalar.terms) else "integrated"
        ours = joints_from.get(joint, live)
        if ours != live:
            c.findings.differ(sid, c.block(sid).name, f"position of joint {joint}", ours, live)


def _compare_velocity(c: Correspondence, sid: str, ours: Signal, live: Signal) -> None:
    for axis, mine, theirs in zip("xyz", ours, live, strict=False):
        if mine.shape != theirs.shape:
            c.differs(f"{sid}#in:1", f"wanted velocity {axis} [m/s]", mine, theirs)
            continue
        if not close(mine.constant, theirs.constant):
            block = _constant_before(c, sid)
            c.findings.differ(
                block.sid,
                block.name,
                f"constant velocity {axis}",
                mine.constant,
                theirs.constant,
                unit="m/s",
            )
        _compare_sines(c, mine, theirs)


def _compare_sines(c: Correspondence, ours: Scalar, live: Scalar) -> None:
    if len(ours.sines) != len(live.sines):
        return
    atoms = sorted((a for a in ours.terms if a.kind == "sine"), key=lambda a: a.numbers)
    for atom, mine, theirs in zip(atoms, ours.sines, live.sines, strict=True):
        block = c.block(c.sine_sids[atom])
        for (name, unit), a, b in zip(SINE, mine, theirs, strict=True):
            if not close(a, b):
                c.findings.differ(block.sid, block.name, name, a, b, unit=unit)


def _match_sources(c: Correspondence, sid: str, ours: Signal, live: Signal) -> None:
    """Name the sources: sines with their numbers, constants in the order of their ports."""
    count = len(c.ours.programs[sid].inputs)
    before = [other for place in range(count) for other in c.before(f"{sid}#in:{place + 1}")]
    constants = c.live.of_type(ConstantVectorSource)
    still = [other for other in before if c.block(other).type in STILL]
    for other in before:
        if c.block(other).type == "Sin":
            c.stands_for(other, c.live.of_type(Sine), parameters=_numbers(c, ours, live, other))
    for other, constant in zip(still, constants, strict=False):
        c.stands_for(other, [constant])
    if still:
        c.stands_for(still[-1], constants[len(still) :])


def _numbers(c: Correspondence, ours: Signal, live: Signal, sid: str) -> list[Item]:
    """Both sides' numbers of a sine, as far as they belong together."""
    for mine, theirs in zip(ours, live, strict=False):
        own = [a for a in mine.terms if a.kind == "sine" and c.sine_sids.get(a) == sid]
        if own and theirs.sines:
            values = (*own[0].numbers, mine.terms[own[0]])
            return [
                {"parameter": name, "simulink": a, "drake": b, "unit": unit}
                for (name, unit), a, b in zip(SINE, values, theirs.sines[0], strict=True)
            ]
    return []


def _constant_before(c: Correspondence, sid: str) -> Block:
    """Find the block that most likely sets a constant velocity."""
    count = len(c.ours.programs[sid].inputs)
    before = [
        c.block(other) for place in range(count) for other in c.before(f"{sid}#in:{place + 1}")
    ]
    moving = [b for b in before if b.type == "Constant" and b.parameters.get("Value") != 0.0]
    return next(iter([*moving, *(b for b in before if b.type == "Sin")]), c.block(sid))
