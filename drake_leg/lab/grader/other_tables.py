"""Mistakes that come from another table: an angle turned the other way, a length left out."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.lab.grader.comparison import Chain
from drake_leg.lab.grader.printed import Format
from drake_leg.lab.grader.tables import Cell
from drake_leg.robot.robot import Robot

QUARTER = math.pi / 2.0
CONVENTION, DEGREES = "convention", "degrees"
Names = Mapping[Cell, str]


@dataclass(frozen=True)
class OtherTable:
    """A table with one mistake in it, from which a print may have been computed."""

    kind: str
    fault: str
    remedy: str
    change: Callable[[Chain], Chain]
    rough: float = 1.0  # times the usual margin: numbers that people round


def other_tables(
    robot: Robot, variables: tuple[str, ...], names: Names, words: Format
) -> Iterator[OtherTable]:
    """List tables with one slip in them.

    Parameters
    ----------
    variables : tuple of str
        Of the joints' positions.
    names : mapping
        Cells to the print's names of lengths, as far as it has any.
    words : Format
        Of the print: the words of advice.
    """
    yield from _other_variables(variables)
    yield from _other_twists(robot)
    yield from _other_lengths(robot, names)
    yield from _other_zeros(robot, variables, words)
    yield OtherTable(
        DEGREES,
        "its fixed angles are degrees taken as radians",
        "multiply degrees by pi/180 before taking sines and cosines",
        lambda c: replace(c, alpha=np.degrees(c.alpha), theta=np.degrees(c.theta)),
        rough=1000.0,
    )


def _put(column: str, index: int, values: Array | float, chain: Chain) -> Chain:
    new = getattr(chain, column).copy()
    new[:, index] = values
    return replace(chain, **{column: new})


def _times(column: str, index: int, factor: float, chain: Chain) -> Chain:
    return _put(column, index, factor * getattr(chain, column)[:, index], chain)


def _take_q(joint: int, other: int, chain: Chain) -> Chain:
    return _put("q", joint, chain.q[:, other], chain)


def _exchange_q(joint: int, other: int, chain: Chain) -> Chain:
    return _put("q", other, chain.q[:, joint], _take_q(joint, other, chain))


def _take(cell: Cell, other: Cell, chain: Chain) -> Chain:
    """Put another cell's value into a cell."""
    return _put(cell.column, cell.row, getattr(chain, other.column)[:, other.row], chain)


def _exchange(cell: Cell, other: Cell, chain: Chain) -> Chain:
    value = getattr(chain, cell.column)[:, cell.row]
    return _put(other.column, other.row, value, _take(cell, other, chain))


def _turn_zero(index: int, angle: float, chain: Chain) -> Chain:
    return _put("theta", index, chain.theta[:, index] + angle, chain)


def _other_variables(variables: tuple[str, ...]) -> Iterator[OtherTable]:
    """Take one joint's variable for another's, with another sign, or leave it out."""
    joints = range(len(variables))
    for i, j in itertools.combinations(joints, 2):
        fault = f"{variables[i]} and {variables[j]} have changed places"
        yield OtherTable("joint", fault, "change them back", partial(_exchange_q, i, j))
    for i, j in itertools.permutations(joints, 2):
        fault = f"{variables[j]} should be {variables[i]} where joint {i + 1} is meant"
        yield OtherTable("joint", fault, f"write {variables[i]} there", partial(_take_q, i, j))
    for i, name in enumerate(variables):
        fault, remedy = f"{name} has the wrong sign throughout", f"write {name} for -{name}"
        yield OtherTable("sign of a joint", fault, remedy, partial(_times, "q", i, -1.0))
    fault, remedy = "all joint variables have the wrong sign", "turn the joints the other way"
    yield OtherTable("sign of a joint", fault, remedy, lambda c: replace(c, q=-c.q))
    for i, name in enumerate(variables):
        fault, remedy = f"{name} is left out, as if it were 0", f"put {name} in"
        yield OtherTable("joint left out", fault, remedy, partial(_times, "q", i, 0.0))


def _other_twists(robot: Robot) -> Iterator[OtherTable]:
    """Turn alpha the other way, leave it out, or put a quarter turn where there is none."""
    twisted = [i for i, row in enumerate(robot.rows) if abs(math.sin(row.alpha)) > 1e-9]
    for i in twisted:
        right = math.degrees(robot.rows[i].alpha)
        yield OtherTable(
            CONVENTION,
            f"it is made with alpha = {-right:g}° in row {i + 1}, the other convention",
            f"{robot.name} has alpha = {right:g}° there",
            partial(_times, "alpha", i, -1.0),
        )
    if len(twisted) > 1:
        yield OtherTable(
            CONVENTION,
            "it is made with every alpha turned the other way, the other convention",
            f"take the signs of alpha from {robot.name}'s table",
            lambda c: replace(c, alpha=-c.alpha),
        )
    for i, row in enumerate(robot.rows):
        right = math.degrees(row.alpha)
        for value in (0.0, QUARTER, -QUARTER, math.pi):
            same = abs(np.exp(1j * value) - np.exp(1j * row.alpha)) < 1e-9
            if not same and abs(value + row.alpha) > 1e-9:
                fault = f"it is made with alpha = {math.degrees(value):g}° in row {i + 1}"
                remedy = f"{robot.name} has alpha = {right:g}° there"
                yield OtherTable("alpha", fault, remedy, partial(_put, "alpha", i, value))


def _other_lengths(robot: Robot, names: Names) -> Iterator[OtherTable]:
    """Exchange lengths, leave one out, turn one round, or take d for r."""
    cells = [
        Cell(i, column)
        for i, row in enumerate(robot.rows)
        for column in ("d", "r")
        if getattr(row, column) != 0.0
    ]
    called = {cell: names.get(cell, f"{cell.column} of row {cell.row + 1}") for cell in cells}
    for a, b in itertools.permutations(cells, 2):
        fault = f"{called[b]} should be {called[a]} where {a.column} of row {a.row + 1} is meant"
        yield OtherTable("length", fault, f"write {called[a]} there", partial(_take, a, b))
    for a, b in itertools.combinations(cells, 2):
        fault = f"{called[a]} and {called[b]} have changed places"
        yield OtherTable("length", fault, "change them back", partial(_exchange, a, b))
    for cell, name in called.items():
        fault, remedy = f"{name} is left out", f"put {name} in"
        change = partial(_times, cell.column, cell.row, 0.0)
        yield OtherTable("length left out", fault, remedy, change)
        fault, remedy = f"{name} has the wrong sign throughout", "turn its sign round"
        change = partial(_times, cell.column, cell.row, -1.0)
        yield OtherTable("sign of a length", fault, remedy, change)
    for i in sorted({cell.row for cell in cells}):
        fault = f"d and r of row {i + 1} have changed places"
        change = partial(_exchange, Cell(i, "d"), Cell(i, "r"))
        yield OtherTable("d and r", fault, "d goes along x and r along z", change)


def _other_zeros(robot: Robot, variables: tuple[str, ...], words: Format) -> Iterator[OtherTable]:
    """Measure a turning joint from elsewhere."""
    moving = [i for i, row in enumerate(robot.rows) if row.joint != "fixed"]
    for i, variable in zip(moving, variables, strict=True):
        for value in (QUARTER, -QUARTER, math.pi) if robot.rows[i].joint == "revolute" else ():
            degrees = f"{'-' if value < 0 else '+'} {abs(math.degrees(value)):g}°"
            yield OtherTable(
                "zero of a joint",
                f"{variable} is measured from another zero: it has {variable} {degrees} for "
                f"{variable}",
                f"measure {variable} as the table does, or say so {words.joints}",
                partial(_turn_zero, i, value),
            )
