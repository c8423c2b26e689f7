"""Looks ahead to a singularity: shortens a guarded run's steps, and slows a driven foot."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from drake_leg.kinematics.loop import Instant
from drake_leg.kinematics.movable import Floats, Movable
from drake_leg.singularity.families import singular_words

STOP, SLOW = 0.01, 0.04  # of the arm's length: singular values where the foot stops, slows down
GREATEST_RATE = 4.0  # [rad/s or m/s] of a joint
LOOK = 1e-4  # [rad or m] of the fastest joint, trial step that shows where the singular value goes

TIME_LEFT = 5e-10  # [s] before the instant of a singularity, at which a run stops
APPROACH = 0.03  # part of the determinant that a step changes, at most
NEAR, NEAR_APPROACH = 0.3, 0.02  # below this normalized determinant, at most this part
LARGEST_TURN = 0.05  # [rad or m] of a joint in a step
SHRINK = 1.5  # factor from one trial step to the next
SMALLEST_STEP = 1e-13  # [s]
DAMPED_STEP = 1.5  # of the time constant of a damped inverse, at most
STEP_OF_KINK, SHORTEST_AT_KINK = 2e-3, 2e-4  # [s], of steps in which a rate may have a kink
PART_AT_KINK = 0.04  # part of a rate that it may change by in such a step


class Braked(NamedTuple):
    """Which part of a command may act, and why not all of it."""

    share: float  # 0 ... 1
    obstacle: str  # in words; empty if nothing is in the way

    def __deepcopy__(self, _memo: object) -> Self:
        """Return itself, as it cannot change: Drake copies abstract states at every step."""
        return self


def room(robot: Movable, sigma_min: float) -> float:
    """Share of a velocity toward a singularity that may act, from the smallest singular value [m].

    It is at least 1 where nothing is slowed, and at most 0 where the foot stops.
    """
    stop, slow = STOP * robot.length, SLOW * robot.length
    return (sigma_min - stop) / (slow - stop)


def braked(robot: Movable, q: Floats, v: Floats, fastest: float = GREATEST_RATE) -> Braked:
    """Part of a commanded velocity that may act in a posture q (n,), which must not be singular.

    A motion that lowers the smallest singular value is slowed in proportion to what is left of it
    above ``STOP``; a motion that raises it is not. No joint moves faster than ``fastest``, in
    rad/s or m/s. The robot is ``robot.at(q)``, and v (m,) is as its ``command`` makes it.
    """
    rates = np.asarray(robot.rates(q, v), dtype=np.float64)
    peak = float(np.abs(rates).max())
    if peak == 0.0:
        return Braked(1.0, "")
    share, obstacle = 1.0, ""
    if peak > fastest:
        share, obstacle = fastest / peak, "a joint is at its greatest speed"
    before = robot.sigma_min(q)
    left = room(robot, before)
    if left < 1.0:
        later = (np.asarray(q) + LOOK / peak * rates).tolist()
        crosses = robot.determinant(q) * robot.determinant(later) <= 0.0
        if crosses or robot.sigma_min(later) < before:
            return Braked(share * max(left, 0.0), singular_words(robot.geometry, q))
    return Braked(share, obstacle)


class LookAhead:
    """Effect of a step, from the joints' rates and, if known, their accelerations.

    Positions are in rad or m, and the determinant is a function of them.
    """

    def __init__(
        self,
        determinant: Callable[[Floats], float],
        q: Floats,
        qdot: Floats,
        qddot: Floats | None,
    ) -> None:
        self._determinant = determinant
        self._q, self._qdot, self._qddot = q, qdot, qddot
        self._now = determinant(q)
        self._fastest = max(map(abs, qdot))
        self._hardest = max(map(abs, qddot)) if qddot else 0.0

    def __call__(self, step: float) -> tuple[float, float]:
        """Greatest change of a joint in a step [rad or m], and of the determinant, relatively.

        Effects of rates and accelerations are added: they may cancel at the end of the step, but
        not within it.
        """
        half = 0.5 * step * step
        drift = abs(self._moved(step, self._qdot) - self._now)
        if self._qddot:
            drift += abs(self._moved(half, self._qddot) - self._now)
        turn = step * self._fastest + half * self._hardest
        return turn, drift / abs(self._now) if self._now else math.inf

    def time_left(self, step: float) -> float:
        """Determinant over the rate at which it falls in a small step [s]; infinite if it grows.

        Where it falls linearly in time, that is when it becomes zero; where it falls like the
        root of the time that is left, it becomes zero at half of that.
        """
        change = self._moved(step, self._qdot) / self._now - 1.0
        return -step / change if change < 0.0 else math.inf

    def shortened(self, step: float, approach: float, least: float) -> float:
        """Shorten a step, to ``least`` at the least, until it changes the determinant by a part."""
        while step > least:
            turn, change = self(step)
            if turn <= LARGEST_TURN and change <= approach:
                break
            step /= SHRINK
        return step

    def _moved(self, step: float, change: Floats) -> float:
        moved = [q + step * part for q, part in zip(self._q, change, strict=True)]
        return self._determinant(moved)


def step_towards(
    robot: Movable, at: Instant, now: float, step: float, *, disturbed: bool
) -> float | None:
    """Shorten a step [s] so that it approaches a singularity but does not cross it.

    ``now`` is the normalized determinant, positive on the side where the robot started. Where
    joints may not move as commanded, they are ``disturbed``: the sensed rates are used. None where
    the singularity is nearer than ``TIME_LEFT``.
    """
    ahead = _look_ahead(robot, at, disturbed=disturbed)
    step = ahead.shortened(step, NEAR_APPROACH if now < NEAR else APPROACH, SMALLEST_STEP)
    if step < TIME_LEFT and ahead.time_left(step) < TIME_LEFT:
        return None
    return step


def step_through(robot: Movable, at: Instant, step: float, *, disturbed: bool) -> float:
    """Shorten a step of an inexact inverse until its rates can be integrated accurately [s]."""
    slowest, stiffness = robot.stiffness(at.q, at.v)
    least = DAMPED_STEP / slowest if slowest > 0.0 else step
    step = _look_ahead(robot, at, disturbed=disturbed).shortened(step, APPROACH, least)
    while step > (kink := step_at_kink(robot, at, step)):
        step = max(step / 2.0, kink)
    return min(step, DAMPED_STEP / stiffness) if stiffness > 0.0 else step


def step_at_kink(robot: Movable, at: Instant, step: float) -> float:
    """Longest step in which the bound of a joint rate may change [s].

    Across a kink the error of an integrator is a part of the rate's change in the step; it has
    to be less than the headroom before a greatest rate and the margin before a limit. The result
    is infinite if the rates have no kink in this step.
    """
    if at.a is None or at.qddot is None:
        return math.inf
    later = (
        _later(at.q, at.qdot if at.w is None else at.w, step),
        _later(at.v, at.a, step),
    )
    now, then = robot.regime(at.q, at.v), robot.regime(*later)
    if now == then:
        return math.inf
    least = STEP_OF_KINK
    for before, after, rate, change in zip(now, then, at.qdot, at.qddot, strict=True):
        if before != after and change:
            least = min(least, PART_AT_KINK * abs(rate / change))
    return max(least, SHORTEST_AT_KINK)


def _look_ahead(robot: Movable, at: Instant, *, disturbed: bool) -> LookAhead:
    if disturbed and at.w is not None:
        return LookAhead(robot.determinant, at.q, at.w, None)
    return LookAhead(robot.determinant, at.q, at.qdot, at.qddot)


def _later(values: Floats, rates: Floats, step: float) -> list[float]:
    return [value + step * rate for value, rate in zip(values, rates, strict=True)]
