"""A printed table against the robot's: read as it stands, put right, compared cell by cell."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from drake_leg.check.cells import fits
from drake_leg.check.decimals import agrees_within_digits
from drake_leg.check.expressions import evaluate
from drake_leg.check.findings import Finding
from drake_leg.check.notation import spelled_as
from drake_leg.check.postures import Postures
from drake_leg.check.reader import Reader
from drake_leg.check.rows import Table
from drake_leg.check.sampling import table_length
from drake_leg.check.shifts import repaired
from drake_leg.check.table import lint_table
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import moving_rows
from drake_leg.robot import Robot

TOLERANCE = 1e-6  # of 1 rad, or of the robot's size
ANGLES = ("alpha", "theta")


def grade_table(robot: Robot, table: Table, reader: Reader, postures: Postures) -> list[Finding]:
    """Read a printed table and compare it with the robot's.

    Parameters
    ----------
    robot : Robot
        The robot as it is.

    Returns
    -------
    list of Finding
        What the linter says, then the cells that are not the robot's; rows that stand beside
        their headings are compared as they were meant.
    """
    table = replace(table, variables=reader.variables)
    findings = lint_table(table)
    if len(table.rows) != len(robot.rows):
        fault = f"it has {len(table.rows)} rows, and {robot.name} has {len(robot.rows)}"
        remedy = "write one row for every frame"
        return [*findings, Finding(place="table", fault=fault, remedy=remedy)]
    grader = _TableGrader(robot, repaired(table), reader, postures)
    for index in range(len(robot.rows)):
        findings += grader.grade_row(index)
    return findings


class _TableGrader:
    """Compares the cells that can be read; the others have their finding already."""

    def __init__(self, robot: Robot, table: Table, reader: Reader, postures: Postures) -> None:
        self._robot, self._table = robot, table
        self._reader, self._postures = reader, postures
        self._length = table_length(robot.rows)
        self._spelling = " ".join(text for row in table.rows for text in table.texts(row))

    def grade_row(self, index: int) -> Iterator[Finding]:
        """Find the cells of a row that are not the robot's."""
        cells = self._table.rows[index].cells
        right = self._robot.rows[index]
        sigma = "~" if right.sigma is None else str(right.sigma)
        if cells["sigma"] != sigma and fits(cells["sigma"], "type"):
            yield Finding(
                place=f"row {index + 1}",
                fault=f"sigma is {cells['sigma']}, and {self._robot.name} is {right.joint} there",
                remedy=f"write sigma = {sigma}",
            )
        for column in ("d", "alpha", "r", "theta"):
            if fits(cells[column], self._table.columns[column], self._table.variables):
                yield from self._grade_cell(index, column, cells[column])

    def _grade_cell(self, index: int, column: str, text: str) -> Iterator[Finding]:
        place, right = f"row {index + 1}", self._right_text(index, column)
        try:
            tree = self._reader.formula(text)
            value = self._value(column, text, tree)
        except InvalidValueError as error:
            yield Finding(
                place=place,
                fault=f"{column} is {text}: {error}",
                remedy=f"write {right}, or say its value under [symbols]",
                understood=False,
            )
            return
        right_value = self._right_value(index, column)
        margin = TOLERANCE * (1.0 if column in ANGLES else self._length)
        if column in ANGLES:
            value = right_value + np.angle(np.exp(1j * (value - right_value)))  # without full turns
        agrees = np.all(np.abs(value - right_value) <= margin) or agrees_within_digits(
            tree, right_value, margin, lambda changed: self._value(column, text, changed)
        )
        if not agrees:
            yield Finding(place=place, fault=f"{column} is {text}", remedy=f"write {right}")

    def _value(self, column: str, text: str, tree: ast.expr) -> Array:
        """Evaluate a cell [m, rad]; bare numbers have the table's units, or degrees."""
        value = np.asarray(evaluate(tree, self._postures.values))
        if column not in ANGLES:
            return value * self._postures.metres
        bare = self._table.kind(text) == "number" and self._table.angles != "rad"
        return np.asarray(np.radians(value)) if bare else value

    def _right_value(self, index: int, column: str) -> Array:
        """Return what the robot has in a cell, at all postures [m, rad]."""
        constant = np.full(len(self._postures.q), getattr(self._robot.rows[index], column))
        joint = self._joint(index, column)
        return constant if joint is None else constant + self._postures.q[:, joint]

    def _right_text(self, index: int, column: str) -> str:
        """Write what the robot has in a cell, in the print's unit of lengths and in degrees."""
        value = getattr(self._robot.rows[index], column)
        number = f"{value / self._postures.metres:.9g}"
        if column in ANGLES:
            number = f"{math.degrees(value):.9g}°"
        joint = self._joint(index, column)
        if joint is None:
            return number
        variable = spelled_as(self._spelling, f"q{joint + 1}")
        return f"{variable} + {number}" if value else variable

    def _joint(self, index: int, column: str) -> int | None:
        """Return the joint that moves a cell, counted from 0."""
        moves = {"revolute": "theta", "prismatic": "r", "fixed": ""}
        if moves[self._robot.rows[index].joint] != column:
            return None
        return moving_rows(self._robot.rows).index(index)
