"""Where the assemblies of closed loops are singular, along the motion of one active joint.

With one active joint moving and the others held, a closed posture is on a curve. Its tangent t
tells what is singular there:

- actuation: the active joint stands still, ``t_a = 0``, while passive joints move. There it does
  not determine them, ``J_p`` loses rank; two assemblies meet and end.
- dead center: a passive joint k stands still, ``t_k = 0``, at an end of its range.
- branching: there are two tangents, J loses rank; two curves meet, as when a parallelogram is flat.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.assemblies import cycle, moving_rows
from drake_leg.kinematics.closed_loops import CLOSED, ClosedLoops
from drake_leg.kinematics.feet import limits_of
from drake_leg.kinematics.khalil import Array, principal

STRIDE = 0.05  # along the curve [rad, or parts of the robot's size]
STRIDES = 1500
TRIED = (1.0, 0.5, 0.25, 1.5, 2.5)  # strides, where one fails: the last ones leap over a branching
SWERVE = 0.5  # of a stride: a correction must be smaller
ALIGNED = 0.7  # least cosine between one tangent and the next
CORRECTIONS = 12
FLAT = 1e-4  # of the greatest: smallest singular value at a branching
STILL = 1e-7  # a rate, of the fastest joint's, that is none
HALVINGS = 60

ACTUATION, DEAD_CENTER, BRANCHING = "actuation", "dead center", "branching"


@dataclass(frozen=True, kw_only=True)
class SingularAssembly:
    """A closed posture in which something is singular."""

    kind: str  # actuation, dead center or branching
    joint: str  # that stands still; the active joint that moves, where assemblies branch
    along: str  # the active joint that moves
    q: tuple[float, ...]  # of the tree's joints [rad or m]
    cut: tuple[float, ...]  # of the joints at which loops are cut [rad or m]


class _Point(NamedTuple):
    q: Array
    tangent: Array  # in the loops' units
    sigma: float  # smallest singular value that is not 0 by the freedom


class _Curve:
    """Closed postures with one active joint moving and the others held."""

    def __init__(self, loops: ClosedLoops, active: int) -> None:
        self.loops, self.active = loops, active
        self.columns = sorted([active, *loops.passive_columns])
        self.rank = len(self.columns) - 1
        limits = limits_of(loops.robot.moving)
        self._low, self._high = np.array(limits).T

    def at(self, guess: Array, along: Array | None = None) -> _Point | None:
        """Close the loops near a posture; None if they do not close nearby."""
        loops, q = self.loops, np.array(guess)
        q, error = loops.closest(q, self.columns, iterations=CORRECTIONS)
        if error > CLOSED:
            return None
        _, sigma, Vt = np.linalg.svd(loops.scaled_jacobian(q)[:, self.columns])
        tangent = np.zeros(len(q))
        tangent[self.columns] = Vt[-1]
        if along is not None and tangent @ along < 0.0:
            tangent = -tangent
        return _Point(q, tangent, float(sigma[self.rank - 1]) if self.rank else math.inf)

    def greatest(self, point: _Point) -> float:
        """Greatest singular value of the loops' Jacobian, by the joints of the curve."""
        return float(np.linalg.norm(self.loops.scaled_jacobian(point.q)[:, self.columns], 2))

    def moved(self, point: _Point, stride: float) -> _Point | None:
        """Move along the tangent, and close the loops again."""
        guess = point.q + stride * point.tangent * self.loops.units
        return self.at(guess, point.tangent)

    def next(self, point: _Point) -> _Point | None:
        """The next point of the curve; None where it ends."""
        for part in TRIED:
            found = self.moved(point, part * STRIDE)
            if found is None or found.tangent @ point.tangent < ALIGNED:
                continue
            off = (found.q - point.q) / self.loops.units - part * STRIDE * point.tangent
            if np.abs(off).max() <= SWERVE * part * STRIDE:
                within = np.all((found.q >= self._low) & (found.q <= self._high))
                return found if within else None
        return None

    def walk(self, start: _Point) -> tuple[list[_Point], bool]:
        """Points from the start until the curve is closed or ends; whether it is closed."""
        points = [start]
        for step in range(STRIDES):
            found = self.next(points[-1])
            if found is None:
                return points, False
            points.append(found)
            away = self.loops.distance(found.q, start.q)
            if step > 2 and away < STRIDE and found.tangent @ start.tangent > ALIGNED:
                return points, True
        return points, False


def singular_assemblies(
    loops: ClosedLoops, q: Sequence[float] | Array
) -> tuple[list[SingularAssembly], str]:
    """Find what is singular when each active joint moves alone from a closed posture.

    Returns the singular assemblies, those nearest to the posture first, and a sentence on how far
    the search went.
    """
    found: list[SingularAssembly] = []
    said = []
    rows = moving_rows(loops)
    around = {row for loop in loops.robot.loops for row, _ in cycle(loops, loop)}
    for active in loops.active_columns:
        if rows[active] not in around:  # it moves all loops as a whole
            continue
        curve = _Curve(loops, active)
        start = curve.at(np.array(q))
        if start is None:
            continue
        points, closed = curve.walk(start)
        if not closed:
            back, _ = curve.walk(_Point(start.q, -start.tangent, start.sigma))
            points = [*(_Point(p.q, -p.tangent, p.sigma) for p in reversed(back[1:])), *points]
        found += _on(curve, points)
        if start.sigma < FLAT * curve.greatest(start):
            found.append(_singular(curve, BRANCHING, loops.joints[active], start))
        turns = "all around" if closed else "as far as the loops close within the limits"
        said.append(f"{loops.joints[active]} {turns}")
    posture = np.array(q)
    found.sort(key=lambda one: loops.distance(np.array(one.q), posture))
    return _once(loops, found), "; ".join(said)


def _once(loops: ClosedLoops, found: list[SingularAssembly]) -> list[SingularAssembly]:
    """Leave out what was found twice."""
    kept: list[SingularAssembly] = []
    for one in found:
        same = (
            (one.kind, one.joint, one.along) == (other.kind, other.joint, other.along)
            and loops.distance(np.array(one.q), np.array(other.q)) < 0.1 * STRIDE
            for other in kept
        )
        if not any(same):
            kept.append(one)
    return kept


def _on(curve: _Curve, points: list[_Point]) -> list[SingularAssembly]:
    """Find the singular assemblies on a curve."""
    loops, found = curve.loops, []
    rates = np.array([point.tangent for point in points])
    for column in curve.columns:
        kind = ACTUATION if column == curve.active else DEAD_CENTER
        moves = np.abs(rates[:, column]).max() > 1e3 * STILL
        flips = np.flatnonzero(rates[:-1, column] * rates[1:, column] < 0.0).tolist()
        for flip in flips if moves else ():
            point = _stopped(curve, points[flip], points[flip + 1], column)
            if point is not None:
                found.append(_singular(curve, kind, loops.joints[column], point))
    sigma = np.array([point.sigma for point in points])
    least = FLAT * sigma.max()
    for index in range(1, len(points) - 1):
        if sigma[index] <= min(sigma[index - 1], sigma[index + 1]):
            point = _flattest(curve, points[index - 1], points[index + 1])
            if point.sigma < least:
                found.append(_singular(curve, BRANCHING, loops.joints[curve.active], point))
    return found


def _singular(curve: _Curve, kind: str, joint: str, point: _Point) -> SingularAssembly:
    loops = curve.loops
    turned = np.where(loops.turning, principal(point.q), point.q)
    return SingularAssembly(
        kind=kind,
        joint=joint,
        along=loops.joints[curve.active],
        q=tuple(turned.tolist()),
        cut=tuple(loops.cut_motion(point.q).position.tolist()),
    )


def _between(curve: _Curve, first: _Point, last: _Point) -> Callable[[float], _Point]:
    """The curve from one point to a near one, by the length along the first one's tangent."""
    reach = float((last.q - first.q) / curve.loops.units @ first.tangent)

    def point(part: float) -> _Point:
        found = curve.moved(first, part * reach)
        return first if found is None else found

    return point


def _stopped(curve: _Curve, first: _Point, last: _Point, column: int) -> _Point | None:
    """Find by bisection where a joint stands still, between two points."""
    at, sign = _between(curve, first, last), math.copysign(1.0, first.tangent[column])
    low, high = 0.0, 1.0
    point = first
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        point = at(middle)
        low, high = (middle, high) if sign * point.tangent[column] > 0.0 else (low, middle)
        if high - low < 1e-12 or abs(point.tangent[column]) < 1e-14:
            break
    return point if abs(point.tangent[column]) < STILL else None  # or it has jumped


def _flattest(curve: _Curve, first: _Point, last: _Point) -> _Point:
    """Find by golden sections where the smallest singular value is least, between two points."""
    at, golden = _between(curve, first, last), 0.5 * (math.sqrt(5.0) - 1.0)
    low, high = 0.0, 1.0
    left, right = at(1.0 - golden), at(golden)
    for _ in range(HALVINGS // 2):
        if left.sigma < right.sigma:
            high, right = low + golden * (high - low), left
            left = at(high - golden * (high - low))
        else:
            low, left = high - golden * (high - low), right
            right = at(low + golden * (high - low))
    return min(left, right, key=lambda point: point.sigma)
