"""The units that Simscape offers, and their values in SI."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from drake_leg.errors import InvalidValueError

_LONGEST = 60  # characters of a unit
_WORDS = re.compile(r"[A-Za-z_]+|\d+|[*/^()-]")

_PI = Fraction(math.pi)
_INCH = Fraction(254, 10_000)
_POUND = Fraction(45_359_237, 100_000_000)
_GEE = Fraction(980_665, 100_000)

Powers = tuple[int, int, int, int]  # of kg, m, s, rad

_ONE: Powers = (0, 0, 0, 0)
_MASS: Powers = (1, 0, 0, 0)
_LENGTH: Powers = (0, 1, 0, 0)
_TIME: Powers = (0, 0, 1, 0)
_ANGLE: Powers = (0, 0, 0, 1)
_RATE: Powers = (0, 0, -1, 1)
_SPEED: Powers = (0, 1, -1, 0)
_ACCELERATION: Powers = (0, 1, -2, 0)
_FORCE: Powers = (1, 1, -2, 0)
_PRESSURE: Powers = (1, -1, -2, 0)
_ENERGY: Powers = (1, 2, -2, 0)
_POWER: Powers = (1, 2, -3, 0)

_ATOMS: dict[str, tuple[Fraction, Powers]] = {
    "kg": (Fraction(1), _MASS),
    "g": (Fraction(1, 1000), _MASS),
    "mg": (Fraction(1, 1_000_000), _MASS),
    "t": (Fraction(1000), _MASS),
    "lbm": (_POUND, _MASS),
    "oz": (_POUND / 16, _MASS),
    "slug": (_POUND * _GEE / (_INCH * 12), _MASS),
    "m": (Fraction(1), _LENGTH),
    "km": (Fraction(1000), _LENGTH),
    "cm": (Fraction(1, 100), _LENGTH),
    "mm": (Fraction(1, 1000), _LENGTH),
    "um": (Fraction(1, 1_000_000), _LENGTH),
    "in": (_INCH, _LENGTH),
    "ft": (_INCH * 12, _LENGTH),
    "yd": (_INCH * 36, _LENGTH),
    "mi": (_INCH * 63_360, _LENGTH),
    "s": (Fraction(1), _TIME),
    "ms": (Fraction(1, 1000), _TIME),
    "us": (Fraction(1, 1_000_000), _TIME),
    "ns": (Fraction(1, 1_000_000_000), _TIME),
    "min": (Fraction(60), _TIME),
    "hr": (Fraction(3600), _TIME),
    "d": (Fraction(86_400), _TIME),
    "rad": (Fraction(1), _ANGLE),
    "deg": (_PI / 180, _ANGLE),
    "rev": (_PI * 2, _ANGLE),
    "rpm": (_PI / 30, _RATE),
    "Hz": (Fraction(1), (0, 0, -1, 0)),
    "kHz": (Fraction(1000), (0, 0, -1, 0)),
    "mph": (_INCH * 63_360 / 3600, _SPEED),
    "kph": (Fraction(1000, 3600), _SPEED),
    "fpm": (_INCH * 12 / 60, _SPEED),
    "fps": (_INCH * 12, _SPEED),
    "gee": (_GEE, _ACCELERATION),
    "N": (Fraction(1), _FORCE),
    "kN": (Fraction(1000), _FORCE),
    "mN": (Fraction(1, 1000), _FORCE),
    "uN": (Fraction(1, 1_000_000), _FORCE),
    "dyn": (Fraction(1, 100_000), _FORCE),
    "lbf": (_POUND * _GEE, _FORCE),
    "Pa": (Fraction(1), _PRESSURE),
    "kPa": (Fraction(1000), _PRESSURE),
    "MPa": (Fraction(1_000_000), _PRESSURE),
    "GPa": (Fraction(1_000_000_000), _PRESSURE),
    "bar": (Fraction(100_000), _PRESSURE),
    "psi": (_POUND * _GEE / _INCH**2, _PRESSURE),
    "J": (Fraction(1), _ENERGY),
    "kJ": (Fraction(1000), _ENERGY),
    "W": (Fraction(1), _POWER),
    "kW": (Fraction(1000), _POWER),
    "mW": (Fraction(1, 1000), _POWER),
}

_NAMES: dict[Powers, str] = {
    _ONE: "1",
    _LENGTH: "m",
    _TIME: "s",
    _ANGLE: "rad",
    _MASS: "kg",
    _SPEED: "m/s",
    _ACCELERATION: "m/s^2",
    _RATE: "rad/s",
    (0, 0, -2, 1): "rad/s^2",
    _FORCE: "N",
    _PRESSURE: "Pa",
    _POWER: "W",
    _ENERGY: "N*m",
    (1, 0, -2, 0): "N/m",
    (1, 0, -1, 0): "N*s/m",
    (1, 2, -2, -1): "N*m/rad",
    (1, 2, -1, -1): "N*m*s/rad",
    (1, -3, 0, 0): "kg/m^3",
    (1, 2, 0, 0): "kg*m^2",
    (0, 2, 0, 0): "m^2",
    (0, 1, 0, -1): "m/rad",
    (0, 0, -1, 0): "1/s",
}


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit, as its value in SI."""

    factor: Fraction
    powers: Powers

    @property
    def si(self) -> str:
        """Name of the SI unit of the same quantity."""
        return _NAMES.get(self.powers) or "*".join(
            f"{name}^{power}" if power != 1 else name
            for name, power in zip(("kg", "m", "s", "rad"), self.powers, strict=True)
            if power
        )

    def is_like(self, other: Unit) -> bool:
        """Whether both measure the same; radians count for nothing, as in Simscape."""
        return self.powers[:3] == other.powers[:3]

    def in_si(self, value: float) -> float:
        """Return a value of this unit in SI, rounded once."""
        if not math.isfinite(value) or self.factor == 1:
            return value
        try:
            return float(Fraction(value) * self.factor)
        except OverflowError:
            return math.copysign(math.inf, value)


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit:
    """Read a unit as Simscape writes it.

    Parameters
    ----------
    text : str
        ``mm``, ``N*m/(deg/s)``, ``kg/m^3``, ``1``.

    Raises
    ------
    InvalidValueError
        If it is no product of units that are known here.
    """
    words = _WORDS.findall(text)
    if len(text) > _LONGEST or not words or "".join(words) != "".join(text.split()):
        raise InvalidValueError(f"{text[:_LONGEST]!r} is no unit")
    try:
        unit, rest = _product(words)
    except (KeyError, IndexError, ValueError, ZeroDivisionError, OverflowError):
        raise InvalidValueError(f"{text!r} is no unit that is known here") from None
    if rest:
        raise InvalidValueError(f"{text!r} is no unit that is known here")
    return unit


def _product(words: list[str]) -> tuple[Unit, list[str]]:
    unit, words = _power(words)
    while words and words[0] in "*/":
        sign = 1 if words[0] == "*" else -1
        factor, words = _power(words[1:])
        unit = _times(unit, factor, sign)
    return unit, words


def _power(words: list[str]) -> tuple[Unit, list[str]]:
    unit, words = _atom(words)
    if words and words[0] == "^":
        negative = words[1] == "-"
        digits, words = words[1 + negative], words[2 + negative :]
        if int(digits) > 9:
            raise ValueError(digits)
        unit = _times(_ATOM_ONE, unit, -int(digits) if negative else int(digits))
    return unit, words


def _atom(words: list[str]) -> tuple[Unit, list[str]]:
    if words[0] == "(":
        unit, words = _product(words[1:])
        if words[0] != ")":
            raise ValueError(words[0])
        return unit, words[1:]
    if words[0] == "1":
        return _ATOM_ONE, words[1:]
    factor, powers = _ATOMS[words[0]]
    return Unit(factor=factor, powers=powers), words[1:]


def _times(unit: Unit, other: Unit, exponent: int) -> Unit:
    kg, m, s, rad = (
        mine + exponent * theirs for mine, theirs in zip(unit.powers, other.powers, strict=True)
    )
    return Unit(factor=unit.factor * other.factor**exponent, powers=(kg, m, s, rad))


_ATOM_ONE = Unit(factor=Fraction(1), powers=_ONE)
