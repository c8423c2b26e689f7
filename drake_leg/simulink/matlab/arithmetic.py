"""MATLAB's operators on values, and its ranges."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import algebra
from drake_leg.simulink.matlab.arrays import Array, Value, grid, measure, number, settle, shape
from drake_leg.simulink.matlab.limits import ELEMENTS, MatlabError, require_room

Operator = Callable[[Value, Value], Value]
COMPLEX = "is complex; only real numbers are known here"


def elementwise(ufunc: Callable[[Any, Any], Any], left: Value, right: Value) -> Value:
    """Combine two values element by element; rows, columns and scalars are repeated.

    Raises
    ------
    MatlabError
        If the sizes do not fit.
    """
    a, b = number(left), number(right)
    for m, n in zip(shape(a), shape(b), strict=True):
        if m != n and 1 not in (m, n):
            raise MatlabError(f"sizes {measure(a)} and {measure(b)} do not fit each other")
    require_room(*(n if m == 1 else m for m, n in zip(shape(a), shape(b), strict=True)))
    return settle(np.asarray(ufunc(a, b)))


def plus(left: Value, right: Value) -> Value:
    """``left + right``."""
    if type(left) is float and type(right) is float:
        return left + right
    return elementwise(np.add, left, right)


def minus(left: Value, right: Value) -> Value:
    """``left - right``."""
    if type(left) is float and type(right) is float:
        return left - right
    return elementwise(np.subtract, left, right)


def times(left: Value, right: Value) -> Value:
    """``left .* right``."""
    if type(left) is float and type(right) is float:
        return left * right
    return elementwise(np.multiply, left, right)


def over(left: Value, right: Value) -> Value:
    """``left ./ right``; a zero divisor gives an infinity, or NaN."""
    if type(left) is float and type(right) is float and right:
        return left / right
    return elementwise(np.divide, left, right)


def under(left: Value, right: Value) -> Value:
    r"""``left .\ right``."""
    return over(right, left)


def to_the(left: Value, right: Value) -> Value:
    """``left .^ right``."""
    if type(left) is float and type(right) is float and left > 0.0:
        try:
            power: float = left**right
            return power
        except OverflowError:
            return math.inf
    a, b = number(left), number(right)
    complex_ones = elementwise(lambda a, b: (a < 0) & np.isfinite(b) & (b != np.floor(b)), a, b)
    if np.any(grid(complex_ones)):
        raise MatlabError(f"a negative number to a broken power {COMPLEX}")
    return elementwise(np.power, a, b)


def matrix_times(left: Value, right: Value) -> Value:
    """``left * right``."""
    if not (isinstance(left, np.ndarray) and isinstance(right, np.ndarray)):
        return times(left, right)
    if left.shape[1] != right.shape[0]:
        raise MatlabError(f"{measure(left)} times {measure(right)} does not fit")
    require_room(left.shape[0], right.shape[1])
    return settle(np.asarray(number(left)) @ np.asarray(number(right)))


def matrix_over(left: Value, right: Value) -> Value:
    """``left / right``: the x of ``x right = left``."""
    if not isinstance(right, np.ndarray):
        return over(left, right)
    return transpose(matrix_under(transpose(right), transpose(left)))


def matrix_under(left: Value, right: Value) -> Value:
    r"""``left \ right``: the x of ``left x = right``."""
    if not isinstance(left, np.ndarray):
        return under(left, right)
    return settle(algebra.solve(np.asarray(number(left)), np.atleast_2d(number(right))))


def matrix_to_the(left: Value, right: Value) -> Value:
    """``left ^ right``."""
    if isinstance(left, np.ndarray) or isinstance(right, np.ndarray):
        return settle(algebra.power(left, right))
    return to_the(left, right)


def transpose(value: Value) -> Value:
    """``value'``."""
    return value.T if isinstance(value, np.ndarray) else value


def negative(value: Value) -> Value:
    """``-value``."""
    return -number(value)


def inverted(value: Value) -> Value:
    """``~value``: 0 becomes true, all else false."""
    array = grid(value)
    if np.isnan(array).any():
        raise MatlabError("NaN is neither true nor false")
    return settle(array == 0)


def _compared(ufunc: Callable[[Any, Any], Any], scalars: Callable[[Any, Any], bool]) -> Operator:
    def compare(left: Value, right: Value) -> Value:
        if type(left) is float and type(right) is float:
            return scalars(left, right)
        return elementwise(ufunc, left, right)

    return compare


def _logical(ufunc: Callable[[Any, Any], Any]) -> Operator:
    def combine(left: Value, right: Value) -> Value:
        return elementwise(lambda a, b: ufunc(a != 0, b != 0), left, right)

    return combine


OPERATORS: dict[str, Operator] = {
    "+": plus,
    "-": minus,
    ".*": times,
    "./": over,
    ".\\": under,
    ".^": to_the,
    "*": matrix_times,
    "/": matrix_over,
    "\\": matrix_under,
    "^": matrix_to_the,
    "==": _compared(np.equal, operator.eq),
    "~=": _compared(np.not_equal, operator.ne),
    "<": _compared(np.less, operator.lt),
    "<=": _compared(np.less_equal, operator.le),
    ">": _compared(np.greater, operator.gt),
    ">=": _compared(np.greater_equal, operator.ge),
    "&": _logical(np.logical_and),
    "|": _logical(np.logical_or),
}
SIGNS: dict[str, Callable[[Value], Value]] = {"+": number, "-": negative, "~": inverted}


def span(first: Value, step: Value, last: Value) -> Value:
    """``first:step:last``, symmetric about its middle and with its last element met.

    Returns
    -------
    Value
        A row; 1×0 where there is nothing between.

    Raises
    ------
    MatlabError
        If one is no finite number, or there are too many elements.
    """
    a, d, b = (_end_of_range(value) for value in (first, step, last))
    if d == 0 or (b - a) * d < 0:
        return np.empty((1, 0))
    intervals = (b - a) / d
    if not intervals < ELEMENTS:
        raise MatlabError(f"a range has more than {ELEMENTS} elements")
    tolerance = 2.0 * np.finfo(float).eps * max(abs(a), abs(b))
    count = math.floor(intervals) if a == round(a) and d == round(d) else round(intervals)
    if math.copysign(1.0, d) * (a + count * d - b) > tolerance:
        count -= 1
    reached = a + count * d
    if math.copysign(1.0, d) * (reached - b) > -tolerance:
        reached = b
    row: Array = a + d * np.arange(count + 1.0)
    back = count // 2 + 1
    row[back:] = reached - d * (count - np.arange(back, count + 1.0))
    if count and count % 2 == 0:
        row[count // 2] = (a + reached) / 2
    return settle(row[np.newaxis, :])


def _end_of_range(value: Value) -> float:
    end = number(value)
    if not isinstance(end, float):
        raise MatlabError(f"a range goes from number to number, not to a {measure(value)} array")
    if not math.isfinite(end):
        raise MatlabError(f"a range has the bound or step {end:g}")
    return end
