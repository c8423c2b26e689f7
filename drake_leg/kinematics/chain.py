"""Velocity kinematics of any chain, by one walk from the base to the foot.

A redundant robot takes the smallest of all rates that move the foot as commanded (Moore and
Penrose): ``qdot = J^T y`` with ``J J^T y = v``. Its accelerations are the derivative of that,

``qddot = J^+ (a - dJ/dt qdot) + (1 - J^+ J) (dJ/dt)^T y``.

The walk takes plain floats, for use inside a simulation; ``khalil`` does the same for batches.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, Self

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.khalil import Array, chain_length
from drake_leg.kinematics.movable import SINGULAR_BELOW, Floats, Movable
from drake_leg.robot.robot import Row

SAMPLES = 256  # random postures in which a chain's freedoms are measured
LEAST_LEVER = 1e-3  # of the chain's length: a shorter lever does not count as moving the foot
RANK_TOLERANCE = 1e-9  # of the greatest singular value

Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)


class Sweep(NamedTuple):
    """A chain in a posture, in the base frame."""

    turning: tuple[bool, ...]  # of every moving row: revolute, not prismatic
    axes: tuple[Vector, ...]  # z of every moving row
    origins: tuple[Vector, ...]  # of every moving row [m]
    foot: Vector  # [m]
    rotation: tuple[Vector, Vector, Vector]  # x, y, z of the last frame


def sweep(rows: Sequence[Row], q: Floats) -> Sweep:
    """Walk from the base to the foot of a table of which n rows move, at q (n,) [rad or m]."""
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    o = ZERO
    turning, axes, origins = [], [], []
    positions = iter(q)
    for row in rows:
        theta, r = row.theta, row.r
        if row.joint == "revolute":
            theta += next(positions)
        elif row.joint == "prismatic":
            r += next(positions)
        c, s = math.cos(theta), math.sin(theta)
        ca, sa = math.cos(row.alpha), math.sin(row.alpha)
        bent = _sum(ca, y, sa, z)
        z = _sum(-sa, y, ca, z)
        o = _sum(1.0, _sum(1.0, o, row.d, x), r, z)
        x, y = _sum(c, x, s, bent), _sum(-s, x, c, bent)
        if row.joint != "fixed":
            turning.append(row.joint == "revolute")
            axes.append(z)
            origins.append(o)
    return Sweep(tuple(turning), tuple(axes), tuple(origins), o, (x, y, z))


def foot_jacobian(here: Sweep) -> Array:
    """Jacobian of the foot: ``[z; z x OF]`` of a revolute joint, ``[0; z]`` of a prismatic one.

    Rows 0-2 are angular, rows 3-5 translational, (6, n), as those of ``khalil.jacobian``.
    """
    columns = [
        (*z, *_cross(z, _sum(1.0, here.foot, -1.0, o))) if turns else (*ZERO, *z)
        for turns, z, o in zip(here.turning, here.axes, here.origins, strict=True)
    ]
    return np.array(columns, dtype=np.float64).T


def foot_jacobian_rate(here: Sweep, qdot: Floats) -> Array:
    """Derivative of the Jacobian in time, (6, n), while the joints move.

    An axis turns with the body before it, ``dz/dt = w x z``, and an origin moves with it.
    """
    w, v, before = ZERO, ZERO, ZERO
    moved = []
    for turns, z, o, rate in zip(here.turning, here.axes, here.origins, qdot, strict=True):
        v = _sum(1.0, v, 1.0, _cross(w, _sum(1.0, o, -1.0, before)))
        z_dot = _cross(w, z)
        if turns:
            w = _sum(1.0, w, rate, z)
        else:
            v = _sum(1.0, v, rate, z)
        moved.append((z_dot, v))
        before = o
    v_foot = _sum(1.0, v, 1.0, _cross(w, _sum(1.0, here.foot, -1.0, before)))
    columns = []
    for turns, z, o, (z_dot, v_o) in zip(here.turning, here.axes, here.origins, moved, strict=True):
        if turns:
            arm = _cross(z_dot, _sum(1.0, here.foot, -1.0, o))
            swing = _cross(z, _sum(1.0, v_foot, -1.0, v_o))
            columns.append((*z_dot, *_sum(1.0, arm, 1.0, swing)))
        else:
            columns.append((*ZERO, *z_dot))
    return np.array(columns, dtype=np.float64).T


def twist_between(here: Sweep, goal: Sweep) -> Array:
    """Twist from one pose of the foot to another, rotation first, (6,); exact to first order."""
    turning = ZERO
    for axis, there in zip(here.rotation, goal.rotation, strict=True):
        turning = _sum(1.0, turning, 0.5, _cross(axis, there))
    return np.array([*turning, *_sum(1.0, goal.foot, -1.0, here.foot)])


def _sum(a: float, u: Vector, b: float, v: Vector) -> Vector:
    return a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]


def _cross(u: Vector, v: Vector) -> Vector:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


class _Posture(NamedTuple):
    """A chain in one posture, with J and the SVD of J after its rows are scaled to lengths."""

    here: Sweep
    J: Array  # (m, n), not scaled
    U: Array  # (m, m)
    sigma: Array  # (m,), descending
    Vt: Array  # (m, n)

    def solve(self, v: Array) -> Array:
        """Smallest rates that produce velocities v, (n,)."""
        solution: Array = self.Vt.T @ ((self.U.T @ v) / self.sigma)
        return solution


class MovableChain(Movable):
    """Any chain, its Jacobian inverted numerically.

    Parameters
    ----------
    rows : tuple of Row
        The table, of which n rows move.
    twists : (6, m) ndarray
        Twist of the foot for each component of a command, rotation first, base frame;
        orthonormal, m at most n.
    varies : bool
        Whether the twists are valid in one posture only.
    """

    def __init__(self, rows: tuple[Row, ...], twists: Array, *, varies: bool = False) -> None:
        self.rows = rows
        self.twists = twists
        self.varies = varies
        self.turning = tuple(row.joint == "revolute" for row in rows if row.joint != "fixed")
        self.length = chain_length(rows)
        turns, moves = np.linalg.norm(twists[:3], axis=0), np.linalg.norm(twists[3:], axis=0)
        self._row_lengths = self.length * turns + moves
        self.row_lengths = tuple(self._row_lengths.tolist())
        sampled = determinants(twists.T @ sampled_jacobians(rows))
        self.determinant_scale = float(np.abs(sampled).max())
        # Rates, accelerations and determinant are computed one after another in the same posture.
        self._posture_at = lru_cache(maxsize=4)(self._decomposed)

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, by the chain of transforms."""
        return np.array(self._posture_at(tuple(q)).here.foot)

    def jacobian(self, q: Floats) -> Array:
        """J, (m, n)."""
        return self._posture_at(tuple(q)).J

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (m,)."""
        bias: Array = self._rate(self._posture_at(tuple(q)), qdot) @ np.asarray(qdot)
        return bias

    def determinant(self, q: Floats) -> float:
        """Det J or, of a redundant chain, Yoshikawa's ``sqrt(det(J J^T))``."""
        return float(determinants(self.jacobian(q)))

    def rates(self, q: Floats, v: Floats) -> Floats:
        """Smallest rates that produce v."""
        qdot: list[float] = self._regular(q).solve(self._row_lengths * np.asarray(v)).tolist()
        return qdot

    def accelerations(
        self,
        q: Floats,
        qdot: Floats,
        a: Floats,
        v: Floats | None = None,
        w: Floats | None = None,
    ) -> Floats:
        """Derivative of the smallest rates."""
        at = self._regular(q)
        moved = self._row_lengths[:, np.newaxis] * self._rate(at, qdot if w is None else w)
        qddot = at.solve(self._row_lengths * np.asarray(a) - moved @ np.asarray(qdot))
        if self.is_redundant:
            y = at.U @ ((at.Vt @ np.asarray(qdot)) / at.sigma)
            swing = moved.T @ y
            qddot = qddot + swing - at.Vt.T @ (at.Vt @ swing)
        found: list[float] = qddot.tolist()
        return found

    def at(self, q: Floats) -> Self:
        """The chain with the twists of a posture: itself, unless it ``varies``."""
        if not self.varies:
            return self
        return type(self)(self.rows, tangent_twists(self.rows, q), varies=True)

    def _decomposed(self, q: tuple[float, ...]) -> _Posture:
        here = sweep(self.rows, q)
        J = self.twists.T @ foot_jacobian(here)
        return _Posture(
            here, J, *np.linalg.svd(self._row_lengths[:, np.newaxis] * J, full_matrices=False)
        )

    def _regular(self, q: Floats) -> _Posture:
        found = self._posture_at(tuple(q))
        if not found.sigma[-1] > SINGULAR_BELOW * found.sigma[0]:
            raise SingularConfigurationError(q=q, sigma_min=float(found.sigma[-1]))
        return found

    def _rate(self, at: _Posture, w: Floats) -> Array:
        """``dJ/dt`` with the joints moving at rates w, (m, n)."""
        rate: Array = self.twists.T @ foot_jacobian_rate(at.here, w)
        return rate


@lru_cache(maxsize=16)
def sampled_jacobians(rows: tuple[Row, ...]) -> Array:
    """Jacobians of the foot in random postures, always the same ones, (SAMPLES, 6, n).

    Rows 0-2 are angular. The array is shared and read-only.
    """
    size = chain_length(rows)
    widest = [math.pi if row.joint == "revolute" else size for row in rows if row.joint != "fixed"]
    random = np.random.default_rng(0).uniform(-1.0, 1.0, (SAMPLES, len(widest)))
    J = khalil.jacobian(rows, random * np.array(widest))
    J.setflags(write=False)
    return J


def determinants(J: Array) -> Array:
    """Det J of Jacobians (..., m, n), or ``sqrt(det(J J^T))`` where n exceeds m, (...)."""
    if J.shape[-1] == J.shape[-2]:
        return np.asarray(np.linalg.det(J))
    return np.asarray(np.linalg.svd(J, compute_uv=False).prod(axis=-1))


@dataclass(frozen=True)
class Freedom:
    """Which motions a chain's foot can make, measured in random postures.

    If the motions of all postures together span no more than those of one, that span can be
    commanded: a line, a plane, all of space. A foot that moves on a sphere has no such span.
    """

    rank: int  # of the motions at one posture
    span: Array | None  # (6, rank), orthonormal twists, rotation first; None: it varies


@lru_cache(maxsize=16)
def freedoms(rows: tuple[Row, ...]) -> tuple[Freedom, Freedom]:
    """Freedoms of a chain's foot: of its translation alone, and of rotation and translation."""
    J = sampled_jacobians(rows)
    only = J.copy()
    only[:, :3] = 0.0
    size = chain_length(rows)
    return _freedom(only, size), _freedom(J, size)


def tangent_twists(rows: tuple[Row, ...], q: Floats) -> Array:
    """Translations of the foot that the joints can make in one posture, orthonormal, (6, rank)."""
    rank = freedoms(rows)[0].rank
    U, _, _ = np.linalg.svd(khalil.jacobian(rows, q)[3:])
    return np.vstack([np.zeros((3, rank)), U[:, :rank]])


def _freedom(J: Array, size: float) -> Freedom:
    """Compare the span of one posture's motions with that of all postures, (samples, 6, n)."""
    scaled = np.array([size] * 3 + [1.0] * 3)[:, np.newaxis] * J
    each = np.linalg.svd(scaled, compute_uv=False)
    greatest = max(float(each.max()), LEAST_LEVER * size)
    rank = int((each > RANK_TOLERANCE * greatest).sum(axis=1).max())
    U, sigma, _ = np.linalg.svd(np.hstack(list(scaled)), full_matrices=False)
    together = int((sigma > RANK_TOLERANCE * greatest).sum())
    return Freedom(rank, _along_axes(U[:, :together]) if together == rank else None)


def _along_axes(span: Array) -> Array:
    """Choose orthonormal vectors of a span along the axes, or near to them."""
    projector = span @ span.T
    straight = np.round(projector)
    if np.abs(projector - straight).max() < RANK_TOLERANCE:
        projector = straight
    chosen: list[Array] = []
    for column in projector[:, [3, 4, 5, 0, 1, 2]].T:  # translations first
        left = column - sum((np.dot(column, one) * one for one in chosen), np.zeros(6))
        size = float(np.linalg.norm(left))
        if size > 1e-6:
            chosen.append(left / size)
    along = np.array(chosen[: span.shape[1]]).reshape(-1, 6).T
    return np.where(np.abs(along) < RANK_TOLERANCE, 0.0, along)
