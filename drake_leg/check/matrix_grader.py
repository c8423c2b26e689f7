"""What is wrong with a printed matrix: as a whole, then entry by entry."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec

import numpy as np

from drake_leg.check.bindings import cell_names
from drake_leg.check.captions import grade_caption
from drake_leg.check.comparison import Comparison
from drake_leg.check.diagnosis import Vocabulary, explain
from drake_leg.check.findings import Finding
from drake_leg.check.jacobian_mistakes import FIRST_LENGTH, HALVES
from drake_leg.check.matrices import TOLERANCE, Matrix, Place
from drake_leg.check.notation import is_joint_variable, plain, readable, spelled_as
from drake_leg.check.postures import COUNT, Postures
from drake_leg.check.printed_file import Printed
from drake_leg.check.reader import Reader
from drake_leg.check.rotations import rotation_fault
from drake_leg.check.whole import Explanation, explain_alone, explain_whole
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot

MOST_TRIALS = 1000  # of two changes in an entry, in all of a print
LARGEST_SYMBOLIC = 4  # joints; right entries of longer chains are said as numbers


class MatrixGrader:
    """Grades the matrices of one print.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    comparison : Comparison
        With what its symbols stand for.
    postures : Postures
        At which numbers are told.
    """

    def __init__(
        self,
        robot: Robot,
        printed: Printed,
        reader: Reader,
        comparison: Comparison,
        postures: Postures,
    ) -> None:
        self._robot, self._comparison, self._postures = robot, comparison, postures
        self._spelled = {plain(name): readable(name) for name in printed.symbols}
        names = cell_names(comparison.binding, self._spelled)
        self._vocabulary = Vocabulary(
            angles=len(robot.moving),
            symbols={n: reader.symbols[n] for n in sorted(comparison.binding)},
            lengths=tuple(dict.fromkeys(map(abs, self._lengths()))),
            unit=printed.lengths or "m",
            units=reader.units,
            names=names,
        )
        self._trials = iter(range(MOST_TRIALS))
        self._right_forms = None
        if find_spec("sympy") is not None and len(robot.moving) <= LARGEST_SYMBOLIC:
            from drake_leg.check.formulas import RightForms

            self._right_forms = RightForms(robot, printed, reader, names)

    def _lengths(self) -> Iterator[float]:
        for cell, value in self._comparison.sampler.lengths.items():
            if cell.column in ("d", "r"):
                yield value

    def grade(self, matrix: Matrix) -> Iterator[Finding]:
        """Find everything that is wrong with a matrix, or not understood in it.

        Yields
        ------
        Finding
            A mistake of the whole first, then the entries that it does not explain.
        """
        caption = grade_caption(matrix.caption, matrix.claim, self._robot)
        if caption:
            yield replace(caption, kind="caption", matrix=matrix.claim.name)
        if matrix.shape != matrix.claim.shape:
            yield _of_another_shape(matrix)
            return
        wrong = matrix.wrong(self._comparison)
        whole = explain_whole(matrix, wrong, self._comparison, self._vocabulary)
        if whole:
            yield self._whole_finding(matrix, whole)
        if whole and whole.kind == HALVES:
            matrix = matrix.with_halves_exchanged()
            wrong = matrix.wrong(self._comparison)
            whole = None
        rest = [place for place in wrong if not whole or place not in whole.explained]
        for place in matrix.texts:
            if place in rest:
                yield self._wrong_finding(matrix, place, wrong)
            elif place in matrix.unread:
                yield matrix.finding(
                    place, matrix.unread[place], self._remedy(matrix, place), understood=False
                )
            elif place in matrix.strangers:
                yield self._stranger_finding(matrix, place, matrix.strangers[place])
        if matrix.claim.kind in ("transform", "rotation") and any(i < 3 and j < 3 for i, j in rest):
            yield from self._grade_rotation(matrix, wrong)

    def _whole_finding(self, matrix: Matrix, whole: Explanation) -> Finding:
        places = tuple((row + 1, column + 1) for row, column in whole.explained)
        where = "" if whole.throughout else f" in {_list(places)}"
        return Finding(
            place=matrix.claim.name,
            fault=self._spell(matrix, whole.fault) + where,
            remedy=self._spell(matrix, whole.remedy),
            kind=whole.kind,
            matrix=matrix.claim.name,
            entries=places,
        )

    def _wrong_finding(self, matrix: Matrix, place: Place, wrong: Sequence[Place]) -> Finding:
        """Say what is wrong inside an entry, and what is right."""
        lengths = sum(row >= FIRST_LENGTH for row in matrix.claim.rows)
        power = lengths if matrix.claim.kind == "determinant" else 1
        found = explain(
            matrix.trees[place],
            replace(self._vocabulary, power=power),
            lambda tree: matrix.is_right(place, self._comparison, tree),
            self._trials,
        ) or explain_alone(matrix, wrong, self._comparison, self._vocabulary.names)
        fault = f"printed {readable(matrix.texts[place])}"
        if found:
            fault += f", in which {found.fault}"
        elif matrix.is_chance(place, self._comparison):
            fault += f", which is right for {self._declared()} only"
        fault = self._spell(matrix, fault)
        kind = found.kind if found else "entry"
        return matrix.finding(place, fault, self._remedy(matrix, place), kind)

    def _spell(self, matrix: Matrix, text: str) -> str:
        """Name lengths and angles as the print does."""
        for name, spelled in self._spelled.items():
            text = re.sub(rf"\b{re.escape(name)}\b", spelled.replace("\\", r"\\"), text)
        return spelled_as(matrix.spelling, text)

    def _declared(self) -> str:
        symbols = self._vocabulary.symbols.items()
        return ", ".join(f"{self._spelled[name]} = {value:g}" for name, value in symbols)

    def _stranger_finding(self, matrix: Matrix, place: Place, strangers: Sequence[str]) -> Finding:
        """Say which symbols have no value: one more joint is wrong, others may be anything."""
        names, verb = " and ".join(strangers), "have" if len(strangers) > 1 else "has"
        fault = f"printed {readable(matrix.texts[place])}, in which {names} {verb} no value"
        fault, remedy = spelled_as(matrix.spelling, fault), self._remedy(matrix, place)
        if all(is_joint_variable(name) for name in strangers):
            return matrix.finding(place, fault, remedy, "unknown joint")
        say = f"or say what {names} is: a number under [symbols], a formula under [where]"
        return matrix.finding(place, fault, f"{remedy}, {say}", understood=False)

    def _remedy(self, matrix: Matrix, place: Place) -> str:
        """Write what is right: as a formula, or as a number at a posture."""
        if self._right_forms is not None:
            form = self._right_forms.text(matrix.claim, *place, matrix.spelling)
            return f"it should be {form}"
        right = matrix.right.at(self._comparison.sampler.as_it_is)[0, place[0], place[1]]
        numbers = f"at {self._postures.at(0)} it should be {right:.6g}"
        return spelled_as(matrix.spelling, numbers)

    def _grade_rotation(self, matrix: Matrix, wrong: Sequence[Place]) -> Iterator[Finding]:
        """Say why a rotation part is none; entries that are right count as exactly right."""
        R = self._rotation(matrix, wrong)
        fault = rotation_fault(R, TOLERANCE) if np.isfinite(R).all() else None
        if fault:
            yield Finding(
                place=matrix.claim.name,
                fault=f"its rotation part is no rotation: {fault}",
                remedy=f"its columns are the axes of frame {matrix.claim.frames[1]}: of length 1, "
                "at right angles, right-handed",
                kind="no rotation",
                matrix=matrix.claim.name,
            )

    def _rotation(self, matrix: Matrix, wrong: Sequence[Place]) -> Array:
        R = np.full((COUNT, 3, 3), np.nan)
        right = matrix.right.at(self._comparison.sampler.as_it_is)
        for (i, j), tree in matrix.trees.items():
            if i < 3 and j < 3:
                printed = (i, j) in wrong
                R[:, i, j] = self._comparison.values(tree) if printed else right[:, i, j]
        return R


def _of_another_shape(matrix: Matrix) -> Finding:
    (rows, columns), (right_rows, right_columns) = matrix.shape, matrix.claim.shape
    joints = len(matrix.subject.robot.moving)
    turned = matrix.claim.kind == "jacobian" and rows == joints and columns in (3, 6)
    seems = " and seems transposed" if turned else ""
    return Finding(
        place=matrix.claim.name,
        fault=f"it has {_shape(rows, columns)}{seems}",
        remedy=f"it should have {_shape(right_rows, right_columns)}",
        kind="shape",
        matrix=matrix.claim.name,
    )


def _shape(rows: int, columns: int) -> str:
    """Count rows and columns: 1 row and 3 columns."""
    return f"{rows} row{'s' * (rows != 1)} and {columns} column{'s' * (columns != 1)}"


def _list(places: Sequence[tuple[int, int]]) -> str:
    """Write entries as people list them."""
    *first, last = [f"({row}, {column})" for row, column in places]
    return f"{', '.join(first)} and {last}" if first else last
