"""MATLAB's values, its operators, and the limits within which foreign text is evaluated."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

VALUE_LENGTH = 20_000  # characters of a parameter
SCRIPT_LENGTH = 200_000  # characters of a function block's code
ELEMENTS = 10_000  # of one array
NESTING = 48  # operators, brackets and blocks inside one another, in one function
CALLS = 120  # the same, over all functions that wait for another
OPERATIONS = 1_000_000  # of one call: statements' nodes, and elements of arrays
CALL = 10  # operations that a function costs at least
FACTOR = 5  # operations for each element that linear algebra works on
EXPONENT = 1_000  # of a matrix


class MatlabError(Exception):
    """What is wrong with MATLAB text, and in which line of it, where that is known."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        self.line = line
        super().__init__(reason)


class Budget:
    """Operations that one call may still take."""

    def __init__(self, operations: int = OPERATIONS) -> None:
        self._left = operations

    def spend(self, operations: int) -> None:
        """Count operations."""
        self._left -= operations
        if self._left < 0:
            raise MatlabError(
                f"it takes more than {OPERATIONS} operations: shorten its loops or its arrays"
            )


def require_room(rows: int, columns: int) -> None:
    """Check the size of an array before it is made."""
    if rows * columns > ELEMENTS or max(rows, columns) > ELEMENTS:
        raise MatlabError(
            f"an array of {rows:.7g}×{columns:.7g} is larger than {ELEMENTS} elements"
        )


Grid = NDArray[Any]  # 2-D, of floats or bools, never of one element
Value = float | bool | str | Grid  # a text is of use as an argument only


def settle(array: Grid) -> Value:
    """Make a 2-D array a value: one element is a scalar."""
    if array.size != 1:
        return array
    scalar: float | bool = array.item()
    return scalar


def number(value: Value) -> float | Grid:
    """Take a value for numbers: true is 1, false is 0."""
    if isinstance(value, str):
        raise MatlabError(f"the text '{value}' is used where a number is needed")
    if isinstance(value, np.ndarray):
        return value if value.dtype == np.float64 else value.astype(np.float64)
    return float(value)


def grid(value: Value) -> Grid:
    """Take a value for an array, scalars included."""
    if isinstance(value, str):
        raise MatlabError(f"the text '{value}' is used where a number is needed")
    return value if isinstance(value, np.ndarray) else np.array([[value]])


def numbers(value: Value) -> Grid:
    """Take a value for an array of numbers."""
    array = grid(value)
    return array if array.dtype == np.float64 else array.astype(np.float64)


def shape(value: Value) -> tuple[int, int]:
    """Rows and columns of a value."""
    if isinstance(value, str):
        return 1, len(value)
    return (value.shape[0], value.shape[1]) if isinstance(value, np.ndarray) else (1, 1)


def measure(value: Value) -> str:
    """Say the size of a value."""
    rows, columns = shape(value)
    return f"{rows}×{columns}"


def truth(value: Value) -> bool:
    """Tell whether a value counts as true: not empty, and no element zero."""
    if isinstance(value, (bool, float)) and value == value:
        return value != 0
    array = grid(value)
    if np.isnan(array).any():
        raise MatlabError("NaN is neither true nor false")
    return bool(array.size and array.all())


def whole(value: Value, what: str) -> int:
    """Take a value for a whole number; `what` names it in the message."""
    scalar = number(value)
    if not isinstance(scalar, float):
        raise MatlabError(f"{what} is an array of {measure(value)}; it must be a number")
    if not scalar.is_integer():
        raise MatlabError(f"{what} is {scalar:g}; it must be a whole number")
    return int(scalar)


def stack(rows: list[list[Value]]) -> Value:
    """Put the blocks of a matrix literal together; blocks of 0×0 are left out."""
    bands: list[Grid] = []
    for row in rows:
        blocks = [block for block in map(grid, row) if block.shape != (0, 0)]
        if len({block.shape[0] for block in blocks}) > 1:
            raise MatlabError(
                f"blocks of {_sizes(blocks)} cannot be put side by side: they differ in height"
            )
        if blocks:
            require_room(blocks[0].shape[0], sum(block.shape[1] for block in blocks))
            bands.append(np.hstack(blocks))
    if not bands:
        return np.empty((0, 0))
    if len({band.shape[1] for band in bands}) > 1:
        raise MatlabError(f"rows of {_sizes(bands)} cannot be stacked: they differ in width")
    require_room(sum(band.shape[0] for band in bands), bands[0].shape[1])
    return settle(np.vstack(bands))


def _sizes(blocks: list[Grid]) -> str:
    sizes = [measure(block) for block in blocks[:6]]
    return ", ".join(sizes) + (", ..." if len(blocks) > 6 else "")


class All:
    """The index ``:``."""


ALL = All()
Index = Value | All
_Places = NDArray[np.intp]
_FAR = 2**31  # beyond any array


def read(value: Value, indices: list[Index], name: str) -> Value:
    """Read elements: one index counts column by column, two are row and column."""
    if len(indices) == 1 and type(indices[0]) is float and isinstance(value, np.ndarray):
        return _element(value, indices[0], name)
    source = grid(value)
    if not indices:
        return value
    if len(indices) == 1:
        places = _places(indices[0], source.size, name)
        _require_within(places, source.size, "element", source, name)
        flat: Grid = source.ravel(order="F")[places]
        return settle(flat.reshape(_read_shape(source, indices[0], len(places)), order="F"))
    rows, columns = _pair(indices, source, name)
    _require_within(rows, source.shape[0], "row", source, name)
    _require_within(columns, source.shape[1], "column", source, name)
    require_room(len(rows), len(columns))
    return settle(source[np.ix_(rows, columns)])


def _element(array: Grid, index: float, name: str) -> Value:
    if not (index >= 1.0 and index.is_integer()):
        raise _no_index(index, name)
    if index > array.size:
        raise _beyond(index, "element", array, name)
    column, row = divmod(int(index) - 1, array.shape[0])
    scalar: float | bool = array.item(row, column)
    return scalar


def _read_shape(source: Grid, index: Index, count: int) -> tuple[int, int]:
    """Shape of what one index reads: a vector keeps its direction, else it is that of the index."""
    if isinstance(index, All):
        return count, 1
    given = grid(index)
    if given.dtype == np.bool_ and given.shape != (1, 1):
        given_shape = (1, count) if given.shape[0] == 1 else (count, 1)
    else:
        given_shape = (given.shape[0], given.shape[1]) if given.size == count else (1, count)
    if 1 in given_shape and 1 in source.shape and source.size != 1:
        return (1, count) if source.shape[0] == 1 else (count, 1)
    return given_shape


def write(value: Value | None, indices: list[Index], new: Value, name: str) -> Value:
    """Write one value for all elements, or as many values, into a copy, which grows if needed."""
    block = grid(new)
    old = np.empty((0, 0), block.dtype) if value is None else grid(value)
    if not block.size:
        raise MatlabError(f"elements of '{name}' cannot be removed or set to []")
    if old.dtype == np.bool_ and block.dtype != np.bool_:
        block = block != 0
    if len(indices) == 1:
        return settle(_write_in_order(old, indices[0], block, name))
    rows, columns = _pair(indices, old, name, block)
    array = _grown(old, (_reach(rows), _reach(columns)))
    _fill(array, np.ix_(rows, columns), (len(rows), len(columns)), block, name)
    return settle(array)


def _write_in_order(old: Grid, index: Index, block: Grid, name: str) -> Grid:
    places = _places(index, old.size, name)
    if (needed := _reach(places)) > old.size:
        if old.size and 1 not in old.shape:
            raise MatlabError(f"'{name}' of {measure(old)} cannot grow by one index")
        old = _grown(old, (needed, 1) if old.shape[1] == 1 and old.size > 1 else (1, needed))
    flat: Grid = old.flatten(order="F")
    if block.size not in (1, len(places)):
        raise MatlabError(f"{block.size} values do not fit {len(places)} elements of '{name}'")
    flat[places] = block.ravel(order="F") if block.size > 1 else block.item()
    return flat.reshape(old.shape, order="F")


def _fill(
    array: Grid, where: tuple[_Places, ...], size: tuple[int, int], block: Grid, name: str
) -> None:
    if block.size == 1:
        array[where] = block.item()
    elif [n for n in block.shape if n != 1] == [n for n in size if n != 1]:
        array[where] = block.reshape(size)
    else:
        raise MatlabError(f"{measure(block)} does not fit {size[0]}×{size[1]} elements of '{name}'")


def _grown(old: Grid, least: tuple[int, int]) -> Grid:
    rows, columns = (max(pair) for pair in zip(old.shape, least, strict=True))
    require_room(rows, columns)
    array = np.zeros((rows, columns), old.dtype)
    array[: old.shape[0], : old.shape[1]] = old
    return array


def _reach(places: _Places) -> int:
    return int(places.max(initial=-1)) + 1


def _pair(
    indices: list[Index], source: Grid, name: str, block: Grid | None = None
) -> tuple[_Places, _Places]:
    """Rows and columns that two indices mean; ``:`` of nothing is as long as what is written."""
    if len(indices) != 2:
        raise MatlabError(f"'{name}' has {len(indices)} indices; there are one or two")
    rows, columns = source.shape
    if block is not None:
        lengths = list(block.shape)
        if isinstance(indices[1], float) and 1 in lengths:
            lengths = [block.size, 1]
        elif isinstance(indices[0], float) and 1 in lengths:
            lengths = [1, block.size]
        rows, columns = rows or lengths[0], columns or lengths[1]
    return _places(indices[0], rows, name), _places(indices[1], columns, name)


def _places(index: Index, extent: int, name: str) -> _Places:
    """Places from 0 that an index means."""
    if isinstance(index, All):
        return np.arange(extent)
    given = grid(index).ravel(order="F")
    if given.dtype == np.bool_:
        return np.flatnonzero(given)
    wrong = given[~((given >= 1) & (given == np.floor(given)))]
    if wrong.size:
        raise _no_index(wrong[0], name)
    places: _Places = np.minimum(given - 1, _FAR).astype(np.intp)
    return places


def _require_within(places: _Places, extent: int, what: str, source: Grid, name: str) -> None:
    if places.size and places.max() >= extent:
        raise _beyond(float(places.max()) + 1.0, what, source, name)


def _no_index(index: float, name: str) -> MatlabError:
    return MatlabError(f"'{name}' has the index {index:g}; indices are whole numbers from 1")


def _beyond(index: float, what: str, source: Grid, name: str) -> MatlabError:
    return MatlabError(f"'{name}' is {measure(source)} and has no {what} {index:.7g}")


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


def power(left: Value, right: Value) -> Grid:
    """Whole power of a square matrix."""
    base = np.atleast_2d(number(left))
    exponent = whole(right, "the exponent of a matrix")
    require_square(base, "a power (^; for each element, .^)")
    if abs(exponent) > EXPONENT:
        raise MatlabError(f"the exponent {exponent} of a matrix is beyond {EXPONENT}")
    return np.linalg.matrix_power(inverse(base) if exponent < 0 else base, abs(exponent))


# --- operators -------------------------------------------------------------------------------

Operator = Callable[[Value, Value], Value]
COMPLEX = "is complex; only real numbers are supported"


def elementwise(ufunc: Callable[[Any, Any], Any], left: Value, right: Value) -> Value:
    """Combine two values element by element; rows, columns and scalars are repeated."""
    a, b = number(left), number(right)
    for m, n in zip(shape(a), shape(b), strict=True):
        if m != n and 1 not in (m, n):
            raise MatlabError(f"sizes {measure(a)} and {measure(b)} do not match")
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
        raise MatlabError(f"a negative number to a fractional power {COMPLEX}")
    return elementwise(np.power, a, b)


def matrix_times(left: Value, right: Value) -> Value:
    """``left * right``."""
    if not (isinstance(left, np.ndarray) and isinstance(right, np.ndarray)):
        return times(left, right)
    if left.shape[1] != right.shape[0]:
        raise MatlabError(f"{measure(left)} times {measure(right)} does not match in size")
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
