"""Moves the foot of any robot: in closed form, or numerically, one posture at a time.

A redundant robot takes the smallest of all rates that move the foot as commanded (Moore and
Penrose): ``qdot = J^T y`` with ``J J^T y = v``. Its accelerations are the derivative of that,

``qddot = J^+ (a - dJ/dt qdot) + (1 - J^+ J) (dJ/dt)^T y``.

A posture is evaluated in plain floats, for use inside a simulation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Self

import numpy as np

from drake_leg.arguments import counted, shown
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.differentiable import DifferentiableChain
from drake_leg.kinematics.khalil import (
    Array,
    Frame,
    chain_frames,
    chain_length,
    cross,
    foot_jacobian_rate,
    joint_columns,
    links_of,
    one_vector,
    real_numbers,
)
from drake_leg.kinematics.leg import LegGeometry, MovableLeg, is_hexabot_leg
from drake_leg.kinematics.movable import (
    SINGULAR_BELOW,
    Floats,
    Movable,
    lapack,
    smallest_singular_value,
)
from drake_leg.kinematics.pendulum import PendulumModel, is_pendulum
from drake_leg.kinematics.scara import ScaraGeometry, is_scara
from drake_leg.robot.robot import Robot, Row, Segment, require_robot
from drake_leg.robot.tree import require_one_foot
from drake_leg.units import exact_degrees

TASKS = ("position", "pose")
SAMPLES = 256  # random postures in which a chain's freedoms are measured
LEAST_LEVER = 1e-3  # of the chain's length: a shorter lever does not count as moving the foot
RANK_TOLERANCE = 1e-9  # of the greatest singular value
TWO_TURNS = 4.0 * math.pi  # [rad], the largest angle that is not asked about


def foot_frame(rows: Sequence[Row], q: Floats) -> Frame:
    """Axes and position of the foot in one posture, in the base frame."""
    return chain_frames(links_of(rows), (q, math.cos, math.sin))[-1]


def twist_between(here: Frame, goal: Frame) -> Array:
    """Twist from one pose of the foot to another, rotation first, (6,); exact to first order."""
    turns = [cross(axis, there) for axis, there in zip(here[:3], goal[:3], strict=True)]
    turning = (0.5 * sum(parts) for parts in zip(*turns, strict=True))
    return np.array([*turning, *(b - a for a, b in zip(here[3], goal[3], strict=True))])


class _Posture:
    """A chain in one posture: J, and what follows from it, computed once and only if needed."""

    def __init__(self, chain: MovableChain, q: tuple[float, ...]) -> None:
        self.frames = chain_frames(chain.links, (q, math.cos, math.sin))
        self.J: Array = chain.twists.T @ np.array(joint_columns(chain.links, self.frames)).T
        self._lengths = chain.lengths

    @cached_property
    def svd(self) -> tuple[Array, Array, Array]:
        """U (m, m), sigma (m,), Vt (m, n) of J, its rows scaled to lengths."""
        U, sigma, Vt, _ = lapack().dgesdd(self._lengths[:, np.newaxis] * self.J, full_matrices=0)
        return U, sigma, Vt

    @cached_property
    def sigma_min(self) -> float:
        """Smallest singular value of J, its rows scaled to lengths."""
        _, sigma, _, _ = lapack().dgesdd(self._lengths[:, np.newaxis] * self.J, compute_uv=0)
        return float(sigma[-1])

    @cached_property
    def determinant(self) -> float:
        """Det J by its LU factors, or ``sqrt(det(J J^T))`` by the QR factors of J^T."""
        if self.J.shape[0] < self.J.shape[1]:
            factors, *_ = lapack().dgeqrf(self.J.T)
            return abs(float(factors.diagonal().prod()))
        factors, pivots, _ = lapack().dgetrf(self.J)
        swaps = sum(row != pivot for row, pivot in enumerate(pivots.tolist()))
        product = float(factors.diagonal().prod())
        return -product if swaps % 2 else product

    def solve(self, v: Array) -> Array:
        """Smallest rates that produce velocities v, scaled to lengths, (n,)."""
        U, sigma, Vt = self.svd
        solution: Array = Vt.T @ ((U.T @ v) / sigma)
        return solution


class MovableChain(Movable):
    """Any chain, its Jacobian inverted numerically; n rows of its table move.

    The twists (6, m), m at most n, are those of the foot for each component of a command, rotation
    first, orthonormal, in the base frame. If the chain ``varies``, they hold in one posture only.
    """

    def __init__(self, rows: tuple[Row, ...], twists: Array, *, varies: bool = False) -> None:
        self.rows, self.links = rows, links_of(rows)
        self.twists = twists
        self.varies = varies
        self.turning = tuple(row.joint == "revolute" for row in rows if row.joint != "fixed")
        self.length = chain_length(rows)
        turns, moves = np.linalg.norm(twists[:3], axis=0), np.linalg.norm(twists[3:], axis=0)
        self.lengths = self.length * turns + moves
        self.row_lengths = tuple(self.lengths.tolist())
        sampled = determinants(twists.T @ sampled_jacobians(rows))
        self.determinant_scale = float(np.abs(sampled).max())
        # Rates, accelerations and determinant are computed one after another in the same posture.
        self._posture_at = lru_cache(maxsize=4)(partial(_Posture, self))

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, by the chain of transforms."""
        return np.array(self._posture_at(tuple(q)).frames[-1][3])

    def jacobian(self, q: Floats) -> Array:
        """J, (m, n)."""
        return self._posture_at(tuple(q)).J

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (m,)."""
        bias: Array = self._rate(self._posture_at(tuple(q)), qdot) @ np.asarray(qdot)
        return bias

    def determinant(self, q: Floats) -> float:
        """Det J or, of a redundant chain, Yoshikawa's ``sqrt(det(J J^T))``."""
        return self._posture_at(tuple(q)).determinant

    def sigma_min(self, q: Floats) -> float:
        """Smallest singular value of J, its rows scaled to lengths [m]."""
        return self._posture_at(tuple(q)).sigma_min

    def sigma_mins(self, q: Array) -> Array:
        """``sigma_min`` of many postures (rows, n), (rows,), with the twists of this one."""
        J = self.twists.T @ khalil.jacobian(self.rows, q)
        return smallest_singular_value(self.lengths[:, np.newaxis] * J)

    def rates(self, q: Floats, v: Floats) -> Floats:
        """Smallest rates that produce v."""
        qdot: list[float] = self._regular(q).solve(self.lengths * np.asarray(v)).tolist()
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
        moved = self.lengths[:, np.newaxis] * self._rate(at, qdot if w is None else w)
        qddot = at.solve(self.lengths * np.asarray(a) - moved @ np.asarray(qdot))
        if self.is_redundant:
            U, sigma, Vt = at.svd
            y = U @ ((Vt @ np.asarray(qdot)) / sigma)
            swing = moved.T @ y
            qddot = qddot + swing - Vt.T @ (Vt @ swing)
        found: list[float] = qddot.tolist()
        return found

    def differentiable(self) -> DifferentiableChain:
        """The chain for joint positions that carry derivatives."""
        return DifferentiableChain(self, self.rows)

    def at(self, q: Floats) -> Self:
        """The chain with the twists of a posture: itself, unless it ``varies``."""
        if not self.varies:
            return self
        return type(self)(self.rows, tangent_twists(self.rows, q), varies=True)

    def _regular(self, q: Floats) -> _Posture:
        found = self._posture_at(tuple(q))
        _, sigma, _ = found.svd
        if not sigma[-1] > SINGULAR_BELOW * sigma[0]:
            raise SingularConfigurationError(q=q, sigma_min=float(sigma[-1]))
        return found

    def _rate(self, at: _Posture, w: Floats) -> Array:
        """``dJ/dt`` with the joints moving at rates w, (m, n)."""
        rate: Array = self.twists.T @ foot_jacobian_rate(self.links, at.frames, w)
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


def geometry_of(robot: Robot) -> LegGeometry | ScaraGeometry | PendulumModel | None:
    """Dimensions for a robot's closed forms; None if it has no closed forms."""
    if is_hexabot_leg(robot):
        return LegGeometry.from_robot(robot)
    if is_scara(robot):
        return ScaraGeometry.from_robot(robot)
    return PendulumModel.from_robot(robot) if is_pendulum(robot) else None


def movable(robot: Robot, q0: Sequence[float] | None = None, task: str | None = None) -> Movable:
    """Choose how a robot's foot is moved: in closed form for the hexabot's leg, else numerically.

    Parameters
    ----------
    q0 : (n,) sequence of float, optional
        Initial posture [rad or m], on which the foot's motions may depend. All 0 by default.
    task : {"position", "pose"}, optional
        Whether only the foot's translation is commanded, or its rotation, too. By default the
        pose, if there are enough joints for it and they can rotate the foot; else the position.

    Returns
    -------
    Movable
        Its velocities are in m/s and, of a pose, rad/s; base frame.

    Raises
    ------
    InvalidValueError
        If the robot cannot do that, or the number of joint positions is wrong.

    Examples
    --------
    >>> from drake_leg import LEG_B, movable
    >>> leg = movable(LEG_B)
    >>> leg.joints, leg.size  # three joints, three velocities of the foot
    (3, 3)
    >>> q, v = [1.57, -0.87, -1.57], [0.05, 0.0, 0.0]
    >>> qdot = leg.rates(q, v)
    >>> bool(abs(leg.jacobian(q) @ qdot - v).max() < 1e-12)
    True
    """
    require_robot(robot)
    require_one_foot(robot)
    if task is not None and task not in TASKS:
        raise InvalidValueError(f"the task is {shown(task)}; it must be {' or '.join(TASKS)}")
    posture = [0.0] * len(robot.moving) if q0 is None else joint_positions("q0", robot, q0)
    if is_hexabot_leg(robot) and task != "pose":
        return MovableLeg(LegGeometry.from_robot(robot))
    span = _constant_span(robot, task)
    if span is not None:
        return MovableChain(robot.rows, span)
    return MovableChain(robot.rows, tangent_twists(robot.rows, posture), varies=True)


def _constant_span(robot: Robot, task: str | None) -> Array | None:
    """Choose the twists that are commanded in every posture; None if they vary."""
    position, pose = freedoms(robot.rows)
    if position.rank == 0:
        raise InvalidValueError(
            f"no joint of {robot.name!r} moves its foot, the last frame of its table: put the foot "
            "farther out by a fixed row at the table's end"
        )
    if (
        pose.span is not None
        and task != "position"
        and (task == "pose" or pose.rank > position.rank)
    ):
        return pose.span
    if task == "pose":
        raise InvalidValueError(
            f"{robot.name!r} cannot hold its foot's orientation with its "
            f"{joints_in_words(robot)} while the foot moves",
            advice="choose `task='position'`",
        )
    return position.span


def joint_positions(
    what: str, robot: Robot, q: Sequence[float], *, least: int | None = None
) -> list[float]:
    """Check joint positions [rad or m]: one for each joint that moves, or ``least`` at least.

    Angles that look like degrees are refused as in ``require_radians``.
    """
    values, count = real_numbers(what, q), len(robot.moving)
    if values.ndim != 1:
        found = f"has shape {values.shape}" if values.ndim else f"is {shown(q)}"
        raise InvalidValueError(f"{what} {found}; it must be {counted(count, 'joint position')}")
    if not (least or count) <= len(values) <= count:
        raise InvalidValueError(
            f"{what} has {counted(len(values), 'number')}; {robot.name} has "
            f"{counted(count, 'joint position')}"
        )
    positions: list[float] = one_vector(what, values, len(values)).tolist()
    require_radians(positions, robot.moving)
    return positions


def require_radians(q: Sequence[float], joints: Sequence[Segment]) -> None:
    """Refuse an angle beyond two turns, unless it was converted from degrees: it looks like them.

    Raises
    ------
    InvalidValueError
        With the angle.
    """
    for angle, joint in zip(q, joints, strict=False):
        if joint.row.joint == "revolute" and abs(angle) > TWO_TURNS:
            degrees = exact_degrees(angle)
            if degrees is None or degrees != round(degrees, 6):
                raise InvalidValueError(
                    f"joint {joint.joint} is at {angle:g} rad, which is more than two turns",
                    advice=f"if degrees were meant, give math.radians({angle:g})",
                )


def base_rotation(robot: Robot) -> Array:
    """Rotation R_W0 of the base in the world, (3, 3)."""
    return np.eye(3) if robot.base_pose is None else np.array(robot.base_pose)[:3, :3]


def joints_in_words(robot: Robot) -> str:
    """Number of joints in words, such as "3 joints"."""
    count = len(robot.moving)
    return f"{count} joint{'s' * (count > 1)}"
