"""Operators on the values of scripts: arrays of any dimensions, complex numbers and texts."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import numeric
from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Function,
    Struct,
    Structs,
    Text,
    array_of,
    boxed,
    items_of,
    numbers_of,
    settled,
)
from drake_leg.simulink.matlab.numeric import MatlabError, measure
from drake_leg.simulink.matlab.transfers import TransferFunction, combined_transfers

# ruff: noqa: ANN401 - any value of a script
_PLAIN: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    ".*": operator.mul,
    "==": operator.eq,
    "~=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
EACH: dict[str, Callable[[Any, Any], Any]] = {
    "+": np.add,
    "-": np.subtract,
    ".*": np.multiply,
    "./": np.divide,
    ".\\": lambda a, b: np.divide(b, a),
    ".^": numeric.power,
    "==": np.equal,
    "~=": np.not_equal,
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "&": lambda a, b: np.logical_and(a != 0, b != 0),
    "|": lambda a, b: np.logical_or(a != 0, b != 0),
}
_WHOLE = {"*": ".*", "/": "./", "\\": ".\\", "^": ".^"}


def combined(symbol: str, left: Any, right: Any, budget: Allowance) -> Any:
    """Combine two values by an operator."""
    if type(left) is float and type(right) is float:
        if symbol in _PLAIN:
            return _PLAIN[symbol](left, right)
        if symbol in ("/", "./") and right:
            return left / right
    if isinstance(left, TransferFunction) or isinstance(right, TransferFunction):
        return combined_transfers(symbol, left, right)
    if isinstance(left, Text) or isinstance(right, Text):
        return _texts(symbol, left, right)
    if symbol in _WHOLE:
        a, b = numbers_of(left), numbers_of(right)
        if not _by_elements(symbol, a, b):
            return _matrices(symbol, a, b, budget)
        symbol = _WHOLE[symbol]
    return each(EACH[symbol], left, right, budget)


def _by_elements(symbol: str, a: Any, b: Any) -> bool:
    """Tell whether an operator of matrices has a number for an operand."""
    one = {"*": a.size == 1 or b.size == 1, "/": b.size == 1, "\\": a.size == 1}
    return bool(one.get(symbol, a.size == b.size == 1))


def each(
    function: Callable[[Any, Any], Any],
    left: Any,
    right: Any,
    budget: Allowance,
) -> Any:
    """Combine two values element by element; rows, columns and numbers are repeated."""
    a, b = numbers_of(left), numbers_of(right)
    if a.shape != b.shape:
        dimensions = max(a.ndim, b.ndim)
        a = a.reshape((*a.shape, *(1,) * (dimensions - a.ndim)))
        b = b.reshape((*b.shape, *(1,) * (dimensions - b.ndim)))
        for m, n in zip(a.shape, b.shape, strict=True):
            if m != n and 1 not in (m, n):
                raise MatlabError(f"sizes {measure(a)} and {measure(b)} do not match")
    shape = [n if m == 1 else m for m, n in zip(a.shape, b.shape, strict=True)]
    budget.room(float(np.prod(shape, dtype=float)))
    return settled(np.asarray(function(a, b)))


def _texts(symbol: str, left: Any, right: Any) -> Any:
    a, b = (str(x) if isinstance(x, str) else f"{numbers_of(x).flat[0]:.5g}" for x in (left, right))
    if symbol == "+":
        return Text(a + b)
    if symbol == "==":
        return a == b
    if symbol == "~=":
        return a != b
    raise MatlabError(f"'{symbol}' does not work on a string")


def _matrices(symbol: str, a: Any, b: Any, budget: Allowance) -> Any:
    if a.ndim > 2 or b.ndim > 2:
        raise MatlabError(f"'{symbol}' of arrays of more than two dimensions")
    if symbol == "*":
        if a.shape[1] != b.shape[0]:
            raise MatlabError(f"{measure(a)} times {measure(b)} does not match in size")
        budget.room(float(a.shape[0]) * b.shape[1])
        budget.work(float(a.size) * b.shape[1])
        return settled(a @ b)
    budget.work(float(a.size + b.size) * (min(a.shape) + min(b.shape)))
    if symbol == "\\":
        return settled(numeric.solve(a, b))
    if symbol == "/":
        return settled(numeric.solve(b.T, a.T).T)
    return settled(_matrix_power(a, b))


def _matrix_power(a: Any, b: Any) -> Any:
    if b.size != 1:
        raise MatlabError("the exponent of a matrix is an array; it must be a whole number")
    exponent = float(b.flat[0].real)
    if not exponent.is_integer():
        raise MatlabError(f"the exponent of a matrix is {exponent:g}; it must be a whole number")
    numeric.require_square(a, "a power (^; for each element, .^)")
    if abs(exponent) > numeric.EXPONENT:
        raise MatlabError(f"the exponent {int(exponent)} of a matrix is beyond {numeric.EXPONENT}")
    base = numeric.inverse(a) if exponent < 0 else a
    return np.linalg.matrix_power(base, abs(int(exponent)))


def sign(symbol: str, value: Any) -> Any:
    """``+``, ``-`` and ``~`` before a value."""
    if symbol == "~":
        array = array_of(value)
        _require_number(array)
        return settled(array == 0)
    if type(value) is float:
        return -value if symbol == "-" else value
    if isinstance(value, TransferFunction):
        return combined_transfers("*", value, -1.0 if symbol == "-" else 1.0)
    array = numbers_of(value)
    return settled(-array if symbol == "-" else array)


def _require_number(array: Any) -> None:
    if np.isnan(array).any():
        raise MatlabError("NaN is neither true nor false")


def transposed(symbol: str, value: Any) -> Any:
    """``value'`` and ``value.'``."""
    if isinstance(value, np.ndarray):
        if value.ndim > 2:
            raise MatlabError("an array of more than two dimensions has no transpose")
        return np.conj(value.T) if symbol == "'" and np.iscomplexobj(value) else value.T
    if isinstance(value, complex):
        return value.conjugate() if symbol == "'" else value
    if isinstance(value, Cell):
        return Cell(value.items.T)
    if isinstance(value, Structs):
        return Structs(value.items.T, value.names)
    return value


def truth(value: Any) -> bool:
    """Tell whether a value counts as true: not empty, and no element zero."""
    if isinstance(value, (bool, float)) and value == value:
        return value != 0
    array = array_of(value)
    _require_number(array)
    return bool(array.size and array.all())


def same(left: Any, right: Any) -> bool:
    """Tell whether a case is that of a switch."""
    if isinstance(left, str) or isinstance(right, str):
        return isinstance(left, str) and isinstance(right, str) and str(left) == str(right)
    a, b = array_of(left), array_of(right)
    return bool(a.size and b.size and (a.flat[0] == b.flat[0]))


def span(parts: list[Any], budget: Allowance) -> Any:
    """``first:step:last``."""
    arrays = [numbers_of(part) for part in parts]
    if any(not array.size for array in arrays):
        return np.zeros((1, 0))
    ends = [float(np.real(array.flat[0])) for array in arrays]
    step = ends[1] if len(ends) == 3 else 1.0
    return settled(numeric.span(ends[0], step, ends[-1], budget.room))


def stacked(rows: list[list[Any]], budget: Allowance) -> Any:
    """Put the blocks of a matrix literal together; blocks of 0×0 are left out."""
    flat = [value for row in rows for value in row]
    if not any(type(value) is not float for value in flat):
        return _of_numbers(rows, budget)
    budget.room(sum(map(_count, flat)))
    if any(isinstance(value, Cell) for value in flat):
        return Cell(_joined(rows, lambda v: v.items if isinstance(v, Cell) else boxed([[v]])))
    if any(isinstance(value, (Struct, Structs)) for value in flat):
        names = next(
            tuple(v) if isinstance(v, Struct) else v.names
            for v in flat
            if isinstance(v, (Struct, Structs))
        )
        items = _joined(rows, items_of)
        return items.flat[0] if items.size == 1 else Structs(items, names)
    if any(isinstance(value, Function) for value in flat):
        raise MatlabError("functions do not go into a matrix; use a cell")
    if any(isinstance(value, Text) for value in flat):
        return flat[0] if len(flat) == 1 else Cell(boxed(rows))
    if any(isinstance(value, str) for value in flat):
        lines = ["".join(v if isinstance(v, str) else _codes(v) for v in row) for row in rows]
        return lines[0] if len(lines) == 1 else Cell(boxed([[line] for line in lines]))
    logical = all(array_of(value).dtype == np.bool_ for value in flat)
    return settled(_joined(rows, array_of if logical else numbers_of))


def _of_numbers(rows: list[list[Any]], budget: Allowance) -> Any:
    budget.room(sum(map(len, rows)))
    widths = {len(row) for row in rows if row}
    if len(widths) > 1:
        sizes = ", ".join(f"1×{len(row)}" for row in rows[:6])
        raise MatlabError(f"rows of {sizes} cannot be stacked: they differ in width")
    if not widths:
        return np.zeros((0, 0))
    return settled(np.array([row for row in rows if row]))


def _count(value: Any) -> int:
    if isinstance(value, (np.ndarray, str)):
        return value.size if isinstance(value, np.ndarray) else len(value)
    return value.items.size if isinstance(value, (Cell, Structs)) else 1


def _codes(value: Any) -> str:
    return "".join(chr(int(code)) for code in array_of(value).ravel(order="F").real)


def _joined(rows: list[list[Any]], as_array: Callable[[Any], Any]) -> Any:
    bands = []
    for row in rows:
        blocks = [block for block in map(as_array, row) if block.shape != (0, 0)]
        if len({block.shape[0] for block in blocks}) > 1:
            blocks = [block for block in blocks if block.size]
        if len({block.shape[0] for block in blocks}) > 1:
            sizes = ", ".join(map(measure, blocks[:6]))
            raise MatlabError(
                f"blocks of {sizes} cannot be put side by side: they differ in height"
            )
        if blocks:
            bands.append(np.concatenate(blocks, axis=1))
    if len({band.shape[1] for band in bands}) > 1:
        bands = [band for band in bands if band.size]
    if len({band.shape[1] for band in bands}) > 1:
        sizes = ", ".join(map(measure, bands[:6]))
        raise MatlabError(f"rows of {sizes} cannot be stacked: they differ in width")
    return np.concatenate(bands, axis=0) if bands else np.zeros((0, 0))


def cells(rows: list[list[Any]], budget: Allowance) -> Cell:
    """Put the elements of a cell literal together."""
    budget.room(sum(map(len, rows)))
    rows = [row for row in rows if row]
    if len({len(row) for row in rows}) > 1:
        raise MatlabError("the rows of a cell differ in length")
    return Cell(boxed(rows))
