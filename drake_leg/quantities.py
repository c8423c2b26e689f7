"""What every quantity of a robot must be: finite, and of a sensible size."""

from __future__ import annotations

import math
from numbers import Real

from drake_leg.errors import InvalidValueError
from drake_leg.units import ANGLE_UNITS as ANGLE_UNITS
from drake_leg.units import DAMPING_UNITS as DAMPING_UNITS
from drake_leg.units import LENGTH_UNITS as LENGTH_UNITS
from drake_leg.units import SPRING_UNITS as SPRING_UNITS
from drake_leg.units import STANDARD_GRAVITY as STANDARD_GRAVITY
from drake_leg.units import TIME_UNITS as TIME_UNITS
from drake_leg.units import in_si as in_si
from drake_leg.units import in_words as in_words
from drake_leg.units import joint_entries as joint_entries

# What is smaller or larger than this in SI units is no robot; numbers beyond it end in an
# overflow inside a parser or a solver.
LEAST, MOST = 1e-30, 1e15
LARGEST_ANGLE = 1e6  # [rad] or [m]

# [rad or m], how far beyond a limit a joint is still at it: more than the rounding of degrees and
# the integration error of a motion that turns back at a limit, and too little to be seen.
AT_LIMIT = 1e-6


def require_number(what: str, value: object) -> None:
    """Refuse what is not a real number."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InvalidValueError(f"{what} is {value!r}; it must be a number")


def require_positive(what: str, value: float, unit: str) -> None:
    """Refuse a value that is not a positive, finite number of a sensible size."""
    require_number(what, value)
    if not (math.isfinite(value) and value > 0.0):
        raise InvalidValueError(f"{what} is {float(value)!r} {unit}; it must be a positive number")
    if not LEAST <= value <= MOST:
        raise InvalidValueError(
            f"{what} is {float(value)!r} {unit}; it must be in {LEAST:g} ... {MOST:g} {unit}"
        )


def require_non_negative(what: str, value: float, unit: str) -> None:
    """Refuse a value that is negative, not finite, or too large or small to be one of a robot."""
    require_number(what, value)
    if not (math.isfinite(value) and value >= 0.0):
        raise InvalidValueError(f"{what} is {float(value)!r} {unit}; it must be zero or positive")
    if value:
        require_positive(what, value, unit)


def require_angle(what: str, value: float) -> None:
    """Refuse a joint position [rad or m] that is not finite or beyond any robot's."""
    require_number(what, value)
    if not math.isfinite(value):
        raise InvalidValueError(f"{what} is {float(value)!r}; it must be a finite angle")
    if abs(value) > LARGEST_ANGLE:
        raise InvalidValueError(
            f"{what} is {float(value)!r} rad; it must be at most {LARGEST_ANGLE:g} rad"
        )


def beyond(position: float, low: float, high: float) -> float:
    """Tell how far a joint is outside its limits [rad or m], which may be infinite.

    Returns
    -------
    float
        Negative below the lower limit, positive above the upper one; 0 within them and up to
        ``AT_LIMIT`` beyond.
    """
    if position < low - AT_LIMIT:
        return position - low
    return position - high if position > high + AT_LIMIT else 0.0
