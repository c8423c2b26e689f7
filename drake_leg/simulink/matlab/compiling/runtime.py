"""What compiled code calls: MATLAB's semantics for plain numbers, and for values in one place.

Where a number leaves the real domain, or a size is not what was expected, these functions raise
`DepartureError`, as Python's own arithmetic raises its errors; then the call is interpreted from
its beginning.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import Allowance, Cell, Struct, array_of
from drake_leg.simulink.matlab.indexing import read, write
from drake_leg.simulink.matlab.library import KNOWN
from drake_leg.simulink.matlab.numeric import span
from drake_leg.simulink.matlab.writing import Indexed, written_in_place

# ruff: noqa: ANN401 - any value of a script
_EPS = float(np.finfo(float).eps)
_HALF = math.nextafter(0.5, 0.0)


class DepartureError(Exception):
    """A value is not of the kind that was expected."""

    def __init__(self, reason: str = "") -> None:
        super().__init__(reason)


def lost() -> Any:
    """Read a variable of which nothing is known."""
    raise DepartureError


def holds(x: float) -> bool:
    """Whether a number counts as true."""
    if x != x:
        raise DepartureError
    return x != 0.0


def all_hold(*numbers: float) -> bool:
    """Whether all numbers count as true."""
    if any(x != x for x in numbers):
        raise DepartureError
    return all(numbers)


def sign(x: float) -> float:
    """1, 0 or -1."""
    return 1.0 if x > 0.0 else -1.0 if x < 0.0 else x


def floored(x: float) -> float:
    """Round down."""
    return float(math.floor(x))


def ceiled(x: float) -> float:
    """Round up."""
    return float(math.ceil(x))


def fixed(x: float) -> float:
    """Round towards zero."""
    return float(math.trunc(x))


def rounded(x: float) -> float:
    """Round halves away from zero."""
    return float(math.trunc(x + math.copysign(_HALF, x)))


def mod(x: float, y: float) -> float:
    """Remainder with the divisor's sign, as `numeric.mod`."""
    if y == 0.0:
        return x
    quotient = x / y
    return 0.0 if _is_whole(quotient) else x % y


def rem(x: float, y: float) -> float:
    """Remainder with the dividend's sign, as `numeric.rem`."""
    return 0.0 if _is_whole(x / y) else math.fmod(x, y)


def _is_whole(quotient: float) -> bool:
    return abs(quotient - rounded(quotient)) <= _EPS * abs(quotient)


def larger(x: float, y: float) -> float:
    """The larger of two numbers; NaN counts as none."""
    return x if x >= y or y != y else y


def smaller(x: float, y: float) -> float:
    """The smaller of two numbers; NaN counts as none."""
    return x if x <= y or y != y else y


def divided(x: float, y: float) -> float:
    """Divide as IEEE does."""
    return x / y if y else float(np.divide(x, y))


def place(index: float) -> int:
    """Place from 0 of an index from 1."""
    found = int(index)
    if found != index or found < 1:
        raise DepartureError
    return found - 1


def place_in(row: float, column: float, rows: int, columns: int) -> int:
    """Place of an element, column by column."""
    i, j = place(row), place(column)
    if i >= rows or j >= columns:
        raise DepartureError
    return i + rows * j


def packed(shape: tuple[int, ...], *numbers: float) -> Any:
    """Array of its elements, column by column."""
    return np.array(numbers).reshape(shape, order="F")


def column(*numbers: float) -> Any:
    """Array of one column."""
    return np.array(numbers).reshape(-1, 1)


def row(*numbers: float) -> Any:
    """Array of one row."""
    return np.array(numbers).reshape(1, -1)


def spread(value: Any, kind: type, shape: tuple[int, ...]) -> Any:
    """Elements of an array, column by column, if it is as expected."""
    if type(value) is not np.ndarray or value.shape != shape or value.dtype != kind:
        raise DepartureError
    return value.ravel("F").tolist()


def array(value: Any, kind: type, shape: tuple[int, ...]) -> Any:
    """Let an array pass, if it is as expected."""
    if type(value) is not np.ndarray or value.shape != shape or value.dtype != kind:
        raise DepartureError
    return value


def number(value: Any) -> float:
    """Let one number pass."""
    if type(value) is not float:
        raise DepartureError
    return value


def logical(value: Any) -> bool:
    """Let one logical pass."""
    if type(value) is not bool:
        raise DepartureError
    return value


def real(value: Any) -> Any:
    """Let a real number or array of real numbers pass."""
    if type(value) is float or (type(value) is np.ndarray and value.dtype == np.float64):
        return value
    raise DepartureError


def element(value: Any, *indices: float) -> float:
    """One element of real numbers."""
    if type(value) is float:
        value = array_of(value)
    at = tuple(map(place, indices))
    if len(at) == 1 and value.ndim == 2:
        column, row = divmod(at[0], max(1, value.shape[0]))
        return float(value.item(row, column))
    if len(at) != value.ndim:
        raise DepartureError
    return float(value.item(*at))


def places(value: Any, *indices: float) -> tuple[int, ...]:
    """Places of one element that is there, from 0, in an array of two or more dimensions."""
    at = tuple(map(place, indices))
    if len(at) == 1 and value.ndim == 2:
        column, row = divmod(at[0], max(1, value.shape[0]))
        at = row, column
    if len(at) != value.ndim:
        raise DepartureError
    return at


def field(value: Any, name: str) -> Any:
    """Field of one structure."""
    if not isinstance(value, Struct):
        raise DepartureError
    return value[name]


def content(value: Any, indices: list[Any], budget: Allowance) -> Any:
    """The one value inside a part of a cell."""
    if not isinstance(value, Cell):
        raise DepartureError
    return read(value, indices, budget).items.item()


def rounds(parts: tuple[float, ...], budget: Allowance) -> Any:
    """Values of a loop's variable."""
    first, step, last = (parts[0], 1.0, parts[1]) if len(parts) == 2 else parts
    if step == 1.0 and first.is_integer() and abs(last) < 1e15:
        end = math.floor(last)
        budget.room(max(0, end - first + 1))
        made: Any = [float(k) for k in range(int(first), end + 1)]
    else:
        made = span(first, step, last, budget.room)[0].tolist()
    budget.step(len(made))
    return made


def known(name: str, budget: Allowance, *arguments: Any) -> Any:
    """Call a function of the library for one value."""
    return KNOWN[name](budget, 1, *arguments)


def copied(value: Any) -> Any:
    """Copy an array."""
    return value.copy(order="F")


def write_owned(value: Any, indices: list[Any], new: Any, budget: Allowance, name: str) -> Any:
    """Write elements of an array to which nothing else refers."""
    if written_in_place(value, indices, new):
        return value
    return write(value, indices, new, budget, name)


def fields(value: Any, names: tuple[str, ...]) -> Any:
    """Let a structure of such fields pass."""
    if not isinstance(value, Struct) or tuple(value) != names:
        raise DepartureError
    return value


def parentheses(indices: Any) -> Indexed:
    """Make a step to elements."""
    return Indexed(indices)


def braces(indices: Any) -> Indexed:
    """Make a step to the contents of a cell."""
    return Indexed(indices, braces=True)


USED = """DepartureError lost holds all_hold sign floored ceiled fixed rounded mod rem larger
smaller
divided place place_in packed column row spread array number logical real element places field
content rounds known copied write_owned fields parentheses braces"""
