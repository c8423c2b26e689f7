"""Signals that are entries of a vector which comes from the mechanism, as code."""

from __future__ import annotations

import math

from drake_leg.simulink.dynamics.ports import Bus
from drake_leg.simulink.running.kinds.routing import written_bus


def signal_at(vector: str, start: int, shape: tuple[int, ...]) -> str:
    """Write a signal that is some entries of a vector."""
    if shape == ():
        return f"float({vector}[{start}])"
    code = f"{vector}[{start}:{start + math.prod(shape)}]"
    return f"{code}.reshape({shape})" if len(shape) == 2 else code


def bus_at(vector: str, start: int, bus: Bus) -> str:
    """Write a bus whose signals are entries of a vector."""
    named: dict[str, str] = {}
    for name, shape in bus:
        named[name] = signal_at(vector, start, shape)
        start += math.prod(shape)
    return written_bus(named)
