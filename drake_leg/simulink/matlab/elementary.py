"""Functions of numbers, element by element, with MATLAB's rounding and exact degrees."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.arithmetic import COMPLEX, elementwise
from drake_leg.simulink.matlab.arrays import Value, number, settle
from drake_leg.simulink.matlab.limits import MatlabError

Elementary = Callable[[Any], Any]
_EPS = float(np.finfo(float).eps)


def of_each(function: Elementary) -> Callable[[Value], Value]:
    """Make a function of NumPy's one of values."""

    def applied(value: Value) -> Value:
        if type(value) is float:
            scalar: float | bool = function(value).item()
            return scalar
        return settle(np.atleast_2d(function(number(value))))

    return applied


def _real(function: Elementary, name: str) -> Callable[[Value], Value]:
    """Refuse where a function of real numbers is complex."""

    def applied(value: Value) -> Value:
        given = number(value)
        found = np.atleast_2d(function(given))
        if np.any(np.isnan(found) & ~np.isnan(given)):
            wrong = np.atleast_2d(given)[np.isnan(found)][0]
            raise MatlabError(f"{name}({wrong:g}) {COMPLEX}")
        return settle(found)

    return applied


def _rounded(x: Any) -> Any:  # noqa: ANN401 - as NumPy's functions
    """Round halves away from zero."""
    return np.trunc(x + np.copysign(np.nextafter(0.5, 0.0), x))


def _sine_in_degrees(x: Any, ahead: float) -> Any:  # noqa: ANN401
    """Sine of degrees and some right angles, exact at whole right angles."""
    turns = _rounded(np.asarray(x) / 90.0)
    quarter, rest = (turns + ahead) % 4.0, (math.pi / 180.0) * (x - 90.0 * turns)
    found = np.where(quarter % 2.0 == 0.0, np.sin(rest), np.cos(rest))
    return np.where(quarter < 2.0, found, 0.0 - found)


def _sind(x: Any) -> Any:  # noqa: ANN401
    return _sine_in_degrees(x, 0.0)


def _cosd(x: Any) -> Any:  # noqa: ANN401
    return _sine_in_degrees(x, 1.0)


def _tand(x: Any) -> Any:  # noqa: ANN401
    return _sind(x) / _cosd(x)


def _mod(x: Any, y: Any) -> Any:  # noqa: ANN401
    """Remainder with the divisor's sign; a quotient that is whole but for rounding leaves 0."""
    quotient = np.divide(x, y)
    meets = np.abs(quotient - _rounded(quotient)) <= _EPS * np.abs(quotient)
    return np.where(np.equal(y, 0), x, np.where(meets, 0.0, np.mod(x, y)))


def _rem(x: Any, y: Any) -> Any:  # noqa: ANN401
    quotient = np.divide(x, y)
    meets = np.abs(quotient - _rounded(quotient)) <= _EPS * np.abs(quotient)
    return np.where(meets, 0.0, np.fmod(x, y))


def of_two(function: Callable[[Any, Any], Any]) -> Callable[[Value, Value], Value]:
    """Make a function of NumPy's one of two values of fitting sizes."""
    return lambda left, right: elementwise(function, left, right)


def _degrees(value: Value) -> Value:
    return settle(np.atleast_2d((180.0 / math.pi) * np.asarray(number(value))))


def _in_degrees(function: Callable[[Value], Value]) -> Callable[[Value], Value]:
    return lambda value: _degrees(function(value))


_ASIN, _ACOS = _real(np.arcsin, "asin"), _real(np.arccos, "acos")
OF_ONE: dict[str, Callable[[Value], Value]] = {
    "sin": of_each(np.sin),
    "cos": of_each(np.cos),
    "tan": of_each(np.tan),
    "asin": _ASIN,
    "acos": _ACOS,
    "atan": of_each(np.arctan),
    "sind": of_each(_sind),
    "cosd": of_each(_cosd),
    "tand": of_each(_tand),
    "asind": _in_degrees(_ASIN),
    "acosd": _in_degrees(_ACOS),
    "atand": _in_degrees(of_each(np.arctan)),
    "sinh": of_each(np.sinh),
    "cosh": of_each(np.cosh),
    "tanh": of_each(np.tanh),
    "deg2rad": of_each(lambda x: np.multiply(math.pi / 180.0, x)),
    "rad2deg": _degrees,
    "sqrt": _real(np.sqrt, "sqrt"),
    "log": _real(np.log, "log"),
    "log2": _real(np.log2, "log2"),
    "log10": _real(np.log10, "log10"),
    "exp": of_each(np.exp),
    "abs": of_each(np.abs),
    "sign": of_each(np.sign),
    "floor": of_each(np.floor),
    "ceil": of_each(np.ceil),
    "round": of_each(_rounded),
    "fix": of_each(np.trunc),
    "double": of_each(np.asarray),
    "isnan": of_each(np.isnan),
    "isinf": of_each(np.isinf),
    "isfinite": of_each(np.isfinite),
}
OF_TWO: dict[str, Callable[[Value, Value], Value]] = {
    "atan2": of_two(np.arctan2),
    "atan2d": lambda y, x: _degrees(elementwise(np.arctan2, y, x)),
    "hypot": of_two(np.hypot),
    "mod": of_two(_mod),
    "rem": of_two(_rem),
}
