"""Grades printed tables, transforms, Jacobians and singular postures against a robot.

Every entry is compared with the chain of the robot's table at random postures, and with random
lengths where it has symbols for them; an entry that differs anywhere is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, moving_rows
from drake_leg.lab.grader.claims import Claim, RightForms
from drake_leg.lab.grader.comparison import (
    COUNT,
    TOLERANCE,
    Comparison,
    Matrix,
    Meaning,
    Place,
    Sampler,
    Target,
    read_matrix,
)
from drake_leg.lab.grader.definitions import (
    Binding,
    Reader,
    bindings,
    names_of_cells,
    unused_definitions,
    with_lengths_as_symbols,
)
from drake_leg.lab.grader.findings import Finding
from drake_leg.lab.grader.mistakes import HALVES, Mistake, mistakes, table_mistakes
from drake_leg.lab.grader.printed import Printed
from drake_leg.lab.grader.singular_sets import grade_singular_sets
from drake_leg.lab.grader.slips import COMMON, Vocabulary, changes, explain
from drake_leg.lab.grader.table_cells import grade_table
from drake_leg.lab.grader.table_slips import has_bare_lengths
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import names_in
from drake_leg.symbolic.spelling import is_joint_variable, plain, readable, renamed, spelled_as

MOST_TRIALS = 1000  # of two changes in an entry, in all of a print
LARGEST_SYMBOLIC = 4  # joints; right entries of longer chains are said as numbers
LEAST = 2  # entries that a mistake of the whole must explain
EXCEPTIONS = 3  # explained entries to one that is not
_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")


def grade(robot: Robot, printed: Printed, *, seed: int = 0) -> list[Finding]:
    """Compare everything that is printed with the robot it describes.

    There is one finding for every row, matrix, entry, rotation and caption that is wrong or not
    understood. ``seed`` is that of the random postures and lengths.
    """
    if printed.lengths is None and _has_lengths(printed):
        raise InvalidValueError(
            f'{printed.origin}: lengths is missing; say lengths = "mm" or "m", or, if this is not '
            "a file of printed matrices or a printed table, give one"
        )
    if seed < 0:
        raise InvalidValueError(f"the seed is {seed}; it must not be negative")
    if printed.matrices or printed.singular:
        _require_one_chain(robot)
    printed = with_lengths_as_symbols(printed, robot)
    reader = Reader(printed, robot)
    sampler = Sampler(robot, reader, np.random.default_rng(seed))
    known = set(sampler.as_it_is.values)
    read = [read_matrix(matrix, robot, printed, reader, known) for matrix in printed.matrices]
    matrices = [matrix for matrix in read if isinstance(matrix, Matrix)]
    likely = _likeliest(sampler, bindings(printed, reader, sampler.lengths), matrices)
    grader = _MatrixGrader(robot, printed, reader, Comparison(sampler, likely[0]))
    findings = [
        *grade_table(robot, printed, reader, sampler),
        *_ambiguities(likely, matrices, sampler, printed),
    ]
    for matrix in read:
        findings += grader.grade(matrix) if isinstance(matrix, Matrix) else [matrix]
    if printed.singular:
        rng = np.random.default_rng(seed)
        findings += grade_singular_sets(robot, printed, reader, sampler, likely, rng)
    return [*findings, *unused_definitions(printed), *printed.unread]


def _has_lengths(printed: Printed) -> bool:
    """Whether anything printed may be a length whose unit must be known."""
    if printed.matrices or printed.singular or printed.symbols:
        return True
    return printed.table is None or has_bare_lengths(printed.table)


def _require_one_chain(robot: Robot) -> None:
    """Refuse to compare matrices, which are of one chain, with a robot that branches."""
    followed = zip(robot.rows, robot.antecedents, strict=True)
    for number, (row, antecedent) in enumerate(followed, start=1):
        if antecedent == number - 1 and not (row.gamma or row.b):
            continue
        has = "gamma or b" if antecedent == number - 1 else f"the antecedent {antecedent}"
        raise InvalidValueError(
            "printed matrices are graded for one chain without gamma and b, and row "
            f"{number} of {robot.name} has {has}",
            advice="compare its table alone, or make a robot of the rows of one branch",
        )


def _likeliest(
    sampler: Sampler, bindings: list[Binding], matrices: Sequence[Matrix]
) -> list[Binding]:
    """Keep the meanings of the symbols under which the fewest entries are wrong."""
    if len(bindings) == 1:
        return bindings
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
                "symbols",
                f"{name} can stand for {' or for '.join(cells)} of the robot's table",
                f"say {said}, or as it is meant",
                severity="warning",
                kind="ambiguous symbol",
            )


# --- matrices --------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Explanation:
    """What is wrong with a matrix as a whole, or with many of its entries alike."""

    kind: str
    fault: str
    remedy: str
    explained: tuple[Place, ...]  # wrong entries that need no finding of their own
    exceptions: int = 0  # readable entries that it does not explain
    throughout: bool = True  # whether the words are of the whole matrix, not of some entries


class _MatrixGrader:
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
        name = matrix.claim.name
        yield from _grade_caption(matrix, self._robot)
        if matrix.shape != matrix.claim.shape:
            yield _of_another_shape(matrix)
            return
        wrong = matrix.wrong(self._comparison)
        whole = self._explain_whole(matrix, wrong)
        if whole:
            entries = tuple((row + 1, column + 1) for row, column in whole.explained)
            where = "" if whole.throughout else f" in {_listed(entries)}"
            fault, remedy = (self._spell(matrix, text) for text in (whole.fault, whole.remedy))
            yield Finding(
                name, fault + where, remedy, kind=whole.kind, matrix=name, entries=entries
            )
        if whole and whole.kind == HALVES:
            matrix = matrix.with_halves_exchanged()
            wrong = matrix.wrong(self._comparison)
            whole = None
        rest = [place for place in wrong if not whole or place not in whole.explained]
        for place, entry in matrix.entries.items():
            about = f"{name} ({place[0] + 1}, {place[1] + 1})"
            kind, understood = "", True
            if place in rest:
                fault, kind = self._fault(matrix, place, wrong)
                remedy = self._remedy(matrix, place)
            elif entry.unread:
                fault, remedy, understood = entry.unread, self._remedy(matrix, place), False
            elif entry.strangers:
                fault, remedy, kind = self._strangers(matrix, place, entry.strangers)
                understood = bool(kind)
            else:
                continue
            yield Finding(
                about,
                fault,
                remedy,
                understood=understood,
                kind=kind,
                matrix=name,
                entries=((place[0] + 1, place[1] + 1),),
            )
        if matrix.claim.kind in ("transform", "rotation") and any(i < 3 and j < 3 for i, j in rest):
            yield from self._grade_rotation(matrix, wrong)

    def _fault(self, matrix: Matrix, place: Place, wrong: Sequence[Place]) -> tuple[str, str]:
        """Say what is wrong inside an entry, and of what kind it is."""
        comparison, target = self._comparison, matrix.target(place)
        formula = matrix.formulas[place]
        power = sum(matrix.claim.lengths) if matrix.claim.kind == "determinant" else 1
        found = explain(
            formula,
            replace(self._vocabulary, power=power),
            lambda changed: comparison.agrees(changed, target),
            self._trials,
        )
        alone = None
        if not found and len(wrong) == 1:  # perhaps from another table
            tables = table_mistakes(matrix, self._vocabulary.names)
            alone = next(self._matching(matrix, wrong, tables), None)
        cause = found or alone
        fault = f"printed {readable(matrix.entries[place].text)}"
        if cause:
            fault += f", in which {cause.fault}"
        elif comparison.agrees_in_number(formula, target):
            symbols = self._vocabulary.symbols.items()
            lengths = ", ".join(f"{self._spelled[name]} = {value:g}" for name, value in symbols)
            fault += f", which is right for {lengths} only"
        return self._spell(matrix, fault), cause.kind if cause else "entry"

    def _spell(self, matrix: Matrix, text: str) -> str:
        """Name lengths and angles as the print does."""
        return spelled_as(matrix.spelling, renamed(text, self._spelled))

    def _strangers(
        self, matrix: Matrix, place: Place, strangers: Sequence[str]
    ) -> tuple[str, str, str]:
        """Report symbols without a value: an unknown joint is wrong, others have no kind."""
        names, verb = " and ".join(strangers), "have" if len(strangers) > 1 else "has"
        text = readable(matrix.entries[place].text)
        fault = spelled_as(matrix.spelling, f"printed {text}, in which {names} {verb} no value")
        remedy = self._remedy(matrix, place)
        if all(is_joint_variable(name) for name in strangers):
            return fault, remedy, "unknown joint"
        return fault, f"{remedy}, or say what {names} is: {self._printed.format.meaning}", ""

    def _remedy(self, matrix: Matrix, place: Place) -> str:
        """Write what is right: as a formula, or as a number at a posture."""
        if self._right_forms is not None:
            form = self._right_forms.text(matrix.claim, *place, matrix.spelling)
            return f"it should be {form}"
        sampler = self._comparison.sampler
        right = matrix.meaning.at(sampler.as_it_is)[0, place[0], place[1]]
        return spelled_as(matrix.spelling, f"at {sampler.posture(0)} it should be {right:.6g}")

    def _grade_rotation(self, matrix: Matrix, wrong: Sequence[Place]) -> Iterator[Finding]:
        """Report a rotation part that is not a rotation; right entries count as exactly right."""
        R = np.full((COUNT, 3, 3), np.nan)
        right = matrix.meaning.at(self._comparison.sampler.as_it_is)
        for (i, j), formula in matrix.formulas.items():
            if i < 3 and j < 3:
                printed = self._comparison.values(formula) if (i, j) in wrong else right[:, i, j]
                R[:, i, j] = printed
        fault = rotation_fault(R, TOLERANCE) if np.isfinite(R).all() else None
        if fault:
            yield Finding(
                matrix.claim.name,
                f"its rotation part is not a rotation: {fault}",
                f"its columns are the axes of frame {matrix.claim.frames[1]}: of length 1, "
                "at right angles, right-handed",
                kind="no rotation",
                matrix=matrix.claim.name,
            )

    def _explain_whole(self, matrix: Matrix, wrong: Sequence[Place]) -> _Explanation | None:
        """Search for one mistake that explains all wrong entries, or all but the fewest."""
        if len(wrong) < LEAST:
            return None
        found = list(self._common_changes(matrix, wrong))
        if not any(explanation.exceptions == 0 for explanation in found):
            found += self._matching(matrix, wrong, mistakes(matrix, self._vocabulary.names))
        return min(found, key=lambda explanation: explanation.exceptions, default=None)

    def _common_changes(self, matrix: Matrix, wrong: Sequence[Place]) -> Iterator[_Explanation]:
        """Look for the same slip of the pen in many entries."""
        formulas = matrix.formulas
        helped: dict[str, list[Place]] = {}
        kinds: dict[str, str] = {}
        for number, place in enumerate(wrong):
            late = 2 * number > len(wrong)  # too late for words that explain half of the entries
            possible = changes(formulas[place], self._vocabulary) if helped or not late else ()
            for kind, fault, formula in possible:
                if kind not in COMMON or (late and fault not in helped):
                    continue
                places = helped.get(fault, [])
                if place not in places and self._comparison.agrees(formula, matrix.target(place)):
                    helped[fault] = [*places, place]
                    kinds[fault] = kind
        for fault, places in helped.items():
            if len(places) >= LEAST and 2 * len(places) >= len(wrong):
                _, should, right = fault.partition(" should be ")
                yield _Explanation(
                    kind=kinds[fault],
                    fault=fault,
                    remedy=f"write {right} there" if should else "change them back",
                    explained=tuple(places),
                    exceptions=len(wrong) - len(places),
                    throughout=False,
                )

    def _matching(
        self, matrix: Matrix, wrong: Sequence[Place], candidates: Iterable[Mistake]
    ) -> Iterator[_Explanation]:
        """Look for a misunderstanding that results in what is printed."""
        comparison, formulas = self._comparison, matrix.formulas
        printed = np.full((COUNT, *matrix.shape), np.nan)
        for (i, j), formula in formulas.items():
            printed[:, i, j] = comparison.values(formula)

        def explains(same: set[Place], mistake: Mistake) -> bool:
            explained, exceptions = len(same & set(wrong)), len(formulas) - len(same)
            enough = explained >= min(LEAST, len(wrong)) and explained >= EXCEPTIONS * exceptions
            return enough and not (mistake.exact and exceptions)

        for mistake in candidates:
            meaning = Meaning(mistake.printed)
            margin = mistake.rough * matrix.margin
            values = meaning.at(comparison.sampler.as_it_is)
            with np.errstate(all="ignore"):
                near = np.all(np.abs(printed - values) <= margin, axis=0)
            same = {place for place in formulas if near[place]}
            if not explains(same, mistake):
                continue
            same = {
                place
                for place in same
                if comparison.agrees(formulas[place], Target(meaning, place, float(margin[place])))
            }
            if explains(same, mistake):
                yield _Explanation(
                    kind=mistake.kind,
                    fault=mistake.fault,
                    remedy=mistake.remedy,
                    explained=tuple(place for place in wrong if place in same),
                    exceptions=len(formulas) - len(same),
                )


def _of_another_shape(matrix: Matrix) -> Finding:
    joints = len(matrix.robot.moving)
    turned = matrix.claim.kind == "jacobian" and matrix.shape[0] == joints
    seems = " and seems transposed" if turned and matrix.shape[1] in (3, 6) else ""
    return Finding(
        matrix.claim.name,
        f"it has {_counted(*matrix.shape)}{seems}",
        f"it should have {_counted(*matrix.claim.shape)}",
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


def _grade_caption(matrix: Matrix, robot: Robot) -> Iterator[Finding]:
    """Compare a caption's "first two DOF" with the joints that a matrix spans."""
    found = re.search(r"(\w+)\s+(?:dof\b|degrees? of freedom)", matrix.caption, re.IGNORECASE)
    word = found[1].lower() if found else ""
    if not word.isdecimal() and word not in _NUMBERS:
        return
    joints = _spanned_joints(matrix.claim, robot)
    if joints != (int(word) if word.isdecimal() else _NUMBERS.index(word)):
        right = _NUMBERS[joints] if joints < len(_NUMBERS) else str(joints)
        yield Finding(
            f"{matrix.claim.name}, caption",
            f"it says {word} degrees of freedom, and the matrix spans {right} joints",
            f"write {right}",
            kind="caption",
            matrix=matrix.claim.name,
        )


def _spanned_joints(claim: Claim, robot: Robot) -> int:
    if claim.is_pose:
        first, last = sorted(claim.frames)
        return len(moving_rows(robot.rows[first:last]))
    return claim.shape[1] if claim.kind == "jacobian" else len(claim.rows)


def rotation_fault(R: Array, tolerance: float) -> str | None:
    """Say why matrices (N, 3, 3) are not rotations, or None for rotations.

    A product of two columns may be as far as ``tolerance`` from 0 or 1.
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
