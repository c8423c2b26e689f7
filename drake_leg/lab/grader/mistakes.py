"""Mistakes of a whole matrix, reported as one finding instead of one per entry.

Each computes the matrix that it results in: transposed, inverse, of other frames or of another
point, in another order, about other axes, in another unit, or from another table, in which an
angle is turned the other way or a length is left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from drake_leg.kinematics.khalil import Array, moving_rows
from drake_leg.lab.grader.claims import (
    SampledChain,
    between,
    claimed_part,
    running_products,
    twists,
)
from drake_leg.lab.grader.comparison import Mask, Matrix
from drake_leg.lab.grader.definitions import Cell, Names

MOST_PERMUTED = 4  # rows or columns; of more only two change places
MOST_FACTORS = 4  # of a product whose orders are all tried
QUARTER = math.pi / 2.0
HALVES, CONVENTION, DEGREES = "halves", "convention", "degrees"


@dataclass(frozen=True)
class Mistake:
    """One misunderstanding that explains many entries of a matrix."""

    kind: str  # a word or a few, the same for all matrices
    fault: str
    remedy: str
    printed: Callable[[SampledChain], Array]  # the matrix with the mistake, (N, r, c)
    rough: float = 1.0  # times the usual margin: numbers that people round
    exact: bool = False  # whether it must explain every entry that can be read


def mistakes(matrix: Matrix, names: Names) -> Iterator[Mistake]:
    """List what can be wrong with a matrix as a whole, the likeliest first."""
    tables = list(table_mistakes(matrix, names))
    yield from (mistake for mistake in tables if mistake.kind == CONVENTION)
    if matrix.claim.is_pose:
        yield from _pose_mistakes(matrix)
    elif matrix.claim.kind == "jacobian":
        yield from _jacobian_mistakes(matrix)
    yield from (mistake for mistake in tables if mistake.kind != CONVENTION)


# --- another table ---------------------------------------------------------------------------

_Change = Callable[[SampledChain], SampledChain]
_Place = tuple[str, int]  # a column of a chain, and a row or a joint
_Slip = tuple[str, str, str, _Change]  # kind, fault, remedy and the table with the mistake


def table_mistakes(matrix: Matrix, names: Names) -> Iterator[Mistake]:
    """List the mistakes that come from a table with one slip in it."""

    def printed(change: _Change, chain: SampledChain) -> Array:
        return matrix.right(change(chain))

    for slips in (_other_variables, _other_twists, partial(_other_lengths, names), _other_zeros):
        for kind, fault, remedy, change in slips(matrix):
            yield Mistake(kind, fault, remedy, partial(printed, change))
    if matrix.claim.kind != "determinant":  # too rough for one entry
        yield Mistake(
            DEGREES,
            "its fixed angles are degrees taken as radians",
            "multiply degrees by pi/180 before taking sines and cosines",
            lambda c: matrix.right(
                replace(c, alpha=np.degrees(c.alpha), theta=np.degrees(c.theta))
            ),
            rough=1000.0,
        )


def _at(place: _Place, chain: SampledChain) -> Array:
    values: Array = getattr(chain, place[0])[:, place[1]]
    return values


def _put(chain: SampledChain, *cells: tuple[_Place, Array | float]) -> SampledChain:
    columns: dict[str, Any] = {}
    for (column, index), values in cells:
        columns.setdefault(column, getattr(chain, column).copy())[:, index] = values
    return replace(chain, **columns)


def _set(place: _Place, value: float) -> _Change:
    return lambda chain: _put(chain, (place, value))


def _times(place: _Place, factor: float) -> _Change:
    return lambda chain: _put(chain, (place, factor * _at(place, chain)))


def _take(place: _Place, other: _Place) -> _Change:
    """Put another cell's value into a cell."""
    return lambda chain: _put(chain, (place, _at(other, chain)))


def _exchange(place: _Place, other: _Place) -> _Change:
    return lambda chain: _put(chain, (place, _at(other, chain)), (other, _at(place, chain)))


def _other_variables(matrix: Matrix) -> Iterator[_Slip]:
    """Take one joint's variable for another's, with another sign, or leave it out."""
    variables = matrix.variables
    joints = range(len(variables))
    for i, j in itertools.combinations(joints, 2):
        fault = f"{variables[i]} and {variables[j]} have changed places"
        yield "joint", fault, "change them back", _exchange(("q", i), ("q", j))
    for i, j in itertools.permutations(joints, 2):
        fault = f"{variables[j]} should be {variables[i]} where joint {i + 1} is meant"
        yield "joint", fault, f"write {variables[i]} there", _take(("q", i), ("q", j))
    for i, name in enumerate(variables):
        fault, remedy = f"{name} has the wrong sign throughout", f"write {name} for -{name}"
        yield "sign of a joint", fault, remedy, _times(("q", i), -1.0)
    fault, remedy = "all joint variables have the wrong sign", "turn the joints the other way"
    yield "sign of a joint", fault, remedy, lambda c: replace(c, q=-c.q)
    for i, name in enumerate(variables):
        fault, remedy = f"{name} is left out, as if it were 0", f"put {name} in"
        yield "joint left out", fault, remedy, _times(("q", i), 0.0)


def _other_twists(matrix: Matrix) -> Iterator[_Slip]:
    """Turn alpha the other way, leave it out, or put a quarter turn where there is none."""
    robot = matrix.robot
    twisted = [i for i, row in enumerate(robot.rows) if abs(math.sin(row.alpha)) > 1e-9]
    for i in twisted:
        right = math.degrees(robot.rows[i].alpha)
        fault = f"it is made with alpha = {-right:g}° in row {i + 1}, the other convention"
        remedy = f"{robot.name} has alpha = {right:g}° there"
        yield CONVENTION, fault, remedy, _times(("alpha", i), -1.0)
    if len(twisted) > 1:
        fault = "it is made with every alpha turned the other way, the other convention"
        remedy = f"take the signs of alpha from {robot.name}'s table"
        yield CONVENTION, fault, remedy, lambda c: replace(c, alpha=-c.alpha)
    for i, row in enumerate(robot.rows):
        for value in (0.0, QUARTER, -QUARTER, math.pi):
            is_right = abs(np.exp(1j * value) - np.exp(1j * row.alpha)) < 1e-9
            if not is_right and abs(value + row.alpha) > 1e-9:
                fault = f"it is made with alpha = {math.degrees(value):g}° in row {i + 1}"
                remedy = f"{robot.name} has alpha = {math.degrees(row.alpha):g}° there"
                yield "alpha", fault, remedy, _set(("alpha", i), value)


def _other_lengths(names: Names, matrix: Matrix) -> Iterator[_Slip]:
    """Exchange lengths, leave one out, turn one round, or take d for r."""
    called = {
        (column, i): names.get(Cell(i, column), f"{column} of row {i + 1}")
        for i, row in enumerate(matrix.robot.rows)
        for column in ("d", "r")
        if getattr(row, column) != 0.0
    }
    for a, b in itertools.permutations(called, 2):
        fault = f"{called[b]} should be {called[a]} where {a[0]} of row {a[1] + 1} is meant"
        yield "length", fault, f"write {called[a]} there", _take(a, b)
    for a, b in itertools.combinations(called, 2):
        fault = f"{called[a]} and {called[b]} have changed places"
        yield "length", fault, "change them back", _exchange(a, b)
    for place, name in called.items():
        fault = f"{name} is left out"
        yield "length left out", fault, f"put {name} in", _times(place, 0.0)
        fault = f"{name} has the wrong sign throughout"
        yield "sign of a length", fault, "change its sign", _times(place, -1.0)
    for i in sorted({row for _, row in called}):
        fault, remedy = (
            f"d and r of row {i + 1} have changed places",
            "d goes along x and r along z",
        )
        yield "d and r", fault, remedy, _exchange(("d", i), ("r", i))


def _other_zeros(matrix: Matrix) -> Iterator[_Slip]:
    """Measure a turning joint from elsewhere."""
    rows = matrix.robot.rows
    for i, variable in zip(moving_rows(rows), matrix.variables, strict=True):
        for value in (QUARTER, -QUARTER, math.pi) if rows[i].joint == "revolute" else ():
            degrees = f"{'-' if value < 0 else '+'} {abs(math.degrees(value)):g}°"
            fault = (
                f"{variable} is measured from another zero: it has {variable} {degrees} for "
                f"{variable}"
            )
            remedy = f"measure {variable} as the table does, or say so {matrix.format.joints}"
            yield "zero of a joint", fault, remedy, _turn_zero(i, value)


def _turn_zero(index: int, angle: float) -> _Change:
    place = ("theta", index)
    return lambda chain: _put(chain, (place, _at(place, chain) + angle))


# --- of any matrix ---------------------------------------------------------------------------


def _of(matrix: Matrix, whole: Callable[[SampledChain], Array]) -> Callable[[SampledChain], Array]:
    """Extract what is claimed from another pose or Jacobian."""
    return lambda chain: claimed_part(matrix.claim, whole(chain))


def _scaled(
    matrix: Matrix, kind: str, fault: str, remedy: str, inside: Mask, factor: float
) -> Mistake:
    """Multiply a part of what is right."""
    factors = np.where(inside, factor, 1.0)
    return Mistake(kind, fault, remedy, lambda c: matrix.right(c) * factors)


def _transposed(matrix: Matrix) -> Iterator[Mistake]:
    if matrix.claim.shape[0] == matrix.claim.shape[1] > 1:
        yield Mistake(
            "transposed",
            "it is transposed",
            "exchange its rows and columns",
            lambda c: np.swapaxes(matrix.right(c), -1, -2),
        )


def _reordered(matrix: Matrix) -> Iterator[Mistake]:
    """Put columns, then rows in another order."""

    def printed(order: Sequence[int], axis: int, chain: SampledChain) -> Array:
        right: Array = np.take(matrix.right(chain), order, axis=axis)
        return right

    rows, columns = matrix.claim.shape
    for what, count, axis in (("columns", columns, -1), ("rows", rows, -2)):
        for order in _orders(count):
            moved = [place + 1 for place, index in enumerate(order) if place != index]
            fault = f"its {what} are in the order {', '.join(str(i + 1) for i in order)}"
            if len(moved) == 2:
                fault = f"its {what} {moved[0]} and {moved[1]} have changed places"
            remedy, wrong = "put them in their order", partial(printed, order, axis)
            yield Mistake(f"order of {what}", fault, remedy, wrong)


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


def _turned(matrix: Matrix, named: Sequence[tuple[str, Mask]]) -> Iterator[Mistake]:
    """Turn the sign round: of named parts, of a column, of a row."""
    for name, inside in (*named, *matrix.lines):
        fault = f"{name} has the wrong sign throughout"
        yield _scaled(matrix, "sign", fault, "change every sign in it", inside, -1.0)


def _in_other_units(matrix: Matrix, lengths: Mask) -> Iterator[Mistake]:
    """Write lengths in meters where the print is in millimeters."""
    for unit, size in matrix.units.items():
        if unit != matrix.unit:
            fault = f"its lengths are in {unit} and should be in {matrix.unit}"
            remedy = f"multiply them by {size:g}"
            yield _scaled(matrix, "unit", fault, remedy, lengths, 1.0 / size)
            times = max(size, 1.0 / size)
            fault = f"its lengths are {times:g} times too large"
            yield _scaled(matrix, "unit", fault, f"divide them by {times:g}", lengths, times)


# --- of a pose -------------------------------------------------------------------------------


def _pose_mistakes(matrix: Matrix) -> Iterator[Mistake]:
    """List mistakes of a transform, a rotation or a position."""
    claim = matrix.claim
    first, last = claim.frames
    if first > last:  # T10 holds T01, which may be its transpose, too
        yield _of_frames(matrix, last, first)
    yield from _transposed(matrix)
    lengths = np.zeros(claim.shape, dtype=bool)
    named = [("all of it", matrix.part())]
    if claim.kind == "position":
        lengths.flat[:3] = True
        named = [("all of it", lengths)]
    elif claim.kind == "transform":
        lengths[:3, 3] = True
        rotation = matrix.part(slice(3), slice(3))
        named += [("the upper part", rotation | lengths), ("the rotation part", rotation)]

        def rotation_transposed(chain: SampledChain) -> Array:
            X = matrix.right(chain).copy()
            X[:, :3, :3] = np.swapaxes(X[:, :3, :3], -1, -2).copy()
            return X

        fault, remedy = "rotation part is transposed", "rows and columns of its rotation part"
        yield Mistake("transposed", f"its {fault}", f"exchange the {remedy}", rotation_transposed)
    yield _of_frames(matrix, last, first)
    for a, b in itertools.permutations(range(len(matrix.robot.rows) + 1), 2):
        if {a, b} != {first, last}:
            yield _of_frames(matrix, a, b)
    yield from _in_other_units(matrix, lengths)
    yield from _reordered(matrix)
    yield from _turned(matrix, named)
    if first < last:
        yield from _other_products(matrix)
        yield from _classic(matrix)


def _of_frames(matrix: Matrix, a: int, b: int) -> Mistake:
    """Take the inverse, or the transform between two other frames."""
    first, last = matrix.claim.frames
    letter = {"transform": "T", "rotation": "R"}.get(matrix.claim.kind, "P")
    right = f"{letter}{first}{last}"
    inverse = (a, b) == (last, first)
    return Mistake(
        "inverse" if inverse else "other frames",
        f"it is the inverse, {letter}{a}{b}" if inverse else f"it is {letter}{a}{b}, not {right}",
        f"write {right}, from frame {last} to frame {first}",
        _of(matrix, lambda c: between(c.frames(), a, b)),
        exact=not inverse,
    )


def _other_products(matrix: Matrix) -> Iterator[Mistake]:
    """Multiply in another order, or leave a factor out."""

    def product(order: Sequence[int], chain: SampledChain) -> Array:
        return running_products(chain.steps()[:, list(order)])[:, -1]

    def said(order: Sequence[int]) -> str:
        return " ".join(f"T{index}{index + 1}" for index in order)

    factors = tuple(range(*matrix.claim.frames))
    if len(factors) < 2:
        return
    remedy = f"multiply {said(factors)}"
    orders = [factors[::-1]]
    if len(factors) <= MOST_FACTORS:
        others = itertools.permutations(factors)
        orders += [order for order in others if order not in (factors, factors[::-1])]
    for order in orders:
        fault = f"it is the product in the wrong order, {said(order)}"
        printed = _of(matrix, partial(product, order))
        yield Mistake("order of the product", fault, remedy, printed)
    for left_out in factors[1:-1]:
        fault = f"{said([left_out])} is left out of the product"
        order = tuple(factor for factor in factors if factor != left_out)
        yield Mistake("factor left out", fault, remedy, _of(matrix, partial(product, order)))


def _classic(matrix: Matrix) -> Iterator[Mistake]:
    """Take the classic transform for Khalil's: z first, then x of the row or of the next one."""
    first, last = matrix.claim.frames

    def product(following: int, chain: SampledChain) -> Array:
        steps = chain.about_z() @ np.roll(chain.about_x(), -following, axis=1)
        return running_products(steps[:, first:last])[:, -1]

    whose = ["of the same rows", "and alpha and a of the next row"]
    for following in range(2 if last < len(matrix.robot.rows) else 1):
        yield Mistake(
            "classic",
            f"it is the classic (standard) transform, with z before x, {whose[following]}",
            "Khalil's turns and shifts about x first: Rx(alpha) Tx(d) Rz(theta) Tz(r)",
            _of(matrix, partial(product, following)),
        )


# --- of a Jacobian ---------------------------------------------------------------------------


def _jacobian_mistakes(matrix: Matrix) -> Iterator[Mistake]:
    moving = matrix.robot.moving[: matrix.claim.shape[1]]
    turning = np.array([segment.row.joint == "revolute" for segment in moving])
    rows = np.array(matrix.claim.lengths)
    of_lengths = np.broadcast_to(rows[:, np.newaxis], matrix.claim.shape)
    yield from _transposed(matrix)
    yield from _inverse_jacobian(matrix)
    if len(rows) == 6:
        wanted, found = ("(v; w)", "(w; v)") if rows[0] else ("(w; v)", "(v; w)")
        yield Mistake(
            HALVES,
            f"it is {found}, velocity and rotation having changed places",
            f"write {wanted}, or name the rows in their order {matrix.format.rows}",
            lambda c: np.roll(matrix.right(c), 3, axis=-2),
        )
    yield from _in_other_units(matrix, of_lengths & turning)
    yield from _with_pi(matrix, "it", matrix.part())
    if not of_lengths.all():
        yield from _with_pi(matrix, "its translational part", of_lengths)
    yield from _reordered(matrix)
    named = [("all of it", matrix.part())]
    if of_lengths.any() and not of_lengths.all():
        named += [("the translational part", of_lengths), ("the rotational part", ~of_lengths)]
    yield from _turned(matrix, named)
    for fault, remedy, kind, whole in _other_jacobians(matrix):
        yield Mistake(kind, fault, remedy, _of(matrix, whole))
    for name, inside in matrix.lines:
        yield _scaled(matrix, "zero", f"{name} is zero", "fill it in", inside, 0.0)


def _inverse_jacobian(matrix: Matrix) -> Iterator[Mistake]:
    if matrix.claim.shape[0] != matrix.claim.shape[1]:
        return

    def inverted(chain: SampledChain) -> Array:
        """Invert where that can be done; elsewhere it has no numbers."""
        J = matrix.right(chain)
        regular = np.linalg.cond(J) < 1e12
        inverse = np.full_like(J, np.nan)
        inverse[regular] = np.linalg.inv(J[regular])
        return inverse

    remedy = "write J, which takes joint rates to velocities"
    yield Mistake("inverse", "it is the inverse of the Jacobian", remedy, inverted)
    fault = "it is the inverse of the transposed Jacobian"
    yield Mistake("inverse", fault, remedy, lambda c: np.swapaxes(inverted(c), -1, -2))


def _with_pi(matrix: Matrix, whose: str, inside: Mask) -> Iterator[Mistake]:
    """Multiply with the factor between degrees and radians."""
    for words, factor in (("pi/180", math.pi / 180.0), ("180/pi", 180.0 / math.pi)):
        fault = f"{whose} has an extra factor of {words}"
        remedy = "leave it out: joint rates are in rad/s"
        yield _scaled(matrix, "factor pi/180", fault, remedy, inside, factor)


def _other_jacobians(
    matrix: Matrix,
) -> Iterator[tuple[str, str, str, Callable[[SampledChain], Array]]]:
    """List Jacobians (6, m) of other points, frames, axes and joints: fault, remedy, kind."""
    rows = matrix.robot.rows
    count = len(rows)

    def of_origin(last: int, chain: SampledChain) -> Array:
        X_B = chain.frames()
        beyond = np.array(chain.moving) >= last
        return np.where(beyond, 0.0, twists(chain, X_B[:, 1:], X_B[:, last, :3, 3]))

    def of_base(chain: SampledChain) -> Array:
        return twists(chain, chain.frames()[:, 1:], np.zeros((len(chain.q), 3)))

    def from_base(chain: SampledChain) -> Array:
        X_B = chain.frames()
        axes = X_B[:, 1:].copy()
        axes[..., :3, 3] = 0.0
        return twists(chain, axes, X_B[:, -1, :3, 3])

    def expressed_in(index: int, chain: SampledChain) -> Array:
        R = np.swapaxes(chain.frames()[:, index, :3, :3], -1, -2)
        J = chain.jacobian()
        return np.concatenate([R @ J[:, :3], R @ J[:, 3:]], axis=1)

    def about_axes_before(chain: SampledChain) -> Array:
        X_B = chain.frames()
        return twists(chain, X_B[:, :-1], X_B[:, -1, :3, 3])

    def about(column: int, chain: SampledChain) -> Array:
        X_B = chain.frames()
        axes = X_B[:, 1:].copy()
        axes[..., 2] = axes[..., column]
        return twists(chain, axes, X_B[:, -1, :3, 3])

    def with_other_joint(index: int, chain: SampledChain) -> Array:
        """Take the joint for one of the other type; the pose stays."""
        joints = list(chain.joints)
        joints[index] = "prismatic" if joints[index] == "revolute" else "revolute"
        X_B = chain.frames()
        return twists(replace(chain, joints=tuple(joints)), X_B[:, 1:], X_B[:, -1, :3, 3])

    point = "other point"
    for last in range(count - 1, 0, -1):
        left = "the last link" if last == count - 1 else f"the links after frame {last}"
        fault = f"it is the Jacobian of frame {last}'s origin, without {left}"
        yield fault, "write the Jacobian of the foot", point, partial(of_origin, last)
    fault = "it is the spatial Jacobian, of the point that passes the base's origin"
    yield fault, "take z x OF, with F the foot", point, of_base
    fault = "distances are taken from the base's origin and not from the joints"
    yield fault, "take z x (p_F - p_i), with p_i on the axis of joint i", point, from_base
    for index in range(count, 0, -1):
        whose = "the foot's frame" if index == count else f"frame {index}"
        remedy = "express it in the base's frame: multiply by the rotation from there to the base"
        yield f"it is expressed in {whose}", remedy, "other frame", partial(expressed_in, index)
    before = "as in classic (standard) tables"
    fault = f"its joints turn about the z axes of the frames before, {before}"
    yield (
        fault,
        "in Khalil's tables joint i turns about z of frame i",
        "other axes",
        about_axes_before,
    )
    for column, letter in enumerate("xy"):
        fault = f"its joints turn about the {letter} axes of their frames"
        yield fault, "joint i turns about z of frame i", "other axes", partial(about, column)
    for number, index in enumerate(moving_rows(rows)[: matrix.claim.shape[1]], start=1):
        turns = rows[index].joint == "revolute"
        meant, is_one = ("sliding", "turning") if turns else ("turning", "sliding")
        fault = f"joint {number} is taken for a {meant} one"
        remedy = f"joint {number} is a {is_one} one"
        yield fault, remedy, "other joint", partial(with_other_joint, index)
