"""Files of numbers that scripts read: tables of text, and the triangles of an STL file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.files import read_text
from drake_leg.simulink.matlab.data import LackError, Struct, numbers_of, settled

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

_TEXTS = (".csv", ".txt", ".dat")
_MOST = 64 << 20  # bytes
_SIGNS = (",", ";", "\t")  # that may stand between numbers; else there are spaces


def _file(self: Interpreter, arguments: Values, name: str) -> Path:
    if not arguments or not isinstance(arguments[0], str):
        raise LackError(f"'{name}' names no file")
    if len(arguments) > 1:
        raise LackError(f"options of '{name}' are not known here")
    path = self.host.path_of(str(arguments[0]))
    if path is None:
        raise LackError(f"the file {str(arguments[0])!r} is not in the given folders")
    return path


def _rows(path: Path) -> Iterator[list[str]]:
    if path.suffix.lower() not in _TEXTS:
        raise LackError(f"only tables of text are read here, not {path.name!r}")
    try:
        text = read_text(path, most=_MOST)
    except InvalidValueError as error:
        raise LackError(str(error)) from None
    for line in text.splitlines():
        if line.strip():
            between = next((sign for sign in _SIGNS if sign in line), None)
            yield [word.strip().strip('"') for word in line.strip().split(between)]


def _numbers(rows: list[list[str]], path: Path) -> NDArray[np.float64]:
    try:
        found = np.array(rows, dtype=float)
    except ValueError:
        raise LackError(f"{path.name!r} is no table of numbers, all rows of one length") from None
    return np.atleast_2d(found)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _matrix(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``readmatrix``, ``csvread``: the numbers of a table, without the names above them."""
    path = _file(self, arguments, "readmatrix")
    rows = [row for row in _rows(path) if any(map(_is_number, row))]
    found = _numbers(rows, path)
    self.budget.room(found.size)
    return [settled(found)]


def _table(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``readtable``: columns by the names in the first row, or ``Var1`` and so on."""
    path = _file(self, arguments, "readtable")
    rows = list(_rows(path))
    names = [f"Var{k}" for k in range(1, len(rows[0]) + 1)] if rows else []
    if rows and not any(map(_is_number, rows[0])):
        names, rows = [re.sub(r"\W", "_", name) for name in rows[0]], rows[1:]
    found = _numbers(rows, path)
    if found.shape[1] != len(names):
        raise LackError(f"{path.name!r} has {len(names)} names for {found.shape[1]} columns")
    self.budget.room(found.size)
    return [Struct(zip(names, map(settled, found.T[..., np.newaxis]), strict=True))]


def _of_table(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``table2array``: its columns side by side."""
    if len(arguments) != 1 or not isinstance(arguments[0], Struct):
        raise LackError("'table2array' takes a table")
    columns = [numbers_of(each) for each in arguments[0].values()]
    return [settled(np.hstack(columns) if columns else np.zeros((0, 0)))]


def _surface(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``stlread``: corners, each once, and the triangles between them."""
    from drake_leg.simulink.multibody.stl import read_stl

    path = _file(self, arguments, "stlread")
    try:
        corners = read_stl(path).reshape(-1, 3)
    except InvalidValueError as error:
        raise LackError(str(error)) from None
    self.budget.room(corners.size)
    _, first, which = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.argsort(order)
    triangles = place[which.ravel()].reshape(-1, 3) + 1.0
    points: Any = corners[first[order]]
    return [Struct(Points=settled(points), ConnectivityList=settled(triangles))]


READERS = {
    "readmatrix": _matrix,
    "csvread": _matrix,
    "readtable": _table,
    "table2array": _of_table,
    "stlread": _surface,
}
