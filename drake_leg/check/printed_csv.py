"""A print typed as text: CSV, columns parted by tabs or bars, or matrices as they are pasted.

``angles,deg`` and ``lengths,mm`` say the units; two cells of which the second is a number give a
symbol its value (``L1,50``), otherwise its formula (``sigma1,2*cos(θ2)+1``). Three cells that
begin with ``joint``, ``cells``, ``caption`` or ``rows`` say something about a joint, a symbol or a
matrix, and ``singular,θ3 = kπ`` where the determinant is zero. A heading with σ, d, α, r, θ begins
a table, which an empty line ends. ``T01 = [...]``, in LaTeX, MATLAB or Python, is a matrix,
``L1 = 50`` a symbol. Every other line is a row of a matrix, its name first.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from typing import Any

from drake_leg.check.matrix_names import kind_of_name
from drake_leg.check.matrix_text import spaced_cells
from drake_leg.check.notation import quoted
from drake_leg.errors import InvalidValueError
from drake_leg.robot_file.document import Document

_COLUMNS = ("sigma", "d", "alpha", "r", "theta")
_SETTINGS = ("title", "angles", "lengths")
_FRAME_WORDS = ("frame", "number", "i", "j", "row", "link", "joint", "n", "#")
_SPELLINGS = {"α": "alpha", "σ": "sigma", "θ": "theta", "ϑ": "theta"}
_BLOCK = re.compile(
    r"\s*(?:\$\$?|\\\[)?\s*(?P<name>[^=,;\t]{1,40}?)\s*:?=\s*(?P<rest>(?:\\left|\\begin|[\[{⎡]|"
    r"(?:[A-Za-z]+\.)?(?:Matrix|MutableDenseMatrix|ImmutableMatrix|array|sym)\s*\().*|)$"
)
_EQUATION = re.compile(r"\s*([^=,;\t|&]{1,40}?)\s*=\s*([^=,;\t|&\[]+?)\s*;?\s*$")
_SINGULAR = re.compile(
    r"\s*\$?(?:\\?det\b|\|)[^=]{1,20}=\s*0\s*"
    r"(?:(?:when|if|iff|for|where|at|si|pour|lorsque|quand)\b|[⇔⟺⇒⟹]|<?=>|\\[a-zA-Z]+)"
)
_DETERMINANT = re.compile(r"\s*(\|[^|=]{1,20}\|)\s*[,;=\t]\s*(.+)")
_RULE = re.compile(r"[\s|:+-]*-[\s|:+-]*$")
_LONGEST_BLOCK = 60  # lines


def parse_csv(text: str, where: str) -> Document:
    """Read text into the tables that a TOML file would have.

    Parameters
    ----------
    text : str
        The file's content; cells are parted by whichever of comma, semicolon, tab and bar is most
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
    reading = _Reading(where)
    lines = list(_without_blocks(text.splitlines(), reading))
    delimiter = max(",;\t|", key="\n".join(lines).count)
    reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=True)
    try:
        for cells in reader:
            reading.add(_unframed([cell.strip() for cell in cells], delimiter), reader.line_num)
    except csv.Error as error:
        raise InvalidValueError(f"{where}, line {reader.line_num}: {error}") from None
    return reading.document


def parse_table(text: str, where: str) -> list[dict[str, str]]:
    """Read a pasted table with its heading.

    Parameters
    ----------
    text : str
        Columns parted by bars, commas, semicolons, tabs or spaces.
    where : str
        Name of the file.

    Returns
    -------
    list of dict
        Rows, column to cell.

    Raises
    ------
    InvalidValueError
        If it has no heading, or a row is not as long as that.
    """
    rows: list[dict[str, str]] = parse_csv(text.strip(), f"{where}: table").get("table", [])
    if not rows:
        raise InvalidValueError(f"{where}: table has no heading; write i | σ | d | α | r | θ above")
    return rows


def _without_blocks(lines: list[str], reading: _Reading) -> Iterator[str]:
    """Read the matrices that are pasted, and leave an empty line for each of theirs."""
    at = 0
    while at < len(lines):
        found = _BLOCK.match(lines[at]) if len(lines[at]) < 10_000 else None
        if found and kind_of_name(found["name"]):
            end = _end_of_block(lines, at, found["rest"])
            block = "\n".join([found["rest"], *lines[at + 1 : end]])
            reading.add_block(found["name"], re.sub(r"\$|\\\]\s*$", "", block))
            yield from [""] * (end - at)
            at = end
        elif _SINGULAR.match(lines[at]):
            reading.add_singular(lines[at])
            yield "#"
            at += 1
        elif bars := _DETERMINANT.match(lines[at]):
            reading.add_block(bars[1], bars[2])
            yield "#"
            at += 1
        else:
            yield "#" if _RULE.match(lines[at]) else lines[at]
            at += 1


def _end_of_block(lines: list[str], at: int, rest: str) -> int:
    """Find the line behind a matrix: where its brackets are closed, or an empty one."""
    block = rest
    for end in range(at + 1, min(at + _LONGEST_BLOCK, len(lines) + 1)):
        latex = block.count(r"\begin") or block.count("⎡")
        closed = block.count(r"\end") if r"\begin" in block else block.count("⎦")
        opened = sum(map(block.count, "([{")) - sum(map(block.count, ")]}"))
        if block.strip() and ((latex and closed >= latex) or (not latex and rest and opened <= 0)):
            return end
        if end == len(lines) or not lines[end].strip():
            return end
        block += "\n" + lines[end]
    return at + 1


def _unframed(cells: list[str], delimiter: str) -> list[str]:
    """Leave out the empty cells before the first bar and behind the last one."""
    if delimiter != "|" or len(cells) < 3:
        return cells
    return cells[cells[0] == "" : len(cells) - (cells[-1] == "")]


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
        if cells[0].startswith(("#", "%")) and not set(_COLUMNS) <= set(map(_column, cells)):
            return
        if len(cells) == 1:
            cells = self._spaced(cells[0])
        if cells[0] == "singular":
            self.add_singular(", ".join(cells[1:]))
            return
        heading = [_column(cell) for cell in cells]
        if set(_COLUMNS) <= set(heading):
            self._heading = heading
        elif self._heading is not None:
            self._add_row(cells, line)
        elif len(cells) == 2 and not _has_columns_of_one(cells[0]):
            self._add_pair(*cells)
        elif len(cells) == 3 and cells[0] in ("joint", "cells", "caption", "rows"):
            self._add_remark(*cells)
        elif len(cells) >= 2:
            self._add_entries(cells[0], cells[1:], line)
        else:
            raise InvalidValueError(
                f"{self._where}, line {line}: {quoted(cells[0])} stands alone; a line has a name "
                "and what belongs to it, parted by commas, semicolons or tabs"
            )

    def _spaced(self, line: str) -> list[str]:
        """Part a line by its spaces where it is a table's, or by its sign of equality."""
        words = spaced_cells(line)
        if self._heading is not None and len(words) == len(self._heading):
            return words
        if set(_COLUMNS) <= {_column(word) for word in line.split()}:
            return line.split()
        equation = _EQUATION.match(line)
        return [equation[1], equation[2]] if equation else [line]

    def add_block(self, name: str, text: str) -> None:
        """Read a matrix that is pasted as it stands."""
        self._matrix(name)["entries"] = text

    def add_singular(self, text: str) -> None:
        """Read a set of singular postures."""
        self.document.setdefault("singular", []).append(text)

    def _add_row(self, cells: list[str], line: int) -> None:
        heading = self._heading or []
        if len(cells) != len(heading):
            raise InvalidValueError(
                f"{self._where}, line {line}: the table's row has {len(cells)} cells and its "
                f"heading {len(heading)}; an empty line ends a table"
            )
        row = {column: cell for column, cell in zip(heading, cells, strict=True) if column}
        self.document.setdefault("table", []).append(row)

    def _add_entries(self, name: str, cells: list[str], line: int) -> None:
        entries = self._matrix(name).setdefault("entries", [])
        if isinstance(entries, str):
            raise InvalidValueError(
                f"{self._where}, line {line}: {name} stands above as a whole; write it once"
            )
        entries.append(cells)

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


def _has_columns_of_one(name: str) -> bool:
    """Whether rows of one entry make sense: a2 and r01 may be lengths."""
    return kind_of_name(name) in ("position", "jacobian", "determinant")


def _column(heading: str) -> str:
    """Recognise a column by the last word of its heading: ``Angle around Z, ϑ`` is theta."""
    words = re.sub(r"[$\\{}]|\([^()]*\)|\[[^\[\]]*\]", "", heading).casefold()
    last = re.split(r"[\s,;]+", words.strip(" ,;"))[-1]
    last = re.sub(r"(?:_[a-z]?(?:-1|\+1)?|[ᵢⱼ])$", "", last)
    last = _SPELLINGS.get(last, last)
    if last in _COLUMNS:
        return last
    return "frame" if last in _FRAME_WORDS else ""
