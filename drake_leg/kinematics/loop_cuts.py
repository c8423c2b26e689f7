"""The cuts of closed loops: how far they are from closed, and how that changes with the joints.

At every cut, frame K is on one side and frame E on the other. A loop that is cut at a revolute
joint is closed where both have one origin and one z axis; at a prismatic joint, one orientation and
one z axis. That is five equations a cut; what remains is the motion of the cut joint itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import (
    STILL,
    Array,
    Frame,
    Link,
    Vector,
    chain_frames,
    components,
    cross,
    foot_jacobian_rate,
    joint_columns,
    links_of,
)
from drake_leg.robot.robot import Robot
from drake_leg.robot.tree import Loop

TINY = 1e-300
ZERO: Vector = (0.0, 0.0, 0.0)


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

    def frames(self, frames: Sequence[Frame]) -> tuple[Frame, Frame]:
        """Frames K and E, of those of all rows."""
        return frames[self.loop.cut - 1], frames[self.loop.end - 1]

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
        frames = chain_frames(self._links, components(q))
        errors: list[Any] = []
        rows: list[list[Any]] = []
        for cut in self._cuts:
            errors += _errors(cut, frames)
            twists = _twists(cut, frames, q.shape[-1])
            rows += [[twist[component] for twist in twists] for component in cut.tied]
        return _assembled(errors, q.shape[:-1]), _assembled(rows, q.shape[:-1])

    def drift(self, q: Array, qdot: Array) -> Array:
        """``dJ/dt qdot`` in one posture, (5 loops,)."""
        return np.array([drift[part] for cut, drift in self._drifts(q, qdot) for part in cut.tied])

    def motion(self, q: Array, qdot: Array, qddot: Array) -> CutMotion:
        """Motion of the cut joints in one posture."""
        frames = chain_frames(self._links, components(q))
        found = []
        for cut, drift in self._drifts(q, qdot):
            (x, y, z, o), (x_E, _, _, o_E) = cut.frames(frames)
            position = math.atan2(dot(y, x_E), dot(x, x_E)) if cut.turns else dot(z, minus(o_E, o))
            own = np.array([twist[cut.own] for twist in _twists(cut, frames, len(q))])
            found.append((position, own @ qdot, own @ qddot + drift[cut.own]))
        return CutMotion(*np.array(found, dtype=np.float64).T)

    def _drifts(self, q: Array, qdot: Array) -> Iterator[tuple[_Cut, list[float]]]:
        """Of every cut: derivative of the twist of E in K, while no joint accelerates."""
        frames = chain_frames(self._links, components(q))
        for cut in self._cuts:
            (x, y, z, o), (*_, o_E) = cut.frames(frames)
            (w, v), (w_dot, v_dot) = _moving(cut.to_cut, frames, qdot)
            (w_E, v_E), (w_dot_E, v_dot_E) = _moving(cut.to_end, frames, qdot)
            p, p_dot = minus(o_E, o), minus(v_E, v)
            spun = minus(minus(w_dot_E, w_dot), cross(w, minus(w_E, w)))
            moved = minus(minus(v_dot_E, v_dot), cross(w_dot, p))
            moved = minus(minus(moved, cross(w, p_dot)), cross(w, minus(p_dot, cross(w, p))))
            yield cut, [dot(axis, part) for part in (spun, moved) for axis in (x, y, z)]


def dot(u: Vector, v: Vector) -> Any:  # noqa: ANN401 - a float, or an array of a batch
    """Scalar product of two vectors."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def minus(u: Vector, v: Vector) -> Vector:
    """Difference of two vectors."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


def _twists(cut: _Cut, frames: Sequence[Frame], joints: int) -> list[tuple[Any, ...]]:
    """Twist of E in K by each joint: rotation first, at the origin of E, in the axes of K."""
    (x, y, z, o), (*_, o_E) = cut.frames(frames)
    p = minus(o_E, o)
    here = joint_columns(cut.to_cut, frames[: cut.loop.cut])
    there = joint_columns(cut.to_end, frames[: cut.loop.end])
    twists = []
    for index in range(joints):
        wx, wy, wz, vx, vy, vz = there[index] if index < len(there) else STILL
        if index < len(here) and here[index] is not STILL:
            ux, uy, uz, *moved = here[index]
            px, py, pz = cross(p, (ux, uy, uz))
            wx, wy, wz = wx - ux, wy - uy, wz - uz
            vx, vy, vz = vx - moved[0] + px, vy - moved[1] + py, vz - moved[2] + pz
        w, v = (wx, wy, wz), (vx, vy, vz)
        twists.append((dot(x, w), dot(y, w), dot(z, w), dot(x, v), dot(y, v), dot(z, v)))
    return twists


def _moving(
    links: Sequence[Link], frames: Sequence[Frame], qdot: Array
) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector]]:
    """Angular velocity and velocity of the last of some rows, and their derivatives.

    No joint accelerates.
    """
    own = frames[: len(links)]
    J = np.array(joint_columns(links, own)).reshape(-1, 6).T
    moved = qdot[: J.shape[1]]
    if not len(moved):
        return (ZERO, ZERO), (ZERO, ZERO)
    twist = (J @ moved).tolist()
    drift = (foot_jacobian_rate(links, own, moved.tolist()) @ moved).tolist()
    return (tuple(twist[:3]), tuple(twist[3:])), (tuple(drift[:3]), tuple(drift[3:]))


def _errors(cut: _Cut, frames: Sequence[Frame]) -> list[Any]:
    """Five errors of a cut [m or rad]."""
    (x, y, z, o), (x_E, y_E, z_E, o_E) = cut.frames(frames)
    p = minus(o_E, o)
    if cut.turns:  # the rotation from one z axis to the other
        return [dot(x, p), dot(y, p), dot(z, p), *_turn((-dot(y, z_E), dot(x, z_E)), dot(z, z_E))]
    twice = (
        dot(z, y_E) - dot(y, z_E),
        dot(x, z_E) - dot(z, x_E),
        dot(y, x_E) - dot(x, y_E),
    )
    cosine = 0.5 * (dot(x, x_E) + dot(y, y_E) + dot(z, z_E) - 1.0)
    return [*_turn(tuple(0.5 * each for each in twice), cosine), dot(x, p), dot(y, p)]


def _turn(axis: tuple[Any, ...], cosine: Any) -> list[Any]:  # noqa: ANN401
    """Rotation vector [rad], given its axis times the sine, and the cosine."""
    sine = np.sqrt(sum(part * part for part in axis))
    angle = np.arctan2(sine, cosine)
    ratio = angle / np.maximum(sine, TINY)
    ratio = np.where(sine > TINY, ratio, 1.0)
    first, *others = (ratio * part for part in axis)
    half = (sine <= TINY) & (cosine < 0.0)  # half a turn, about whatever axis
    return [np.where(half, math.pi, first), *others]


def _assembled(entries: Sequence[Any], batch: tuple[int, ...]) -> Array:
    """Assemble a vector (*batch, k) or a matrix (*batch, k, n) from its entries."""
    if not batch:
        return np.array(entries, dtype=np.float64)
    if not isinstance(entries[0], list):
        return np.stack(np.broadcast_arrays(*entries), axis=-1)
    matrix = np.empty((*batch, len(entries), len(entries[0])))
    for i, row in enumerate(entries):
        for j, entry in enumerate(row):
            matrix[..., i, j] = entry
    return matrix
