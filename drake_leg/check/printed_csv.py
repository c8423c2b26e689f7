"""A print typed as CSV, or copied with tabs: the same content as in TOML, line by line.

``angles,deg`` and ``lengths,mm`` say the units; two cells of which the second is a number give a
symbol its value (``L1,50``), otherwise its formula (``sigma1,2*cos(θ2)+1``). Three cells that
begin with ``joint``, ``cells``, ``caption`` or ``rows`` say something about a joint, a symbol or a
matrix. A heading
with σ, d, α, r, θ begins a table, which an empty line ends. Every other line is a row of a
matrix, its name first.
"""

from __future__ import annotations

import csv
import re
from typing import Any

from drake_leg.check.notation import plain
from drake_leg.errors import InvalidValueError
from drake_leg.robot_file.document import Document

_COLUMNS = ("sigma", "d", "alpha", "r", "theta")
_SETTINGS = ("title", "angles", "lengths")
_FRAME_WORDS = ("frame", "number", "i", "row")


def parse_csv(text: str, where: str) -> Document:
    """Read CSV into the tables that a TOML file would have.

    Parameters
    ----------
    text : str
        The file's content; cells are parted by whichever of comma, semicolon and tab is most
        frequent.
    where : str
        Name of the file, for the error's sentence.

    Returns
    -------
    dict
        As ``tomllib`` would give it.

    Raises
    ------
    InvalidValueError
        With the line that makes no sense.
    """
    lines = text.splitlines()
    reader = csv.reader(lines, delimiter=max(",;\t", key=text.count), skipinitialspace=True)
    reading = _Reading(where)
    try:
        for cells in reader:
            reading.add([cell.strip() for cell in cells], reader.line_num)
    except csv.Error as error:
        raise InvalidValueError(f"{where}, line {reader.line_num}: {error}") from None
    return reading.document


class _Reading:
    """What has been read of a print."""

    def __init__(self, where: str) -> None:
        self.document: Document = {}
        self._where = where
        self._heading: list[str] | None = None
        self._matrices: dict[str, dict[str, Any]] = {}

    def add(self, cells: list[str], line: int) -> None:
        """Read one line."""
        if not any(cells):
            self._heading = None
            return
        if cells[0].startswith("#"):
            return
        heading = [_column(cell) for cell in cells]
        if set(_COLUMNS) <= set(heading):
            self._heading = heading
        elif self._heading is not None:
            self._add_row(cells, line)
        elif len(cells) == 2 and not _is_matrix(cells[0]):
            self._add_pair(*cells)
        elif len(cells) == 3 and cells[0] in ("joint", "cells", "caption", "rows"):
            self._add_remark(*cells)
        elif len(cells) >= 2:
            self._matrix(cells[0]).setdefault("entries", []).append(cells[1:])
        else:
            raise InvalidValueError(
                f"{self._where}, line {line}: {cells[0]!r} stands alone; a line has a name and "
                "what belongs to it, parted by commas, semicolons or tabs"
            )

    def _add_row(self, cells: list[str], line: int) -> None:
        heading = self._heading or []
        if len(cells) != len(heading):
            raise InvalidValueError(
                f"{self._where}, line {line}: the table's row has {len(cells)} cells and its "
                f"heading {len(heading)}; an empty line ends a table"
            )
        row = {column: cell for column, cell in zip(heading, cells, strict=True) if column}
        self.document.setdefault("table", []).append(row)

    def _add_pair(self, name: str, value: str) -> None:
        if name in _SETTINGS:
            self.document[name] = value
            return
        try:
            self.document.setdefault("symbols", {})[name] = float(value)
        except ValueError:
            self.document.setdefault("where", {})[name] = value

    def _add_remark(self, what: str, name: str, value: str) -> None:
        if what == "joint":
            self.document.setdefault("joints", {})[name] = value
        elif what == "cells":
            self.document.setdefault("cells", {})[name] = value
        elif what == "rows":
            self._matrix(name)["rows"] = value.split()
        else:
            self._matrix(name)["caption"] = value

    def _matrix(self, name: str) -> dict[str, Any]:
        if name not in self._matrices:
            self._matrices[name] = {"name": name}
            self.document.setdefault("matrix", []).append(self._matrices[name])
        return self._matrices[name]


def _is_matrix(name: str) -> bool:
    return bool(re.fullmatch(r"[pt]\d\d|j|detj", plain(name)))


def _column(heading: str) -> str:
    """Recognise a column by the last word of its heading: ``Angle around Z, ϑ`` is theta."""
    words = re.split(r"[\s,;]+", heading.strip(" ,;"))
    last = plain(words[-1]) if words[-1] else ""
    last = {"α": "alpha"}.get(last, last)
    if last in _COLUMNS:
        return last
    return "frame" if last in _FRAME_WORDS else ""
