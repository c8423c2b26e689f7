"""Rows whose cells stand under another heading: found, and put right."""

from __future__ import annotations

from dataclasses import dataclass

from drake_leg.check.cells import fits
from drake_leg.check.rows import Table, TableRow

UNKNOWN = "?"


@dataclass(frozen=True, kw_only=True)
class Shift:
    """How a row is read so that every cell fits its column."""

    cells: tuple[str, ...]  # in the columns' order
    missing: str  # the column that has no cell of its own
    moved: tuple[str, ...]  # the columns whose cells belong to a neighbour
    side: str  # where the cells stand: left or right of their headings


@dataclass(frozen=True, kw_only=True)
class Swap:
    """Two cells of a row, read in each other's place."""

    cells: tuple[str, ...]  # in the columns' order
    columns: tuple[str, str]


def find_shift(table: Table, row: TableRow) -> Shift | None:
    """Look for a cell left out and an empty one too many that together explain a row.

    Parameters
    ----------
    row : TableRow
        A row that has a cell where it cannot belong.

    Returns
    -------
    Shift or None
        The one that moves the fewest cells; None where no shift explains the row.
    """
    columns, texts = list(table.columns), table.texts(row)
    found = []
    for spare, text in enumerate(texts):
        if table.kind(text) not in ("nothing", "zero"):
            continue
        for gap, missing in enumerate(columns):
            rest = [*texts[:spare], *texts[spare + 1 :]]
            cells = [*rest[:gap], "", *rest[gap:]]
            if gap != spare and _all_fit(table, cells, gap):
                cells[gap] = _missing_cell(table, missing, cells)
                moved = columns[gap:spare] if gap < spare else columns[spare + 1 : gap + 1]
                side = "left" if gap < spare else "right"
                found.append(
                    Shift(cells=tuple(cells), missing=missing, moved=tuple(moved), side=side)
                )
    return min(found, key=lambda shift: len(shift.moved), default=None)


def find_swap(table: Table, row: TableRow) -> Swap | None:
    """Look for two cells that have changed places.

    Parameters
    ----------
    row : TableRow
        A row that has a cell where it cannot belong.

    Returns
    -------
    Swap or None
        The two that do not fit, where they do so in each other's place.
    """
    columns, cells = list(table.columns), table.texts(row)
    wrong = [
        index
        for index, sort in enumerate(table.columns.values())
        if not fits(cells[index], sort, table.variables)
    ]
    if len(wrong) != 2:
        return None
    i, j = wrong
    cells[i], cells[j] = cells[j], cells[i]
    fitting = _all_fit(table, cells, -1)
    return Swap(cells=tuple(cells), columns=(columns[i], columns[j])) if fitting else None


def _all_fit(table: Table, cells: list[str], gap: int) -> bool:
    sorts = list(table.columns.values())
    return all(
        index == gap or fits(text, sorts[index], table.variables)
        for index, text in enumerate(cells)
    )


def _missing_cell(table: Table, column: str, cells: list[str]) -> str:
    return likely_sigma(table, cells) if column == "sigma" else UNKNOWN


def likely_sigma(table: Table, cells: list[str]) -> str:
    """Guess a row's joint from where its variable stands.

    Parameters
    ----------
    cells : list of str
        Of the row, in the columns' order.

    Returns
    -------
    str
        ``0``, ``1``, ``~``; ``?`` in a table whose variables are not written.
    """
    if not table.symbolic:
        return UNKNOWN
    for (_, sort), text in zip(table.columns.items(), cells, strict=True):
        if table.kind(text) == "variable":
            return "0" if sort == "turn" else "1"
    return "~"


def repaired(table: Table) -> Table:
    """Put rows right whose cells stand under another heading.

    Returns
    -------
    Table
        A row that neither a swap nor a shift explains stays as it is.
    """
    rows = []
    for row in table.rows:
        fitting = _all_fit(table, table.texts(row), -1)
        better = None if fitting else find_swap(table, row) or find_shift(table, row)
        cells = better.cells if better else table.texts(row)
        named = dict(zip(table.columns, cells, strict=True))
        rows.append(TableRow(frame=row.frame, cells=named))
    return Table(
        rows=tuple(rows),
        convention=table.convention,
        angles=table.angles,
        lengths=table.lengths,
        variables=table.variables,
    )
