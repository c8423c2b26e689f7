"""Converts units to SI, and refuses quantities that are not finite or of no sensible size."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from typing import Any, Literal

from drake_leg.arguments import is_number, shown
from drake_leg.errors import InvalidValueError

AngleUnit = Literal["deg", "rad"]
Powers = tuple[int, int, int, int, int, int]  # of kg, m, s, rad, A, K

_LONGEST = 60  # characters of a unit
_WORDS = re.compile(r"[A-Za-z_]+|\d+|[*/^()-]")

_PI, _GEE = Fraction(math.pi), Fraction("9.80665")
_INCH, _POUND = Fraction("0.0254"), Fraction("0.45359237")
STANDARD_GRAVITY = float(_GEE)  # [m/s^2], Simscape's default; Drake's own is 9.81

# No robot has a smaller or larger quantity in SI units; numbers beyond these overflow in a parser
# or a solver.
LEAST, MOST = 1e-30, 1e15
LARGEST_ANGLE = 1e6  # [rad] or [m]

# [rad or m], how far beyond its limit a joint still counts as at it: more than the rounding of
# degrees and the integration error of a motion that turns back at a limit, too little to be seen.
AT_LIMIT = 1e-6


# --- units and their values in SI ------------------------------------------------------------

_BASE = ("kg", "m", "s", "rad", "A", "K")


def _of(
    kg: int = 0, m: int = 0, s: int = 0, rad: int = 0, ampere: int = 0, kelvin: int = 0
) -> Powers:
    return kg, m, s, rad, ampere, kelvin


_MASS, _LENGTH, _TIME, _ANGLE = _of(1), _of(0, 1), _of(0, 0, 1), _of(0, 0, 0, 1)
_CURRENT, _TEMPERATURE = _of(ampere=1), _of(kelvin=1)
_RATE, _FREQUENCY = _of(s=-1, rad=1), _of(s=-1)
_SPEED, _ACCELERATION = _of(m=1, s=-1), _of(m=1, s=-2)
_FORCE, _PRESSURE = _of(1, 1, -2), _of(1, -1, -2)
_ENERGY, _POWER = _of(1, 2, -2), _of(1, 2, -3)
_VOLTAGE, _RESISTANCE = _of(1, 2, -3, ampere=-1), _of(1, 2, -3, ampere=-2)
_CONDUCTANCE = _of(-1, -2, 3, ampere=2)
_INDUCTANCE, _CAPACITANCE = _of(1, 2, -2, ampere=-2), _of(-1, -2, 4, ampere=2)
_CHARGE, _VOLUME, _FLOW = _of(s=1, ampere=1), _of(m=3), _of(m=3, s=-1)

_ATOMS: dict[str, tuple[Fraction | int, Powers]] = {
    "kg": (1, _MASS),
    "g": (Fraction("1e-3"), _MASS),
    "mg": (Fraction("1e-6"), _MASS),
    "t": (1000, _MASS),
    "lbm": (_POUND, _MASS),
    "oz": (_POUND / 16, _MASS),
    "slug": (_POUND * _GEE / (_INCH * 12), _MASS),
    "m": (1, _LENGTH),
    "km": (1000, _LENGTH),
    "cm": (Fraction("1e-2"), _LENGTH),
    "mm": (Fraction("1e-3"), _LENGTH),
    "um": (Fraction("1e-6"), _LENGTH),
    "in": (_INCH, _LENGTH),
    "ft": (_INCH * 12, _LENGTH),
    "yd": (_INCH * 36, _LENGTH),
    "mi": (_INCH * 63_360, _LENGTH),
    "s": (1, _TIME),
    "ms": (Fraction("1e-3"), _TIME),
    "us": (Fraction("1e-6"), _TIME),
    "ns": (Fraction("1e-9"), _TIME),
    "min": (60, _TIME),
    "hr": (3600, _TIME),
    "d": (86_400, _TIME),
    "rad": (1, _ANGLE),
    "deg": (_PI / 180, _ANGLE),
    "rev": (_PI * 2, _ANGLE),
    "rpm": (_PI / 30, _RATE),
    "Hz": (1, _FREQUENCY),
    "kHz": (1000, _FREQUENCY),
    "mph": (_INCH * 63_360 / 3600, _SPEED),
    "kph": (Fraction(1000, 3600), _SPEED),
    "fpm": (_INCH * 12 / 60, _SPEED),
    "fps": (_INCH * 12, _SPEED),
    "gee": (_GEE, _ACCELERATION),
    "N": (1, _FORCE),
    "kN": (1000, _FORCE),
    "mN": (Fraction("1e-3"), _FORCE),
    "uN": (Fraction("1e-6"), _FORCE),
    "dyn": (Fraction("1e-5"), _FORCE),
    "lbf": (_POUND * _GEE, _FORCE),
    "Pa": (1, _PRESSURE),
    "kPa": (1000, _PRESSURE),
    "MPa": (10**6, _PRESSURE),
    "GPa": (10**9, _PRESSURE),
    "bar": (10**5, _PRESSURE),
    "psi": (_POUND * _GEE / _INCH**2, _PRESSURE),
    "J": (1, _ENERGY),
    "kJ": (1000, _ENERGY),
    "W": (1, _POWER),
    "kW": (1000, _POWER),
    "mW": (Fraction("1e-3"), _POWER),
    "A": (1, _CURRENT),
    "mA": (Fraction("1e-3"), _CURRENT),
    "uA": (Fraction("1e-6"), _CURRENT),
    "kA": (1000, _CURRENT),
    "V": (1, _VOLTAGE),
    "mV": (Fraction("1e-3"), _VOLTAGE),
    "kV": (1000, _VOLTAGE),
    "Ohm": (1, _RESISTANCE),
    "mOhm": (Fraction("1e-3"), _RESISTANCE),
    "kOhm": (1000, _RESISTANCE),
    "MOhm": (10**6, _RESISTANCE),
    "S": (1, _CONDUCTANCE),
    "mS": (Fraction("1e-3"), _CONDUCTANCE),
    "uS": (Fraction("1e-6"), _CONDUCTANCE),
    "H": (1, _INDUCTANCE),
    "mH": (Fraction("1e-3"), _INDUCTANCE),
    "uH": (Fraction("1e-6"), _INDUCTANCE),
    "nH": (Fraction("1e-9"), _INDUCTANCE),
    "F": (1, _CAPACITANCE),
    "mF": (Fraction("1e-3"), _CAPACITANCE),
    "uF": (Fraction("1e-6"), _CAPACITANCE),
    "nF": (Fraction("1e-9"), _CAPACITANCE),
    "pF": (Fraction("1e-12"), _CAPACITANCE),
    "c": (1, _CHARGE),
    "K": (1, _TEMPERATURE),
    "l": (Fraction("1e-3"), _VOLUME),
    "lpm": (Fraction(1, 60_000), _FLOW),
}

_SI_NAMES: dict[Powers, str] = {
    _of(0, 0, 0, 0): "1",
    _MASS: "kg",
    _LENGTH: "m",
    _TIME: "s",
    _ANGLE: "rad",
    _SPEED: "m/s",
    _ACCELERATION: "m/s^2",
    _RATE: "rad/s",
    _of(0, 0, -2, 1): "rad/s^2",
    _FORCE: "N",
    _PRESSURE: "Pa",
    _POWER: "W",
    _ENERGY: "N*m",
    _of(1, 0, -2, 0): "N/m",
    _of(1, 0, -1, 0): "N*s/m",
    _of(1, 2, -2, -1): "N*m/rad",
    _of(1, 2, -1, -1): "N*m*s/rad",
    _of(1, -3, 0, 0): "kg/m^3",
    _of(1, 2, 0, 0): "kg*m^2",
    _of(1, 3, -2, 0): "N*m^2",
    _of(0, 2, 0, 0): "m^2",
    _of(0, 1, 0, -1): "m/rad",
    _FREQUENCY: "1/s",
    _CURRENT: "A",
    _TEMPERATURE: "K",
    _VOLTAGE: "V",
    _RESISTANCE: "Ohm",
    _CONDUCTANCE: "S",
    _INDUCTANCE: "H",
    _CAPACITANCE: "F",
    _VOLUME: "m^3",
    _FLOW: "m^3/s",
}


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit, as its exact value in SI."""

    factor: Fraction
    powers: Powers

    @property
    def si(self) -> str:
        """Name of the SI unit of the same quantity."""
        return _SI_NAMES.get(self.powers) or "*".join(
            f"{name}^{power}" if power != 1 else name
            for name, power in zip(_BASE, self.powers, strict=True)
            if power
        )

    def is_like(self, other: Unit) -> bool:
        """Whether both measure the same; radians do not count, as in Simscape."""
        return self._without_radians == other._without_radians

    @property
    def _without_radians(self) -> Powers:
        return (*self.powers[:3], 0, *self.powers[4:])

    def in_si(self, value: float) -> float:
        """Convert a value of this unit to SI, rounded once."""
        if not math.isfinite(value) or self.factor == 1:
            return value
        try:
            return float(Fraction(value) * self.factor)
        except OverflowError:
            return math.copysign(math.inf, value)

    def times(self, other: Unit, exponent: int) -> Unit:
        """Multiply by a power of another unit."""
        both = zip(self.powers, other.powers, strict=True)
        powers = _of(*(mine + exponent * theirs for mine, theirs in both))
        return Unit(factor=self.factor * other.factor**exponent, powers=powers)


_ONE = Unit(factor=Fraction(1), powers=_of())


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit:
    """Read a unit as Simscape writes it: ``mm``, ``N*m/(deg/s)``, ``kg/m^3``, ``1``."""
    words = _WORDS.findall(text)
    if len(text) > _LONGEST or not words or "".join(words) != "".join(text.split()):
        raise InvalidValueError(f"{text[:_LONGEST]!r} is not a unit")
    try:
        unit, rest = _product(words)
    except (KeyError, IndexError, ValueError, ZeroDivisionError, OverflowError):
        raise InvalidValueError(f"{text!r} is not a known unit") from None
    if rest:
        raise InvalidValueError(f"{text!r} is not a known unit")
    return unit


def _product(words: list[str]) -> tuple[Unit, list[str]]:
    """Read factors, and return what follows them."""
    unit, words = _power(words)
    while words and words[0] in "*/":
        sign = 1 if words[0] == "*" else -1
        factor, words = _power(words[1:])
        unit = unit.times(factor, sign)
    return unit, words


def _power(words: list[str]) -> tuple[Unit, list[str]]:
    unit, words = _atom(words)
    if words and words[0] == "^":
        negative = words[1] == "-"
        digits, words = words[1 + negative], words[2 + negative :]
        if int(digits) > 9:
            raise ValueError(digits)
        unit = _ONE.times(unit, -int(digits) if negative else int(digits))
    return unit, words


def _atom(words: list[str]) -> tuple[Unit, list[str]]:
    if words[0] == "(":
        unit, words = _product(words[1:])
        if words[0] != ")":
            raise ValueError(words[0])
        return unit, words[1:]
    if words[0] == "1":
        return _ONE, words[1:]
    factor, powers = _ATOMS[words[0]]
    return Unit(factor=Fraction(factor), powers=powers), words[1:]


# --- units that a person can choose from -----------------------------------------------------


def _choices(*units: str) -> dict[str, float]:
    """Map units to their values in SI: ``mm`` to 0.001."""
    return {unit: parse_unit(unit).in_si(1.0) for unit in units}


TIME_UNITS = _choices("s", "ms")
ANGLE_UNITS = _choices("rad", "deg")
LENGTH_UNITS = _choices("m", "cm", "mm")
DAMPING_UNITS = _choices("N*m*s/rad", "N*m/(deg/s)")  # SI, and Simscape's default
SPRING_UNITS = _choices("N*m/rad", "N*m/deg")  # likewise
SLIDING_DAMPING_UNITS = _choices("N*s/m")
SLIDING_SPRING_UNITS = _choices("N/m")


def in_si(what: str, value: float, unit: str, units: Mapping[str, float]) -> float:
    """Convert a value in one of several units to SI; ``units`` maps them to their values in SI."""
    if unit not in units:
        raise InvalidValueError(f"the {what} unit is {unit!r}; it must be {' or '.join(units)}")
    return value * units[unit]


@dataclass(frozen=True, kw_only=True)
class JointUnits:
    """The units of a joint in a robot file."""

    position: str  # deg, rad or m
    effort: str
    stiffness: dict[str, float]  # unit -> its value in SI, the default first
    damping: dict[str, float]  # likewise

    @property
    def velocity(self) -> str:
        """Unit of the joint's speed."""
        return f"{self.position}/s"

    @property
    def rotor_inertia(self) -> str:
        """Unit of a rotor's inertia, seen at the joint."""
        return "kg" if self.position == "m" else "kg*m^2"

    def si(self, value: float) -> float:
        """Convert a position or a speed to rad, m, rad/s or m/s."""
        return math.radians(value) if self.position == "deg" else value


def joint_units(joint: str, angles: AngleUnit) -> JointUnits:
    """Choose the units of a joint of this kind, ``"prismatic"`` or another."""
    if joint == "prismatic":
        return JointUnits(
            position="m",
            effort="N",
            stiffness=SLIDING_SPRING_UNITS,
            damping=SLIDING_DAMPING_UNITS,
        )
    return JointUnits(position=angles, effort="N*m", stiffness=SPRING_UNITS, damping=DAMPING_UNITS)


# --- joint positions -------------------------------------------------------------------------


def in_radians(angle: float, angles: AngleUnit) -> float:
    """Convert an angle in this unit to radians."""
    return math.radians(angle) if angles == "deg" else angle


def exact_degrees(angle: float) -> float | None:
    """Find the shortest number of degrees that is exactly this angle [rad] when converted back.

    None where there is none.
    """
    degrees = math.degrees(angle)
    rounded = (round(degrees, digits) for digits in range(16))
    neighbours = (math.nextafter(degrees, math.inf), math.nextafter(degrees, -math.inf))
    for candidate in (*rounded, degrees, *neighbours):
        if math.radians(candidate) == angle:
            return candidate
    return None


def in_words(position: float, *, slides: bool) -> str:
    """Write a joint's position [rad or m] in degrees, or in m where it slides: ``120 deg``."""
    return f"{position:.9g} m" if slides else f"{math.degrees(position):.9g} deg"


def joint_entries(name: str, q: Sequence[float], slides: Sequence[bool]) -> dict[str, Any]:
    """Name joint positions [rad or m] for a summary: ``q0_deg``, or ``q0`` and ``q0_units``."""
    shown = [
        position if sliding else round(math.degrees(position), 9)
        for position, sliding in zip(q, slides, strict=True)
    ]
    if not any(slides):
        return {f"{name}_deg": shown}
    return {name: shown, f"{name}_units": ["m" if sliding else "deg" for sliding in slides]}


# --- sizes of quantities ---------------------------------------------------------------------


def require_number(what: str, value: object) -> None:
    """Refuse what is not a real number."""
    if not is_number(value):
        raise InvalidValueError(f"{what} is {shown(value)}; it must be a number")


def require_finite(what: str, value: float) -> None:
    """Refuse what is not a finite number."""
    require_number(what, value)
    if not math.isfinite(value):
        raise InvalidValueError(f"{what} is {float(value)!r}; it must be a finite number")


def require_three(what: str, values: Iterable[float]) -> None:
    """Refuse what is not three finite numbers."""
    parts = tuple(values) if isinstance(values, Iterable) else ()
    try:
        for part in parts:
            require_finite(what, part)
    except InvalidValueError:
        parts = ()
    if len(parts) != 3:
        raise InvalidValueError(f"{what} is {shown(values)}; it must be three finite numbers")


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
    """Refuse a value that is neither zero nor a positive, finite number of a sensible size."""
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

    Negative below the lower limit, positive above the upper one; 0 within them and up to
    ``AT_LIMIT`` beyond.
    """
    if position < low - AT_LIMIT:
        return position - low
    return position - high if position > high + AT_LIMIT else 0.0


def plain_number(value: float, digits: int) -> str:
    """Write a number with so many digits and without an exponent: ``12000``, ``0.00012``.

    Python's ``g`` writes 10000 with four digits as ``1e+04``.
    """
    return format(Decimal(f"{value + 0.0:.{digits}g}"), "f")
