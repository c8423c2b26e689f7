"""How data of a chart start, and what their types make of them."""

from __future__ import annotations

from drake_leg.simulink.stateflow.machine import Datum

INTEGERS = tuple(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32))
NUMBERS = ("double", "single", "boolean")


def start(datum: Datum) -> str:
    """Return an expression of its first value."""
    value = datum.initial or "0"
    if not datum.size:
        return value
    size = datum.size if "[" in datum.size else f"{datum.size}, 1"
    return f"({value}) + zeros({size})"


def cast(datum: Datum) -> str:
    """Return what its type makes of it after a step; "" where that is itself."""
    if datum.type in INTEGERS:
        return f"double({datum.type}({datum.name}))"
    if datum.type == "single":
        return f"double(single({datum.name}))"
    if datum.type == "boolean":
        return f"double({datum.name} ~= 0)"
    return ""
