"""Parameters of physical blocks, in SI."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.running.code import Writer
from drake_leg.simulink.running.settings import Signal
from drake_leg.units import parse_unit


def in_si(w: Writer, name: str, default: str) -> Signal:
    """Evaluate a parameter of a physical block, in SI."""
    value = w.settings.array(name, default)
    unit = w.settings.text(f"{name}_unit", "1")
    if unit in ("1", ""):
        return value
    scale = parse_unit(unit)
    if isinstance(value, np.ndarray):
        return np.array([scale.in_si(each) for each in value.ravel()]).reshape(value.shape)
    return scale.in_si(value)


def require(w: Writer, **usual: str) -> None:
    """Refuse a physical block whose choices are others than those that run."""
    for name, value in usual.items():
        given = w.settings.text(name, value).rpartition(".")[2]
        if given.lower() != value.lower():
            raise w.fault(f"has {name} {given!r}, which does not run: choose {value!r}")
