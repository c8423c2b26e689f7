"""Printed Denavit-Hartenberg tables: the kinds of their cells, and corrected rows."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.spelling import plain, quoted

Kind = Literal["nothing", "zero", "number", "length", "angle", "variable", "fixed", "other"]
Sort = Literal["type", "length", "offset", "twist", "turn", "frame"]

COLUMNS: dict[str, dict[str, Sort]] = {
    "khalil": {"sigma": "type", "d": "length", "alpha": "twist", "r": "offset", "theta": "turn"},
    "classic": {"sigma": "type", "theta": "turn", "d": "offset", "a": "length", "alpha": "twist"},
}
# Columns that only branches and loops need; a table may leave them out.
BRANCHING: dict[str, Sort] = {"antecedent": "frame", "gamma": "twist", "b": "length"}
UNKNOWN = "?"  # a cell that cannot be guessed
_FITTING: dict[Sort, set[Kind]] = {
    "length": {"zero", "number", "length"},
    "offset": {"zero", "number", "length", "variable"},
    "twist": {"zero", "number", "angle"},
    "turn": {"zero", "number", "angle", "variable"},
}
_WORDS: dict[Kind, str] = {
    "length": "a length",
    "angle": "an angle",
    "variable": "a joint's variable",
    "fixed": "the mark of a fixed row",
    "number": "a number",
    "zero": "zero",
    "nothing": "empty",
    "other": "neither a number nor a formula",
}
_FRAME_WORDS = ("frame", "number", "i", "j", "row", "link", "joint", "n", "#")
_SPELLINGS = {"α": "alpha", "σ": "sigma", "θ": "theta", "ϑ": "theta", "γ": "gamma"}
_SPELLINGS |= {"ant": "antecedent", "parent": "antecedent"}
NUMBER = re.compile(r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:e[-+]?\d{1,2})?")


@dataclass(frozen=True, kw_only=True)
class TableRow:
    """One row as printed."""

    frame: str  # number in the print; empty where there is none
    cells: Mapping[str, str]  # column to text; a missing one is left out, or empty


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table as printed."""

    rows: tuple[TableRow, ...]
    convention: str = "khalil"  # a key of COLUMNS
    angles: str | None = None  # unit of bare numbers: deg or rad
    lengths: str | None = None  # unit of bare numbers: mm, cm or m
    variables: frozenset[str] = frozenset()  # symbols, in lower case, that are joint positions

    @property
    def columns(self) -> Mapping[str, Sort]:
        """Columns of the convention, in their order, with what they hold."""
        return COLUMNS[self.convention]

    def texts(self, row: TableRow) -> list[str]:
        """Cells of a row in the columns' order; empty where there is nothing."""
        return [row.cells.get(column, "").strip() for column in self.columns]

    def kind(self, text: str) -> Kind:
        """What a cell's text is: a bare number is ``number``, whatever its unit."""
        return _kind_of(text.strip(), self.variables)

    def fits(self, text: str, sort: Sort) -> bool:
        """Whether a cell's text makes sense in a column."""
        if sort == "type":
            return text.strip() in ("0", "1", "~")
        return self.kind(text) in _FITTING[sort]

    def misfits(self, texts: list[str]) -> list[int]:
        """Which cells of a row make no sense in their columns."""
        sorts = self.columns.values()
        return [i for i, sort in enumerate(sorts) if not self.fits(texts[i], sort)]

    def described(self, text: str) -> str:
        """Show a cell with what it is: ``'L_1', a length``."""
        return f"{quoted(text, 40)}, {_WORDS[self.kind(text)]}"

    @property
    def symbolic(self) -> bool:
        """Whether the joints' variables are written into the table."""
        return any(self.kind(text) == "variable" for row in self.rows for text in self.texts(row))


def table_of_document(document: Mapping[str, Any]) -> Table:
    """Read the table of a robot file; without rows if the file has none."""
    rows = document.get("row")
    convention = document.get("convention", "khalil")
    angles = document.get("angles")
    return Table(
        rows=tuple(_row(row) for row in rows) if isinstance(rows, list) else (),
        convention=convention if convention in COLUMNS else "khalil",
        angles=angles if angles in ("deg", "rad") else None,
        lengths="m",
    )


def _row(row: object) -> TableRow:
    cells = row.items() if isinstance(row, dict) else ()
    return TableRow(
        frame="", cells={key: str(value) for key, value in cells if not isinstance(value, dict)}
    )


@lru_cache(maxsize=1000)
def _kind_of(text: str, variables: frozenset[str]) -> Kind:
    if not text:
        return "nothing"
    if text in ("~", "fixed"):
        return "fixed"
    try:
        names = cell_names(text, variables)
    except InvalidValueError:
        return "other"
    if any(re.fullmatch(r"q\d", name) or name in variables for name in names):
        return "variable"
    if re.search(r"°|deg|rad|pi", plain(text)):
        return "angle"
    if names:
        return "length"
    return "zero" if re.fullmatch(r"[-+]?0*\.?0*", plain(text)) else "number"


def cell_names(text: str, variables: frozenset[str] = frozenset()) -> set[str]:
    """Collect the symbols of a cell's formula; refuse what is not a formula.

    SymPy is imported only for a cell that is more than a number.
    """
    if NUMBER.fullmatch(text):
        return set()
    from drake_leg.symbolic.formulas import names_in
    from drake_leg.symbolic.parser import parse_formula

    return names_in(parse_formula(text, variables))


@dataclass(frozen=True, kw_only=True)
class _Repair:
    """How a row is read so that every cell fits its column."""

    cells: tuple[str, ...]  # in the columns' order
    exchanged: str = ""  # which two cells have changed places; or else
    shifted: str = ""  # where the cells are, and which one is missing


def find_repair(table: Table, row: TableRow) -> _Repair | None:
    """Look for two cells that have changed places, or for cells one column off.

    Of several shifts the one that moves the fewest cells is taken.
    """
    columns, texts = list(table.columns), table.texts(row)
    wrong = table.misfits(texts)
    if len(wrong) == 2:
        i, j = wrong
        cells = list(texts)
        cells[i], cells[j] = cells[j], cells[i]
        if not table.misfits(cells):
            return _Repair(cells=tuple(cells), exchanged=f"{columns[i]} and {columns[j]}")
    found: list[tuple[int, _Repair]] = []
    for spare, text in enumerate(texts):
        if table.kind(text) not in ("nothing", "zero"):
            continue
        for gap, missing in enumerate(columns):
            rest = [*texts[:spare], *texts[spare + 1 :]]
            cells = [*rest[:gap], "", *rest[gap:]]
            if gap == spare or not set(table.misfits(cells)) <= {gap}:
                continue
            cells[gap] = likely_sigma(table, cells) if missing == "sigma" else UNKNOWN
            side = "left" if gap < spare else "right"
            shifted = f"one column to the {side}, and {missing} is missing"
            found.append((abs(spare - gap), _Repair(cells=tuple(cells), shifted=shifted)))
    return min(found, key=lambda moved: moved[0], default=(0, None))[1]


def likely_sigma(table: Table, cells: list[str]) -> str:
    """Guess a row's joint from where its variable is; ? in a table without variables."""
    if not table.symbolic:
        return UNKNOWN
    for sort, text in zip(table.columns.values(), cells, strict=True):
        if table.kind(text) == "variable":
            return "0" if sort == "turn" else "1"
    return "~"


def repaired(table: Table) -> Table:
    """Correct rows whose cells are under the wrong headings, as far as that can be determined."""
    rows = []
    for row in table.rows:
        texts = table.texts(row)
        better = find_repair(table, row) if table.misfits(texts) else None
        cells = dict(zip(table.columns, better.cells if better else texts, strict=True))
        rows.append(TableRow(frame=row.frame, cells={**row.cells, **cells}))
    return replace(table, rows=tuple(rows))


def is_heading(cells: Iterable[str]) -> bool:
    """Whether cells name all columns of a table."""
    return set(COLUMNS["khalil"]) <= set(map(column_named, cells))


def column_named(heading: str) -> str:
    """Recognize a column by the last word of its heading: ``Angle around Z, ϑ`` is theta."""
    words = re.sub(r"[$\\{}]|\([^()]*\)|\[[^\[\]]*\]", "", heading).casefold()
    last = re.split(r"[\s,;]+", words.strip(" ,;"))[-1]
    last = re.sub(r"(?:_[a-z]?(?:-1|\+1)?|[ᵢⱼ])$", "", last)
    last = re.sub(r"^(.|sigma|alpha|theta|gamma)[ijn](?:-1)?$", r"\1", last)  # σj
    last = "antecedent" if re.search(r"\ba\([ij]\)", heading) else _SPELLINGS.get(last, last)
    if last in COLUMNS["khalil"] or last in BRANCHING:
        return last
    return "frame" if last in _FRAME_WORDS else ""


def delimiter_of(line: str) -> str:
    """Find the sign that separates a line's cells: of a heading all, otherwise the first."""
    for sign in "\t|;,":
        if is_heading(line.split(sign)):
            return sign
    if line.lstrip().startswith("|"):
        return "|"
    depth = 0
    for letter in line:
        depth += (letter in "([{") - (letter in ")]}")
        if letter in ",;\t|" and depth <= 0:
            return letter
    return ","
