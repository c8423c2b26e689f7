"""A printed table against the robot's: read as it stands, put right, compared cell by cell."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from drake_leg.check.cells import Sort, fits
from drake_leg.check.expressions import evaluate, names_in
from drake_leg.check.findings import Finding
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


def grade_table(robot: Robot, table: Table, reader: Reader, postures: Postures) -> list[Finding]:
    """Read a printed table and compare it with the robot's.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    table : Table
        As printed.
    reader : Reader
        Of the print.
    postures : Postures
        N of them.

    Returns
    -------
    list of Finding
        What the linter says, then the cells that are not the robot's; rows that stand beside
        their headings are compared as they were meant.
    """
    variables = frozenset(name for tree in reader.joints.values() for name in names_in(tree))
    table = replace(table, variables=variables - set(reader.symbols))
    findings = lint_table(table)
    if len(table.rows) != len(robot.rows):
        fault = f"it has {len(table.rows)} rows, and {robot.name} has {len(robot.rows)}"
        remedy = "write one row for every frame"
        return [*findings, Finding(place="table", fault=fault, remedy=remedy)]
    meant = repaired(table)
    for index in range(len(robot.rows)):
        findings += _grade_row(robot, meant, index, reader, postures)
    return findings


def _grade_row(
    robot: Robot, table: Table, index: int, reader: Reader, postures: Postures
) -> Iterator[Finding]:
    """Compare the cells of a row that can be read; the others have their finding already."""
    row, place = robot.rows[index], f"row {index + 1}"
    texts = dict(zip(table.columns, table.texts(table.rows[index]), strict=True))
    sigma = "~" if row.sigma is None else str(row.sigma)
    if texts["sigma"] != sigma and fits(texts["sigma"], "type"):
        fault = f"sigma is {texts['sigma']}, and {robot.name} is {row.joint} there"
        yield Finding(place=place, fault=fault, remedy=f"write sigma = {sigma}")
    length = table_length(robot.rows)
    for column, right in _right_cells(robot, index, postures.q).items():
        sort, text = table.columns[column], texts[column]
        if not fits(text, sort, table.variables):
            continue
        try:
            value = _value(text, sort, table, reader, postures)
        except InvalidValueError as error:
            remedy = f"write {_right_text(robot, index, column, postures)}, or say its value"
            yield Finding(place=place, fault=f"{column} is {text}: {error}", remedy=remedy)
            continue
        if not _agree(value, right, sort, length):
            remedy = f"write {_right_text(robot, index, column, postures)}"
            yield Finding(place=place, fault=f"{column} is {text}", remedy=remedy)


def _right_cells(robot: Robot, index: int, q: Array) -> dict[str, Array]:
    """Return what the robot has in the columns of a row, at all postures [m, rad]."""
    row, nothing = robot.rows[index], np.zeros(len(q))
    moving = moving_rows(robot.rows)
    position = q[:, moving.index(index)] if index in moving else nothing
    return {
        "d": row.d + nothing,
        "alpha": row.alpha + nothing,
        "r": row.r + (position if row.joint == "prismatic" else nothing),
        "theta": row.theta + (position if row.joint == "revolute" else nothing),
    }


def _value(text: str, sort: Sort, table: Table, reader: Reader, postures: Postures) -> Array:
    """Evaluate a cell [m, rad]; bare numbers have the table's units, degrees if it has none."""
    value = evaluate(reader.formula(text), postures.values)
    if sort in ("length", "offset"):
        return np.asarray(value * postures.metres)
    bare = table.kind(text) == "number" and table.angles != "rad"
    return np.asarray(np.radians(value) if bare else value)


def _agree(value: Array, right: Array, sort: Sort, length: float) -> bool:
    if sort in ("length", "offset"):
        return bool(np.all(np.abs(value - right) <= TOLERANCE * length))
    turns = np.exp(1j * (value - right))
    return bool(np.all(np.abs(turns - 1.0) <= TOLERANCE))


def _right_text(robot: Robot, index: int, column: str, postures: Postures) -> str:
    """Write what the robot has in a cell, in the print's unit of lengths and in degrees."""
    row = robot.rows[index]
    value = getattr(row, column)
    angle = column in ("alpha", "theta")
    number = f"{math.degrees(value):.9g}°" if angle else f"{value / postures.metres:.9g}"
    moves = {"revolute": "theta", "prismatic": "r", "fixed": ""}[row.joint]
    if column != moves:
        return number
    variable = f"q{moving_rows(robot.rows).index(index) + 1}"
    return f"{number} + {variable}" if value else variable
