"""How near a Jacobian is to losing rank, and which direction it loses, for any chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.chain import RANK_TOLERANCE
from drake_leg.kinematics.khalil import jacobian, moving_rows
from drake_leg.kinematics.movable import Floats, Movable
from drake_leg.robot import Row

# Of the greatest singular value of the foot's translation: where the smallest one is greater, the
# foot goes everywhere.
STILL_MOVES = 1e-3


@dataclass(frozen=True, kw_only=True)
class RankReport:
    """What a singular value decomposition says of a Jacobian."""

    rank: int
    full_rank: int  # the rank that it has elsewhere: its smaller dimension
    sigma_min: float  # smallest singular value, in the Jacobian's unit
    manipulability: float  # product of the singular values (Yoshikawa)
    lost_directions: Array  # (full_rank - rank, rows), orthonormal; empty at full rank


def examine(J: Array, least: float = 0.0) -> RankReport:
    """Take a Jacobian (m, n), its rows in one unit, apart.

    Singular values below ``least`` are nothing but rounding. A lost direction is one in which no
    joint rate moves the foot; its first component that is not zero is positive.
    """
    U, sigma, _ = np.linalg.svd(J)
    smaller = len(sigma)
    rank = int((sigma > max(RANK_TOLERANCE * sigma[0], least)).sum())
    lost = U[:, rank:smaller].T
    cleaned = np.where(np.abs(lost) < 1e-12, 0.0, lost)
    signs = [np.sign(row[np.flatnonzero(row)[0]]) for row in cleaned]
    return RankReport(
        rank=rank,
        full_rank=smaller,
        sigma_min=float(sigma[-1]),
        manipulability=float(np.prod(sigma)),
        lost_directions=cleaned * np.array(signs).reshape(-1, 1) + 0.0,
    )


@dataclass(frozen=True, kw_only=True)
class LostTwist:
    """A motion that no joint rates give, though they do nearby."""

    turning: Array | None  # unit axis, about which the foot does not turn while it stays in place
    moving: Array | None  # unit vector, along which it does not move while it holds its orientation


@dataclass(frozen=True, kw_only=True)
class WholeRank:
    """What is known of the rank of the whole Jacobian, turning and moving."""

    rank: int
    full_rank: int  # 6, or as many as there are joints
    sigma_min: float  # smallest of full_rank singular values, with the chain's length as unit
    lost: tuple[LostTwist, ...]


def examine_whole(rows: Sequence[Row], q: ArrayLike, length: float) -> WholeRank:
    """Take the whole Jacobian of a chain's foot apart, lengths measured by ``length`` [m].

    Nothing is reported lost that no posture nearby has.
    """
    posture = np.asarray(q, dtype=np.float64)
    unit = np.where([rows[index].joint == "revolute" for index in moving_rows(rows)], 1.0, length)

    def scaled(at: Array) -> Array:
        J: Array = jacobian(rows, at) * unit
        J[..., 3:, :] /= length
        return J

    U, sigma, _ = np.linalg.svd(scaled(posture))
    rank = int((sigma > RANK_TOLERANCE * sigma[0]).sum()) if sigma[0] > 0.0 else 0
    nothing = U[:, rank:]
    near = posture + 1e-3 * unit * np.random.default_rng(0).uniform(-1.0, 1.0, (8, len(posture)))
    regained = nothing.T @ np.hstack(list(scaled(near)))
    return WholeRank(
        rank=rank,
        full_rank=len(sigma),
        sigma_min=float(sigma[-1]),
        lost=_lost_twists(nothing, regained, len(sigma) - rank),
    )


def _lost_twists(nothing: Array, regained: Array, most: int) -> tuple[LostTwist, ...]:
    """Name the motions, of those that nothing gives here, that postures nearby have."""
    if not most:
        return ()
    V, gain, _ = np.linalg.svd(regained, full_matrices=False)
    count = min(most, int((gain > 1e-6).sum()))
    lost = nothing @ V[:, :count]
    _, _, Wt = np.linalg.svd(lost[3:], full_matrices=False)  # pure turning apart, where there is
    return tuple(
        LostTwist(turning=_axis(twist[:3]), moving=_axis(twist[3:])) for twist in (lost @ Wt.T).T
    )


def _axis(vector: Array) -> Array | None:
    """Return a unit vector, its first component that is not zero positive; None of nothing."""
    size = float(np.linalg.norm(vector))
    if size < 1e-6:
        return None
    one = np.where(np.abs(vector / size) < 1e-9, 0.0, vector / size)
    axis: Array = np.sign(one[np.flatnonzero(one)[0]]) * one + 0.0
    return axis


def loses_turning(robot: Movable, q: Floats) -> bool:
    """Tell whether a singular posture loses only a turning: the foot still goes everywhere."""
    _, sigma, moved = _translations(robot, q)
    return bool(robot.keeps_orientation and sigma[moved - 1] > STILL_MOVES * sigma[0])


def lost_direction(robot: Movable, q: Floats) -> tuple[float, float, float]:
    """Direction in which the foot moves least for all that its joints do, in a singular posture.

    Returns
    -------
    (3,) tuple of float
        Unit vector in the base frame, its first component that is not zero positive: of a
        translation or, where only a turning is lost, of its axis.
    """
    U, _, moved = _translations(robot, q)
    lost = U[:, moved - 1]
    if loses_turning(robot, q):
        U, _, _ = np.linalg.svd(robot.jacobian_in_lengths(q))
        lost = robot.twists[:3] @ U[:, -1]
        lost = lost / np.linalg.norm(lost)
    lost = np.where(np.abs(lost) < 1e-9, 0.0, lost)
    sign = np.sign(lost[np.flatnonzero(lost)[0]])
    x, y, z = (sign * lost + 0.0).tolist()
    return x, y, z


def _translations(robot: Movable, q: Floats) -> tuple[Array, Array, int]:
    """Take the foot's translation apart: directions, singular values, and how many it has."""
    moved = int(np.linalg.matrix_rank(robot.twists[3:]))
    U, sigma, _ = np.linalg.svd(robot.twists[3:] @ robot.jacobian_in_lengths(q))
    return U, sigma, moved
