"""One parameter of a kind of block."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter as a block has it before anybody touches it."""

    name: str
    default: str  # MATLAB text, in `unit`
    numeric: bool
    unit: str = ""  # default of the parameter that is named like this one plus "Units"


Parameters = tuple[Parameter, ...]


def numbers(**defaults: str) -> Parameters:
    """Return numeric parameters without unit, or with one that cannot be chosen."""
    return tuple(
        Parameter(name=name, default=text, numeric=True) for name, text in defaults.items()
    )


def choices(**defaults: str) -> Parameters:
    """Return parameters that stay text."""
    return tuple(
        Parameter(name=name, default=text, numeric=False) for name, text in defaults.items()
    )


def quantities(unit: str, **defaults: str) -> Parameters:
    """Return numeric parameters that have their unit beside them."""
    return tuple(
        Parameter(name=name, default=text, numeric=True, unit=unit)
        for name, text in defaults.items()
    )
