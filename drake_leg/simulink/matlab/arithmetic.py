"""MATLAB's operators, its ranges, and linear algebra in which a singular matrix is no error."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.values import (
    ELEMENTS,
    EXPONENT,
    Grid,
    MatlabError,
    Value,
    grid,
    measure,
    number,
    require_room,
    settle,
    shape,
    whole,
)


def require_square(matrix: Grid, what: str) -> None:
    """Check that a matrix is square."""
    if matrix.shape[0] != matrix.shape[1]:
        raise MatlabError(f"{what} needs a square matrix, not one of {measure(matrix)}")


def inverse(matrix: Grid) -> Grid:
    """Inverse of a matrix; infinite where it is singular."""
    require_square(matrix, "inv")
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.full(matrix.shape, np.inf)


def singular(matrix: Grid, what: str) -> tuple[Grid, Grid, Grid]:
    """Decompose a matrix into U (m, k), falling singular values (k,) and V transposed (k, n)."""
    try:
        if np.isfinite(matrix).all():
            return np.linalg.svd(matrix, full_matrices=False)
    except np.linalg.LinAlgError:
        pass
    raise MatlabError(f"{what} of a matrix needs finite numbers of like sizes")


def pseudoinverse(matrix: Grid) -> Grid:
    """Moore-Penrose inverse; singular values below MATLAB's tolerance count as zero."""
    if not matrix.size:
        return np.zeros(matrix.shape[::-1])
    left, sigma, right = singular(matrix, "pinv")
    kept = sigma > max(matrix.shape) * np.spacing(sigma[0])
    inverted: Grid = right[kept].T @ (left[:, kept] / sigma[kept]).T
    return inverted


def solve(matrix: Grid, wanted: Grid) -> Grid:
    """Solve ``matrix @ x = wanted``, in the least squares where there are more rows.

    The answer is not finite where a square matrix is singular.
    """
    rows, columns = matrix.shape
    if rows != wanted.shape[0]:
        raise MatlabError(f"a division of {measure(wanted)} by {measure(matrix)} does not fit")
    if rows == columns:
        try:
            return np.linalg.solve(matrix, wanted)
        except np.linalg.LinAlgError:
            return _eliminate(matrix, wanted)
    left, sigma, right = singular(matrix, "a division by")
    if rows < columns or sigma[-1] <= rows * np.spacing(sigma[0]):
        raise MatlabError(f"a division by a {measure(matrix)} matrix has many answers: use pinv")
    least: Grid = right.T @ ((left.T @ wanted) / sigma[:, np.newaxis])
    return least


def _eliminate(matrix: Grid, wanted: Grid) -> Grid:
    """Eliminate with row pivots, dividing by zero as IEEE does."""
    n = len(matrix)
    work = np.hstack([matrix, wanted])
    for k in range(n):
        pivot = k + int(np.argmax(np.abs(work[k:, k])))
        work[[k, pivot]] = work[[pivot, k]]
        if work[k, k]:
            work[k + 1 :] -= np.outer(work[k + 1 :, k] / work[k, k], work[k])
    solution = work[:, n:]
    for k in reversed(range(n)):
        solution[k] = (solution[k] - work[k, k + 1 : n] @ solution[k + 1 :]) / work[k, k]
    return solution


def power(left: Value, right: Value) -> Grid:
    """Whole power of a square matrix."""
    base = np.atleast_2d(number(left))
    exponent = whole(right, "the exponent of a matrix")
    require_square(base, "a power (^; for each element, .^)")
    if abs(exponent) > EXPONENT:
        raise MatlabError(f"the exponent {exponent} of a matrix is beyond {EXPONENT}")
    return np.linalg.matrix_power(inverse(base) if exponent < 0 else base, abs(exponent))


Operator = Callable[[Value, Value], Value]
COMPLEX = "is complex; only real numbers are supported"


def elementwise(ufunc: Callable[[Any, Any], Any], left: Value, right: Value) -> Value:
    """Combine two values element by element; rows, columns and scalars are repeated."""
    a, b = number(left), number(right)
    for m, n in zip(shape(a), shape(b), strict=True):
        if m != n and 1 not in (m, n):
            raise MatlabError(f"sizes {measure(a)} and {measure(b)} do not fit each other")
    require_room(*(n if m == 1 else m for m, n in zip(shape(a), shape(b), strict=True)))
    return settle(np.asarray(ufunc(a, b)))


def _combined(ufunc: Callable[[Any, Any], Any], scalars: Callable[[Any, Any], Any]) -> Operator:
    """Make an operator that is fast on two numbers."""

    def combine(left: Value, right: Value) -> Value:
        if type(left) is float and type(right) is float:
            result: float | bool = scalars(left, right)
            return result
        return elementwise(ufunc, left, right)

    return combine


times = _combined(np.multiply, operator.mul)


def over(left: Value, right: Value) -> Value:
    """``left ./ right``; a division by zero is infinite, or NaN."""
    if type(left) is float and type(right) is float and right:
        return left / right
    return elementwise(np.divide, left, right)


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
        return over(right, left)
    return settle(solve(np.asarray(number(left)), np.atleast_2d(number(right))))


def matrix_to_the(left: Value, right: Value) -> Value:
    """``left ^ right``."""
    if isinstance(left, np.ndarray) or isinstance(right, np.ndarray):
        return settle(power(left, right))
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


def _logical(ufunc: Callable[[Any, Any], Any]) -> Operator:
    def combine(left: Value, right: Value) -> Value:
        return elementwise(lambda a, b: ufunc(a != 0, b != 0), left, right)

    return combine


OPERATORS: dict[str, Operator] = {
    "+": _combined(np.add, operator.add),
    "-": _combined(np.subtract, operator.sub),
    ".*": times,
    "./": over,
    ".\\": lambda left, right: over(right, left),
    ".^": to_the,
    "*": matrix_times,
    "/": matrix_over,
    "\\": matrix_under,
    "^": matrix_to_the,
    "==": _combined(np.equal, operator.eq),
    "~=": _combined(np.not_equal, operator.ne),
    "<": _combined(np.less, operator.lt),
    "<=": _combined(np.less_equal, operator.le),
    ">": _combined(np.greater, operator.gt),
    ">=": _combined(np.greater_equal, operator.ge),
    "&": _logical(np.logical_and),
    "|": _logical(np.logical_or),
}
SIGNS: dict[str, Callable[[Value], Value]] = {"+": number, "-": negative, "~": inverted}


def span(first: Value, step: Value, last: Value) -> Value:
    """``first:step:last`` as a row, symmetric about its middle, that meets its last element."""
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
    row: Grid = a + d * np.arange(count + 1.0)
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
