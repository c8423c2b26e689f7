"""The signal lines, one by one."""

from __future__ import annotations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.primitives import VectorLogSink

from drake_leg.compare.correspondence import Correspondence, listed
from drake_leg.compare.diagram_signals import DiagramSignals
from drake_leg.compare.match_blocks import UNCONNECTED
from drake_leg.compare.signals import Atom
from drake_leg.diagrams.wiring import Wire as LiveWire
from drake_leg.simulink.model import Wire
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.prescribed_motion import PrescribedMotion

Shape = frozenset[Atom]


def match_wires(c: Correspondence) -> None:
    """Find for every wire of the model the live connections that carry its signal.

    Parameters
    ----------
    c : Correspondence
        With all roles and all blocks judged.
    """
    why_missing = {item["sid"]: item["why"] for item in c.findings.comparison.missing}
    for wire in c.model.wires:
        item = {"what": "wire", "from": wire.source, "to": wire.target, "name": wire.name}
        ends = [port.partition("#")[0] for port in (wire.source, wire.target)]
        lost = next((sid for sid in ends if sid in why_missing), None)
        if lost is not None:
            why = f"{c.block(lost).name!r} has no counterpart: {why_missing[lost]}"
            c.findings.comparison.missing.append({**item, "why": why})
        elif wire.target not in c.wrong:
            _match_wire(c, wire, item)


def physical(live: DiagramSignals) -> set[LiveWire]:
    """Find the connections that in Simscape are physical ones: around the plant."""
    plants, logs = set(live.of_type(MultibodyPlant)), set(live.of_type(VectorLogSink))
    inner = {*plants, *live.of_type(PrescribedMotion), *live.of_type(FrameSensor)}
    around = inner | {w.target for w in live.wires if w.source in plants} - logs
    return {
        wire
        for wire in live.wires
        if (wire.source in inner and wire.target in around)
        or (wire.target in inner and wire.input == "q")
    }


def _match_wire(c: Correspondence, wire: Wire, item: dict[str, str]) -> None:
    source, target = (port.partition("#")[0] for port in (wire.source, wire.target))
    signal = c.role(c.ours.output(wire.source))
    shapes = list(dict.fromkeys(scalar.shape for scalar in signal if scalar.shape))
    found = _carrying(c, shapes, source, target)
    c.findings.wired.update(found)
    text = ", ".join(f"{w.source}.{w.output} -> {w.target}.{w.input}" for w in found)
    if not text and not shapes:
        names = sorted(c.counterparts.get(source, ()))
        text = f"a number of {listed(names)}" if names else "a constant"
    if not text and c.block(target).type == "Terminator":
        text = UNCONNECTED
    if text:
        c.findings.comparison.matched.append({**item, "counterpart": text})
    else:
        shown = ", ".join(map(str, signal))
        why = f"no connection of the diagram carries {shown}"
        c.findings.comparison.missing.append({**item, "why": why})


def _carrying(c: Correspondence, shapes: list[Shape], source: str, target: str) -> list[LiveWire]:
    """Find the live connections that carry signals of these shapes, the likeliest alone.

    Empty where none of the signals is in the diagram.
    """
    from_, into = c.counterparts.get(source, set()), c.counterparts.get(target, set())
    carrier = c.ours.is_carrier(c.block(target))
    if not shapes:
        still = [wire for wire in c.live.wires if not any(c.shapes[wire])]
        return [wire for wire in still if wire.source in from_ and wire.target in into]
    found: list[LiveWire] = []
    for shape in shapes:
        wires = [wire for wire in c.live.wires if shape in c.shapes[wire]]
        if not wires:
            continue
        best = max(wires, key=lambda wire: _rank(c, wire, from_, into, carrier=carrier))
        if best not in found:
            found.append(best)
    return found


def _rank(
    c: Correspondence, wire: LiveWire, from_: set[str], into: set[str], *, carrier: bool
) -> int:
    """Tell how well a live connection fits: first by the end that does something."""
    first, second = wire.target in into, wire.source in from_
    if carrier:
        first, second = second, first
    logs = isinstance(c.live.systems[wire.target], VectorLogSink)
    return 4 * first + 2 * second + (not logs)
