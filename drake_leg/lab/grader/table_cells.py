"""Compares the cells of a printed table with the robot's."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, moving_rows, table_length
from drake_leg.lab.grader.comparison import TOLERANCE, Sampler, agrees_within_digits
from drake_leg.lab.grader.definitions import Reader
from drake_leg.lab.grader.findings import Finding
from drake_leg.lab.grader.printed import Printed
from drake_leg.lab.grader.table_slips import lint_table
from drake_leg.lab.grader.tables import BRANCHING, Table, repaired
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import evaluate
from drake_leg.symbolic.spelling import spelled_as

ANGLES = ("alpha", "theta", "gamma")


def grade_table(
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
        fault = f"it has {len(table.rows)} rows, and {robot.name} has {len(robot.rows)}"
        yield Finding("table", fault, "write one row for every frame", kind="table")
        return
    table = repaired(table)
    for index, row in enumerate(table.rows):
        sigma = "~" if robot.rows[index].sigma is None else str(robot.rows[index].sigma)
        if row.cells["sigma"] != sigma and table.fits(row.cells["sigma"], "type"):
            joint = robot.rows[index].joint
            fault = f"sigma is {row.cells['sigma']}, and {robot.name} is {joint} there"
            yield Finding(f"row {index + 1}", fault, f"write sigma = {sigma}", kind="table")
        for column in ("d", "alpha", "r", "theta"):
            if table.fits(row.cells[column], table.columns[column]):
                cell = _Cell(index, column, table, robot, sampler)
                yield from cell.grade(reader, printed.format.symbol)
        yield from _grade_branching(index, table, robot, reader, sampler, printed.format.symbol)


def _grade_branching(
    index: int, table: Table, robot: Robot, reader: Reader, sampler: Sampler, symbol: str
) -> Iterator[Finding]:
    """Compare where a row is attached: antecedent, gamma, b. Where they are missing they are 0.

    A row without an antecedent follows the one before it.
    """
    cells, place = table.rows[index].cells, f"row {index + 1}"
    right = robot.antecedents[index]
    text = cells.get("antecedent", "").strip()
    if text and not re.fullmatch(r"\d{1,4}", text):
        fault, remedy = f"antecedent is {text}", "write the number of a row, or 0 for the base"
        yield Finding(place, fault, remedy, understood=False, kind="table")
    elif int(text or index) != right:
        said = f"antecedent is {text}" if text else "antecedent is missing"
        fault = f"{said}, and {robot.name} has {right} there"
        yield Finding(place, fault, f"write antecedent = {right}", kind="table")
    for column in ("gamma", "b"):
        text = cells.get(column, "").strip()
        if text and table.fits(text, BRANCHING[column]):
            yield from _Cell(index, column, table, robot, sampler).grade(reader, symbol)
        elif not text and getattr(robot.rows[index], column):
            cell = _Cell(index, column, table, robot, sampler)
            fault = f"{column} is missing, and {robot.name} has {cell.right_text()} there"
            yield Finding(place, fault, f"write {column} = {cell.right_text()}", kind="table")


class _Cell:
    """A cell of a printed table, compared with the robot's."""

    def __init__(self, row: int, column: str, table: Table, robot: Robot, sampler: Sampler) -> None:
        self._place, self._column = f"row {row + 1}", column
        self._text = table.rows[row].cells.get(column, "")
        self._spelling = " ".join(text for each in table.rows for text in table.texts(each))
        self._degrees = table.kind(self._text) == "number" and table.angles != "rad"
        self._sampler, self._length = sampler, table_length(robot.rows)
        self._right: float = getattr(robot.rows[row], column)
        moves = {"revolute": "theta", "prismatic": "r", "fixed": ""}[robot.rows[row].joint]
        self._joint = moving_rows(robot.rows).index(row) if moves == column else None

    def grade(self, reader: Reader, symbol: str) -> Iterator[Finding]:
        """Report it if it differs from the robot's; ``symbol`` is where the print declares one."""
        fault, remedy = f"{self._column} is {self._text}", f"write {self.right_text()}"
        try:
            agrees, understood = self._agrees(reader.formula(self._text)), True
        except InvalidValueError as error:
            agrees, understood = False, False
            fault, remedy = f"{fault}: {error}", f"{remedy}, or say its value {symbol}"
        if not agrees:
            yield Finding(self._place, fault, remedy, understood=understood, kind="table")

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
            return value * self._sampler.meters
        return np.asarray(np.radians(value)) if self._degrees else value

    def _right_value(self) -> Array:
        """Return the robot's value at all postures [m, rad]."""
        q = self._sampler.q
        return np.full(len(q), self._right) + (0.0 if self._joint is None else q[:, self._joint])

    def right_text(self) -> str:
        """Write the robot's value, in the print's unit of lengths or in degrees."""
        number = f"{self._right / self._sampler.meters:.9g}"
        if self._column in ANGLES:
            number = f"{math.degrees(self._right):.9g}°"
        if self._joint is None:
            return number
        variable = spelled_as(self._spelling, f"q{self._joint + 1}")
        return f"{variable} + {number}" if self._right else variable
