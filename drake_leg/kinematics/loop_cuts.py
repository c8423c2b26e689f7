"""The cuts of closed loops: how far they are from closed, and how that changes with the joints.

At every cut, frame K is on one side and frame E on the other. A loop that is cut at a revolute
joint is closed where both have one origin and one z axis; at a prismatic joint, one orientation and
one z axis. That is five equations a cut; what remains is the motion of the cut joint itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import (
    Array,
    Frame,
    Link,
    Vector,
    chain_frames,
    components,
    foot_jacobian_rate,
    joint_columns,
    links_of,
)
from drake_leg.robot.robot import Robot
from drake_leg.robot.tree import Loop

TINY = 1e-300


class CutMotion(NamedTuple):
    """Motion of the joints at which the loops are cut, (loops,) each [rad or m, /s, /s^2]."""

    position: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class _Cut:
    """A cut, with the rows that lead to its two frames."""

    loop: Loop
    turns: bool  # cut at a revolute joint, not at a prismatic one
    to_cut: tuple[Link, ...]
    to_end: tuple[Link, ...]

    @property
    def tied(self) -> list[int]:
        """Components of the twist of E in K, rotation first, that are zero."""
        return [3, 4, 5, 0, 1] if self.turns else [0, 1, 2, 3, 4]

    @property
    def own(self) -> int:
        """The component that is the cut joint's rate."""
        return 2 if self.turns else 5


class Cuts:
    """The cuts of a robot's loops; q (..., n) are the positions of its tree's joints [rad or m]."""

    def __init__(self, robot: Robot) -> None:
        rows = robot.rows
        self.size = sum(abs(row.d) + abs(row.r) + abs(row.b) for row in rows) or 1.0  # [m]
        self._links = links_of(rows)
        self._cuts = tuple(
            _Cut(
                loop,
                robot.segments[loop.cut - 1].row.joint == "revolute",
                links_of(rows[: loop.cut]),
                links_of(rows[: loop.end]),
            )
            for loop in robot.loops
        )
        lengths = [component >= 3 for cut in self._cuts for component in cut.tied]
        self.units = np.where(lengths, self.size, 1.0)  # of the equations [m or rad]

    def equations(self, q: Array) -> tuple[Array, Array]:
        """Errors e (..., 5 loops) [m or rad], 0 where the loops are closed; J (..., 5 loops, n).

        ``de/dt = J qdot`` where the loops are closed, and to first order nearby.
        """
        errors, rows = [], []
        for cut, X_KE, twists in self.relative(q):
            errors.append(_errors(cut, X_KE))
            rows.append(twists[..., cut.tied, :])
        return np.concatenate(errors, axis=-1), np.concatenate(rows, axis=-2)

    def relative(self, q: Array) -> Iterator[tuple[_Cut, Array, Array]]:
        """Of every cut: pose X_KE (..., 4, 4), and the twist of E in K by all joints, (..., 6, n).

        Rotation first, at the origin of E, in the axes of K.
        """
        frames = chain_frames(self._links, components(q))
        for cut in self._cuts:
            J_K = _jacobian(cut.to_cut, frames, q)
            J_E = _jacobian(cut.to_end, frames, q)
            R_BK, p_BK = _pose(frames[cut.loop.cut - 1])
            R_BE, p_BE = _pose(frames[cut.loop.end - 1])
            R_KB = np.swapaxes(R_BK, -1, -2)
            p = p_BE - p_BK
            X_KE = np.zeros((*q.shape[:-1], 4, 4))
            X_KE[..., :3, :3] = R_KB @ R_BE
            X_KE[..., :3, 3] = (R_KB @ p[..., np.newaxis])[..., 0]
            X_KE[..., 3, 3] = 1.0
            spin = J_E[..., :3, :] - J_K[..., :3, :]
            moved = J_E[..., 3:, :] - J_K[..., 3:, :] + _crossed(p) @ J_K[..., :3, :]
            yield cut, X_KE, np.concatenate([R_KB @ spin, R_KB @ moved], axis=-2)

    def drift(self, q: Array, qdot: Array) -> Array:
        """``dJ/dt qdot`` in one posture, (5 loops,)."""
        return np.concatenate([drift[cut.tied] for cut, drift in self._drifts(q, qdot)])

    def motion(self, q: Array, qdot: Array, qddot: Array) -> CutMotion:
        """Motion of the cut joints in one posture."""
        positions, rates, accelerations = [], [], []
        for (cut, X_KE, twists), (_, drift) in zip(
            self.relative(q), self._drifts(q, qdot), strict=True
        ):
            positions.append(math.atan2(X_KE[1, 0], X_KE[0, 0]) if cut.turns else float(X_KE[2, 3]))
            rates.append(twists[cut.own] @ qdot)
            accelerations.append(twists[cut.own] @ qddot + drift[cut.own])
        return CutMotion(np.array(positions), np.array(rates), np.array(accelerations))

    def _drifts(self, q: Array, qdot: Array) -> Iterator[tuple[_Cut, Array]]:
        """Of every cut: derivative of the twist of E in K, (6,), while no joint accelerates."""
        frames = chain_frames(self._links, components(q))
        for cut in self._cuts:
            V_K, A_K = _twist(cut.to_cut, frames, qdot)
            V_E, A_E = _twist(cut.to_end, frames, qdot)
            R_BK, p_BK = _pose(frames[cut.loop.cut - 1])
            p, w = _pose(frames[cut.loop.end - 1])[1] - p_BK, V_K[:3]
            apart = V_E[3:] - V_K[3:]  # dp/dt
            spun = A_E[:3] - A_K[:3] - np.cross(w, V_E[:3] - V_K[:3])
            moved = A_E[3:] - A_K[3:] - np.cross(A_K[:3], p) - np.cross(w, apart)
            moved -= np.cross(w, apart - np.cross(w, p))
            yield cut, np.concatenate([R_BK.T @ spun, R_BK.T @ moved])


def _jacobian(links: Sequence[Link], frames: Sequence[Frame], q: Array) -> Array:
    """Jacobian of the last of some rows by all joints, (..., 6, n)."""
    found = joint_columns(links, frames[: len(links)])
    J = np.zeros((*q.shape[:-1], 6, q.shape[-1]))
    if q.ndim == 1:
        J[:, : len(found)] = np.array(found).reshape(-1, 6).T
        return J
    for number, column in enumerate(found):
        for part, entry in enumerate(column):
            J[..., part, number] = entry
    return J


def _twist(links: Sequence[Link], frames: Sequence[Frame], qdot: Array) -> tuple[Array, Array]:
    """Twist (6,) of the last of some rows, and its derivative while no joint accelerates."""
    own = frames[: len(links)]
    J = np.array(joint_columns(links, own)).reshape(-1, 6).T
    moved = qdot[: J.shape[1]]
    if not len(moved):
        return np.zeros(6), np.zeros(6)
    return J @ moved, foot_jacobian_rate(links, own, moved.tolist()) @ moved


def _pose(frame: Frame) -> tuple[Array, Array]:
    """Rotation (..., 3, 3) and origin (..., 3) of a frame."""
    x, y, z, origin = map(_vector, frame)
    return np.stack([x, y, z], axis=-1), origin


def _vector(parts: Vector) -> Array:
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _crossed(p: Array) -> Array:
    """Matrix of ``p x``, (..., 3, 3)."""
    matrix = np.zeros((*p.shape, 3))
    for row, column, part in ((2, 1, 0), (0, 2, 1), (1, 0, 2)):
        matrix[..., row, column], matrix[..., column, row] = p[..., part], -p[..., part]
    return matrix


def _errors(cut: _Cut, X_KE: Array) -> Array:
    """Five errors of a cut, (..., 5) [m or rad]."""
    R, p = X_KE[..., :3, :3], X_KE[..., :3, 3]
    if cut.turns:  # the rotation from one z axis to the other
        turned = _turn(np.stack([-R[..., 1, 2], R[..., 0, 2]], axis=-1), R[..., 2, 2])
        return np.concatenate([p, turned], axis=-1)
    twice = [R[..., i, j] - R[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))]
    cosine = 0.5 * (np.trace(R, axis1=-2, axis2=-1) - 1.0)
    return np.concatenate([_turn(0.5 * np.stack(twice, axis=-1), cosine), p[..., :2]], axis=-1)


def _turn(axis: Array, cosine: Array) -> Array:
    """Rotation vector (..., k) [rad], given its axis times the sine, and the cosine."""
    sine = np.linalg.norm(axis, axis=-1)
    angle = np.arctan2(sine, cosine)
    some = np.zeros_like(axis)
    some[..., 0] = 1.0  # where the axis is undefined: half a turn
    ratio = np.where(sine > TINY, angle / np.maximum(sine, TINY), 1.0)[..., np.newaxis]
    flipped = ((sine <= TINY) & (cosine < 0.0))[..., np.newaxis]
    return np.where(flipped, math.pi * some, ratio * axis)
