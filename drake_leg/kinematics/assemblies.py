"""All assemblies of closed loops: the postures that close with the active joints in one place.

A planar loop of revolute joints, two of them passive, is a triangle: it closes in closed form, in
two ways or not at all. Other loops are searched by Newton's method from random starts, until as
many assemblies are found as there can be, or until many starts in a row find none that is new.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.closed_loops import CLOSED, ClosedLoops
from drake_leg.kinematics.khalil import (
    Array,
    base_transforms,
    one_vector,
    principal,
    triangle_angle,
)
from drake_leg.robot.tree import Loop

PARALLEL = 1e-9  # sine of the angle between parallel axes; also parts of the robot's size
APART = 1e-5  # [rad, or parts of the size]: assemblies that differ by less are one
BATCH = 32  # starts of Newton's method at a time
IN_VAIN = 128  # closed starts in a row that find nothing new: then the search ends
MOST_STARTS = 2048
FOLDED = "one of infinitely many, as two links lie on each other and turn together"
NEARLY_SINGULAR = 1e-3  # least singular value of the passive joints' scaled Jacobian
PLANAR, SPATIAL = 2, 16  # most assemblies of a single loop


@dataclass(frozen=True, kw_only=True)
class Assembly:
    """One posture in which all loops are closed."""

    name: str
    q: tuple[float, ...]  # of the tree's joints [rad or m]
    cut: tuple[float, ...]  # of the joints at which the loops are cut [rad or m]


@dataclass(frozen=True, kw_only=True)
class Assemblies:
    """The assemblies that were found, and what is known of their number."""

    found: tuple[Assembly, ...]
    complete: bool  # whether there are no others for certain
    how: str  # they were found, in words


@dataclass(frozen=True)
class _Solved:
    """The ways to close loops that share no passive joint with others."""

    columns: list[int]  # of their passive joints
    ways: list[tuple[str, Array]]  # names, positions
    complete: bool
    how: str


def assemblies(loops: ClosedLoops, q_a: ArrayLike) -> Assemblies:
    """Find all assemblies with the active joints in one place.

    The assemblies of a parallelogram are the parallelogram and the crossed one. Those of another
    planar loop are positive or negative, by the turn at the middle one of the three joints that are
    passive or cut; they meet only in singular assemblies. Others are numbered.

    Parameters
    ----------
    loops : ClosedLoops
        Of a robot.
    q_a : (a,) array_like
        Positions of the active joints [rad or m].

    Returns
    -------
    Assemblies
        None found means that the loops do not close there.

    Examples
    --------
    >>> from drake_leg.kinematics.closed_loops import ClosedLoops
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> both = assemblies(ClosedLoops(FOUR_BAR), [1.0])
    >>> [one.name for one in both.found], both.complete
    (['positive', 'negative'], True)
    """
    driven = one_vector("q_a", q_a, len(loops.active))
    q = np.zeros(len(loops.joints))
    q[loops.active_columns] = driven
    parts = [_solve(loops, group, q) for group in _groups(loops)]
    found = []
    for ways in itertools.product(*(part.ways for part in parts)):
        posture = q.copy()
        for part, (_, positions) in zip(parts, ways, strict=True):
            posture[part.columns] = positions
        cut = loops.cut_motion(posture).position
        name = ", ".join(name for name, _ in ways)
        found.append(Assembly(name=name, q=tuple(posture.tolist()), cut=tuple(cut.tolist())))
    return Assemblies(
        found=tuple(found),
        complete=all(part.complete for part in parts),
        how="; ".join(dict.fromkeys(part.how for part in parts)),
    )


def _groups(loops: ClosedLoops) -> list[list[int]]:
    """Indices of the loops that have passive joints in common."""
    groups: list[tuple[list[int], set[int]]] = []
    for index, loop in enumerate(loops.robot.loops):
        members, columns = [index], set(_passive_of(loops, [loop]))
        for group in [one for one in groups if one[1] & columns]:
            groups.remove(group)
            members, columns = [*group[0], *members], group[1] | columns
        groups.append((sorted(members), columns))
    return [members for members, _ in groups]


def _passive_of(loops: ClosedLoops, some: Iterable[Loop]) -> list[int]:
    """Passive joints, among all joints, that move one frame of a cut against the other."""
    rows = {row for loop in some for row, _ in cycle(loops, loop)}
    columns = [column for column, row in enumerate(moving_rows(loops)) if row in rows]
    return [column for column in columns if column in loops.passive_columns]


def moving_rows(loops: ClosedLoops) -> list[int]:
    """Rows, from 1, of the joints."""
    rows = enumerate(loops.robot.rows, start=1)
    return [number for number, row in rows if row.joint != "fixed"]


def cycle(loops: ClosedLoops, loop: Loop) -> list[tuple[int, int]]:
    """Moving rows, from 1, around a loop from its cut to its end; -1 where they are passed back."""
    here, there = loops.robot.path(loop.cut), loops.robot.path(loop.end)
    around = [(row, -1) for row in reversed(here) if row not in there]
    around += [(row, 1) for row in there if row not in here]
    return [(row, way) for row, way in around if loops.robot.rows[row - 1].joint != "fixed"]


def _solve(loops: ClosedLoops, group: Sequence[int], q: Array) -> _Solved:
    columns = _passive_of(loops, [loops.robot.loops[index] for index in group])
    if len(group) == 1:
        loop = loops.robot.loops[group[0]]
        planar = is_planar(loops, loop)
        cut = loops.robot.segments[loop.cut - 1].row.joint
        kinds = {loops.robot.rows[row - 1].joint for row, _ in cycle(loops, loop)}
        if planar and kinds == {"revolute"} == {cut} and len(columns) == 2:
            return _triangle(loops, loop, columns, q)
        most = PLANAR if planar and len(columns) == 2 else SPATIAL
        return _search(loops, columns, q, most if len(columns) in (2, 5) else None)
    return _search(loops, columns, q, None)


def is_planar(loops: ClosedLoops, loop: Loop) -> bool:
    """Whether a loop's revolute joints are parallel, and its prismatic ones across them."""
    X_B = base_transforms(loops.robot.rows, np.zeros(len(loops.joints)))
    around = [row for row, _ in cycle(loops, loop)]
    joints = [(loops.robot.rows[row - 1].joint, X_B[row - 1][:3, 2]) for row in around]
    cut = loops.robot.segments[loop.cut - 1].row.joint
    joints.append((cut, X_B[loop.cut - 1][:3, 2]))
    turning = [z for joint, z in joints if joint == "revolute"]
    sliding = [z for joint, z in joints if joint == "prismatic"]
    if not turning:
        return False
    normal = turning[0]
    return all(np.linalg.norm(np.cross(normal, z)) < PARALLEL for z in turning) and all(
        abs(normal @ z) < PARALLEL for z in sliding
    )


# --- in closed form ----------------------------------------------------------------------------


def _triangle(loops: ClosedLoops, loop: Loop, columns: list[int], q: Array) -> _Solved:
    """Close a planar loop with two passive revolute joints: ``c + e^(i s)(m + e^(i t) v) = 0``.

    Seen from the cut, in its plane, c is the first passive joint, m leads from there to the second
    one, and v from there back to the cut, before the passive joints are turned by s and t.
    """
    X_B = base_transforms(loops.robot.rows, q)
    X_KB = np.linalg.inv(X_B[loop.cut - 1])
    rows = moving_rows(loops)
    passive = [(row, way) for row, way in cycle(loops, loop) if rows.index(row) in columns]
    first, second = (_in_plane(X_KB @ X_B[row - 1]) for row, _ in passive)
    end = _in_plane(X_KB @ X_B[loop.end - 1])
    signs = [way * math.copysign(1.0, (X_KB @ X_B[row - 1])[2, 2]) for row, way in passive]
    m, v = second - first, end - second
    folded = _folded(first, m, v, PARALLEL * loops.size)
    if folded is not None:
        posture = q.copy()
        for (row, _), sign, angle in zip(passive, signs, folded, strict=True):
            posture[rows.index(row)] = principal(np.array(sign * angle))
        return _Solved(columns, [("folded", posture[columns])], False, FOLDED)
    bend = float(triangle_angle(abs(m), abs(v), np.array(abs(first))))
    ways = []
    for name, turn in (("positive", bend), ("negative", -bend)):
        if math.isnan(turn) or (name == "negative" and bend in (0.0, math.pi)):
            continue
        t = turn + _angle(m) - _angle(v)
        s = _angle(-first) - _angle(m + _turned(v, t))
        posture = q.copy()
        for (row, _), sign, angle in zip(passive, signs, (s, t), strict=True):
            posture[rows.index(row)] = principal(np.array(sign * angle))
        if loops.closure(posture) <= CLOSED:  # it is not, where the planes are apart
            ways.append((_named(loops, loop, posture, name), posture[columns]))
    return _Solved(columns, ways, True, "in closed form")


def _folded(c: complex, m: complex, v: complex, rounding: float) -> tuple[float, float] | None:
    """One pair of angles s, t where a side of the triangle is 0 and the others are alike.

    Then infinitely many close it: c, m or v is 0, and s + t, t or s is all that matters.
    """
    small = [abs(side) < rounding for side in (c, m, v)]
    sizes = [abs(side) for side, is_small in zip((c, m, v), small, strict=True) if not is_small]
    if len(sizes) != 2 or abs(sizes[0] - sizes[1]) > rounding:
        return None
    if small[0]:
        return 0.0, math.pi + _angle(m) - _angle(v)
    return (0.0, _angle(-c) - _angle(v)) if small[1] else (_angle(-c) - _angle(m), 0.0)


def _named(loops: ClosedLoops, loop: Loop, q: Array, sign: str) -> str:
    """Tell a parallelogram from the crossed assembly of the same four bars."""
    X_B = base_transforms(loops.robot.rows, q)
    X_KB = np.linalg.inv(X_B[loop.cut - 1])
    rounding = PARALLEL * loops.size
    corners = [0j]  # the cut; then the joints, two on one axis as one
    for row, _ in cycle(loops, loop):
        corner = _in_plane(X_KB @ X_B[row - 1])
        if abs(corner - corners[-1]) > rounding:
            corners.append(corner)
    if len(corners) != 4:
        return sign
    _, a, b, c = corners
    if abs(abs(a) - abs(c - b)) > rounding or abs(abs(b - a) - abs(c)) > rounding:
        return sign
    return "parallelogram" if abs(a + c - b) <= 1e3 * rounding else "crossed"


def _in_plane(X: Array) -> complex:
    return complex(X[0, 3], X[1, 3])


def _angle(side: complex) -> float:
    return math.atan2(side.imag, side.real)


def _turned(side: complex, angle: float) -> complex:
    return side * complex(math.cos(angle), math.sin(angle))


# --- by a search -------------------------------------------------------------------------------


def _search(loops: ClosedLoops, columns: list[int], q: Array, most: int | None) -> _Solved:
    """Close loops from random starts, until ``most`` assemblies are found, or no more are."""
    generator = np.random.default_rng(0)
    turning = loops.turning[columns]
    found: list[Array] = []
    starts = closed = last_new = 0
    while starts < MOST_STARTS and closed - last_new < IN_VAIN and len(found) != most:
        if starts >= 8 * BATCH and not closed:
            break
        trials = np.tile(q, (BATCH, 1))
        random = generator.uniform(-1.0, 1.0, (BATCH, len(columns)))
        trials[:, columns] = random * np.where(turning, math.pi, loops.size)
        if starts == 0:
            trials[0, columns] = q[columns]
        starts += BATCH
        postures, errors = loops.closest(trials, columns)
        for posture in postures[errors <= CLOSED]:
            closed += 1
            if all(loops.distance(posture, other) > APART for other in found):
                found.append(posture)
                last_new = closed
    positions = [posture[columns] for posture in found]
    principals = [np.where(turning, principal(one), one) for one in positions]
    ordered = sorted(principals, key=lambda one: one.tolist())
    ways = [(str(number), one) for number, one in enumerate(ordered, start=1)]
    full = most is not None and len(found) == most
    how = f"Newton's method from {starts} starts, of which {closed} closed"
    if full:
        how += f"; there are no more than {most}"
    elif closed:
        how += f", and the last {closed - last_new} found none that is new"
    return _Solved(columns, ways, full, how)


def closed_near(loops: ClosedLoops, near: Sequence[float]) -> tuple[Array, int, int] | None:
    """Search the closed posture that is nearest to another, all joints moving.

    Newton's method starts there, and at random postures around it. Those in limits and apart from
    singular assemblies are preferred. Returned are the posture, and how many starts there were and
    how many of them closed; None if none did.
    """
    start = np.array(near, dtype=np.float64)
    generator = np.random.default_rng(0)
    around = generator.uniform(-1.0, 1.0, (BATCH, len(start)))
    around *= np.where(loops.turning, math.pi, loops.size)
    around *= np.linspace(0.0, 1.0, BATCH)[:, np.newaxis]
    postures, errors = loops.closest(start + around, range(len(start)))
    closed = postures[errors <= CLOSED]
    if not len(closed):
        return None
    bounds = np.array([segment.mechanics.bounds for segment in loops.robot.moving])

    def rank(q: Array) -> tuple[bool, bool, float]:
        outside = bool(((q < bounds[:, 0]) | (q > bounds[:, 1])).any())
        return outside, loops.sigma_min(q) < NEARLY_SINGULAR, loops.distance(q, start)

    best = min(closed, key=rank)
    return np.where(loops.turning, principal(best), best), BATCH, len(closed)
