"""Blocks that only carry signals on, and blocks that show them."""

from __future__ import annotations

import math

from pydrake.systems.primitives import ConstantVectorSource

from drake_leg.compare.correspondence import Correspondence
from drake_leg.compare.signals import CLOSE, Scalar, close
from drake_leg.compare.simulink_signals import SINKS, unit_factor
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block
from drake_leg.simulink.units import parse_unit

UNCONNECTED = "an output that stays unconnected"
SCALES = (1.0, 1e2, 1e3, 180.0 / math.pi, 30.0 / math.pi)  # units of what a scope shows
UNITS = {  # of what is sensed: where a joint turns, where it slides
    ("sensed", "position"): ("rad", "m"),
    ("sensed", "velocity"): ("rad/s", "m/s"),
    ("sensed", "acceleration"): ("rad/s^2", "m/s^2"),
    ("sensed", "torque"): ("N*m", "N"),
    ("foot", "position"): ("m", ""),
    ("foot", "velocity"): ("m/s", ""),
    ("foot", "acceleration"): ("m/s^2", ""),
    ("foot", "angular velocity"): ("rad/s", ""),
    ("foot", "quaternion"): ("1", ""),
}
LIKELY = {  # what the live block's name begins with, where several carry the signal
    "Mux": "Mux",
    "Demux": "Demux",
    "Gain": "Gain",
    "Sum": "Integrator",
    "PS-Simulink Converter": "PS-Simulink",
}


def match_carriers(c: Correspondence) -> None:
    """Name for every mux, gain, sum and converter the live block at which its signal appears."""
    for block in c.model.blocks:
        if block.type == "Terminator":
            c.findings.match(block, UNCONNECTED)
        elif c.ours.is_carrier(block):
            _match_carrier(c, block)


def check_units(c: Correspondence) -> None:
    """Refuse converters whose unit measures something else than what reaches them."""
    for sid, joint in c.network.joints.items():
        converter = c.ours.converter(sid)
        if converter is not None:
            _check_unit(c, converter, c.unit_of(joint))
    for block in c.model.blocks:
        if block.kind == "PS-Simulink Converter":
            for scalar in c.ours.output(f"{block.sid}#out:1"):
                for atom in scalar.terms:
                    if (atom.kind, atom.what) in UNITS:
                        turning, sliding = UNITS[atom.kind, atom.what]
                        slides = atom.kind == "sensed" and c.unit_of(int(atom.of)) == "m"
                        _check_unit(c, block, sliding if slides else turning)


def _check_unit(c: Correspondence, block: Block, wanted: str) -> None:
    unit = str(block.parameters.get("Unit", "1"))
    if unit in ("1", "inherit", ""):
        return
    try:
        fits = parse_unit(unit).is_like(parse_unit(wanted))
    except InvalidValueError:
        fits = False
    if not fits:
        c.findings.differ(block.sid, block.name, "Unit", unit, wanted)


def match_sinks(c: Correspondence) -> None:
    """Find the scopes that record what the model's scopes show."""
    logged = [(scalar.renamed(c.live_names), name) for scalar, name in c.live.logged()]
    for block in c.model.blocks:
        if block.kind in SINKS or block.type in SINKS:
            _match_sink(c, block, logged)


def _match_carrier(c: Correspondence, block: Block) -> None:
    wired = [w.source for w in c.model.wires if w.source.startswith(f"{block.sid}#")]
    ports = dict.fromkeys(wired or [f"{block.sid}#out:1"])
    scalars = [s for port in ports for s in c.role(c.ours.output(port)) if s.shape]
    names = [_carriers_of(c, scalar) for scalar in scalars]
    best = [_preferred(block, found) for found in names if found]
    if scalars and not best:
        c.findings.miss(block, f"no block of the diagram gives {scalars[0]}")
    else:
        c.stands_for(block.sid, best or c.live.of_type(ConstantVectorSource))


def _preferred(block: Block, names: list[str]) -> str:
    word = LIKELY.get(block.kind, " ")
    return next((name for name in names if name.startswith(word)), names[0])


def _carriers_of(c: Correspondence, scalar: Scalar) -> list[str]:
    """Name the live blocks at whose outputs a signal of the same shape appears."""
    carrying = (wire.source for wire in c.live.wires if scalar.shape in c.shapes[wire])
    return list(dict.fromkeys(carrying))


def _match_sink(c: Correspondence, block: Block, logged: list[tuple[Scalar, str]]) -> None:
    if not any(wire.target.startswith(f"{block.sid}#") for wire in c.model.wires):
        c.findings.match(block, "nothing: it shows nothing")
        return
    scopes: list[str] = []
    for wire in c.model.wires:
        if wire.target.partition("#")[0] != block.sid:
            continue
        for scalar in c.role(c.ours.output(wire.source)):
            found = [(other, name) for other, name in logged if other.shape == scalar.shape]
            if found:
                scopes.append(_best_scope([name for _, name in found], block.name, scopes))
                _check_scale(c, block, scalar, found[0][0])
            elif scalar.shape:
                c.findings.miss(block, f"no scope of the diagram records {scalar}")
    if scopes and block.sid not in c.findings.seen:
        c.stands_for(block.sid, scopes)
    c.findings.miss(block, "nothing that the diagram has reaches it")


def _best_scope(names: list[str], wanted: str, taken: list[str]) -> str:
    """Prefer the scope of the same name, then one that is in use for this block already."""
    for name in names:
        if name.lower() == wanted.lower():
            return name
    return next((name for name in names if name in taken), names[0])


def _check_scale(c: Correspondence, block: Block, ours: Scalar, live: Scalar) -> None:
    """A scope may show another unit; any other factor is a gain that the diagram lacks."""
    if any(atom.kind == "sine" for atom in ours.terms):
        return
    converters = [b for b in c.model.blocks if b.kind == "PS-Simulink Converter"]
    unit = math.prod(unit_factor(b) for b in converters if b.sid in ours.origins)
    for atom, factor in ours.terms.items():
        ratio = factor * unit / live.terms[atom]
        offset = ours.constant * unit - ratio * live.constant
        if abs(offset) > CLOSE * abs(ratio):
            c.findings.differ(block.sid, block.name, f"offset of {atom}", offset, 0.0)
        if not any(close(ratio, unit) or close(ratio, 1.0 / unit) for unit in SCALES):
            c.findings.differ(block.sid, block.name, f"factor of {atom}", ratio, 1.0)
