"""A printed Denavit-Hartenberg table as text: the kinds of its cells, and corrected rows."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal, NamedTuple

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.spelling import plain, quoted

Kind = Literal["nothing", "zero", "number", "length", "angle", "variable", "fixed", "other"]
Sort = Literal["type", "length", "offset", "twist", "turn"]

COLUMNS: dict[str, dict[str, Sort]] = {
    "khalil": {"sigma": "type", "d": "length", "alpha": "twist", "r": "offset", "theta": "turn"},
    "classic": {"sigma": "type", "theta": "turn", "d": "offset", "a": "length", "alpha": "twist"},
}
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
_NUMBER = re.compile(r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:e[-+]?\d{1,2})?")


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
    """Collect the symbols of a cell's formula; refuse what is no formula.

    SymPy is imported only for a cell that is more than a number.
    """
    if _NUMBER.fullmatch(text):
        return set()
    from drake_leg.symbolic.formulas import names_in
    from drake_leg.symbolic.parser import parse_formula

    return names_in(parse_formula(text, variables))


def cell_number(text: str) -> float:
    """Evaluate a cell of the kind ``number``."""
    if _NUMBER.fullmatch(text):
        return float(text)
    from drake_leg.symbolic.formulas import evaluate
    from drake_leg.symbolic.parser import parse_formula

    return float(evaluate(parse_formula(text), {}))


@dataclass(frozen=True, kw_only=True)
class Repair:
    """How a row is read so that every cell fits its column."""

    cells: tuple[str, ...]  # in the columns' order
    swapped: tuple[str, ...] = ()  # two columns whose cells have changed places; or else
    missing: str = ""  # the column that has no cell of its own, and
    side: str = ""  # left or right: where the other cells are, seen from their headings


def find_repair(table: Table, row: TableRow) -> Repair | None:
    """Look for two cells that have changed places, or for cells one column off."""
    return _find_swap(table, row) or _find_shift(table, row)


def _find_swap(table: Table, row: TableRow) -> Repair | None:
    columns, cells = list(table.columns), table.texts(row)
    wrong = table.misfits(cells)
    if len(wrong) != 2:
        return None
    i, j = wrong
    cells[i], cells[j] = cells[j], cells[i]
    if table.misfits(cells):
        return None
    return Repair(cells=tuple(cells), swapped=(columns[i], columns[j]))


def _find_shift(table: Table, row: TableRow) -> Repair | None:
    """Look for a cell left out and an empty one too many; the shift that moves the fewest cells."""
    columns, texts = list(table.columns), table.texts(row)
    found = []
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
            shift = Repair(cells=tuple(cells), missing=missing, side=side)
            found.append((abs(spare - gap), shift))
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
        rows.append(TableRow(frame=row.frame, cells=cells))
    return replace(table, rows=tuple(rows))


MOST = 48  # readings that are compared
MOST_TRIED = 1000  # ways to give symbols to lengths, of which two symbols must not share one
_NEAR = 1e-6  # of a length: how far its declared value may be rounded


class Cell(NamedTuple):
    """A cell of the robot's table that is not zero."""

    row: int  # from 0
    column: str  # d, alpha, r or theta

    def __str__(self) -> str:
        """Write it as column and row: d2."""
        return f"{self.column}{self.row + 1}"


Binding = Mapping[str, frozenset[Cell]]  # symbol to the cells that it stands for
_Rule = Callable[[Sequence[Cell], int], Cell | None]  # finds the cell of a number


def cell_values(robot: Robot, metres: float) -> dict[Cell, float]:
    """List the cells of a table that are not zero [rad, or the print's unit of so many metres]."""
    units = {"d": metres, "r": metres, "alpha": 1.0, "theta": 1.0}
    return {
        Cell(index, column): getattr(row, column) / unit
        for index, row in enumerate(robot.rows)
        for column, unit in units.items()
        if getattr(row, column) != 0.0
    }


def names_of_cells(binding: Binding, spelled: Mapping[str, str]) -> dict[Cell, str]:
    """Name cells by their first symbols, as ``spelled`` in the print."""
    return {
        cell: spelled.get(name, name)
        for name, cells in reversed(list(binding.items()))
        for cell in cells
    }


def same(a: float, b: float) -> bool:
    """Whether two lengths are the same but for their signs and rounding."""
    return math.isclose(abs(a), abs(b), rel_tol=_NEAR)


def said_cells(said: Mapping[str, str], values: Mapping[Cell, float], origin: str) -> Binding:
    """Read what a file says under ``cells``: symbol to ``d2`` or ``d3 d4``.

    A cell that is none, or that is zero in the robot's table, is refused.
    """
    known = {str(cell): cell for cell in values}
    binding = {}
    for name, text in said.items():
        words = re.findall(r"[^\s,]+", text)
        if not words or any(word not in known for word in words):
            raise InvalidValueError(
                f"{origin}: cells: {name} is {text!r}; the robot has {', '.join(known)}"
            )
        binding[plain(name)] = frozenset(known[word] for word in words)
    return binding


def printed_cells(
    table: Table | None, symbols: Mapping[str, float], values: Mapping[Cell, float]
) -> Binding:
    """Find symbols that are alone in a cell of a printed table where their value is the robot's."""
    found: dict[str, set[Cell]] = {}
    for cell, value in values.items():
        if table is None or cell.row >= len(table.rows):
            continue
        name = _plain_name(table.rows[cell.row].cells.get(cell.column, ""))
        if name in symbols and same(symbols[name], value):
            found.setdefault(name, set()).add(cell)
    return {name: frozenset(cells) for name, cells in found.items()}


def _plain_name(text: str) -> str:
    """Spell a cell's text as a symbol, without its sign; nothing where it cannot be read."""
    try:
        return plain(text).lstrip("-+ ")
    except InvalidValueError:
        return ""


def readings(
    symbols: Mapping[str, float], values: Mapping[Cell, float], known: Binding
) -> list[Binding]:
    """List what the declared symbols can stand for, the likeliest first, at most ``MOST``.

    Parameters
    ----------
    symbols : mapping
        Name in lower case to value; one without a cell is a mere number.
    known : Binding
        Symbols of which it is said, or written into a table.
    """
    return _distinct(itertools.islice(_all_readings(symbols, values, known), MOST))


def _distinct(bindings: Iterable[Binding]) -> list[Binding]:
    return list({frozenset(binding.items()): binding for binding in bindings}.values())


def _all_readings(
    symbols: Mapping[str, float], values: Mapping[Cell, float], known: Binding
) -> Iterator[Binding]:
    rest = {name: value for name, value in symbols.items() if name not in known and value}
    for indexed in _indexed_readings(rest, values):
        by_number = {**known, **indexed}
        for free in _free_readings(rest, values, by_number):
            yield from _shared_readings({**by_number, **free}, symbols, values)


def _indexed_readings(
    symbols: Mapping[str, float], values: Mapping[Cell, float]
) -> Iterator[Binding]:
    """Bind L1, L2, ... by their numbers: each letter by the rules that fit most of its symbols."""
    families: dict[str, dict[str, int]] = {}
    for name in symbols:
        numbered = re.fullmatch(r"([a-z]+?)_?(\d+)", name)
        if numbered:
            families.setdefault(numbered[1], {})[name] = int(numbered[2])
    choices = [_family_readings(*family, symbols, values) for family in families.items()]
    for chosen in itertools.product(*choices):
        yield {name: cells for binding in chosen for name, cells in binding.items()}


def _family_readings(
    letter: str,
    family: Mapping[str, int],
    symbols: Mapping[str, float],
    values: Mapping[Cell, float],
) -> list[Binding]:
    def read(columns: Sequence[str], rule: _Rule) -> Binding:
        cells = [cell for cell in values if cell.column in columns]
        placed = {name: rule(cells, number) for name, number in family.items()}
        return {
            name: frozenset([cell])
            for name, cell in placed.items()
            if cell and same(symbols[name], values[cell])
        }

    found = list(itertools.starmap(read, itertools.product(_COLUMNS, _RULES)))
    most = max(map(len, found))
    as_named = read((letter,), _in_row)
    if len(as_named) == most:
        return [as_named]
    return _distinct(binding for binding in found if len(binding) == most)


def _at(cells: Sequence[Cell], number: int) -> Cell | None:
    return cells[number - 1] if 0 < number <= len(cells) else None


def _in_row(cells: Sequence[Cell], number: int) -> Cell | None:
    return next((cell for cell in cells if cell.row == number - 1), None)


_COLUMNS = (("d",), ("r",), ("d", "r"), ("alpha",), ("theta",))
# L1 is the first length, or that of row 1; classic tables have it in the row after; L0 the first.
_RULES: tuple[_Rule, ...] = (
    _at,
    _in_row,
    lambda cells, number: _in_row(cells, number + 1),
    lambda cells, number: _at(cells, number + 1),
)


def _free_readings(
    symbols: Mapping[str, float], values: Mapping[Cell, float], bound: Binding
) -> Iterator[Binding]:
    """Bind symbols that have no number, or one that fits no length, by their values."""
    taken = {cell for cells in bound.values() for cell in cells}
    loose = {name: value for name, value in symbols.items() if name not in bound}
    options: dict[str, list[frozenset[Cell]]] = {}
    for name, value in loose.items():
        equal = [cell for cell in values if same(values[cell], value)]
        free = [cell for cell in equal if cell not in taken] or equal
        rivals = sum(same(other, value) for other in loose.values()) - 1
        if free:
            together = [frozenset(free)] if len(free) > 1 and not rivals else []
            options[name] = [*(frozenset([cell]) for cell in free), *together]
    first = {name: each[0] for name, each in options.items()}
    chosen_ones = itertools.islice(itertools.product(*options.values()), MOST_TRIED)
    apart = [chosen for chosen in chosen_ones if len(set(chosen)) == len(chosen)]
    yield from (dict(zip(options, chosen, strict=True)) for chosen in apart)
    if not apart:
        yield first


def _shared_readings(
    bound: Binding, symbols: Mapping[str, float], values: Mapping[Cell, float]
) -> Iterator[Binding]:
    """Let a symbol stand for an equal length, too, that has no symbol of its own."""
    taken = {cell for cells in bound.values() for cell in cells}
    names: dict[Cell, list[str | None]] = {}
    for cell, value in values.items():
        equal = [name for name in bound if same(symbols[name], value)]
        if cell not in taken and equal:
            names[cell] = [None, *equal]
    for chosen in itertools.product(*names.values()):
        shared = dict(bound)
        for cell, name in zip(names, chosen, strict=True):
            if name is not None:
                shared[name] = shared[name] | {cell}
        yield shared
