"""Numbers as MATLAB's: linear algebra, ranges, rounding; the limits of foreign text."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

VALUE_LENGTH = 20_000  # characters of a parameter
SCRIPT_LENGTH = 200_000  # characters of a function block's code
ELEMENTS = 100_000  # of one array of a parameter, or in a function block
NESTING = 48  # operators, brackets and blocks inside one another, in one function
CALLS = 120  # the same, over all functions that wait for another
EXPONENT = 1_000  # of a matrix

Grid = NDArray[Any]
_EPS = float(np.finfo(float).eps)


class MatlabError(Exception):
    """What is wrong with MATLAB text, in which line and function, where that is known."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        self.line, self.function = line, ""
        super().__init__(reason)


@contextmanager
def quiet() -> Iterator[None]:
    """Let numbers be infinite or NaN without a warning, as in MATLAB."""
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def measure(array: Any) -> str:  # noqa: ANN401 - an array or a number
    """Say a size: 2×3."""
    return "×".join(map(str, np.shape(array) or (1, 1)))


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
        raise MatlabError(
            f"a division of {measure(wanted)} by {measure(matrix)} does not match in size"
        )
    if rows == columns:
        try:
            return np.linalg.solve(matrix, wanted)
        except np.linalg.LinAlgError:
            return _eliminate(matrix, wanted)
    left, sigma, right = singular(matrix, "a division by")
    if rows < columns or sigma[-1] <= rows * np.spacing(sigma[0]):
        raise MatlabError(f"a division by a {measure(matrix)} matrix has many solutions: use pinv")
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


def span(first: float, step: float, last: float, require_room: Callable[[float], None]) -> Grid:
    """``first:step:last`` as a row, symmetric about its middle, that meets its last element."""
    for end in (first, step, last):
        if not math.isfinite(end):
            raise MatlabError(f"a range has the bound or step {end:g}")
    if step == 0 or (last - first) * step < 0:
        return np.empty((1, 0))
    intervals = (last - first) / step
    require_room(intervals + 1.0)
    tolerance = 2.0 * _EPS * max(abs(first), abs(last))
    whole = first == round(first) and step == round(step)
    count = math.floor(intervals) if whole else round(intervals)
    if math.copysign(1.0, step) * (first + count * step - last) > tolerance:
        count -= 1
    reached = first + count * step
    if math.copysign(1.0, step) * (reached - last) > -tolerance:
        reached = last
    row: Grid = first + step * np.arange(count + 1.0)
    back = count // 2 + 1
    row[back:] = reached - step * (count - np.arange(back, count + 1.0))
    if count and count % 2 == 0:
        row[count // 2] = (first + reached) / 2
    return row[np.newaxis, :]


# --- elementary functions of arrays, where MATLAB's differ from NumPy's -----------------------


def rounded(x: Any) -> Any:  # noqa: ANN401 - as NumPy's functions
    """Round halves away from zero."""
    return np.trunc(x + np.copysign(np.nextafter(0.5, 0.0), x))


def _sine_in_degrees(x: Any, ahead: float) -> Any:  # noqa: ANN401
    """Sine of degrees and some right angles, exact at whole right angles."""
    turns = rounded(np.asarray(x) / 90.0)
    quarter, rest = (turns + ahead) % 4.0, (math.pi / 180.0) * (x - 90.0 * turns)
    found = np.where(quarter % 2.0 == 0.0, np.sin(rest), np.cos(rest))
    return np.where(quarter < 2.0, found, 0.0 - found)


def sind(x: Any) -> Any:  # noqa: ANN401
    """Sine of degrees."""
    return _sine_in_degrees(x, 0.0)


def cosd(x: Any) -> Any:  # noqa: ANN401
    """Cosine of degrees."""
    return _sine_in_degrees(x, 1.0)


def mod(x: Any, y: Any) -> Any:  # noqa: ANN401
    """Remainder with the divisor's sign; a quotient that is whole except for rounding leaves 0."""
    quotient = np.divide(x, y)
    meets = np.abs(quotient - rounded(quotient)) <= _EPS * np.abs(quotient)
    return np.where(np.equal(y, 0), x, np.where(meets, 0.0, np.mod(x, y)))


def rem(x: Any, y: Any) -> Any:  # noqa: ANN401
    """Remainder with the dividend's sign."""
    quotient = np.divide(x, y)
    meets = np.abs(quotient - rounded(quotient)) <= _EPS * np.abs(quotient)
    return np.where(meets, 0.0, np.fmod(x, y))


def power(x: Any, y: Any) -> Any:  # noqa: ANN401
    """Powers of each element; of negative numbers to fractional powers, complex ones."""
    real = np.isrealobj(x) and np.isrealobj(y)
    if real and np.any((np.asarray(x) < 0) & np.isfinite(y) & (np.asarray(y) % 1 != 0)):
        x = np.asarray(x, dtype=complex)
    return np.power(x, y)


def real_root(x: Any, n: Any) -> Any:  # noqa: ANN401 - arrays or numbers
    """``nthroot``: the real root of a real number; of a negative one for odd whole ``n`` alone."""
    x, n = np.real(x), np.real(n)
    if np.any((x < 0.0) & (np.mod(n, 2.0) != 1.0)):
        raise MatlabError("'nthroot' takes an odd whole root of a negative number")
    found = np.sign(x) * np.abs(x) ** (1.0 / n)
    step = (found**n - x) / (n * found ** (n - 1.0))  # of Newton's method, against rounding
    return np.where(np.isfinite(step), found - step, found)
