"""What every quantity of a robot must be: finite, of a sensible size, and its units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real

from drake_leg.errors import InvalidValueError

# What is smaller or larger than this in SI units is no robot; numbers beyond it end in an
# overflow inside a parser or a solver.
LEAST, MOST = 1e-30, 1e15
LARGEST_ANGLE = 1e6  # [rad] or [m]

STANDARD_GRAVITY = 9.80665  # [m/s^2], Simscape's default; Drake's own is 9.81

# In s, rad and m.
TIME_UNITS = {"s": 1.0, "ms": 1e-3}
ANGLE_UNITS = {"rad": 1.0, "deg": math.pi / 180.0}
LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}

# In N*m*s/rad; N*m/(deg/s) is Simscape's default.
DAMPING_UNITS = {"N*m*s/rad": 1.0, "N*m/(deg/s)": 180.0 / math.pi}

# In N*m/rad; N*m/deg is Simscape's default.
SPRING_UNITS = {"N*m/rad": 1.0, "N*m/deg": 180.0 / math.pi}


def require_number(what: str, value: object) -> None:
    """Refuse what is no real number.

    Raises
    ------
    InvalidValueError
        Naming the quantity and the value.
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InvalidValueError(f"{what} is {value!r}; it must be a number")


def require_positive(what: str, value: float, unit: str) -> None:
    """Refuse a value that is not a positive finite number.

    Raises
    ------
    InvalidValueError
        Naming the quantity, the value and the unit.
    """
    require_number(what, value)
    if not (math.isfinite(value) and value > 0.0):
        raise InvalidValueError(f"{what} is {float(value)!r} {unit}; it must be a positive number")
    if not LEAST <= value <= MOST:
        raise InvalidValueError(
            f"{what} is {float(value)!r} {unit}; it must be in {LEAST:g} ... {MOST:g} {unit}"
        )


def require_non_negative(what: str, value: float, unit: str) -> None:
    """Refuse a value that is negative or not finite.

    Raises
    ------
    InvalidValueError
        Naming the quantity, the value and the unit.
    """
    require_number(what, value)
    if not (math.isfinite(value) and value >= 0.0):
        raise InvalidValueError(f"{what} is {float(value)!r} {unit}; it must be zero or positive")
    if value:
        require_positive(what, value, unit)


def in_si(what: str, value: float, unit: str, units: Mapping[str, float]) -> float:
    """Convert what was typed in one of several units.

    Parameters
    ----------
    what : str
        Of which quantity it is the unit, for the error's sentence.
    value : float
        In that unit.
    unit : str
        Its name.
    units : mapping
        Name -> value in SI.

    Returns
    -------
    float

    Raises
    ------
    InvalidValueError
        If the unit is none of these.
    """
    if unit not in units:
        raise InvalidValueError(f"the {what} unit is {unit!r}; it must be {' or '.join(units)}")
    return value * units[unit]


def require_angle(what: str, value: float) -> None:
    """Refuse a joint position that is not finite or beyond any robot's.

    Raises
    ------
    InvalidValueError
        Naming the quantity and the value.
    """
    require_number(what, value)
    if not math.isfinite(value):
        raise InvalidValueError(f"{what} is {float(value)!r}; it must be a finite angle")
    if abs(value) > LARGEST_ANGLE:
        raise InvalidValueError(
            f"{what} is {float(value)!r} rad; it must be at most {LARGEST_ANGLE:g} rad"
        )
