"""How far any chain's foot goes along a straight line: to a singularity, its reach, or a limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.khalil import foot_pose, jacobian, moving_rows
from drake_leg.kinematics.stroke import unit
from drake_leg.robot import Row

SAMPLES = 24  # random postures that tell what a chain's foot can do
RANK_TOLERANCE = 1e-9  # of the greatest singular value
LEAST_LEVER = 1e-3  # of the length: a shorter lever than any that is meant
STEPS = 60  # over the length of the chain
RESOLUTION = 1e-9  # smallest step, of the length of the chain
ROUNDING = 1e-13  # of the length of the chain: what a foot misses its goal by at best
FARTHEST = 10.0  # of the length of the chain; farther is called infinite
LARGEST_CHANGE = 0.5  # [rad, or of the length] of a joint in one step; more is a jump
LIMIT_ROUNDING = 1e-9  # [rad or m]: a joint this far outside a limit is at it

Limits = Sequence[tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class Steering:
    """What a chain's foot can be told, in every posture that is not singular."""

    twists: Array  # (6, r) orthonormal, turning (times the length) first
    holds: bool  # the orientation, while the foot moves
    pose_rank: int  # of the whole Jacobian where it is greatest
    position_rank: int  # of the translation's


@dataclass(frozen=True, kw_only=True)
class Way:
    """How far the foot came."""

    length: float  # [m]; infinite where nothing is in its way
    joint: int | None  # index of the joint whose limit ends it; None: the chain's own end
    q: Array  # (n,), [rad or m], just before the end


def chain_length(rows: Sequence[Row]) -> float:
    """Length of a table, link by link; 1 m for one without lengths.

    Parameters
    ----------
    rows : sequence of Row
        The table.

    Returns
    -------
    float
        [m].
    """
    return sum(math.hypot(row.d, row.r) for row in rows) or 1.0


def sampled_jacobians(rows: Sequence[Row]) -> Array:
    """Jacobians in random postures, sliding joints up to the chain's length.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which n rows move.

    Returns
    -------
    (samples, 6, n) ndarray
    """
    spans = [
        math.pi if rows[index].joint == "revolute" else chain_length(rows)
        for index in moving_rows(rows)
    ]
    rng = np.random.default_rng(0)
    return jacobian(rows, np.array(spans) * rng.uniform(-1.0, 1.0, (SAMPLES, len(spans))))


def steering(rows: Sequence[Row]) -> Steering:
    """Find out what a chain's foot can be told.

    Where the motions of all postures together span no more than those of one, the foot holds its
    orientation: in space with six joints, in a plane with three. Otherwise only its position is
    told.

    Parameters
    ----------
    rows : sequence of Row
        The table.

    Returns
    -------
    Steering
    """
    scaled = _weights(rows)[:, np.newaxis] * sampled_jacobians(rows)
    only = np.concatenate([0.0 * scaled[:, :3], scaled[:, 3:]], axis=1)
    pose_rank, pose_span = _span(scaled, LEAST_LEVER * chain_length(rows))
    position_rank, position_span = _span(only, LEAST_LEVER * chain_length(rows))
    holds = pose_span is not None and pose_rank > position_rank
    twists = pose_span if holds else position_span
    if twists is None:
        twists = np.vstack([np.zeros((3, 3)), np.eye(3)])
    return Steering(twists=twists, holds=holds, pose_rank=pose_rank, position_rank=position_rank)


def steered(rows: Sequence[Row], q: ArrayLike, how: Steering) -> Array:
    """Jacobian of what the foot is told.

    Parameters
    ----------
    rows : sequence of Row
        The table.
    q : (n,) array_like
        Joint positions [rad or m].
    how : Steering
        Of the chain.

    Returns
    -------
    (r, n) ndarray
        [m/rad, or 1].
    """
    J: Array = how.twists.T @ (_weights(rows)[:, np.newaxis] * jacobian(rows, q))
    return J


def straight_way(
    rows: Sequence[Row],
    q: ArrayLike,
    direction: ArrayLike,
    how: Steering,
    limits: Limits,
    farthest: float | None = None,
) -> Way:
    """Follow a chain along a line in small steps, each closed by Newton's method.

    It ends where a step fails, a joint meets its limit or the determinant changes its sign; the
    last step is then bisected. Of many joints those move that need to, least squares.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which n rows move.
    q : (n,) array_like
        Joint positions at the start [rad or m], not singular.
    direction : (3,) array_like
        In the base frame.
    how : Steering
        Of the chain.
    limits : sequence of n pairs of float
        Lower and upper limit of each joint [rad or m]; they may be infinite.
    farthest : float, optional
        Where to stop looking [m]; by default ten times the chain's length.

    Returns
    -------
    Way
    """
    posture = one_vector("q", q, len(moving_rows(rows)))
    start, d, size = foot_pose(rows, posture), unit(direction), chain_length(rows)
    sign = _side(rows, posture, how)
    way, step, joint = 0.0, size / STEPS, None
    slope = np.zeros_like(posture)
    while way < (FARTHEST * size if farthest is None else farthest):
        goal = start.copy()
        goal[:3, 3] += (way + step) * d
        closed = _closed(rows, posture, step * slope, goal, step, how)
        reached = closed is not None and _side(rows, closed, how) == sign
        joint = _outside(closed, limits) if reached and closed is not None else None
        if closed is None or not reached or joint is not None:
            step /= 2.0
            if step < RESOLUTION * size:
                return Way(length=way, joint=joint, q=posture)
        else:
            slope = (closed - posture) / step
            way, posture = way + step, closed
            step = min(2.0 * step, size / STEPS)
    return Way(length=math.inf, joint=None, q=posture)


def outside(q: Sequence[float] | Array, limits: Limits) -> list[int]:
    """List the joints that are outside their limits.

    Parameters
    ----------
    q : (n,) sequence of float
        Joint positions [rad or m].
    limits : sequence of n pairs of float
        Lower and upper limit of each.

    Returns
    -------
    list of int
        Their indices.
    """
    return [
        index
        for index, (value, (low, high)) in enumerate(zip(q, limits, strict=True))
        if not low - LIMIT_ROUNDING <= value <= high + LIMIT_ROUNDING
    ]


def _weights(rows: Sequence[Row]) -> Array:
    return np.array([chain_length(rows)] * 3 + [1.0] * 3)


def _span(scaled: Array, least: float) -> tuple[int, Array | None]:
    """Return the greatest rank of Jacobians, and the span of all, if it is no larger."""
    each = np.linalg.svd(scaled, compute_uv=False)
    greatest = max(float(each.max()), least)
    rank = int((each > RANK_TOLERANCE * greatest).sum(axis=1).max())
    U, sigma, _ = np.linalg.svd(np.hstack(list(scaled)), full_matrices=False)
    together = int((sigma > RANK_TOLERANCE * greatest).sum())
    return rank, U[:, :rank] if together == rank else None


def _side(rows: Sequence[Row], q: Array, how: Steering) -> float:
    """Tell on which side of the singularity a posture is; 0 where no determinant tells it."""
    J = steered(rows, q, how)
    return float(np.sign(np.linalg.det(J))) if J.shape[0] == J.shape[1] else 0.0


def _outside(q: Array, limits: Limits) -> int | None:
    return next(iter(outside(q, limits)), None)


def _closed(
    rows: Sequence[Row], q: Array, guess: Array, goal: Array, step: float, how: Steering
) -> Array | None:
    """Move the foot to the goal by Newton's method; None where that fails or jumps."""
    posture, size = q + guess, chain_length(rows)
    largest = np.array(
        [1.0 if rows[index].joint == "revolute" else size for index in moving_rows(rows)]
    )
    missed = math.inf
    while True:
        miss = _miss(rows, posture, goal, how)
        before, missed = missed, float(np.abs(miss).max())
        if missed < ROUNDING * size or missed > before / 2.0:
            break
        J = steered(rows, posture, how) * largest
        change = np.linalg.lstsq(J, how.twists.T @ miss, rcond=1e-12)[0]
        if float(np.abs(change).max()) > LARGEST_CHANGE:
            return None
        posture = posture + change * largest
    return posture if missed < max(1e-6 * step, ROUNDING * size) else None


def _miss(rows: Sequence[Row], q: Array, goal: Array, how: Steering) -> Array:
    """Return what is left to the goal, (6,) [m]: turning times the length, then the way."""
    X_BF = foot_pose(rows, q)
    turn = goal[:3, :3] @ X_BF[:3, :3].T
    spin = 0.5 * np.array(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )
    way = goal[:3, 3] - X_BF[:3, 3]
    return np.concatenate([spin * (chain_length(rows) if how.holds else 0.0), way])
