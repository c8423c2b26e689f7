"""Grades printed tables, transforms, Jacobians and singular postures against a robot.

Every entry is compared with the chain of the robot's table at random postures, and with random
lengths where it has symbols for them; an entry that differs anywhere is wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, moving_rows, table_length
from drake_leg.lab.grader.comparison import Comparison, Sampler, agrees_within_digits
from drake_leg.lab.grader.definitions import Reader, unused_definitions, with_lengths_as_symbols
from drake_leg.lab.grader.matrices import TOLERANCE, Matrix, read_matrix
from drake_leg.lab.grader.matrix_grader import MatrixGrader
from drake_leg.lab.grader.printed import Finding, Printed
from drake_leg.lab.grader.singular_sets import grade_singular_sets
from drake_leg.lab.grader.table_linter import lint_table
from drake_leg.lab.grader.tables import (
    Binding,
    Table,
    printed_cells,
    readings,
    repaired,
    said_cells,
)
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import evaluate, names_in
from drake_leg.symbolic.spelling import spelled_as

ANGLES = ("alpha", "theta")


def grade(robot: Robot, printed: Printed, *, seed: int = 0) -> list[Finding]:
    """Compare everything that is printed with the robot.

    Parameters
    ----------
    robot : Robot
        The robot that the print describes.
    printed : Printed
        A table, matrices, or both.
    seed : int
        Of the random postures and lengths.

    Returns
    -------
    list of Finding
        One for every row, matrix, entry, rotation and caption that is wrong or not understood;
        empty if everything is right.

    Raises
    ------
    InvalidValueError
        If the print does not say its unit of lengths, or a definition is no formula.
    """
    if printed.table is not None and printed.lengths is None and not printed.matrices:
        return [*lint_table(printed.table), *printed.unread]
    if printed.lengths is None:
        raise InvalidValueError(f'{printed.origin}: lengths is missing; say lengths = "mm" or "m"')
    if seed < 0:
        raise InvalidValueError(f"the seed is {seed}; it must not be negative")
    printed = with_lengths_as_symbols(printed, robot)
    reader = Reader(printed, robot)
    sampler = Sampler(robot, reader, np.random.default_rng(seed))
    known = set(sampler.as_it_is.values)
    read = [read_matrix(matrix, robot, printed, reader, known) for matrix in printed.matrices]
    matrices = [matrix for matrix in read if isinstance(matrix, Matrix)]
    likely = _likeliest(sampler, _bindings(printed, reader, sampler), matrices)
    grader = MatrixGrader(robot, printed, reader, Comparison(sampler, likely[0]))
    findings = [
        *_grade_table(robot, printed, reader, sampler),
        *_ambiguities(likely, matrices, sampler, printed),
    ]
    for matrix in read:
        findings += grader.grade(matrix) if isinstance(matrix, Matrix) else [matrix]
    if printed.singular:
        rng = np.random.default_rng(seed)
        findings += grade_singular_sets(robot, printed, reader, sampler, likely, rng)
    return [*findings, *unused_definitions(printed), *printed.unread]


def _bindings(printed: Printed, reader: Reader, sampler: Sampler) -> list[Binding]:
    """List the possible meanings of the print's symbols for lengths."""
    said = said_cells(printed.cells, sampler.lengths, printed.origin)
    table = printed.table and repaired(printed.table)
    known = {**printed_cells(table, reader.symbols, sampler.lengths), **said}
    return readings(reader.symbols, sampler.lengths, known)


def _likeliest(
    sampler: Sampler, bindings: Sequence[Binding], matrices: Sequence[Matrix]
) -> list[Binding]:
    """Keep the meanings of the symbols under which the fewest entries are wrong."""
    if len(bindings) == 1:
        return list(bindings)
    counts = [len(list(_right_by_chance(Comparison(sampler, b), matrices))) for b in bindings]
    return [b for b, count in zip(bindings, counts, strict=True) if count == min(counts)]


def _right_by_chance(comparison: Comparison, matrices: Sequence[Matrix]) -> Iterator[sp.Expr]:
    """List the entries that are right in numbers but not in symbols."""
    for matrix in matrices:
        formulas = matrix.formulas
        for place in matrix.wrong(comparison):
            if comparison.agrees_in_number(formulas[place], matrix.target(place)):
                yield formulas[place]


def _ambiguities(
    likely: Sequence[Binding], matrices: Sequence[Matrix], sampler: Sampler, printed: Printed
) -> Iterator[Finding]:
    """Report symbols whose meaning is ambiguous and decides whether an entry is wrong."""
    if len(likely) == 1:
        return
    doubtful = list(_right_by_chance(Comparison(sampler, likely[0]), matrices))
    numbered = {name: cells for name, cells in likely[0].items() if name[-1].isdigit()}
    alike = [binding for binding in likely if numbered.items() <= binding.items()]
    for name in sorted(
        {name for formula in doubtful for name in names_in(formula)} - set(numbered)
    ):
        options = {tuple(sorted(binding[name])) for binding in alike if name in binding}
        if len(options) > 1:
            cells = sorted({str(cell) for option in options for cell in option})
            said = printed.format.cells.format(name=name, cell=cells[0])
            yield Finding(
                place="symbols",
                fault=f"{name} can stand for {' or for '.join(cells)} of the robot's table",
                remedy=f"say {said}, or as it is meant",
                severity="warning",
                kind="ambiguous symbol",
            )


def _grade_table(
    robot: Robot, printed: Printed, reader: Reader, sampler: Sampler
) -> Iterator[Finding]:
    """Lint a printed table, then compare its cells with the robot's.

    Rows whose cells are under the wrong headings are compared as they were meant.
    """
    if printed.table is None:
        return
    table = replace(printed.table, variables=reader.variables)
    yield from (replace(finding, kind="table") for finding in lint_table(table))
    if len(table.rows) != len(robot.rows):
        yield Finding(
            place="table",
            fault=f"it has {len(table.rows)} rows, and {robot.name} has {len(robot.rows)}",
            remedy="write one row for every frame",
            kind="table",
        )
        return
    table = repaired(table)
    for index, row in enumerate(table.rows):
        sigma = "~" if robot.rows[index].sigma is None else str(robot.rows[index].sigma)
        if row.cells["sigma"] != sigma and table.fits(row.cells["sigma"], "type"):
            yield Finding(
                place=f"row {index + 1}",
                fault=f"sigma is {row.cells['sigma']}, and {robot.name} is "
                f"{robot.rows[index].joint} there",
                remedy=f"write sigma = {sigma}",
                kind="table",
            )
        for column in ("d", "alpha", "r", "theta"):
            if table.fits(row.cells[column], table.columns[column]):
                cell = _Cell(index, column, table, robot, sampler)
                yield from cell.grade(reader, printed.format.symbol)


class _Cell:
    """A cell of a printed table, compared with the robot's."""

    def __init__(self, row: int, column: str, table: Table, robot: Robot, sampler: Sampler) -> None:
        self._place, self._column = f"row {row + 1}", column
        self._text = table.rows[row].cells[column]
        self._spelling = " ".join(text for each in table.rows for text in table.texts(each))
        self._degrees = table.kind(self._text) == "number" and table.angles != "rad"
        self._sampler, self._length = sampler, table_length(robot.rows)
        self._right: float = getattr(robot.rows[row], column)
        moves = {"revolute": "theta", "prismatic": "r", "fixed": ""}[robot.rows[row].joint]
        self._joint = moving_rows(robot.rows).index(row) if moves == column else None

    def grade(self, reader: Reader, symbol: str) -> Iterator[Finding]:
        """Report it if it differs from the robot's; ``symbol`` is where the print declares one."""
        try:
            formula = reader.formula(self._text)
            agrees = self._agrees(formula)
        except InvalidValueError as error:
            yield Finding(
                place=self._place,
                fault=f"{self._column} is {self._text}: {error}",
                remedy=f"write {self._right_text()}, or say its value {symbol}",
                understood=False,
                kind="table",
            )
            return
        if not agrees:
            yield Finding(
                place=self._place,
                fault=f"{self._column} is {self._text}",
                remedy=f"write {self._right_text()}",
                kind="table",
            )

    def _agrees(self, formula: sp.Expr) -> bool:
        value, right, margin = self._value(formula), self._right_value(), TOLERANCE
        if self._column in ANGLES:
            value = right + np.angle(np.exp(1j * (value - right)))  # without full turns
        else:
            margin *= self._length
        near = np.all(np.abs(value - right) <= margin)
        return bool(near) or agrees_within_digits(formula, right, margin, self._value)

    def _value(self, formula: sp.Expr) -> Array:
        """Evaluate it [m, rad]; bare numbers have the table's units, or degrees."""
        value = np.asarray(evaluate(formula, self._sampler.as_it_is.values))
        if self._column not in ANGLES:
            return value * self._sampler.metres
        return np.asarray(np.radians(value)) if self._degrees else value

    def _right_value(self) -> Array:
        """Return the robot's value at all postures [m, rad]."""
        q = self._sampler.q
        return np.full(len(q), self._right) + (0.0 if self._joint is None else q[:, self._joint])

    def _right_text(self) -> str:
        """Write the robot's value, in the print's unit of lengths or in degrees."""
        number = f"{self._right / self._sampler.metres:.9g}"
        if self._column in ANGLES:
            number = f"{math.degrees(self._right):.9g}°"
        if self._joint is None:
            return number
        variable = spelled_as(self._spelling, f"q{self._joint + 1}")
        return f"{variable} + {number}" if self._right else variable
