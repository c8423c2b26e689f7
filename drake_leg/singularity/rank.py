"""The rank of a Jacobian, and what motion is lost where it falls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.chain import RANK_TOLERANCE
from drake_leg.kinematics.khalil import Array, jacobian, moving_rows
from drake_leg.robot.robot import Row
from drake_leg.singularity.stroke import signed

ROUNDING = 1e-13  # of the length: singular values below it are zero


@dataclass(frozen=True, kw_only=True)
class RankReport:
    """Rank, singular values and lost directions of a Jacobian."""

    rank: int
    full_rank: int  # the rank that it has elsewhere: its smaller dimension
    sigma_min: float  # smallest singular value, in the Jacobian's unit
    manipulability: float  # product of the singular values (Yoshikawa)
    lost_directions: Array  # (full_rank - rank, rows), orthonormal; empty at full rank


def examine(J: Array, least: float = 0.0) -> RankReport:
    """Rank and lost directions of a Jacobian (m, n) whose rows have the same unit.

    Singular values below ``least`` count as zero. A lost direction is one in which no
    joint rate moves the foot; its first component that is not zero is positive.
    """
    U, sigma, _ = np.linalg.svd(J)
    smaller = len(sigma)
    rank = int((sigma > max(RANK_TOLERANCE * sigma[0], least)).sum())
    lost = U[:, rank:smaller].T
    return RankReport(
        rank=rank,
        full_rank=smaller,
        sigma_min=float(sigma[-1]),
        manipulability=float(np.prod(sigma)),
        lost_directions=np.array([signed(row, 1e-12) for row in lost]).reshape(-1, len(J)),
    )


@dataclass(frozen=True, kw_only=True)
class LostTwist:
    """A motion of the foot that no joint rates produce in this posture, but do nearby."""

    turning: Array | None  # unit axis, about which the foot does not turn while it stays in place
    moving: Array | None  # unit vector, along which it does not move while it holds its orientation


@dataclass(frozen=True, kw_only=True)
class WholeRank:
    """Rank of the whole Jacobian, rotation and translation."""

    rank: int
    full_rank: int  # 6, or as many as there are joints
    sigma_min: float  # smallest of full_rank singular values, with the chain's length as unit
    lost: tuple[LostTwist, ...]


def examine_whole(rows: Sequence[Row], q: ArrayLike, length: float) -> WholeRank:
    """Rank of the whole Jacobian of a chain's foot, with ``length`` [m] as its unit.

    A motion counts as lost only if nearby postures have it.
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
    """Of the motions that no joint rates produce here, return those that nearby postures have."""
    if not most:
        return ()
    V, gain, _ = np.linalg.svd(regained, full_matrices=False)
    count = min(most, int((gain > 1e-6).sum()))
    lost = nothing @ V[:, :count]
    _, _, Wt = np.linalg.svd(lost[3:], full_matrices=False)  # separates pure rotations
    return tuple(
        LostTwist(turning=_axis(twist[:3]), moving=_axis(twist[3:])) for twist in (lost @ Wt.T).T
    )


def _axis(vector: Array) -> Array | None:
    """Direction of a vector, as ``signed``; None if the vector is zero to rounding."""
    size = float(np.linalg.norm(vector))
    return None if size < 1e-6 else signed(vector / size, 1e-9)
