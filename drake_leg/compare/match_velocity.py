"""The inverse Jacobian and the velocity that it is given."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np
from pydrake.systems.primitives import ConstantVectorSource, Sine

from drake_leg.compare.comparison import Item
from drake_leg.compare.correspondence import Correspondence, function_role, same_factors
from drake_leg.compare.function_probe import slots_of
from drake_leg.compare.inverse import LENGTH_UNITS, Match, match_function
from drake_leg.compare.signals import Atom, Scalar, close
from drake_leg.kinematics.batches import Array
from drake_leg.simulink.model import Block
from drake_leg.simulink.values import number
from drake_leg.systems.inverse_jacobian import InverseJacobian

SINE = (("Frequency", "rad/s"), ("Phase", "rad"), ("Amplitude", "m/s"))
TIMED = {"SineType": "Time based", "TimeSource": "Use simulation time"}
STILL = ("Constant", "Ground")
WAVES = ("Sin", "SignalGenerator")


def match_inverse_jacobian(c: Correspondence) -> None:
    """Compare the MATLAB Function that makes the joint rates, and its inputs.

    Parameters
    ----------
    c : Correspondence
        With the roles of the integrals; those of the function's outputs are noted there.
    """
    name = next(iter(c.live.of_type(InverseJacobian)), None)
    sid = _function(c)
    if sid is None or name is None:
        return
    rate_unit = c.rate_unit()
    found = match_function(c.ours, sid, c.live.systems[name], _commanded(c), rate_unit=rate_unit)
    c.names |= found.names
    c.scales |= {role: rate_unit for role in found.names.values() if role.what == "qdot"}
    for parameter, ours, live in found.findings:
        c.findings.differ(sid, c.block(sid).name, parameter, ours, live)
    if not found.velocity:
        found = _wanted_all_the_same(c, sid, name, found)
    c.stands_for(sid, [name], unit_of_length_m=found.unit)
    if not found.names:
        _take_in_order(c, sid, name)
    _compare_positions(c, sid, name, found.joints_from)
    _compare_velocity(c, sid, name, found)
    _match_other_sources(c, sid)


def _function(c: Correspondence) -> str | None:
    """Find the MATLAB Function that the joints' motions come from, or the only one there is."""
    on_the_way = [
        atom.of
        for _, scalar in c.integrated().values()
        for atom in (scalar.terms if scalar else ())
        if atom.kind == "function"
    ]
    candidates = sorted(on_the_way) or list(c.ours.programs)
    return max(candidates, key=candidates.count) if candidates else None


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


def _compare_velocity(c: Correspondence, sid: str, name: str, found: Match) -> None:
    live = c.live_role(c.live.input(name, "v"))
    parts = [_part(twist) for twist in c.live.systems[name].robot.twists.T]
    for index, ((axis, unit), mine, theirs) in enumerate(
        zip(parts, found.velocity, live, strict=False)
    ):
        _match_sources(c, mine, theirs)
        port = found.ports[index] if found.ports else f"{sid}#in:1"
        if mine.shape != theirs.shape or not same_factors(mine, theirs):
            c.differs(port, f"wanted velocity {axis} [{unit}]", mine, theirs)
            continue
        if not close(mine.constant, theirs.constant):
            block = _setting(c, mine) or c.block(sid)
            c.findings.differ(
                block.sid,
                block.name,
                f"constant velocity {axis}",
                mine.constant,
                theirs.constant,
                unit=unit,
            )
        _compare_sines(c, port, mine, theirs)


def _part(twist: Array) -> tuple[str, str]:
    """Name what a part of a commanded velocity is, and its unit."""
    turning, translation = np.split(np.abs(twist), 2)
    if turning.any():
        return ("roll", "pitch", "yaw")[int(turning.argmax())], "rad/s"
    return "xyz"[int(translation.argmax())], "m/s"


def _match_sources(c: Correspondence, ours: Scalar, live: Scalar) -> None:
    """Name the sources that a component comes from on both sides."""
    for types, kind in ((WAVES, Sine), (STILL, ConstantVectorSource)):
        names = [n for n in c.live.of_type(kind) if n in live.origins]
        names = names or ([] if kind is Sine else sorted(live.origins))
        for block in c.origins(ours, *types):
            if names and kind is Sine:
                c.stands_for(block.sid, names, parameters=_numbers(c, block, ours, live))
            elif names:
                c.stands_for(block.sid, names)


def _take_in_order(c: Correspondence, sid: str, name: str) -> None:
    """Let a function that is none be the inverse Jacobian by its outputs' order alone.

    That it is another function is noted; what is wired behind it need not be wrong for that.
    """
    size = c.live.systems[name].GetOutputPort("qdot").size()
    outputs = [
        atom
        for place in range(len(c.ours.programs[sid].outputs))
        for scalar in c.ours.output(f"{sid}#out:{place + 1}")
        for atom in scalar.terms
    ]
    roles = [*(function_role("qdot", index) for index in range(size)), function_role("det J")]
    c.names |= dict(zip(outputs, roles, strict=False))


def _wanted_all_the_same(c: Correspondence, sid: str, name: str, found: Match) -> Match:
    """Take what a function of another law is given for the wanted velocity, in the likeliest unit.

    Which of its inputs is which is then told by what reaches them; the order decides the rest.
    """
    slots = [slot for row in slots_of(c.ours, sid, _commanded(c)) for slot in row if not slot.joint]
    live = c.live_role(c.live.input(name, "v"))
    if len(slots) != len(live):
        return found
    shapes = [scalar.shape for scalar in live]
    ordered = next(
        (order for order in permutations(slots) if [s.scalar.shape for s in order] == shapes), slots
    )
    unit = _likeliest_unit([slot.scalar for slot in ordered], live)
    velocity = tuple(slot.scalar.scaled(unit) for slot in ordered)
    return replace(found, unit=unit, velocity=velocity, ports=tuple(s.port for s in ordered))


def _likeliest_unit(ours: Sequence[Scalar], live: Sequence[Scalar]) -> float:
    """Find the unit of length in which the sines' amplitudes are nearest."""
    for mine, theirs in zip(ours, live, strict=True):
        sines = [[f for a, f in one.terms.items() if a.kind == "sine"] for one in (mine, theirs)]
        if all(sines):
            ratio = abs(sines[1][0] / sines[0][0])
            return min(LENGTH_UNITS, key=lambda unit: abs(math.log(unit / ratio)))
    return 1.0


def _match_other_sources(c: Correspondence, sid: str) -> None:
    """Name counterparts of the function's sources that belong to no matching component."""
    for place in range(len(c.ours.programs[sid].inputs)):
        for scalar in c.ours.input(sid, place + 1) or ():
            if any(atom.kind in ("integral", "sensed") for atom in scalar.terms):
                continue
            for types, kind in ((WAVES, Sine), (STILL, ConstantVectorSource)):
                for block in c.origins(scalar, *types):
                    if block.sid not in c.findings.seen and c.live.of_type(kind):
                        c.stands_for(block.sid, c.live.of_type(kind))


def _setting(c: Correspondence, scalar: Scalar) -> Block | None:
    """Find the block that sets a constant part: a constant that is not zero, or a sine's bias."""
    constants = c.origins(scalar, *STILL)
    moving = [block for block in constants if number(block.parameters.get("Value")) != 0.0]
    biased = [b for b in c.origins(scalar, *WAVES) if number(b.parameters.get("Bias")) != 0.0]
    return next(iter([*moving, *biased, *constants, *c.origins(scalar, *WAVES)]), None)


def _compare_sines(c: Correspondence, port: str, ours: Scalar, live: Scalar) -> None:
    if len(ours.sines) != len(live.sines):
        c.differs(port, "wanted velocity", ours, live)
        return
    atoms = sorted((a for a in ours.terms if a.kind == "sine"), key=lambda a: a.numbers)
    for atom, mine, theirs in zip(atoms, ours.sines, live.sines, strict=True):
        for block in _blocks_of(c, atom, ours):
            _check_sine(c, block)
            for (name, unit), a, b in zip(SINE, mine, theirs, strict=True):
                if not close(a, b):
                    c.findings.differ(block.sid, block.name, name, a, b, unit=unit)


def _check_sine(c: Correspondence, block: Block) -> None:
    for name, plain in TIMED.items():
        c.findings.check(block, name, str(block.parameters.get(name, plain)), plain)
    held = str(block.parameters.get("SampleTime", "0")).strip()
    if held not in ("0", "-1", "0.0", "[0 0]"):
        c.findings.differ(block.sid, block.name, "SampleTime", held, "0")


def _blocks_of(c: Correspondence, atom: Atom, scalar: Scalar) -> list[Block]:
    """Find the Sine Waves that a term of a signal comes from."""
    return [
        block
        for block in c.origins(scalar, *WAVES)
        if any(atom in one.terms for one in c.ours.output(f"{block.sid}#out:1"))
    ]


def _numbers(c: Correspondence, block: Block, ours: Scalar, live: Scalar) -> list[Item]:
    """Both sides' numbers of a sine."""
    own = [a for a in ours.terms if a.kind == "sine" and block in _blocks_of(c, a, ours)]
    if not own or not live.sines:
        return []
    values = (own[0].numbers[0], own[0].numbers[1], ours.terms[own[0]])
    return [
        {"parameter": name, "simulink": a, "drake": b, "unit": unit}
        for (name, unit), a, b in zip(SINE, values, live.sines[0], strict=True)
    ]
