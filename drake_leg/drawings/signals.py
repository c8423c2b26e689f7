"""What the signals of a diagram are called: after the named ports at their ends."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from pydrake.systems.framework import System
from pydrake.systems.primitives import Demultiplexer, Multiplexer

from drake_leg.diagrams.wiring import LiveWire

End = tuple[str, str]  # block, and its output

_PRETTY = {
    "qdot": "q\u0307",
    "qddot": "q\u0308",
    "det_j": "det J",
    "angular_velocity": "ω",
    "generalized_acceleration": "acceleration",
}
_NAMELESS = re.compile(r"[uy]\d+|data")
_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def pretty(name: str) -> str:
    """Write a port's name as a person does; empty for a port that has only a number."""
    if _NAMELESS.fullmatch(name):
        return ""
    return _PRETTY.get(name, name.replace("_", " "))


def signal_names(systems: Mapping[str, System], shown: Sequence[LiveWire]) -> dict[End, str]:
    """Name the signals that leave nameless ports: output to name.

    A signal is called after the input that it feeds; one that a Mux joins, or a Demux takes apart,
    after the whole, with a number.
    """
    named: dict[End, str] = {}
    for wire in shown:
        if not pretty(wire.output) and pretty(wire.input):
            named.setdefault((wire.source, wire.output), pretty(wire.input))
    for wire in shown:
        if wire.output == "state" and isinstance(systems[wire.target], Demultiplexer):
            named.setdefault((wire.target, "y0"), "q")
            named.setdefault((wire.target, "y1"), "w")  # as a joint's port is named in Simscape
        elif isinstance(systems[wire.target], Demultiplexer):
            whole = pretty(wire.output) or named.get((wire.source, wire.output), "")
            outputs = systems[wire.target].num_output_ports()
            width = systems[wire.source].GetOutputPort(wire.output).size()
            for place in range(outputs if whole and outputs == width else 0):
                named.setdefault((wire.target, f"y{place}"), f"{whole}{_sub(place)}")
    for wire in shown:
        target = systems[wire.target]
        whole = named.get((wire.target, "y0"), "")
        joins = isinstance(target, Multiplexer) and not pretty(wire.output)
        if joins and whole and target.num_input_ports() == target.get_output_port(0).size():
            place = int(wire.input.removeprefix("u"))
            named.setdefault((wire.source, wire.output), f"{whole}{_sub(place)}")
    return {end: name for end, name in named.items() if not pretty(end[1])}


def _sub(place: int) -> str:
    return str(place + 1).translate(_SUBSCRIPTS)
