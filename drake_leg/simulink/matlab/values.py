"""MATLAB's values, and the limits within which foreign text is evaluated."""

from __future__ import annotations

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
            raise MatlabError(f"blocks of {_sizes(blocks)} do not fit into one row")
        if blocks:
            require_room(blocks[0].shape[0], sum(block.shape[1] for block in blocks))
            bands.append(np.hstack(blocks))
    if not bands:
        return np.empty((0, 0))
    if len({band.shape[1] for band in bands}) > 1:
        raise MatlabError(f"rows of {_sizes(bands)} do not fit under one another")
    require_room(sum(band.shape[0] for band in bands), bands[0].shape[1])
    return settle(np.vstack(bands))


def _sizes(blocks: list[Grid]) -> str:
    sizes = [measure(block) for block in blocks[:6]]
    return ", ".join(sizes) + (", ..." if len(blocks) > 6 else "")
