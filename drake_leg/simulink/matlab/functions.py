"""The functions and constants that are known by name."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.values import (
    COMPLEX,
    Grid,
    MatlabError,
    Value,
    elementwise,
    grid,
    inverse,
    measure,
    number,
    numbers,
    pseudoinverse,
    require_room,
    require_square,
    settle,
    singular,
    whole,
)

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
    """Remainder with the divisor's sign; a quotient that is whole except for rounding leaves 0."""
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


CONSTANTS: dict[str, float | bool] = {
    "pi": math.pi,
    "eps": float(np.finfo(float).eps),
    **dict.fromkeys(("inf", "Inf"), math.inf),
    **dict.fromkeys(("nan", "NaN"), math.nan),
    "realmax": float(np.finfo(float).max),
    "realmin": float(np.finfo(float).tiny),
    "true": True,
    "false": False,
}


def _along(value: Value, axis: Value | None) -> tuple[Grid, int]:
    """Grid and axis that a sum runs along: the first axis that is not 1 long, if none is given."""
    array = numbers(value)
    if axis is None:
        return array, int(array.shape[0] == 1)
    chosen = whole(axis, "the dimension")
    if chosen not in (1, 2):
        raise MatlabError(f"the dimension is {chosen}; there are 1 and 2")
    return array, chosen - 1


def _reduced(reduce: Callable[..., Any]) -> Callable[..., Value]:
    def applied(value: Value, axis: Value | None = None) -> Value:
        array, along = _along(value, axis)
        if axis is None and array.shape == (0, 0):
            return settle(np.atleast_2d(reduce(array)))
        return settle(np.asarray(reduce(array, axis=along, keepdims=True)))

    return applied


def _extreme(name: str, pick: Any, of_pair: Any) -> Callable[..., Value]:  # noqa: ANN401
    def applied(value: Value, other: Value | None = None, axis: Value | None = None) -> Value:
        if other is not None and not (isinstance(other, np.ndarray) and not other.size):
            if axis is not None:
                raise MatlabError(f"{name} of two arrays takes no dimension")
            return of_two(of_pair)(value, other)
        array, along = _along(value, axis)
        if not array.size:
            return np.empty((0, 0))
        return settle(np.asarray(pick(array, axis=along, keepdims=True)))

    return applied


def _made(fill: Callable[[int, int], Grid]) -> Callable[..., Value]:
    def made(*sizes: Value) -> Value:
        given: list[Value] = [size for size in sizes if not isinstance(size, str)]
        rows, columns = _wanted_size(given)
        require_room(rows, columns)
        return settle(fill(rows, columns))

    return made


def _wanted_size(given: list[Value]) -> tuple[int, int]:
    if not given:
        return 1, 1
    sizes: list[Value] = list(numbers(given[0]).flat) if len(given) == 1 else given
    if len(sizes) not in (1, 2):
        raise MatlabError(f"a size has two numbers, not {len(sizes)}")
    whole_ones = [max(0, whole(float(size), "a size")) for size in map(_scalar, sizes)]
    return whole_ones[0], whole_ones[-1]


def _scalar(value: Value) -> float:
    array = numbers(value)
    if array.size != 1:
        raise MatlabError(f"an array of {measure(value)} is used where a number is needed")
    return float(array.item())


def _diag(value: Value) -> Value:
    array = grid(value)
    if 1 in array.shape:
        require_room(array.size, array.size)
        return settle(np.diagflat(array))
    return settle(np.diag(array)[:, np.newaxis])


def _norm(value: Value, order: Value = 2.0) -> Value:
    array = numbers(value)
    if order == "fro" or not array.size:
        return float(np.sqrt(np.sum(array**2)))
    kind = _scalar(order)
    if kind not in (1.0, 2.0, math.inf):
        raise MatlabError(f"norm of order {kind:g} is not supported: 1, 2, inf or 'fro'")
    if 1 in array.shape:
        return float(np.linalg.norm(array.ravel(), kind))
    if kind == 2.0:
        return float(singular(array, "norm")[1][0])
    return float(np.linalg.norm(array, kind))


def _det(value: Value) -> Value:
    matrix = numbers(value)
    require_square(matrix, "det")
    return float(np.linalg.det(matrix))


def _size(value: Value, axis: Value | None = None) -> Value:
    extents = grid(value).shape
    if axis is None:
        return np.array([extents], dtype=float)
    chosen = whole(axis, "the dimension")
    if chosen < 1:
        raise MatlabError(f"the dimension is {chosen}; it counts from 1")
    return float(extents[chosen - 1]) if chosen <= 2 else 1.0


def _cross(left: Value, right: Value) -> Value:
    a, b = numbers(left), numbers(right)
    if a.size != 3 or b.size != 3:
        raise MatlabError(f"cross needs vectors of 3, not {measure(left)} and {measure(right)}")
    product = np.cross(a.ravel(), b.ravel())
    return product.reshape(a.shape if a.shape == b.shape else (3, 1))


def _dot(left: Value, right: Value) -> Value:
    a, b = numbers(left), numbers(right)
    if 1 in a.shape and 1 in b.shape and a.size == b.size:
        return float(a.ravel() @ b.ravel())
    if a.shape != b.shape:
        raise MatlabError(f"dot of {measure(left)} and {measure(right)} does not match in size")
    return settle(np.sum(a * b, axis=0, keepdims=True))


def _reshape(value: Value, *sizes: Value) -> Value:
    array = grid(value)
    rows, columns = _wanted_size(list(sizes))
    if rows * columns != array.size:
        raise MatlabError(f"{measure(value)} cannot be reshaped to {rows}×{columns}")
    return settle(array.reshape(rows, columns, order="F"))


def _repmat(value: Value, *sizes: Value) -> Value:
    array = grid(value)
    rows, columns = _wanted_size(list(sizes))
    require_room(rows * array.shape[0], columns * array.shape[1])
    return settle(np.tile(array, (rows, columns)))


def _linspace(first: Value, last: Value, count: Value = 100.0) -> Value:
    number = max(1, whole(count, "the count of linspace"))
    require_room(1, number)
    start, stop = _scalar(first), _scalar(last)
    row = np.linspace(start, stop, number) if number > 1 else np.array([stop])
    return settle(row[np.newaxis, :])


def _eps(value: Value) -> Value:
    return settle(np.atleast_2d(np.abs(np.spacing(numbers(value)))))


def _length(value: Value) -> Value:
    return float(max(grid(value).shape) if grid(value).size else 0)


_Known = tuple[int, int, Callable[..., Value]]  # least and most arguments
KNOWN: dict[str, _Known] = {
    **{name: (1, 1, function) for name, function in OF_ONE.items()},
    **{name: (2, 2, function) for name, function in OF_TWO.items()},
    "min": (1, 3, _extreme("min", np.fmin.reduce, np.fmin)),
    "max": (1, 3, _extreme("max", np.fmax.reduce, np.fmax)),
    "sum": (1, 2, _reduced(np.sum)),
    "prod": (1, 2, _reduced(np.prod)),
    "mean": (1, 2, _reduced(np.mean)),
    "any": (1, 2, _reduced(np.any)),
    "all": (1, 2, _reduced(np.all)),
    "zeros": (0, 3, _made(lambda rows, columns: np.zeros((rows, columns)))),
    "ones": (0, 3, _made(lambda rows, columns: np.ones((rows, columns)))),
    "eye": (0, 3, _made(lambda rows, columns: np.eye(rows, columns))),
    "diag": (1, 1, _diag),
    "norm": (1, 2, _norm),
    "inv": (1, 1, lambda value: settle(inverse(numbers(value)))),
    "pinv": (1, 1, lambda value: settle(pseudoinverse(numbers(value)))),
    "det": (1, 1, _det),
    "trace": (1, 1, lambda value: float(np.trace(numbers(value)))),
    "transpose": (1, 1, lambda value: settle(grid(value).T)),
    "ctranspose": (1, 1, lambda value: settle(grid(value).T)),
    "numel": (1, 1, lambda value: float(grid(value).size)),
    "length": (1, 1, _length),
    "size": (1, 2, _size),
    "isempty": (1, 1, lambda value: not grid(value).size),
    "logical": (1, 1, lambda value: settle(grid(value) != 0)),
    "cross": (2, 2, _cross),
    "dot": (2, 2, _dot),
    "reshape": (2, 3, _reshape),
    "repmat": (2, 3, _repmat),
    "linspace": (2, 3, _linspace),
    "eps": (1, 1, _eps),
}
HEAVY = frozenset(("inv", "pinv", "det", "norm"))
SILENT = frozenset(("disp", "display", "fprintf", "warning"))  # they print; nothing here does
