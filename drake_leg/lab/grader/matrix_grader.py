"""Finds what is wrong with a printed matrix: as a whole, then entry by entry."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from drake_leg.kinematics.khalil import Array, moving_rows
from drake_leg.lab.grader.claims import FIRST_LENGTH, Claim
from drake_leg.lab.grader.comparison import COUNT, Comparison, Meaning, Target
from drake_leg.lab.grader.definitions import Reader, RightForms
from drake_leg.lab.grader.matrices import TOLERANCE, Matrix, Place
from drake_leg.lab.grader.mistakes import HALVES, Mistake, mistakes, table_mistakes
from drake_leg.lab.grader.printed import Finding, Printed
from drake_leg.lab.grader.slips import COMMON, Vocabulary, changes, explain
from drake_leg.lab.grader.tables import names_of_cells
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.spelling import is_joint_variable, plain, readable, renamed, spelled_as

MOST_TRIALS = 1000  # of two changes in an entry, in all of a print
LARGEST_SYMBOLIC = 4  # joints; right entries of longer chains are said as numbers
LEAST = 2  # entries that a mistake of the whole must explain
EXCEPTIONS = 3  # explained entries to one that is not
_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """What is wrong with a matrix as a whole, or with many of its entries alike."""

    kind: str
    fault: str
    remedy: str
    explained: tuple[Place, ...]  # wrong entries that need no finding of their own
    exceptions: int = 0  # readable entries that it does not explain
    throughout: bool = True  # whether the words are of the whole matrix, not of some entries


class MatrixGrader:
    """Grades the matrices of one print, under one meaning of its symbols."""

    def __init__(
        self, robot: Robot, printed: Printed, reader: Reader, comparison: Comparison
    ) -> None:
        self._robot, self._printed, self._reader = robot, printed, reader
        self._comparison = comparison
        self._spelled = {plain(name): readable(name) for name in printed.symbols}
        lengths = comparison.sampler.lengths.items()
        self._vocabulary = Vocabulary(
            angles=len(robot.moving),
            symbols={n: reader.symbols[n] for n in sorted(comparison.binding)},
            lengths=tuple(dict.fromkeys(abs(v) for c, v in lengths if c.column in ("d", "r"))),
            unit=printed.unit,
            units=reader.units,
            names=names_of_cells(comparison.binding, self._spelled),
        )
        self._trials = iter(range(MOST_TRIALS))

    @cached_property
    def _right_forms(self) -> RightForms | None:
        if len(self._robot.moving) > LARGEST_SYMBOLIC:
            return None
        return RightForms(self._robot, self._printed, self._reader, self._vocabulary.names)

    def grade(self, matrix: Matrix) -> Iterator[Finding]:
        """Find everything that is wrong or not understood in a matrix.

        First a mistake of the whole matrix, then the entries that it does not explain.
        """
        yield from _grade_caption(matrix, self._robot)
        if matrix.shape != matrix.claim.shape:
            yield _of_another_shape(matrix)
            return
        wrong = matrix.wrong(self._comparison)
        whole = _explain_whole(matrix, wrong, self._comparison, self._vocabulary)
        if whole:
            yield self._whole_finding(matrix, whole)
        if whole and whole.kind == HALVES:
            matrix = matrix.with_halves_exchanged()
            wrong = matrix.wrong(self._comparison)
            whole = None
        rest = [place for place in wrong if not whole or place not in whole.explained]
        for place, entry in matrix.entries.items():
            if place in rest:
                yield self._wrong_finding(matrix, place, wrong)
            elif entry.unread:
                remedy = self._remedy(matrix, place)
                yield matrix.finding(place, entry.unread, remedy, understood=False)
            elif entry.strangers:
                yield self._stranger_finding(matrix, place, entry.strangers)
        if matrix.claim.kind in ("transform", "rotation") and any(i < 3 and j < 3 for i, j in rest):
            yield from self._grade_rotation(matrix, wrong)

    def _whole_finding(self, matrix: Matrix, whole: Explanation) -> Finding:
        entries = tuple((row + 1, column + 1) for row, column in whole.explained)
        where = "" if whole.throughout else f" in {_listed(entries)}"
        return Finding(
            place=matrix.claim.name,
            fault=self._spell(matrix, whole.fault) + where,
            remedy=self._spell(matrix, whole.remedy),
            kind=whole.kind,
            matrix=matrix.claim.name,
            entries=entries,
        )

    def _wrong_finding(self, matrix: Matrix, place: Place, wrong: Sequence[Place]) -> Finding:
        """Say what is wrong inside an entry, and what is right."""
        comparison, target = self._comparison, matrix.target(place)
        formula = matrix.formulas[place]
        lengths = sum(row >= FIRST_LENGTH for row in matrix.claim.rows)
        power = lengths if matrix.claim.kind == "determinant" else 1
        found = explain(
            formula,
            replace(self._vocabulary, power=power),
            lambda changed: comparison.agrees(changed, target),
            self._trials,
        ) or _explain_alone(matrix, wrong, comparison, self._vocabulary)
        fault = f"printed {readable(matrix.entries[place].text)}"
        if found:
            fault += f", in which {found.fault}"
        elif comparison.agrees_in_number(formula, target):
            symbols = self._vocabulary.symbols.items()
            lengths_text = ", ".join(
                f"{self._spelled[name]} = {value:g}" for name, value in symbols
            )
            fault += f", which is right for {lengths_text} only"
        kind = found.kind if found else "entry"
        return matrix.finding(place, self._spell(matrix, fault), self._remedy(matrix, place), kind)

    def _spell(self, matrix: Matrix, text: str) -> str:
        """Name lengths and angles as the print does."""
        return spelled_as(matrix.spelling, renamed(text, self._spelled))

    def _stranger_finding(self, matrix: Matrix, place: Place, strangers: Sequence[str]) -> Finding:
        """Report symbols without a value: an unknown joint is wrong, others are not understood."""
        names, verb = " and ".join(strangers), "have" if len(strangers) > 1 else "has"
        text = readable(matrix.entries[place].text)
        fault = spelled_as(matrix.spelling, f"printed {text}, in which {names} {verb} no value")
        remedy = self._remedy(matrix, place)
        if all(is_joint_variable(name) for name in strangers):
            return matrix.finding(place, fault, remedy, "unknown joint")
        remedy += f", or say what {names} is: {self._printed.format.meaning}"
        return matrix.finding(place, fault, remedy, understood=False)

    def _remedy(self, matrix: Matrix, place: Place) -> str:
        """Write what is right: as a formula, or as a number at a posture."""
        if self._right_forms is not None:
            form = self._right_forms.text(matrix.claim, *place, matrix.spelling)
            return f"it should be {form}"
        sampler = self._comparison.sampler
        right = matrix.right.at(sampler.as_it_is)[0, place[0], place[1]]
        numbers = f"at {sampler.posture(0)} it should be {right:.6g}"
        return spelled_as(matrix.spelling, numbers)

    def _grade_rotation(self, matrix: Matrix, wrong: Sequence[Place]) -> Iterator[Finding]:
        """Report a rotation part that is no rotation; right entries count as exactly right."""
        R = np.full((COUNT, 3, 3), np.nan)
        right = matrix.right.at(self._comparison.sampler.as_it_is)
        for (i, j), formula in matrix.formulas.items():
            if i < 3 and j < 3:
                printed = self._comparison.values(formula) if (i, j) in wrong else right[:, i, j]
                R[:, i, j] = printed
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


def _of_another_shape(matrix: Matrix) -> Finding:
    (rows, columns), (right_rows, right_columns) = matrix.shape, matrix.claim.shape
    joints = len(matrix.subject.robot.moving)
    turned = matrix.claim.kind == "jacobian" and rows == joints and columns in (3, 6)
    seems = " and seems transposed" if turned else ""
    return Finding(
        place=matrix.claim.name,
        fault=f"it has {_counted(rows, columns)}{seems}",
        remedy=f"it should have {_counted(right_rows, right_columns)}",
        kind="shape",
        matrix=matrix.claim.name,
    )


def _counted(rows: int, columns: int) -> str:
    """Count rows and columns: 1 row and 3 columns."""
    return f"{rows} row{'s' * (rows != 1)} and {columns} column{'s' * (columns != 1)}"


def _listed(entries: Sequence[tuple[int, int]]) -> str:
    """Write entries as a list in a sentence."""
    *first, last = [f"({row}, {column})" for row, column in entries]
    return f"{', '.join(first)} and {last}" if first else last


def _explain_whole(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, vocabulary: Vocabulary
) -> Explanation | None:
    """Search for one mistake that explains all wrong entries, or all but the fewest."""
    if len(wrong) < LEAST:
        return None
    found = list(_common_changes(matrix, wrong, comparison, vocabulary))
    if not any(explanation.exceptions == 0 for explanation in found):
        likely = mistakes(matrix.subject, vocabulary.names)
        found += _matching(matrix, wrong, comparison, likely)
    return min(found, key=lambda explanation: explanation.exceptions, default=None)


def _explain_alone(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, vocabulary: Vocabulary
) -> Explanation | None:
    """Search for another table that explains the only wrong entry of a matrix."""
    if len(wrong) != 1:
        return None
    likely = table_mistakes(matrix.subject, vocabulary.names)
    return next(_matching(matrix, wrong, comparison, likely), None)


def _common_changes(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, vocabulary: Vocabulary
) -> Iterator[Explanation]:
    """Look for the same slip of the pen in many entries."""
    formulas = matrix.formulas
    helped: dict[str, list[Place]] = {}
    kinds: dict[str, str] = {}
    for number, place in enumerate(wrong):
        late = 2 * number > len(wrong)  # too late for words that explain half of the entries
        for change in changes(formulas[place], vocabulary) if helped or not late else ():
            if change.kind not in COMMON or (late and change.words not in helped):
                continue
            places = helped.get(change.words, [])
            if place not in places and comparison.agrees(change.formula, matrix.target(place)):
                helped[change.words] = [*places, place]
                kinds[change.words] = change.kind
    for words, places in helped.items():
        if len(places) >= LEAST and 2 * len(places) >= len(wrong):
            _, should, right = words.partition(" should be ")
            yield Explanation(
                kind=kinds[words],
                fault=words,
                remedy=f"write {right} there" if should else "change them back",
                explained=tuple(places),
                exceptions=len(wrong) - len(places),
                throughout=False,
            )


def _matching(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, candidates: Iterable[Mistake]
) -> Iterator[Explanation]:
    """Look for a misunderstanding that results in what is printed."""
    formulas = matrix.formulas
    printed = np.full((COUNT, *matrix.shape), np.nan)
    for (i, j), formula in formulas.items():
        printed[:, i, j] = comparison.values(formula)
    readable_places = set(formulas)

    def explains(same: set[Place], mistake: Mistake) -> bool:
        explained, exceptions = len(same & set(wrong)), len(readable_places - same)
        enough = explained >= min(LEAST, len(wrong)) and explained >= EXCEPTIONS * exceptions
        return enough and not (mistake.exact and exceptions)

    for mistake in candidates:
        meaning = Meaning(mistake.printed)
        margin = mistake.rough * matrix.margin
        values = meaning.at(comparison.sampler.as_it_is)
        with np.errstate(all="ignore"):
            near = np.all(np.abs(printed - values) <= margin, axis=0)
        same = {place for place in readable_places if near[place]}
        if not explains(same, mistake):
            continue
        same = {
            place
            for place in same
            if comparison.agrees(formulas[place], Target(meaning, place, float(margin[place])))
        }
        if explains(same, mistake):
            yield Explanation(
                kind=mistake.kind,
                fault=mistake.fault,
                remedy=mistake.remedy,
                explained=tuple(place for place in wrong if place in same),
                exceptions=len(readable_places - same),
            )


def _grade_caption(matrix: Matrix, robot: Robot) -> Iterator[Finding]:
    """Compare a caption's "first two DOF" with the joints that a matrix spans."""
    found = re.search(r"(\w+)\s+(?:dof\b|degrees? of freedom)", matrix.caption, re.IGNORECASE)
    word = found[1].lower() if found else ""
    if not word.isdigit() and word not in _NUMBERS:
        return
    joints = _spanned_joints(matrix.claim, robot)
    if joints != (int(word) if word.isdigit() else _NUMBERS.index(word)):
        yield Finding(
            place=f"{matrix.claim.name}, caption",
            fault=f"it says {word} degrees of freedom, and the matrix spans {_NUMBERS[joints]} "
            "joints",
            remedy=f"write {_NUMBERS[joints]}",
            kind="caption",
            matrix=matrix.claim.name,
        )


def _spanned_joints(claim: Claim, robot: Robot) -> int:
    if claim.is_pose:
        first, last = sorted(claim.frames)
        return len(moving_rows(robot.rows[first:last]))
    return claim.shape[1] if claim.kind == "jacobian" else len(claim.rows)


def rotation_fault(R: Array, tolerance: float) -> str | None:
    """Say why matrices are no rotations, or None for rotations.

    Parameters
    ----------
    R : (N, 3, 3) ndarray
        One matrix at N postures [-].
    tolerance : float
        How far a product of two columns may be from 0 or 1.
    """
    off = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max(axis=0) > tolerance
    lengths = [i for i in range(3) if off[i, i]]
    pairs = [(i, j) for i in range(3) for j in range(i + 1, 3) if off[i, j]]
    faults = []
    if lengths:
        faults.append(f"{_columns(lengths)} not of length 1")
    faults += [f"{_columns(pair)} not at right angles" for pair in pairs]
    if not faults and np.any(np.linalg.det(R) < 0.0):
        faults.append("its determinant is -1, a mirror's")
    return ", ".join(faults) or None


def _columns(indices: Sequence[int]) -> str:
    numbers = " and ".join(str(index + 1) for index in indices)
    return f"column {numbers} is" if len(indices) == 1 else f"columns {numbers} are"
