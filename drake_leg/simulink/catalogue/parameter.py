"""One parameter of a kind of block."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a kind of block, with its default."""

    name: str
    default: str  # MATLAB text, in `unit`
    numeric: bool
    unit: str = ""  # default of the parameter that is named like this one plus "Units"
    unbounded: bool = False  # whether it may be infinite, as a limit or a time may
    aliases: tuple[str, ...] = ()  # other names that files have for it

    @property
    def names(self) -> tuple[str, ...]:
        """All its names, the one that is reported first."""
        return (self.name, *self.aliases)


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
    """Return numeric parameters that have a unit."""
    return tuple(
        Parameter(name=name, default=text, numeric=True, unit=unit)
        for name, text in defaults.items()
    )


def unbounded(parameters: Parameters) -> Parameters:
    """Return parameters that may be infinite."""
    return tuple(replace(parameter, unbounded=True) for parameter in parameters)


def switches(*names: str) -> Parameters:
    """Return switches that are off by default."""
    return choices(**dict.fromkeys(names, "off"))


def also_named(parameters: Parameters, **aliases: str) -> Parameters:
    """Return parameters that some files name otherwise: ``name="alias"``."""
    return tuple(
        replace(parameter, aliases=(aliases[parameter.name],))
        if parameter.name in aliases
        else parameter
        for parameter in parameters
    )


def without_table(names: str) -> dict[str, Parameters]:
    """Return the kinds of blocks, by names with commas between, whose parameters are not known."""
    return dict.fromkeys(" ".join(names.split()).split(", "), ())
