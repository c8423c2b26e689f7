"""The functions that are known by name: how many arguments they take, and what they do."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import algebra
from drake_leg.simulink.matlab.arrays import Array, Value, grid, measure, numbers, settle, whole
from drake_leg.simulink.matlab.elementary import OF_ONE, OF_TWO, of_two
from drake_leg.simulink.matlab.limits import MatlabError, require_room

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


def _along(value: Value, axis: Value | None) -> tuple[Array, int]:
    """Array and axis that a sum runs along: the first axis that is not 1 long, if none is given."""
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


def _made(fill: Callable[[int, int], Array]) -> Callable[..., Value]:
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
        raise MatlabError(f"an array of {measure(value)} stands where a number should be")
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
        raise MatlabError(f"norm of order {kind:g} is not known here: 1, 2, inf or 'fro'")
    if 1 in array.shape:
        return float(np.linalg.norm(array.ravel(), kind))
    if kind == 2.0:
        return float(algebra.singular(array, "norm")[1][0])
    return float(np.linalg.norm(array, kind))


def _det(value: Value) -> Value:
    matrix = numbers(value)
    algebra.require_square(matrix, "det")
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
        raise MatlabError(f"dot of {measure(left)} and {measure(right)} does not fit")
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
    "inv": (1, 1, lambda value: settle(algebra.inverse(numbers(value)))),
    "pinv": (1, 1, lambda value: settle(algebra.pseudoinverse(numbers(value)))),
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
