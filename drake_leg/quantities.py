"""What every quantity of a robot must be: finite, of a sensible size, and its units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

from drake_leg.errors import InvalidValueError

# What is smaller or larger than this in SI units is no robot; numbers beyond it end in an
# overflow inside a parser or a solver.
LEAST, MOST = 1e-30, 1e15
LARGEST_ANGLE = 1e6  # [rad] or [m]

# [rad or m], how far beyond a limit a joint is still at it: the rounding of degrees, and what the
# integration of a motion that turns back at a limit errs by, is less; nobody sees a micrometre.
AT_LIMIT = 1e-6

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
    units : mapping
        Name -> value in SI.

    Raises
    ------
    InvalidValueError
        If the unit is none of these.
    """
    if unit not in units:
        raise InvalidValueError(f"the {what} unit is {unit!r}; it must be {' or '.join(units)}")
    return value * units[unit]


def beyond(position: float, low: float, high: float) -> float:
    """Tell how far a joint is outside its limits.

    Parameters
    ----------
    position, low, high : float
        [rad or m]; a limit may be infinite.

    Returns
    -------
    float
        Negative below the lower limit, positive above the upper one; 0 within them and up to
        ``AT_LIMIT`` beyond.
    """
    if position < low - AT_LIMIT:
        return position - low
    return position - high if position > high + AT_LIMIT else 0.0


def in_words(position: float, *, slides: bool) -> str:
    """Write a joint's position as a person gives it: in m where it slides, else in degrees.

    Parameters
    ----------
    position : float
        [rad or m].
    slides : bool
        Whether the joint is prismatic.

    Returns
    -------
    str
        ``120 deg``.
    """
    return f"{position:.9g} m" if slides else f"{math.degrees(position):.9g} deg"


def joint_entries(name: str, q: Sequence[float], slides: Sequence[bool]) -> dict[str, Any]:
    """Name joint positions for a summary: ``q0_deg``, or ``q0`` and its units where a joint slides.

    Parameters
    ----------
    q : (n,) sequence of float
        [rad or m].
    slides : (n,) sequence of bool
        Which joints are prismatic.
    """
    shown = [
        position if sliding else round(math.degrees(position), 9)
        for position, sliding in zip(q, slides, strict=True)
    ]
    if not any(slides):
        return {f"{name}_deg": shown}
    return {name: shown, f"{name}_units": ["m" if sliding else "deg" for sliding in slides]}


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
