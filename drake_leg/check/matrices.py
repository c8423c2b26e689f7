"""A printed matrix, read: what it is of, and its entries as formulas."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from drake_leg.check.claims import Claim, claim_of, scales
from drake_leg.check.comparison import Comparison, Meaning
from drake_leg.check.expressions import names_in
from drake_leg.check.findings import Finding, unreadable
from drake_leg.check.printed_file import METRES, Printed, PrintedMatrix
from drake_leg.check.reader import Reader
from drake_leg.check.sampling import table_length
from drake_leg.check.subject import Subject
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

TOLERANCE = 1e-6  # of 1, or of the robot's size: a print's numbers are rounded

Place = tuple[int, int]  # row and column, from 0


@dataclass(frozen=True, kw_only=True)
class Matrix:
    """What is printed, beside what is right."""

    subject: Subject
    caption: str
    shape: tuple[int, int]  # as printed
    spelling: str  # examples of the print's notation
    margin: Array  # (r, c), how far from what is right counts as right
    right: Meaning
    texts: Mapping[Place, str]  # as printed
    trees: dict[Place, ast.expr] = field(default_factory=dict)  # of entries that can be read
    unread: dict[Place, str] = field(default_factory=dict)  # why others cannot
    strangers: dict[Place, Sequence[str]] = field(default_factory=dict)  # symbols without value

    @property
    def claim(self) -> Claim:
        """What it says it is."""
        return self.subject.claim

    def with_halves_exchanged(self) -> Matrix:
        """Take a Jacobian's rows for (v; w) where they are said to be (w; v), or the other way."""
        rows = self.claim.rows
        half = len(rows) // 2
        claim = replace(self.claim, rows=rows[half:] + rows[:half])
        subject = replace(self.subject, claim=claim)
        margin = np.roll(self.margin, half, axis=0)
        return replace(self, subject=subject, margin=margin, right=Meaning(subject.right))

    def is_right(self, place: Place, comparison: Comparison, formula: ast.expr) -> bool:
        """Whether a formula would be right in an entry's place."""
        return comparison.agrees(formula, self.right, place, float(self.margin[place]))

    def is_chance(self, place: Place, comparison: Comparison) -> bool:
        """Whether a wrong entry is right for the robot's own lengths."""
        margin = float(self.margin[place])
        return comparison.agrees_in_number(self.trees[place], self.right, place, margin)

    def finding(
        self, place: Place, fault: str, remedy: str, kind: str = "", *, understood: bool = True
    ) -> Finding:
        """Name an entry by row and column, from 1."""
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

    def wrong(self, comparison: Comparison) -> list[Place]:
        """Find the entries that can be read and are not right; none in one of another shape."""
        if self.shape != self.claim.shape:
            return []
        return [p for p, tree in self.trees.items() if not self.is_right(p, comparison, tree)]


class MatrixReader:
    """Reads the matrices of one print.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    known : collection of str
        Symbols that have a value.
    """

    def __init__(
        self, robot: Robot, printed: Printed, reader: Reader, known: Mapping[str, object]
    ) -> None:
        self._robot, self._printed, self._reader = robot, printed, reader
        self._known = set(known)
        self._length = table_length(robot.rows) / METRES[printed.lengths or "m"]

    def read(self, matrix: PrintedMatrix) -> Matrix | Finding:
        """Read one, or say why it cannot be read.

        Returns
        -------
        Matrix or Finding
            A finding if its name or a definition is not understood.
        """
        try:
            claim = claim_of(matrix, self._robot)
            definitions = self._reader.definitions(matrix.where)
        except InvalidValueError as error:
            return unreadable(matrix.name, error, matrix.name)
        return self._read(matrix, self._subject(claim), definitions)

    def _read(
        self, matrix: PrintedMatrix, subject: Subject, definitions: Mapping[str, ast.expr]
    ) -> Matrix:
        texts = {
            (i, j): text.strip()
            for i, row in enumerate(matrix.entries)
            for j, text in enumerate(row)
        }
        read = Matrix(
            subject=subject,
            caption=matrix.caption,
            shape=(len(matrix.entries), len(matrix.entries[0])),
            spelling=self._spelling(matrix),
            margin=TOLERANCE * scales(subject.claim, self._length),
            right=Meaning(subject.right),
            texts=texts,
        )
        for place, text in texts.items():
            self._read_entry(read, place, text, definitions)
        return read

    def _read_entry(
        self, matrix: Matrix, place: Place, text: str, definitions: Mapping[str, ast.expr]
    ) -> None:
        try:
            tree = self._reader.formula(text, definitions)
        except InvalidValueError as error:
            matrix.unread[place] = str(error)
            return
        strangers = sorted(names_in(tree) - self._known)
        if strangers:
            matrix.strangers[place] = strangers
        else:
            matrix.trees[place] = tree

    def _subject(self, claim: Claim) -> Subject:
        return Subject(
            claim=claim,
            robot=self._robot,
            variables=tuple(self._variable(i) for i in range(len(self._robot.moving))),
            unit=self._printed.lengths or "m",
            units=self._reader.units,
        )

    def _variable(self, index: int) -> str:
        """Name a joint's position: as in its formula, if there is one."""
        formula = self._reader.joints.get(index)
        own = names_in(formula) - set(self._reader.symbols) if formula is not None else set()
        return own.pop() if len(own) == 1 else f"q{index + 1}"

    def _spelling(self, matrix: PrintedMatrix) -> str:
        """Join all formulas that belong to a matrix, as examples of its notation."""
        cells = [cell for row in matrix.entries for cell in row]
        return " ".join([*cells, *matrix.where.values(), *self._printed.where.values()])
