"""Reads a print's formulas and definitions, and finds what its symbols can stand for."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.findings import Finding
from drake_leg.lab.grader.matrix_text import NAMES
from drake_leg.lab.grader.printed import METERS, Printed
from drake_leg.lab.grader.tables import repaired
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import (
    DEGREE,
    FUNCTIONS,
    UNITS,
    changed,
    evaluate,
    inside,
    is_negative,
    names_in,
    product,
    replace_at,
    substitute,
    written,
)
from drake_leg.symbolic.parser import parse_formula
from drake_leg.symbolic.spelling import ANGLE_LETTERS, is_joint_variable, plain, quoted

# Names that people give to a result: Δ, J11, P4, T, x04. Other symbols may be lengths.
_RESULT = re.compile(r"(?:[jptxyz]|delta|det\w*)_?\(?[\d, ]*\)?")


class Reader:
    """Reads a print's formulas.

    Its symbols and definitions are checked at once: a name that means something already, two
    meanings of one name, a definition that is not a formula, and an unknown joint are refused.
    """

    def __init__(self, printed: Printed, robot: Robot) -> None:
        self._origin = printed.origin
        self.degrees = printed.angles == "deg"
        said: list[tuple[str, float | str]] = [*printed.symbols.items(), *printed.where.items()]
        _require_free(said, printed.origin)
        _require_one_meaning(said, printed.origin)
        self.symbols = {plain(name): value for name, value in printed.symbols.items()}
        self.units = {unit: meters / printed.meters for unit, meters in METERS.items()}
        self._names = {*self.symbols, *map(plain, printed.where)}
        self.definitions(printed.where)  # refused before the joints' formulas are
        self.joints = {
            _joint_index(name, robot, printed.origin): formula
            for name, formula in self._parsed(printed.joints, "joints", weak=False).items()
        }
        of_joints = {name for formula in self.joints.values() for name in names_in(formula)}
        self._names |= of_joints
        self._definitions = self.definitions(printed.where)
        # θ is the angle of a robot with one joint.
        alone = ANGLE_LETTERS if len(robot.moving) == 1 else ()
        self._alone = {a: sp.Symbol("q1") for a in alone if a not in self._names}
        self.variables = frozenset(of_joints | set(self._alone)) - set(self.symbols)

    def definitions(self, where: Mapping[str, str]) -> dict[str, sp.Expr]:
        """Read definitions as printed: name in lower case to formula."""
        names = list(map(plain, where))
        parsed = self._parsed(where, "where", names)
        return dict(zip(names, parsed.values(), strict=True))

    def formula(
        self,
        text: str,
        own: Mapping[str, sp.Expr] | None = None,
        *,
        names: Collection[str] = (),
    ) -> sp.Expr:
        """Read a formula of q1, q2, ..., other symbols and numbers, and put all definitions in.

        ``own`` are definitions that hold for this formula alone, ``names`` symbols in it that
        are not the print's own.
        """
        definitions = {**self._definitions, **(own or {})}
        formula = self._parse(text, {*self._names, *definitions, *names})
        formula = substitute(formula, {**self._alone, **definitions})
        return changed(formula, self._without_cosd) if self.degrees else formula

    def joint(self, index: int) -> sp.Expr:
        """Return the formula of a joint's position, counted from 0."""
        return self.joints.get(index, sp.Symbol(f"q{index + 1}"))

    def turns(self, formula: sp.Expr) -> bool:
        """Whether a joint's position is in a formula."""
        return any(is_joint_variable(n) or n in self.variables for n in names_in(formula))

    def _without_cosd(self, part: sp.Expr) -> sp.Expr | None:
        """Read cosd(q2 + 30) as cos(q2 + 30°), in a print whose angles are in degrees."""
        if part.func not in FUNCTIONS:
            return None
        angle, *unit = part.args[0].args if part.args[0].is_Mul else part.args
        if unit != [DEGREE] or not self.turns(angle):
            return None
        return part.func(self._in_radians(angle), evaluate=False)

    def _in_radians(self, angle: sp.Expr) -> sp.Expr:
        """Turn what is added to joints' angles from degrees into radians."""
        if angle.is_Add or is_negative(angle):
            return _of_terms(angle, self._in_radians)
        return angle if self.turns(angle) else product(angle, DEGREE)

    def _parse(self, text: str, names: Collection[str], *, weak: bool = True) -> sp.Expr:
        formula = parse_formula(text, names, weak=weak)
        return changed(formula, _with_degrees) if self.degrees else formula

    def _parsed(
        self, texts: Mapping[str, str], key: str, names: Iterable[str] = (), *, weak: bool = True
    ) -> dict[str, sp.Expr]:
        known = {*self._names, *names}
        try:
            return {name: self._parse(text, known, weak=weak) for name, text in texts.items()}
        except InvalidValueError as error:
            raise InvalidValueError(f"{self._origin}: {key}: {error}") from None


def _require_free(said: Iterable[tuple[str, object]], origin: str) -> None:
    """Refuse a symbol that the notation reads as something else."""
    for name, _ in said:
        try:
            read, own = parse_formula(name, weak=False), plain(name)
            meaning = written(read)
        except InvalidValueError:
            read, own, meaning = None, "", "no name"
        if read != sp.Symbol(own) or own in UNITS or is_joint_variable(own):
            raise InvalidValueError(
                f"{origin}: the symbol {quoted(name)} is read as {meaning}; choose another name"
            )


def _require_one_meaning(said: Iterable[tuple[str, float | str]], origin: str) -> None:
    """Refuse two values of one symbol, and two symbols that are read as one."""
    first: dict[str, tuple[str, float | str]] = {}
    for name, value in said:
        other, known = first.setdefault(plain(name), (name, value))
        if _number_or_text(known) == _number_or_text(value):
            continue
        one, two = (v if isinstance(v, str) else f"{v:g}" for v in (known, value))
        values = f"is given as {one} and as {two}"
        if other == name:
            raise InvalidValueError(f"{origin}: {quoted(name)} {values}; define it once")
        raise InvalidValueError(
            f"{origin}: {quoted(other)} and {quoted(name)} are read as one symbol, which {values}; "
            "choose another name for one of them"
        )


def _number_or_text(value: float | str) -> float | str:
    try:
        return float(value)
    except ValueError:
        return value


def _joint_index(name: str, robot: Robot, origin: str) -> int:
    """Find a joint by its name or by its variable: 0 for the first."""
    names = [str(segment.joint) for segment in robot.moving]
    variables = [f"q{number}" for number in range(1, len(names) + 1)]
    for candidates, key in ((names, name), (variables, plain(name))):
        if key in candidates:
            return candidates.index(key)
    raise InvalidValueError(
        f"{origin}: joints: {robot.name} has no joint {quoted(name)}; it has {', '.join(names)}"
    )


def _with_degrees(part: sp.Expr) -> sp.Expr | None:
    """Read cos(θ2 + 90) as cos(θ2 + 90°): whole numbers of 15 degrees, in a print in degrees."""
    if part.func not in FUNCTIONS:
        return None
    return part.func(_terms_with_degrees(part.args[0]), evaluate=False)


def _terms_with_degrees(part: sp.Expr) -> sp.Expr:
    if part.is_Integer and part != 0 and part % 15 == 0:
        return product(part, DEGREE)
    if not (part.is_Add or is_negative(part)):
        return changed(part, _with_degrees)
    return _of_terms(part, _terms_with_degrees)


def _of_terms(formula: sp.Expr, change: Callable[[sp.Expr], sp.Expr]) -> sp.Expr:
    """Change the terms of a sum, or what has a sign."""
    for path, part in inside(formula):
        formula = replace_at(formula, path, change(part))
    return formula


def with_lengths_as_symbols(printed: Printed, robot: Robot) -> Printed:
    """Move lengths from the definitions to the symbols: L2 = 100, or L2 = 2*L1.

    A definition such as sigma1 = 2*c1 stays one.
    """
    reader = Reader(printed, robot)
    symbols = dict(printed.symbols)
    for name, text in printed.where.items():
        formula = reader.formula(text)
        names = names_in(formula)
        if names <= set(reader.symbols) and (not names or _is_sibling(plain(name), names)):
            symbols[name] = float(evaluate(formula, reader.symbols))
    where = {name: text for name, text in printed.where.items() if name not in symbols}
    return replace(printed, symbols=symbols, where=where)


def _is_sibling(name: str, others: Collection[str]) -> bool:
    """Whether a name differs from another by its number only: L2 and L1."""
    letters = {re.sub(r"\d+$", "", other) for other in others}
    return bool(re.search(r"\d$", name)) and re.sub(r"\d+$", "", name) in letters


def unused_definitions(printed: Printed) -> Iterator[Finding]:
    """Find definitions that nothing graded uses: often a result under another name.

    Not understood are every formula that moves, and every length with the name of a result.
    """
    known = {name: _plain_or_as_it_is(name) for name in (*printed.symbols, *printed.where)}
    names = tuple(known.values())
    for name, spelled in known.items():
        if not _moves(printed.where.get(name, "0"), names) and not _RESULT.fullmatch(spelled):
            continue
        if any(spelled in _plain_or_as_it_is(text) for text in printed.singular):
            continue
        others = [text for other, text in printed.where.items() if other != name]
        if not any(_uses(text, spelled, names) for text in (*_texts(printed), *others)):
            yield Finding(
                name,
                f"{quoted(name)} is defined and used nowhere",
                f"name it as what it is: {NAMES}, singular, or leave it out",
                understood=False,
                kind="unused definition",
            )


def _texts(printed: Printed) -> Iterator[str]:
    """List the formulas of a print that are not definitions."""
    for matrix in printed.matrices:
        for row in matrix.entries:
            yield from row
        yield from matrix.where.values()
    yield from printed.joints.values()
    for table_row in printed.table.rows if printed.table else ():
        yield from table_row.cells.values()


def _moves(text: str, names: tuple[str, ...]) -> bool:
    """Whether a formula changes with the robot's posture; one without angles may be a length."""
    try:
        return any(map(is_joint_variable, names_in(parse_formula(text, names))))
    except InvalidValueError:
        return True


def _uses(text: str, name: str, names: tuple[str, ...]) -> bool:
    """Whether a formula has a name in it; where it cannot be read, whether its letters are."""
    if name not in _plain_or_as_it_is(text):
        return False
    try:
        return name in names_in(parse_formula(text, names))
    except InvalidValueError:
        return True


def _plain_or_as_it_is(text: str) -> str:
    try:
        return plain(text)
    except InvalidValueError:
        return text


# --- what the symbols of lengths stand for ---------------------------------------------------

MOST = 48  # readings that are compared
MOST_TRIED = 1000  # ways to give symbols to lengths, of which two symbols must not share one
_NEAR = 1e-6  # of a length: how far its declared value may be rounded


class Cell(NamedTuple):
    """A cell of the robot's table that is not zero."""

    row: int  # from 0
    column: str  # d, alpha, r, theta, b or gamma

    def __str__(self) -> str:
        """Write it as column and row: d2."""
        return f"{self.column}{self.row + 1}"


Names = Mapping[Cell, str]  # cells of the table to the names that the print has for them
Binding = Mapping[str, frozenset[Cell]]  # symbol to the cells that it stands for
_Rule = Callable[[Sequence[Cell], int], Cell | None]  # finds the cell of a number


def cell_values(robot: Robot, meters: float) -> dict[Cell, float]:
    """List the cells of a table that are not zero [rad, or the print's unit of so many meters]."""
    units = {"d": meters, "r": meters, "alpha": 1.0, "theta": 1.0, "b": meters, "gamma": 1.0}
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
    """Whether two lengths are the same except for their signs and rounding."""
    return math.isclose(abs(a), abs(b), rel_tol=_NEAR)


def bindings(printed: Printed, reader: Reader, values: Mapping[Cell, float]) -> list[Binding]:
    """List the possible meanings of a print's symbols for lengths, the likeliest first."""
    known = _said_cells(printed.cells, values, printed.origin)
    return readings(reader.symbols, values, {**_printed_cells(printed, reader, values), **known})


def _said_cells(said: Mapping[str, str], values: Mapping[Cell, float], origin: str) -> Binding:
    """Read what a file says under ``cells``: symbol to ``d2`` or ``d3 d4``."""
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


def _printed_cells(printed: Printed, reader: Reader, values: Mapping[Cell, float]) -> Binding:
    """Find symbols that are alone in a cell of a printed table where their value is the robot's."""
    rows = repaired(printed.table).rows if printed.table else ()
    found: dict[str, set[Cell]] = {}
    for cell, value in values.items():
        text = rows[cell.row].cells.get(cell.column, "") if cell.row < len(rows) else ""
        name = _plain_or_as_it_is(text).lstrip("-+ ")
        if name in reader.symbols and same(reader.symbols[name], value):
            found.setdefault(name, set()).add(cell)
    return {name: frozenset(cells) for name, cells in found.items()}


def readings(
    symbols: Mapping[str, float], values: Mapping[Cell, float], known: Binding
) -> list[Binding]:
    """List what the declared symbols can stand for, the likeliest first, at most ``MOST``.

    A symbol without a cell is just a number; of the ``known`` ones it is said, or written into a
    table.
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
