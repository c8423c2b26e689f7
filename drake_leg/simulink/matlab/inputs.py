"""What the library's functions take: numbers, whole numbers, dimensions, sizes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import Allowance, Known, numbers_of, settled
from drake_leg.simulink.matlab.numeric import MatlabError, measure
from drake_leg.simulink.matlab.operators import each

# ruff: noqa: ANN401 - any value of a script


def of_array(function: Callable[[Any], Any]) -> Known:
    """Make a function of each element one of the library."""

    def applied(budget: Allowance, wanted: int, value: Any) -> Any:
        if type(value) is float:
            found = function(value)
            return found.item() if isinstance(found, np.generic) else settled(np.asarray(found))
        return settled(np.asarray(function(numbers_of(value))))

    return applied


def of_two(function: Callable[[Any, Any], Any]) -> Known:
    """Make a function of the elements of two arrays of fitting sizes one of the library."""
    return lambda budget, wanted, left, right: each(function, left, right, budget)


def of_matrix(function: Callable[[NDArray[Any]], Any], factor: float = 1.0) -> Known:
    """Make a function of a matrix one of the library; its work grows with the cube of the size."""

    def applied(budget: Allowance, wanted: int, value: Any) -> Any:
        array = matrix(value)
        budget.work(factor * array.size * max(array.shape))
        return settled(np.asarray(function(array)))

    return applied


def matrix(value: Any) -> NDArray[Any]:
    """Take a value for numbers in rows and columns."""
    array = numbers_of(value)
    if array.ndim > 2:
        raise MatlabError(f"a matrix is needed, not an array of {measure(array)}")
    return array


def scalar(value: Any) -> float:
    """Take a value for one real number."""
    array = numbers_of(value)
    if array.size != 1:
        raise MatlabError(f"an array of {measure(array)} is used where a number is needed")
    return float(np.real(array.flat[0]))


def whole(value: Any) -> int:
    """Take a value for a whole number."""
    number = scalar(value)
    if not number.is_integer():
        raise MatlabError(f"{number:g} is used where a whole number is needed")
    return int(number)


def axis_of(array: NDArray[Any], axis: Any = None) -> int:
    """Axis that a function runs along: the first one that is not 1 long, if none is given."""
    if axis is not None:
        found = whole(axis) - 1
        if found < 0:
            raise MatlabError("a dimension counts from 1")
        return found
    return next((k for k, n in enumerate(array.shape) if n != 1), 0)


def sizes_of(given: tuple[Any, ...], budget: Allowance) -> tuple[int, ...]:
    """Size that numbers, or one row of them, give; words such as 'like' are left out."""
    plain = [size for size in given if not isinstance(size, str)]
    if not plain:
        return (1, 1)
    numbers = numbers_of(plain[0]).ravel() if len(plain) == 1 else [scalar(n) for n in plain]
    if len(numbers) > 32:
        raise MatlabError("a size has at most 32 numbers")
    shape = tuple(max(0, whole(float(np.real(n)))) for n in numbers)
    shape = shape * 2 if len(shape) == 1 else shape
    budget.room(math.prod(map(float, shape)))
    return shape


def line_like(row: NDArray[Any], source: NDArray[Any]) -> Any:
    """Make a list of numbers a row where its source is one, else a column."""
    flat = source.shape[0] == 1 and source.size != 1
    return settled(row.reshape((1, -1) if flat else (-1, 1)))
