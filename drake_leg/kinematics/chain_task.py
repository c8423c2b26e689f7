"""The task of any chain, square or redundant, its Jacobian inverted numerically.

A redundant task takes, of all rates that move the foot as commanded, the least (Moore and
Penrose): ``qdot = J^T y`` with ``J J^T y = v``. Its accelerations are the derivative of that,

``qddot = J^+ (a - dJ/dt qdot) + (1 - J^+ J) (dJ/dt)^T y``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import jacobian as batch_jacobian
from drake_leg.kinematics.rates import SINGULAR_BELOW
from drake_leg.kinematics.sweep import Sweep, foot_jacobian, foot_jacobian_rate, sweep
from drake_leg.kinematics.task import Floats, Task
from drake_leg.robot import Row

SAMPLES = 256  # postures that tell what a chain can do
LEAST_LEVER = 1e-3  # of the chain's length: what has a shorter one is taken not to move the foot


class _Posture(NamedTuple):
    """A chain where it is asked for rates, and J taken apart, its rows made lengths."""

    here: Sweep
    J: Array  # (m, n), its rows as they are
    U: Array  # (m, m)
    sigma: Array  # (m,), falling
    Vt: Array  # (m, n)

    def solve(self, v: Array) -> Array:
        """Return the least rates that give velocities v, (n,)."""
        solution: Array = self.Vt.T @ ((self.U.T @ v) / self.sigma)
        return solution


def chain_task(rows: tuple[Row, ...], twists: Array) -> Task:
    """Make the task of moving a chain's foot.

    Parameters
    ----------
    rows : tuple of Row
        The table, of which n rows move.
    twists : (6, m) ndarray
        Turning, then translation of the foot, base frame, that each part of a command is;
        orthonormal, m at most n.
    """
    length = size_of(rows)
    row_lengths = length * np.linalg.norm(twists[:3], axis=0) + np.linalg.norm(twists[3:], axis=0)
    square = twists.shape[1] == sum(row.joint != "fixed" for row in rows)

    @lru_cache(maxsize=4)  # rates, accelerations and determinant are asked for at one posture
    def posture_at(q: tuple[float, ...]) -> _Posture:
        here = sweep(rows, q)
        J = twists.T @ foot_jacobian(here)
        parts = np.linalg.svd(row_lengths[:, np.newaxis] * J, full_matrices=False)
        return _Posture(here, J, *parts)

    def regular(q: Floats) -> _Posture:
        found = posture_at(tuple(q))
        if not found.sigma[-1] > SINGULAR_BELOW * found.sigma[0]:
            raise SingularConfigurationError(q=q, sigma_min=float(found.sigma[-1]))
        return found

    def jacobian(q: Floats) -> Array:
        return posture_at(tuple(q)).J

    def rate(here: Sweep, qdot: Floats) -> Array:
        found: Array = twists.T @ foot_jacobian_rate(here, qdot)
        return found

    def bias(q: Floats, qdot: Floats) -> Array:
        found: Array = rate(posture_at(tuple(q)).here, qdot) @ np.asarray(qdot)
        return found

    def determinant(q: Floats) -> float:
        return float(determinants(jacobian(q)))

    def rates(q: Floats, v: Floats) -> Floats:
        qdot: list[float] = regular(q).solve(row_lengths * np.asarray(v)).tolist()
        return qdot

    def accelerations(q: Floats, qdot: Floats, a: Floats, v: Floats = (), w: Floats = ()) -> Floats:
        at = regular(q)
        moved = row_lengths[:, np.newaxis] * rate(at.here, w or qdot)
        qddot = at.solve(row_lengths * np.asarray(a) - moved @ np.asarray(qdot))
        if not square:
            y = at.U @ ((at.Vt @ np.asarray(qdot)) / at.sigma)
            swing = moved.T @ y
            qddot = qddot + swing - at.Vt.T @ (at.Vt @ swing)
        found: list[float] = qddot.tolist()
        return found

    sampled = twists.T @ sampled_jacobians(rows)
    return Task(
        jacobian=jacobian,
        bias=bias,
        determinant=determinant,
        rates=rates,
        accelerations=accelerations,
        determinant_scale=float(np.abs(determinants(sampled)).max()),
        length=length,
        row_lengths=tuple(row_lengths.tolist()),
        joints=sampled.shape[-1],
        twists=twists,
    )


def size_of(rows: Sequence[Row]) -> float:
    """Return the sum of all lengths in a table [m]; 1 m where there are none."""
    return sum(abs(row.d) + abs(row.r) for row in rows) or 1.0


@lru_cache(maxsize=16)
def sampled_jacobians(rows: tuple[Row, ...]) -> Array:
    """Return Jacobians of the foot in postures from everywhere, always the same ones.

    Parameters
    ----------
    rows : tuple of Row
        The table, of which n rows move.

    Returns
    -------
    (SAMPLES, 6, n) ndarray
        Turning first; not to be written to.
    """
    size = size_of(rows)
    widest = [math.pi if row.joint == "revolute" else size for row in rows if row.joint != "fixed"]
    random = np.random.default_rng(0).uniform(-1.0, 1.0, (SAMPLES, len(widest)))
    J = batch_jacobian(rows, random * np.array(widest))
    J.setflags(write=False)
    return J


def determinants(J: Array) -> Array:
    """Return det J or, where J has more columns than rows, Yoshikawa's sqrt(det(J J^T)).

    Parameters
    ----------
    J : (..., m, n) ndarray
        One Jacobian or many.

    Returns
    -------
    (...) ndarray
    """
    if J.shape[-1] == J.shape[-2]:
        return np.asarray(np.linalg.det(J))
    return np.asarray(np.linalg.svd(J, compute_uv=False).prod(axis=-1))
