"""Numerical search for postures, from many starts at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.chain import LEAST_LEVER
from drake_leg.kinematics.euler import quaternions
from drake_leg.kinematics.khalil import (
    Array,
    chain_length,
    foot_pose,
    jacobian,
    moving_rows,
    nearest_turn,
    one_vector,
    principal,
)
from drake_leg.robot.robot import Row
from drake_leg.units import AT_LIMIT

STARTS = 400  # random postures
STEPS, POLISHING = 80, 12  # of the damped, then of the undamped search
NEAR = 1e-3  # of the length: nearer, the search goes on undamped
REACHED = 1e-10  # of the length
SAME = 1e-4  # [rad, or of the length]: postures that differ by less are one, as when stretched
STUCK = 1e3  # damping beyond which the search has stopped moving
LARGEST_STEP = 0.6  # [rad]
SINGULAR = 1e-6  # smallest singular value over the greatest
WIGGLE = 0.05  # [rad, or of the length], to see whether a joint can move on
ROUNDING = 8.0 * np.finfo(float).eps  # miss of the foot by sums of rounded terms, of its size
SHOWN = 4  # postures returned of infinitely many

Limits = Sequence[tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class Postures:
    """Result of a numerical search for postures."""

    q: Array  # (k, n) [rad or m]
    miss: Array  # (k,) [m] from the foot's goal; rotations count times the chain's length
    infinitely_many: bool  # whether these are only some of them
    nearest: float  # [m], miss of the best start, also if none is found


def find_postures(
    rows: Sequence[Row],
    position: ArrayLike,
    rotation: ArrayLike | None = None,
    *,
    limits: Limits,
) -> Postures:
    """Find postures whose foot is at a point [m], or in a pose, by damped least squares.

    ``foot_pose(rows, q)`` is the goal to 1e-10 of the chain's length for every ``q`` found. All
    branches of an ordinary chain are found, without proof that there is no other. Without a
    rotation R_BF any orientation will do. Revolute joints are moved into their limits by whole
    turns where possible, otherwise into (-pi, pi]. Postures within the limits [rad or m] come
    first.
    """
    goal = np.eye(4)
    goal[:3, 3] = one_vector("the foot", position, 3)
    if rotation is not None:
        goal[:3, :3] = np.asarray(rotation, dtype=np.float64)
    search = Search(rows, goal, turning=rotation is not None, limits=limits)
    kept, misses = search.run(inside=search.redundant)
    if search.redundant and not len(kept):
        kept, misses = search.run(inside=False)
    reached = misses <= REACHED * search.size
    q, miss = search.different(kept[reached], misses[reached])
    many = any(search.moves_freely(one) for one in q)
    if many:
        q = scattered(q)
        miss = search.miss(q)
    return Postures(
        q=q, miss=miss, infinitely_many=many, nearest=float(misses.min(initial=math.inf))
    )


class Search:
    """A chain and its goal; lengths are in units of the chain's length."""

    def __init__(self, rows: Sequence[Row], goal: Array, *, turning: bool, limits: Limits) -> None:
        self._rows, self._goal = rows, goal
        self.size = chain_length(rows)
        revolute = [rows[index].joint == "revolute" for index in moving_rows(rows)]
        self._turns = np.array(revolute)
        self._scale = np.where(self._turns, 1.0, self.size)
        self._low, self._high = np.array(limits, dtype=np.float64).T
        self._parts = slice(0, 6) if turning else slice(3, 6)
        self.redundant = len(revolute) > (6 if turning else 3)

    def run(self, *, inside: bool, seed: int = 0) -> tuple[Array, Array]:
        """Search from every start; return all ends and their misses [m]."""
        q = self._damped(self._starts(seed), inside=inside)
        near = self.miss(q) <= NEAR * self.size
        polished = self.polished(q[near], inside=inside)
        ends = np.concatenate([q[~near], polished])
        return ends, self.miss(ends)

    def _starts(self, seed: int) -> Array:
        span = np.where(self._turns, math.pi, self.size + float(np.linalg.norm(self._goal[:3, 3])))
        low = np.where(np.isfinite(self._low), self._low, np.minimum(-span, self._high - span))
        high = np.where(np.isfinite(self._high), self._high, np.maximum(span, low + span))
        rng = np.random.default_rng(seed)
        return rng.uniform(low, high, (STARTS, len(low)))

    def _damped(self, q: Array, *, inside: bool) -> Array:
        """Levenberg-Marquardt method for all starts at once, until near the goal or stuck."""
        ends, active = q.copy(), np.arange(len(q))
        damping, error = np.full(len(q), 1e-2), self._error(q)
        for _ in range(STEPS):
            J = self._jacobian(q)
            Jt = np.swapaxes(J, -1, -2)
            normal = J @ Jt + damping[:, np.newaxis, np.newaxis] * np.eye(J.shape[-2])
            change = (Jt @ np.linalg.solve(normal, error[..., np.newaxis]))[..., 0]
            tried = self._placed(q + self._shortened(change) * self._scale, inside=inside)
            after = self._error(tried)
            better = (after**2).sum(axis=-1) < (error**2).sum(axis=-1)
            q = np.where(better[:, np.newaxis], tried, q)
            error = np.where(better[:, np.newaxis], after, error)
            damping = np.where(better, np.maximum(damping / 4.0, 1e-14), damping * 4.0)
            ends[active] = q
            going = (np.linalg.norm(error, axis=-1) > NEAR) & (damping < STUCK)
            if not going.any():
                break
            q, error, damping, active = q[going], error[going], damping[going], active[going]
        return ends

    def polished(self, q: Array, *, inside: bool = False) -> Array:
        """Newton's method; a step is taken only if it comes nearer, by more than rounding."""
        for _ in range(POLISHING):
            if not len(q):
                break
            inverse = np.linalg.pinv(self._jacobian(q), rcond=1e-9)
            change = self._shortened((inverse @ self._error(q)[..., np.newaxis])[..., 0])
            tried = self._placed(q + change * self._scale, inside=inside)
            miss = self.miss(q)
            better = (miss > ROUNDING * self.size) & (self.miss(tried) < miss)
            if not better.any():
                break
            q = np.where(better[:, np.newaxis], tried, q)
        return q

    def _placed(self, q: Array, *, inside: bool) -> Array:
        return np.clip(q, self._low, self._high) if inside else q

    def _shortened(self, change: Array) -> Array:
        turns = np.where(self._turns, np.abs(change), 0.0)
        longest = turns.max(axis=-1, keepdims=True)
        shortened: Array = change * np.minimum(1.0, LARGEST_STEP / np.maximum(longest, 1e-300))
        return shortened

    def _jacobian(self, q: Array) -> Array:
        J = jacobian(self._rows, q) * self._scale
        J[..., 3:, :] /= self.size
        part: Array = J[..., self._parts, :]
        return part

    def _error(self, q: Array) -> Array:
        """Rotation vector and translation to the goal, in units of the chain's length."""
        X_BF = foot_pose(self._rows, q)
        way = (self._goal[:3, 3] - X_BF[..., :3, 3]) / self.size
        turn = rotation_vector(self._goal[:3, :3] @ np.swapaxes(X_BF[..., :3, :3], -1, -2))
        part: Array = np.concatenate([turn, way], axis=-1)[..., self._parts]
        return part

    def miss(self, q: Array) -> Array:
        """Distance to the goal [m]; rotations count times the chain's length."""
        miss: Array = self.size * np.linalg.norm(self._error(q), axis=-1)
        return miss

    def gap(self, q: Array) -> tuple[float, float]:
        """Distance [m] and angle [rad] between a posture's foot and the goal; 0 if any will do."""
        error = self._error(q)
        turn, way = np.linalg.norm(error[:-3]), np.linalg.norm(error[-3:])
        return float(self.size * way), float(turn)

    def null_motion(self, q: Array) -> Array | None:
        """Joint rates (n,) that do not move the foot, if there are any; the greatest is 1."""
        _, sigma, Vt = np.linalg.svd(self._jacobian(q))
        if len(sigma) == len(q) and sigma[-1] >= SINGULAR * max(sigma[0], LEAST_LEVER):
            return None
        rates: Array = Vt[-1] * self._scale / np.abs(Vt[-1]).max()
        return rates

    def moves_freely(self, q: Array) -> bool:
        """Whether joints can move while the foot stays in place.

        Where two postures meet, as in a stretched arm, rates do not move the foot, either; but the
        joints cannot go on that way.
        """
        rates = self.null_motion(q)
        if rates is None:
            return False
        back = self.polished(self.polished((q + WIGGLE * rates)[np.newaxis]))[0]
        gone = np.abs((back - q) / self._scale).max() > WIGGLE / 2.0
        return bool(gone and self.miss(back) <= REACHED * self.size)

    def different(self, q: Array, miss: Array) -> tuple[Array, Array]:
        """Keep one of each posture, turned into the limits, those within the limits first."""
        placed = self.turned(q)
        chosen: list[int] = []
        for index in np.argsort(miss, kind="stable"):
            if not any(self._is_same(placed[index], placed[other]) for other in chosen):
                chosen.append(int(index))

        def order(index: int) -> tuple[bool, list[float]]:
            one = placed[index]
            return not self.within_limits(one), np.round(one, 6).tolist()

        chosen.sort(key=order)
        return placed[chosen], miss[chosen]

    def within_limits(self, q: Array) -> bool:
        """Whether every joint of a posture is within its limits."""
        return not ((q < self._low - AT_LIMIT) | (q > self._high + AT_LIMIT)).any()

    def turned(self, q: Array) -> Array:
        """Postures whose joints are turned into their limits, where whole turns can do that."""
        turn = 2.0 * math.pi
        wrapped = principal(q)
        up = wrapped + turn * np.maximum(np.ceil((self._low - AT_LIMIT - wrapped) / turn), 0.0)
        down = up - turn * np.maximum(np.ceil((up - self._high - AT_LIMIT) / turn), 0.0)
        placed = np.where(down >= self._low - AT_LIMIT, down, wrapped)
        return np.where(self._turns, placed, q)

    def _is_same(self, a: Array, b: Array) -> bool:
        difference = (a - b) / self._scale
        turns = nearest_turn(difference, np.zeros(()))
        return bool(np.abs(np.where(self._turns, turns, difference)).max() < SAME)


def rotation_vector(R: Array) -> Array:
    """Axis times angle, 0 ... pi, of rotation matrices (..., 3, 3), (..., 3) [rad]."""
    of_half = quaternions(R)
    sine = np.linalg.norm(of_half[..., 1:], axis=-1)
    angle = 2.0 * np.arctan2(sine, of_half[..., 0])
    stretch = np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)
    vector: Array = of_half[..., 1:] * stretch[..., np.newaxis]
    return vector


def scattered(q: Array) -> Array:
    """Choose a few postures that are far apart."""
    chosen = [0] if len(q) else []
    while len(chosen) < min(SHOWN, len(q)):
        distances = np.abs(q[:, np.newaxis] - q[chosen]).max(axis=-1).min(axis=-1)
        chosen.append(int(distances.argmax()))
    return q[chosen]
