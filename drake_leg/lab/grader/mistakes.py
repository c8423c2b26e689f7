"""Mistakes of a whole matrix, reported as one finding instead of one per entry.

Each computes the matrix that it results in: transposed, inverse, of other frames or of another
point, in another order, about other axes, in another unit.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.lab.grader.claims import FIRST_LENGTH, Claim
from drake_leg.lab.grader.comparison import (
    Chain,
    between,
    claimed_part,
    right_values,
    running_products,
    twists,
)
from drake_leg.lab.grader.other_tables import CONVENTION, DEGREES, other_tables
from drake_leg.lab.grader.printed import Format
from drake_leg.lab.grader.tables import Cell
from drake_leg.robot.robot import Robot

Mask = NDArray[np.bool_]  # which entries of a matrix belong to a part of it
Index = int | slice

MOST_PERMUTED = 4  # rows or columns; of more only two change places
MOST_FACTORS = 4  # of a product whose orders are all tried
HALVES = "halves"
_EVERY = slice(None)


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A matrix of a robot, in a print's unit of lengths."""

    claim: Claim
    robot: Robot
    variables: tuple[str, ...]  # names of the joints' positions
    unit: str  # of the print's lengths: mm, cm or m
    units: Mapping[str, float]  # all units of lengths, in the print's
    format: Format  # of the print: the words of advice

    def right(self, chain: Chain) -> Array:
        """Evaluate what is right, (N, r, c)."""
        return right_values(self.claim, chain)

    def part(self, index: tuple[Index, Index]) -> Mask:
        """Choose entries of the matrix."""
        inside = np.zeros(self.claim.shape, dtype=bool)
        inside[index] = True
        return inside

    @property
    def all(self) -> Mask:
        """Choose all entries."""
        return self.part((_EVERY, _EVERY))

    @property
    def lines(self) -> list[tuple[str, Mask]]:
        """Name every column, then every row."""
        rows, columns = self.claim.shape
        named = [(f"column {j + 1}", self.part((_EVERY, j))) for j in range(columns)]
        return named + [(f"row {i + 1}", self.part((i, _EVERY))) for i in range(rows)]


@dataclass(frozen=True)
class Mistake:
    """One misunderstanding that explains many entries of a matrix."""

    kind: str  # a word or a few, the same for all matrices
    fault: str
    remedy: str
    printed: Callable[[Chain], Array]  # the matrix with the mistake, (N, r, c)
    rough: float = 1.0  # times the usual margin: numbers that people round
    exact: bool = False  # whether it must explain every entry that can be read


def mistakes(subject: Subject, names: Mapping[Cell, str]) -> Iterator[Mistake]:
    """List what can be wrong with a matrix as a whole, the likeliest first.

    ``names`` are the print's, of the cells of the robot's table.
    """
    tables = list(table_mistakes(subject, names))
    yield from (mistake for mistake in tables if mistake.kind == CONVENTION)
    if subject.claim.is_pose:
        yield from _pose_mistakes(subject)
    elif subject.claim.kind == "jacobian":
        yield from _jacobian_mistakes(subject)
    yield from (mistake for mistake in tables if mistake.kind != CONVENTION)


def table_mistakes(subject: Subject, names: Mapping[Cell, str]) -> Iterator[Mistake]:
    """List the mistakes that come from another table than the robot's."""
    for table in other_tables(subject.robot, subject.variables, names, subject.format):
        if subject.claim.kind != "determinant" or table.kind != DEGREES:  # too rough for one entry
            printed = partial(lambda change, chain: subject.right(change(chain)), table.change)
            yield Mistake(table.kind, table.fault, table.remedy, printed, rough=table.rough)


def _pose_mistakes(subject: Subject) -> Iterator[Mistake]:
    """List mistakes of a transform, a rotation or a position."""
    claim = subject.claim
    first, last = claim.frames
    if first > last:  # T10 holds T01, which may be its transpose, too
        yield _of_frames(subject, last, first)
    yield from _transposed(subject)
    lengths = np.zeros(claim.shape, dtype=bool)
    named = [("all of it", subject.all)]
    if claim.kind == "position":
        lengths.flat[:3] = True
        named = [("all of it", lengths)]
    elif claim.kind == "transform":
        lengths[:3, 3] = True
        rotation = subject.part((slice(3), slice(3)))
        named += [("the upper part", rotation | lengths), ("the rotation part", rotation)]
        yield Mistake(
            "transposed",
            "its rotation part is transposed",
            "exchange the rows and columns of its rotation part",
            lambda c: _rotation_transposed(subject.right(c)),
        )
    yield _of_frames(subject, last, first)
    for a, b in itertools.permutations(range(len(subject.robot.rows) + 1), 2):
        if {a, b} != {first, last}:
            yield _of_frames(subject, a, b)
    yield from _in_other_units(subject, lengths)
    yield from _reordered(subject)
    yield from _turned(subject, named)
    if first < last:
        yield from _other_products(subject)
        yield from _classic(subject)


def _of(subject: Subject, whole: Callable[[Chain], Array]) -> Callable[[Chain], Array]:
    """Extract what is claimed from another pose or Jacobian."""
    return lambda chain: claimed_part(subject.claim, whole(chain))


def _rotation_transposed(X: Array) -> Array:
    turned = X.copy()
    turned[:, :3, :3] = np.swapaxes(X[:, :3, :3], -1, -2)
    return turned


def _of_frames(subject: Subject, a: int, b: int) -> Mistake:
    """Take the inverse, or the transform between two other frames."""
    first, last = subject.claim.frames
    letter = {"transform": "T", "rotation": "R"}.get(subject.claim.kind, "P")
    right = f"{letter}{first}{last}"
    inverse = (a, b) == (last, first)
    return Mistake(
        "inverse" if inverse else "other frames",
        f"it is the inverse, {letter}{a}{b}" if inverse else f"it is {letter}{a}{b}, not {right}",
        f"write {right}, from frame {last} to frame {first}",
        _of(subject, lambda c: between(c.frames(), a, b)),
        exact=not inverse,
    )


def _other_products(subject: Subject) -> Iterator[Mistake]:
    """Multiply in another order, or leave a factor out."""
    factors = tuple(range(*subject.claim.frames))
    if len(factors) < 2:
        return
    remedy = f"multiply {_product_text(factors)}"
    orders = [factors[::-1]]
    if len(factors) <= MOST_FACTORS:
        others = itertools.permutations(factors)
        orders += [order for order in others if order not in (factors, factors[::-1])]
    for order in orders:
        fault = f"it is the product in the wrong order, {_product_text(order)}"
        printed = _of(subject, partial(_product, order))
        yield Mistake("order of the product", fault, remedy, printed)
    for left_out in factors[1:-1]:
        fault = f"{_product_text([left_out])} is left out of the product"
        order = tuple(factor for factor in factors if factor != left_out)
        yield Mistake("factor left out", fault, remedy, _of(subject, partial(_product, order)))


def _product_text(order: Sequence[int]) -> str:
    return " ".join(f"T{index}{index + 1}" for index in order)


def _product(order: Sequence[int], chain: Chain) -> Array:
    return running_products(chain.steps()[:, list(order)])[:, -1]


def _classic(subject: Subject) -> Iterator[Mistake]:
    """Take the classic transform for Khalil's: z first, then x of the row or of the next one."""
    first, last = subject.claim.frames

    def product(following: int, chain: Chain) -> Array:
        steps = chain.about_z() @ np.roll(chain.about_x(), -following, axis=1)
        return running_products(steps[:, first:last])[:, -1]

    whose = ["of the same rows", "and alpha and a of the next row"]
    for following in range(2 if last < len(subject.robot.rows) else 1):
        yield Mistake(
            "classic",
            f"it is the classic (standard) transform, with z before x, {whose[following]}",
            "Khalil's turns and shifts about x first: Rx(alpha) Tx(d) Rz(theta) Tz(r)",
            _of(subject, partial(product, following)),
        )


def _jacobian_mistakes(subject: Subject) -> Iterator[Mistake]:
    moving = subject.robot.moving[: subject.claim.shape[1]]
    turning = np.array([segment.row.joint == "revolute" for segment in moving])
    rows = np.array([row >= FIRST_LENGTH for row in subject.claim.rows])
    of_lengths = np.broadcast_to(rows[:, np.newaxis], subject.claim.shape)
    yield from _transposed(subject)
    yield from _inverse_jacobian(subject)
    yield from _halves(subject)
    yield from _in_other_units(subject, of_lengths & turning)
    yield from _with_pi(subject, "it", subject.all)
    if not of_lengths.all():
        yield from _with_pi(subject, "its translational part", of_lengths)
    yield from _reordered(subject)
    named = [("all of it", subject.all)]
    if of_lengths.any() and not of_lengths.all():
        named += [("the translational part", of_lengths), ("the rotational part", ~of_lengths)]
    yield from _turned(subject, named)
    yield from _of_other_points(subject)
    yield from _in_other_frames(subject)
    yield from _about_other_axes(subject)
    yield from _of_other_joints(subject)
    for name, inside in subject.lines:
        yield _scaled(subject, "zero", f"{name} is zero", "fill it in", inside, 0.0)


def _inverse_jacobian(subject: Subject) -> Iterator[Mistake]:
    if subject.claim.shape[0] != subject.claim.shape[1]:
        return

    def inverted(chain: Chain) -> Array:
        """Invert where that can be done; elsewhere it has no numbers."""
        J = subject.right(chain)
        regular = np.linalg.cond(J) < 1e12
        inverse = np.full_like(J, np.nan)
        inverse[regular] = np.linalg.inv(J[regular])
        return inverse

    remedy = "write J, which takes joint rates to velocities"
    yield Mistake("inverse", "it is the inverse of the Jacobian", remedy, inverted)
    fault = "it is the inverse of the transposed Jacobian"
    yield Mistake("inverse", fault, remedy, lambda c: np.swapaxes(inverted(c), -1, -2))


def _halves(subject: Subject) -> Iterator[Mistake]:
    """Take (v; w) for (w; v), or the other way round."""
    rows = subject.claim.rows
    if len(rows) == 6:
        wanted, found = ("(v; w)", "(w; v)") if rows[0] >= FIRST_LENGTH else ("(w; v)", "(v; w)")
        yield Mistake(
            HALVES,
            f"it is {found}, velocity and rotation having changed places",
            f"write {wanted}, or name the rows in their order {subject.format.rows}",
            lambda c: np.roll(subject.right(c), 3, axis=-2),
        )


def _of_other_points(subject: Subject) -> Iterator[Mistake]:
    """Take the Jacobian of another frame's origin, or of the base's origin on the foot's body."""

    def of_origin(last: int, chain: Chain) -> Array:
        X_B = chain.frames()
        beyond = np.array(chain.moving) >= last
        return np.where(beyond, 0.0, twists(chain, X_B[:, 1:], X_B[:, last, :3, 3]))

    def from_base(chain: Chain) -> Array:
        axes = chain.frames()[:, 1:].copy()
        axes[..., :3, 3] = 0.0
        return twists(chain, axes, chain.frames()[:, -1, :3, 3])

    count = len(subject.robot.rows)
    for last in range(count - 1, 0, -1):
        left = "the last link" if last == count - 1 else f"the links after frame {last}"
        yield Mistake(
            "other point",
            f"it is the Jacobian of frame {last}'s origin, without {left}",
            "write the Jacobian of the foot",
            _of(subject, partial(of_origin, last)),
        )
    yield Mistake(
        "other point",
        "it is the spatial Jacobian, of the point that passes the base's origin",
        "take z x OF, with F the foot",
        _of(subject, lambda c: twists(c, c.frames()[:, 1:], np.zeros((len(c.q), 3)))),
    )
    yield Mistake(
        "other point",
        "distances are taken from the base's origin and not from the joints",
        "take z x (p_F - p_i), with p_i on the axis of joint i",
        _of(subject, from_base),
    )


def _in_other_frames(subject: Subject) -> Iterator[Mistake]:
    """Express the Jacobian in the axes of the foot or of another frame."""

    def expressed_in(index: int, chain: Chain) -> Array:
        R = np.swapaxes(chain.frames()[:, index, :3, :3], -1, -2)
        J = chain.jacobian()
        return np.concatenate([R @ J[:, :3], R @ J[:, 3:]], axis=1)

    count = len(subject.robot.rows)
    for index in range(count, 0, -1):
        whose = "the foot's frame" if index == count else f"frame {index}"
        yield Mistake(
            "other frame",
            f"it is expressed in {whose}",
            "express it in the base's frame: multiply by the rotation from there to the base",
            _of(subject, partial(expressed_in, index)),
        )


def _about_other_axes(subject: Subject) -> Iterator[Mistake]:
    """Turn about the z axis of the frame before, as in classic tables; or about x, about y."""

    def about(column: int, chain: Chain) -> Array:
        X_B = chain.frames()
        axes = X_B[:, 1:].copy()
        axes[..., 2] = axes[..., column]
        return twists(chain, axes, X_B[:, -1, :3, 3])

    yield Mistake(
        "other axes",
        "its joints turn about the z axes of the frames before, as in classic (standard) tables",
        "in Khalil's tables joint i turns about z of frame i",
        _of(subject, lambda c: twists(c, c.frames()[:, :-1], c.frames()[:, -1, :3, 3])),
    )
    for column, letter in enumerate("xy"):
        yield Mistake(
            "other axes",
            f"its joints turn about the {letter} axes of their frames",
            "joint i turns about z of frame i",
            _of(subject, partial(about, column)),
        )


def _of_other_joints(subject: Subject) -> Iterator[Mistake]:
    """Take a sliding joint's column for a turning one's, or the other way; the pose stays."""

    def with_other_joint(index: int, chain: Chain) -> Array:
        joints = list(chain.joints)
        joints[index] = "prismatic" if joints[index] == "revolute" else "revolute"
        X_B = chain.frames()
        return twists(replace(chain, joints=tuple(joints)), X_B[:, 1:], X_B[:, -1, :3, 3])

    moving = [i for i, row in enumerate(subject.robot.rows) if row.joint != "fixed"]
    for number, index in enumerate(moving[: subject.claim.shape[1]], start=1):
        turns = subject.robot.rows[index].joint == "revolute"
        meant, is_one = ("sliding", "turning") if turns else ("turning", "sliding")
        yield Mistake(
            "other joint",
            f"joint {number} is taken for a {meant} one",
            f"joint {number} is a {is_one} one",
            _of(subject, partial(with_other_joint, index)),
        )


def _scaled(
    subject: Subject, kind: str, fault: str, remedy: str, inside: Mask, factor: float
) -> Mistake:
    """Multiply a part of what is right."""
    factors = np.where(inside, factor, 1.0)
    return Mistake(kind, fault, remedy, lambda c: subject.right(c) * factors)


def _transposed(subject: Subject) -> Iterator[Mistake]:
    if subject.claim.shape[0] == subject.claim.shape[1] > 1:
        yield Mistake(
            "transposed",
            "it is transposed",
            "exchange its rows and columns",
            lambda c: np.swapaxes(subject.right(c), -1, -2),
        )


def _reordered(subject: Subject) -> Iterator[Mistake]:
    """Put columns, then rows in another order."""
    rows, columns = subject.claim.shape
    for what, count, axis in (("columns", columns, -1), ("rows", rows, -2)):
        for order in _orders(count):
            moved = [place + 1 for place, index in enumerate(order) if place != index]
            fault = f"its {what} are in the order {', '.join(str(i + 1) for i in order)}"
            if len(moved) == 2:
                fault = f"its {what} {moved[0]} and {moved[1]} have changed places"
            printed = partial(_in_order, subject, order, axis)
            yield Mistake(f"order of {what}", fault, "put them in their order", printed)


def _in_order(subject: Subject, order: Sequence[int], axis: int, chain: Chain) -> Array:
    right: Array = np.take(subject.right(chain), order, axis=axis)
    return right


def _orders(count: int) -> Iterator[tuple[int, ...]]:
    """List orders, those first in which only two have changed places."""
    usual = tuple(range(count))
    swaps = []
    for i, j in itertools.combinations(usual, 2):
        swapped = list(usual)
        swapped[i], swapped[j] = j, i
        swaps.append(tuple(swapped))
    yield from swaps
    if count <= MOST_PERMUTED:
        others = itertools.permutations(usual)
        yield from (order for order in others if order != usual and order not in swaps)


def _turned(subject: Subject, named: Sequence[tuple[str, Mask]]) -> Iterator[Mistake]:
    """Turn the sign round: of named parts, of a column, of a row."""
    for name, inside in (*named, *subject.lines):
        fault = f"{name} has the wrong sign throughout"
        yield _scaled(subject, "sign", fault, "turn every sign in it round", inside, -1.0)


def _in_other_units(subject: Subject, lengths: Mask) -> Iterator[Mistake]:
    """Write lengths in metres where the print is in millimetres."""
    for unit, size in subject.units.items():
        if unit != subject.unit:
            fault = f"its lengths are in {unit} and should be in {subject.unit}"
            remedy = f"multiply them by {size:g}"
            yield _scaled(subject, "unit", fault, remedy, lengths, 1.0 / size)
            times = max(size, 1.0 / size)
            fault = f"its lengths are {times:g} times too great"
            yield _scaled(subject, "unit", fault, f"divide them by {times:g}", lengths, times)


def _with_pi(subject: Subject, whose: str, inside: Mask) -> Iterator[Mistake]:
    """Multiply with the factor between degrees and radians."""
    for words, factor in (("pi/180", math.pi / 180.0), ("180/pi", 180.0 / math.pi)):
        fault = f"{whose} has a factor of {words} too much"
        remedy = "leave it out: joint rates are in rad/s"
        yield _scaled(subject, "factor pi/180", fault, remedy, inside, factor)
