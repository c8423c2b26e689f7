"""A teacher's grader: printed transforms, Jacobians and tables against the robot as it is."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec

import numpy as np

from drake_leg.check.captions import grade_caption
from drake_leg.check.claims import Claim, claim_of, right_values, scales
from drake_leg.check.decimals import agrees_within_digits
from drake_leg.check.diagnosis import explain
from drake_leg.check.expressions import evaluate, names_in
from drake_leg.check.findings import Finding
from drake_leg.check.notation import is_joint_variable, readable, spelled_as
from drake_leg.check.postures import COUNT, Postures, draw_postures
from drake_leg.check.printed_file import Printed, PrintedMatrix
from drake_leg.check.printed_table import grade_table
from drake_leg.check.reader import Reader
from drake_leg.check.rotations import rotation_fault
from drake_leg.check.sampling import table_length
from drake_leg.check.singular_sets import grade_singular_sets
from drake_leg.check.table import lint_table
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

TOLERANCE = 1e-6  # of 1, or of the robot's size: a print's numbers are rounded
LARGEST_SYMBOLIC = 4  # joints; right entries of longer chains are said as numbers


def grade(robot: Robot, printed: Printed, *, seed: int = 0) -> list[Finding]:
    """Compare everything that is printed with the robot.

    Every entry is evaluated at random postures, beside the chain of the robot's table; an entry
    that differs somewhere is wrong.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    printed : Printed
        A table, matrices, or both.
    seed : int
        Of the random postures.

    Returns
    -------
    list of Finding
        One for every row, entry, rotation and caption that is wrong or not understood; empty for
        a print without fault.

    Raises
    ------
    InvalidValueError
        If the print's units are not said, or a definition is no formula.
    """
    if printed.table is not None and printed.lengths is None and not printed.matrices:
        return lint_table(printed.table)
    if printed.lengths is None:
        raise InvalidValueError(f'{printed.origin}: lengths is missing; say lengths = "mm" or "m"')
    if seed < 0:
        raise InvalidValueError(f"the seed is {seed}; it must not be negative")
    reader = Reader(printed, robot)
    postures = draw_postures(robot, reader, np.random.default_rng(seed))
    findings = []
    if printed.table is not None:
        findings += grade_table(robot, printed.table, reader, postures)
    grader = _Grader(robot, printed, reader, postures)
    for matrix in printed.matrices:
        findings += grader.grade(matrix)
    if printed.singular:
        rng = np.random.default_rng(seed)
        findings += grade_singular_sets(robot, printed, reader, rng)
    return findings


class _Grader:
    """Grades the matrices of one print."""

    def __init__(self, robot: Robot, printed: Printed, reader: Reader, postures: Postures) -> None:
        self._robot, self._printed = robot, printed
        self._reader, self._postures = reader, postures
        self._length = table_length(robot.rows) / self._postures.metres
        self._right_forms = None
        if find_spec("sympy") is not None and len(robot.moving) <= LARGEST_SYMBOLIC:
            from drake_leg.check.formulas import RightForms

            self._right_forms = RightForms(robot, printed, reader)

    def grade(self, matrix: PrintedMatrix) -> Iterator[Finding]:
        """Find everything that is wrong with a matrix, or not understood in it."""
        try:
            claim = claim_of(matrix, self._robot)
            definitions = self._reader.definitions(matrix.where)
        except InvalidValueError as error:
            yield _unread(matrix.name, error)
            return
        caption = grade_caption(matrix.caption, claim, self._robot)
        if caption:
            yield caption
        shape = (len(matrix.entries), len(matrix.entries[0]))
        if shape != claim.shape:
            yield Finding(
                place=claim.name,
                fault=f"it has {shape[0]} rows and {shape[1]} columns",
                remedy=f"it should have {claim.shape[0]} rows and {claim.shape[1]} columns",
            )
            return
        right = right_values(claim, self._robot, self._postures)
        margin = TOLERANCE * scales(claim, self._length)
        values = np.full(right.shape, np.nan)
        for row, column in np.ndindex(*shape):
            entry = _Entry(
                claim=claim,
                row=row,
                column=column,
                text=matrix.entries[row][column].strip(),
                definitions=definitions,
                spelling=self._spelling(matrix),
                right=right[:, row, column],
                margin=float(margin[row, column]),
            )
            values[:, row, column], finding = self._grade_entry(entry)
            if finding:
                yield finding
        if claim.kind in ("transform", "rotation"):
            yield from _grade_rotation(claim, values[:, :3, :3])

    def _grade_entry(self, entry: _Entry) -> tuple[Array, Finding | None]:
        """Evaluate an entry; say what is wrong with it, or what to write to be understood."""
        nothing = np.full(COUNT, np.nan)
        try:
            tree = self._reader.formula(entry.text, entry.definitions)
        except InvalidValueError as error:
            return nothing, entry.unread(str(error), self._remedy(entry))
        strangers = sorted(names_in(tree) - set(self._postures.values))
        if strangers:
            return nothing, self._stranger_finding(entry, strangers)
        values = self._values(tree)
        if entry.agrees(values) or entry.agrees_within_digits(tree, self._values):
            return entry.right, None
        wrong = explain(tree, len(self._robot.moving), lambda t: entry.agrees(self._values(t)))
        fault = f"printed {readable(entry.text)}" + (f", in which {wrong}" if wrong else "")
        return values, entry.finding(spelled_as(entry.spelling, fault), self._remedy(entry))

    def _stranger_finding(self, entry: _Entry, strangers: Sequence[str]) -> Finding:
        """Say which symbols have no value: one more joint is wrong, others may be anything."""
        names = " and ".join(strangers)
        fault = f"printed {readable(entry.text)}, in which {names} has no value"
        fault, remedy = spelled_as(entry.spelling, fault), self._remedy(entry)
        if all(is_joint_variable(name) for name in strangers):
            return entry.finding(fault, remedy)
        say = f"or say what {names} is: a number under [symbols], a formula under [where]"
        return entry.unread(fault, f"{remedy}, {say}")

    def _spelling(self, matrix: PrintedMatrix) -> str:
        """Join all formulas that belong to a matrix, as examples of its notation."""
        cells = [cell for row in matrix.entries for cell in row]
        return " ".join([*cells, *matrix.where.values(), *self._printed.where.values()])

    def _values(self, tree: ast.expr) -> Array:
        return np.broadcast_to(evaluate(tree, self._postures.values), COUNT)

    def _remedy(self, entry: _Entry) -> str:
        """Write what is right: as a formula, or as a number at a posture."""
        if self._right_forms is not None:
            form = self._right_forms.text(entry.claim, entry.row, entry.column, entry.spelling)
            return f"it should be {form}"
        numbers = f"at {self._postures.at(0)} it should be {entry.right[0]:.6g}"
        return spelled_as(entry.spelling, numbers)


@dataclass(frozen=True, kw_only=True)
class _Entry:
    """One entry of a matrix and what is right there."""

    claim: Claim
    row: int  # from 0
    column: int
    text: str  # as printed
    definitions: Mapping[str, ast.expr]  # that hold in its matrix
    spelling: str  # examples of the print's notation
    right: Array  # (N,) in the print's units
    margin: float  # how far from it counts as equal

    def agrees(self, values: Array) -> bool:
        """Whether values are right at all postures; one that is not finite is not."""
        return bool(np.all(np.abs(values - self.right) <= self.margin))

    def agrees_within_digits(self, tree: ast.expr, values_of: Callable[[ast.expr], Array]) -> bool:
        """Whether it is right but for the rounding of its decimals."""
        return agrees_within_digits(tree, self.right, self.margin, values_of)

    def finding(self, fault: str, remedy: str) -> Finding:
        """Name the entry by row and column, from 1."""
        place = f"{self.claim.name} ({self.row + 1}, {self.column + 1})"
        return Finding(place=place, fault=fault, remedy=remedy)

    def unread(self, fault: str, remedy: str) -> Finding:
        """Say of the entry what is not understood."""
        return replace(self.finding(fault, remedy), understood=False)


def _unread(place: str, error: InvalidValueError) -> Finding:
    """Part an error's sentence into what is not understood and what to write instead."""
    fault, _, remedy = str(error).partition("; ")
    remedy = remedy or "write it another way"
    return Finding(place=place, fault=fault, remedy=remedy, understood=False)


def _grade_rotation(claim: Claim, R: Array) -> Iterator[Finding]:
    fault = rotation_fault(R, TOLERANCE) if np.isfinite(R).all() else None
    if fault:
        yield Finding(
            place=claim.name,
            fault=f"its rotation part is no rotation: {fault}",
            remedy=f"its columns are the axes of frame {claim.frames[1]}: of length 1, at right "
            "angles, right-handed",
        )
