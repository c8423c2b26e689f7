"""Which cell of the robot's table each declared symbol stands for, also where lengths coincide.

``L2 = 100`` and ``L3 = 100`` are two lengths: a printed table tells them apart, or the file's
``cells``, or the numbers in their names. Where several readings remain, all of them are listed.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.tables import Table
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.spelling import plain

MOST = 48  # readings that are compared
MOST_TRIED = 1000  # ways to give symbols to lengths, of which two symbols must not share one
_NEAR = 1e-6  # of a length: how far its declared value may be rounded


class Cell(NamedTuple):
    """A cell of the robot's table that is not zero."""

    row: int  # from 0
    column: str  # d, alpha, r or theta

    def __str__(self) -> str:
        """Write it as people do: d2."""
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


def cell_names(binding: Binding, spelled: Mapping[str, str]) -> dict[Cell, str]:
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
