"""A Denavit-Hartenberg table as it stands, before anyone has made sense of it: all text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drake_leg.check.cells import Kind, Sort, kind_of

COLUMNS: dict[str, dict[str, Sort]] = {
    "khalil": {"sigma": "type", "d": "length", "alpha": "twist", "r": "offset", "theta": "turn"},
    "classic": {"sigma": "type", "theta": "turn", "d": "offset", "a": "length", "alpha": "twist"},
}


@dataclass(frozen=True, kw_only=True)
class TableRow:
    """One row as it stands."""

    frame: str  # number in the print; empty where there is none
    cells: Mapping[str, str]  # column to text; a missing one is not there, or empty


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table as it stands."""

    rows: tuple[TableRow, ...]
    convention: str = "khalil"  # a key of COLUMNS
    angles: str | None = None  # unit of bare numbers: deg or rad
    lengths: str | None = None  # unit of bare numbers: mm, cm or m
    variables: frozenset[str] = frozenset()  # symbols, in lower case, that are joint positions

    @property
    def columns(self) -> Mapping[str, Sort]:
        """Columns of the convention, in their order, with what may stand in them."""
        return COLUMNS[self.convention]

    def texts(self, row: TableRow) -> list[str]:
        """Cells of a row in the columns' order; empty where there is nothing."""
        return [row.cells.get(column, "").strip() for column in self.columns]

    def kind(self, text: str) -> Kind:
        """What a cell's text is in this table."""
        return kind_of(text, self.variables)

    @property
    def symbolic(self) -> bool:
        """Whether the joints' variables are written into the table."""
        return any(self.kind(text) == "variable" for row in self.rows for text in self.texts(row))


def table_of_document(document: Mapping[str, Any]) -> Table:
    """Take the table out of a robot file.

    Parameters
    ----------
    document : mapping
        The file as nested tables.

    Returns
    -------
    Table
        Without rows where the file has none; what is no table of keys is an empty row.
    """
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
