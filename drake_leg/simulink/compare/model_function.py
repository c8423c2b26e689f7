"""The MATLAB Function of a model beside the inverse Jacobian: its inputs, sources and outputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np
from pydrake.systems.primitives import ConstantVectorSource, Sine

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.findings import (
    Item,
    Verdict,
    check,
    differences,
    different,
    listed,
    matched,
    unreadable,
)
from drake_leg.simulink.compare.inverse import LENGTH_UNITS, Match, Slots, match_function, slots_of
from drake_leg.simulink.compare.sides import Roles, Sides, other_signal, same_factors
from drake_leg.simulink.compare.signals import Atom, Scalar, close, function_role
from drake_leg.simulink.model import Block, number
from drake_leg.systems.inverse_jacobian import InverseJacobian

SINE = (("Frequency", "rad/s"), ("Phase", "rad"), ("Amplitude", "m/s"))
TIMED = {"SineType": "Time based", "TimeSource": "Use simulation time"}
STILL = ("Constant", "Ground")
WAVES = ("Sin", "SignalGenerator")


@dataclass(frozen=True, kw_only=True)
class InverseFunction:
    """The MATLAB Function that is compared with the inverse Jacobian, and how they are related."""

    sid: str
    name: str  # of the live block
    match: Match  # its velocity and names are the likeliest ones if the function is another
    rate_unit: float  # [rad/s]
    is_same: bool  # whether the names follow from the function and not from its outputs' order


def match_inverse(sides: Sides) -> InverseFunction | None:
    """Match the MATLAB Function that makes the joint rates; None where one side has none.

    A function of another law, or one that could not be read, is taken for the inverse Jacobian by
    the order of its inputs and outputs, since the wires around it may be right all the same.
    """
    name = next(iter(sides.live.of_type(InverseJacobian)), None)
    sid = _function(sides)
    if sid is None or name is None:
        return None
    code, block, commanded = sides.ours.codes[sid], sides.live.systems[name], _commanded(sides)
    rate_unit, slots = sides.rate_unit(), slots_of(sides.ours, sid, commanded)
    found = Match()
    if code.program is not None:
        found = match_function(code.program, sid, slots, block, commanded, rate_unit=rate_unit)
    is_same = bool(found.names)
    if not found.velocity:
        found = _in_likeliest_unit(sides, name, slots, found)
    if not is_same:
        found = replace(found, names=_in_order(sides, sid, block))
    return InverseFunction(sid=sid, name=name, match=found, rate_unit=rate_unit, is_same=is_same)


def function_roles(joints: Roles, inverse: InverseFunction | None) -> Roles:
    """Add to the joints' roles those of the function's outputs."""
    if inverse is None:
        return joints
    names = inverse.match.names
    rates = [role for role in names.values() if role.what == "qdot"] if inverse.is_same else []
    return Roles(names={**joints.names, **names}, units=dict.fromkeys(rates, inverse.rate_unit))


def compare_function(sides: Sides, inverse: InverseFunction | None) -> Iterator[Verdict]:
    """Compare the function with the inverse Jacobian, and its inputs; list unreadable code."""
    for sid, code in sides.ours.codes.items():
        if code.program is None:
            live = "the inverse Jacobian" if inverse and inverse.sid == sid else "none"
            yield unreadable(sides.block(sid), code.why, live)
    if inverse is None:
        return
    block, name = sides.block(inverse.sid), inverse.name
    for difference in inverse.match.differences:
        yield different(block.sid, block.name, *difference)
    yield matched(block, listed([name]), [name], unit_of_length_m=inverse.match.unit)
    for joint, scalar in enumerate(sides.live.input(name, "q") or (), start=1):
        live = "sensed" if any(atom.kind == "sensed" for atom in scalar.terms) else "integrated"
        ours = inverse.match.joints_from.get(joint, live)
        if ours != live:
            yield different(block.sid, block.name, f"position of joint {joint}", ours, live)
    sources = list(_compare_velocity(sides, inverse))
    yield from sources
    yield from _other_sources(sides, inverse.sid, {verdict.block for verdict in sources})


def _function(sides: Sides) -> str | None:
    """Find the MATLAB Function that the joints' motions come from, or the only one there is."""
    on_the_way = [
        atom.of
        for _, scalar in sides.rates().values()
        for atom in (scalar.terms if scalar else ())
        if atom.kind == "function"
    ]
    candidates = sorted(on_the_way) or list(sides.ours.codes)
    return max(candidates, key=candidates.count) if candidates else None


def _commanded(sides: Sides) -> dict[int, Scalar]:
    """Map a joint to the scalar that is commanded to it, in the converter's unit."""
    found = {}
    for sid, joint in sides.joints.items():
        converter = sides.ours.converter(sid)
        signal = sides.ours.input(converter.sid, 1) if converter else None
        if signal and any(atom.kind == "integral" for atom in signal[0].terms):
            found[joint] = signal[0]
    return found


def _in_order(sides: Sides, sid: str, block: InverseJacobian) -> dict[Atom, Atom]:
    """Name the outputs of a function by their order."""
    size = block.GetOutputPort("qdot").size()
    outputs = [
        atom
        for place in range(sides.ours.codes[sid].outputs)
        for scalar in sides.ours.output(f"{sid}#out:{place + 1}")
        for atom in scalar.terms
    ]
    roles = [*(function_role("qdot", index) for index in range(size)), function_role("det J")]
    return dict(zip(outputs, roles, strict=False))


def _in_likeliest_unit(sides: Sides, name: str, slots: Slots, found: Match) -> Match:
    """Take the inputs of a function of another law for the wanted velocity.

    Which of its inputs is which is then told by what reaches them; the order decides the rest.
    """
    parts = [slot for row in slots for slot in row if not slot.joint]
    live = sides.live.input(name, "v") or ()
    if len(parts) != len(live):
        return found
    shapes = [scalar.shape for scalar in live]
    ordered = next(
        (order for order in permutations(parts) if [s.scalar.shape for s in order] == shapes), parts
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


def _compare_velocity(sides: Sides, inverse: InverseFunction) -> Iterator[Verdict]:
    live = sides.live.input(inverse.name, "v") or ()
    parts = [_part(twist) for twist in sides.live.systems[inverse.name].robot.twists.T]
    ports = inverse.match.ports or (f"{inverse.sid}#in:1",) * len(parts)
    for (axis, unit), port, mine, theirs in zip(
        parts, ports, inverse.match.velocity, live, strict=False
    ):
        yield from _sources(sides, mine, theirs)
        if mine.shape != theirs.shape or not same_factors(mine, theirs):
            yield other_signal(sides, port, f"wanted velocity {axis} [{unit}]", mine, theirs)
            continue
        if not close(mine.constant, theirs.constant):
            block = _setting(sides, mine) or sides.block(inverse.sid)
            what, both = f"constant velocity {axis}", (mine.constant, theirs.constant)
            yield different(block.sid, block.name, what, *both, unit=unit)
        yield from _compare_sines(sides, port, mine, theirs)


def _part(twist: Array) -> tuple[str, str]:
    """Name what a part of a commanded velocity is, and its unit."""
    turning, translation = np.split(np.abs(twist), 2)
    if turning.any():
        return ("roll", "pitch", "yaw")[int(turning.argmax())], "rad/s"
    return "xyz"[int(translation.argmax())], "m/s"


def _sources(sides: Sides, ours: Scalar, live: Scalar) -> Iterator[Verdict]:
    """Name the sources that a component comes from on both sides."""
    waves = [name for name in sides.live.of_type(Sine) if name in live.origins]
    for block in sides.sources(ours, WAVES) if waves else ():
        numbers = _numbers(sides, block, ours, live)
        yield matched(block, listed(waves), waves, parameters=numbers)
    still = [name for name in sides.live.of_type(ConstantVectorSource) if name in live.origins]
    still = still or sorted(live.origins)
    for block in sides.sources(ours, STILL) if still else ():
        yield matched(block, listed(still), still)


def _other_sources(sides: Sides, sid: str, named: set[str]) -> Iterator[Verdict]:
    """Name counterparts of the function's sources that belong to no matching component."""
    for place in range(sides.ours.codes[sid].inputs):
        for scalar in sides.ours.input(sid, place + 1) or ():
            if any(atom.kind in ("integral", "sensed") for atom in scalar.terms):
                continue
            for types, kind in ((WAVES, Sine), (STILL, ConstantVectorSource)):
                names = sides.live.of_type(kind)
                for block in sides.sources(scalar, types):
                    if block.sid not in named and names:
                        named.add(block.sid)
                        yield matched(block, listed(names), names)


def _setting(sides: Sides, scalar: Scalar) -> Block | None:
    """Find the block that sets a constant part: a constant that is not zero, or a sine's bias."""
    constants = sides.sources(scalar, STILL)
    waves = sides.sources(scalar, WAVES)
    moving = [block for block in constants if number(block.parameters.get("Value")) != 0.0]
    biased = [block for block in waves if number(block.parameters.get("Bias")) != 0.0]
    return next(iter([*moving, *biased, *constants, *waves]), None)


def _compare_sines(sides: Sides, port: str, ours: Scalar, live: Scalar) -> Iterator[Verdict]:
    if len(ours.sines) != len(live.sines):
        yield other_signal(sides, port, "wanted velocity", ours, live)
        return
    atoms = sorted((a for a in ours.terms if a.kind == "sine"), key=lambda a: a.numbers)
    for atom, mine, theirs in zip(atoms, ours.sines, live.sines, strict=True):
        for block in _blocks_of(sides, atom, ours):
            for name, plain in TIMED.items():
                stated = str(block.parameters.get(name, plain))
                yield from differences(check(block, name, stated, plain))
            held = str(block.parameters.get("SampleTime", "0")).strip()
            if held not in ("0", "-1", "0.0", "[0 0]"):
                yield different(block.sid, block.name, "SampleTime", held, "0")
            for (name, unit), a, b in zip(SINE, mine, theirs, strict=True):
                if not close(a, b):
                    yield different(block.sid, block.name, name, a, b, unit=unit)


def _blocks_of(sides: Sides, atom: Atom, scalar: Scalar) -> list[Block]:
    """Find the Sine Waves that a term of a signal comes from."""
    return [
        block
        for block in sides.sources(scalar, WAVES)
        if any(atom in one.terms for one in sides.ours.output(f"{block.sid}#out:1"))
    ]


def _numbers(sides: Sides, block: Block, ours: Scalar, live: Scalar) -> list[Item]:
    """Both sides' numbers of a sine."""
    own = [a for a in ours.terms if a.kind == "sine" and block in _blocks_of(sides, a, ours)]
    if not own or not live.sines:
        return []
    values = (own[0].numbers[0], own[0].numbers[1], ours.terms[own[0]])
    return [
        {"parameter": name, "simulink": a, "drake": b, "unit": unit}
        for (name, unit), a, b in zip(SINE, values, live.sines[0], strict=True)
    ]
