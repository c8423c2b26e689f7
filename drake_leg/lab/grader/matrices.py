"""Reads a printed matrix: what it claims to be, and its entries as formulas."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, table_length
from drake_leg.lab.grader.claims import Claim, claim_of
from drake_leg.lab.grader.comparison import Comparison, Meaning, Target, scales
from drake_leg.lab.grader.definitions import Reader
from drake_leg.lab.grader.mistakes import Subject
from drake_leg.lab.grader.printed import Finding, Printed, PrintedMatrix, unreadable
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import names_in

TOLERANCE = 1e-6  # of 1, or of the robot's size: a print's numbers are rounded

Place = tuple[int, int]  # row and column, from 0


@dataclass(frozen=True, kw_only=True)
class Entry:
    """An entry as printed, and either its formula or what prevents it from being graded."""

    text: str
    formula: sp.Expr | None = None
    unread: str = ""  # why it is no formula
    strangers: tuple[str, ...] = ()  # its symbols without a value


@dataclass(frozen=True, kw_only=True)
class Matrix:
    """A printed matrix and the right one."""

    subject: Subject
    caption: str
    shape: tuple[int, int]  # as printed
    spelling: str  # examples of the print's notation
    margin: Array  # (r, c), how far from what is right counts as right
    right: Meaning
    entries: Mapping[Place, Entry]

    @property
    def claim(self) -> Claim:
        """What it claims to be."""
        return self.subject.claim

    @property
    def formulas(self) -> dict[Place, sp.Expr]:
        """The entries that can be graded."""
        return {p: entry.formula for p, entry in self.entries.items() if entry.formula is not None}

    def with_halves_exchanged(self) -> Matrix:
        """Exchange a Jacobian's rows (w; v) for (v; w), or the other way round."""
        rows = self.claim.rows
        half = len(rows) // 2
        claim = replace(self.claim, rows=rows[half:] + rows[:half])
        subject = replace(self.subject, claim=claim)
        margin = np.roll(self.margin, half, axis=0)
        return replace(self, subject=subject, margin=margin, right=Meaning(subject.right))

    def target(self, place: Place) -> Target:
        """Return the right value of an entry."""
        return Target(self.right, place, float(self.margin[place]))

    def wrong(self, comparison: Comparison) -> list[Place]:
        """Find the entries that can be read and are not right; none in one of another shape."""
        if self.shape != self.claim.shape:
            return []
        formulas = self.formulas.items()
        return [p for p, formula in formulas if not comparison.agrees(formula, self.target(p))]

    def finding(
        self, place: Place, fault: str, remedy: str, kind: str = "", *, understood: bool = True
    ) -> Finding:
        """Make a finding about an entry, named by row and column, from 1."""
        row, column = place[0] + 1, place[1] + 1
        return Finding(
            place=f"{self.claim.name} ({row}, {column})",
            fault=fault,
            remedy=remedy,
            understood=understood,
            kind=kind,
            matrix=self.claim.name,
            entries=((row, column),),
        )


def read_matrix(
    matrix: PrintedMatrix, robot: Robot, printed: Printed, reader: Reader, known: set[str]
) -> Matrix | Finding:
    """Read a matrix, or say why its name or a definition is not understood.

    ``known`` are the symbols that have a value.
    """
    try:
        words = printed.format
        claim = claim_of(matrix.name, matrix.rows, matrix.shape, robot, words.rows)
        own = reader.definitions(matrix.where)
    except InvalidValueError as error:
        return unreadable(matrix.name, error, matrix.name)
    subject = Subject(
        claim=claim,
        robot=robot,
        variables=tuple(_variable(reader, index) for index in range(len(robot.moving))),
        unit=printed.unit,
        units=reader.units,
        format=words,
    )
    cells = [cell for row in matrix.entries for cell in row]
    return Matrix(
        subject=subject,
        caption=matrix.caption,
        shape=matrix.shape,
        spelling=" ".join([*cells, *matrix.where.values(), *printed.where.values()]),
        margin=TOLERANCE * scales(claim, table_length(robot.rows) / printed.metres),
        right=Meaning(subject.right),
        entries={
            (i, j): _read_entry(text.strip(), reader, own, known)
            for i, row in enumerate(matrix.entries)
            for j, text in enumerate(row)
        },
    )


def _read_entry(text: str, reader: Reader, own: Mapping[str, sp.Expr], known: set[str]) -> Entry:
    try:
        formula = reader.formula(text, own)
    except InvalidValueError as error:
        return Entry(text=text, unread=str(error))
    strangers = tuple(sorted(names_in(formula) - known))
    return Entry(text=text, formula=None if strangers else formula, strangers=strangers)


def _variable(reader: Reader, index: int) -> str:
    """Name a joint's position: as in its formula, if that has one symbol of its own."""
    own = names_in(reader.joint(index)) - set(reader.symbols)
    return own.pop() if len(own) == 1 else f"q{index + 1}"
