"""The leg's inverse kinematics: all branches, and the one of a given posture.

A foot position is met in up to four ways: the leg may face it or turn its back (the sign of
the reach, ``l1 + l2 c2 + l3 c23``), and the ankle may bend either way (the sign of sin q3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import (
    Array,
    finite_vectors,
    one_vector,
    triangle_angle,
    within_turns,
)
from drake_leg.kinematics.leg import LegGeometry

BRANCHES = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # facing, bend


@dataclass(frozen=True, kw_only=True)
class Branch:
    """One way of putting the foot at a point."""

    facing: int  # +1: the foot is in front of the hip, -1: behind it
    bend: int  # sign of sin q3
    q: tuple[float, float, float] | None  # [rad]; None where the point is out of reach
    within_limits: bool  # of the joints; True where none are given

    @property
    def name(self) -> str:
        """What the branch looks like, in words."""
        front = "foot in front of the hip" if self.facing > 0 else "foot behind the hip"
        return f"{front}, q3 {'positive' if self.bend > 0 else 'negative'}"


def branch_angles(leg: LegGeometry, p_BF: ArrayLike) -> Array:
    """Joint angles of all four branches.

    ``foot_position(leg, branch_angles(leg, p)[..., b, :]) == p`` wherever it is not NaN.

    The ankle follows from the triangle of femur, tibia and the distance from knee to foot.

    Parameters
    ----------
    p_BF : (..., 3) array_like
        Foot positions in the base frame [m]. On the hip axis the hip angle is arbitrary: 0 or pi.

    Returns
    -------
    q : (..., 4, 3) ndarray
        Hip, knee, ankle angles [rad] in (-pi, pi], in the order of ``BRANCHES``; NaN where the
        point is out of reach.

    Raises
    ------
    InvalidValueError
        If ``p_BF`` does not end in 3, or is not finite.
    """
    points = finite_vectors("p_BF", p_BF, 3)
    x, y, w = points[..., 0], points[..., 1], leg.sign * points[..., 2]
    solutions = [_solve(leg, x, y, w, facing, bend) for facing, bend in BRANCHES]
    return np.stack(solutions, axis=-2)


def _solve(leg: LegGeometry, x: Array, y: Array, w: Array, facing: int, bend: int) -> Array:
    q1 = np.arctan2(facing * y, facing * x)
    u = facing * np.hypot(x, y) - leg.l1
    q3 = bend * triangle_angle(leg.l2, leg.l3, np.hypot(u, w))
    q2 = np.arctan2(w, u) - np.arctan2(leg.l3 * np.sin(q3), leg.l2 + leg.l3 * np.cos(q3))
    q = np.stack([np.where(np.isnan(q3), np.nan, q1), q2, q3], axis=-1)
    wrapped: Array = math.pi - np.mod(math.pi - q, 2.0 * math.pi)
    return wrapped


def branches(
    leg: LegGeometry,
    p_BF: ArrayLike,
    limits: Sequence[tuple[float, float]] | None = None,
) -> tuple[Branch, ...]:
    """All four ways of putting the foot at one point, those out of reach named as such.

    Parameters
    ----------
    p_BF : (3,) array_like
        Foot position in the base frame [m].
    limits : sequence of three pairs of float, optional
        Lower and upper limit of each joint [rad].

    Returns
    -------
    tuple of four Branch
        In the order of ``BRANCHES``.

    Raises
    ------
    InvalidValueError
        If ``p_BF`` has not three finite numbers, or there are not three pairs of limits.
    """
    if limits is not None and len(limits) != 3:
        raise InvalidValueError(f"there are {len(limits)} pairs of limits; a leg has three joints")
    found = []
    for (facing, bend), q in zip(
        BRANCHES, branch_angles(leg, one_vector("p_BF", p_BF, 3)), strict=True
    ):
        reached = bool(np.isfinite(q).all())
        inside = limits is None or all(
            within_turns(angle, low, high) for angle, (low, high) in zip(q, limits, strict=True)
        )
        found.append(
            Branch(
                facing=facing,
                bend=bend,
                q=(float(q[0]), float(q[1]), float(q[2])) if reached else None,
                within_limits=reached and inside,
            )
        )
    return tuple(found)


def inverse_kinematics(leg: LegGeometry, p_BF: ArrayLike, like: ArrayLike) -> Array:
    """Joint angles that put the foot at a point, on the branch of a given posture.

    ``foot_position(leg, inverse_kinematics(leg, p_BF, like)) == p_BF``.

    Parameters
    ----------
    p_BF : (..., 3) array_like
        Foot position in the base frame [m].
    like : (3,) array_like
        Joint angles [rad] whose branch is wanted, and whose turns: every angle is the one
        nearest to its own.

    Returns
    -------
    q : (..., 3) ndarray
        Hip, knee, ankle angles [rad]; NaN where the point is out of reach.

    Raises
    ------
    InvalidValueError
        If a shape is wrong or a value is not finite.
    """
    near = one_vector("like", like, 3)
    reach = leg.l1 + leg.l2 * math.cos(near[1]) + leg.l3 * math.cos(near[1] + near[2])
    branch = (1 if reach >= 0.0 else -1, 1 if math.sin(near[2]) >= 0.0 else -1)
    q = branch_angles(leg, p_BF)[..., BRANCHES.index(branch), :]
    turn = 2.0 * math.pi
    nearest: Array = q + turn * np.round((near - q) / turn)
    return nearest
