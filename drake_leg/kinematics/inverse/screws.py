"""A chain as the axes of its joints: where they are while all positions are zero.

The pose of the foot is ``X_BF(q) = M_1(q_1) ... M_n(q_n) X_BF(0)``, where ``M_i`` turns about the
axis of joint i, or slides along it. Fixed rows and the choice of the frames are in ``X_BF(0)``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import Array, base_transforms, cross, moving_rows
from drake_leg.robot.robot import Row

PARALLEL = 1e-9  # sine of the angle between two axes that count as parallel


class Screw(NamedTuple):
    """The axis of a joint, in the base frame."""

    turns: bool  # revolute, not prismatic
    z: Array  # (3,), unit vector
    o: Array  # (3,) [m], a point of the axis


class Normal(NamedTuple):
    """The common normal of two axes a and b."""

    n: Array  # (3,), unit vector, at right angles to both
    d: float  # [m], from a to b along it
    sine: float  # of the angle from a to b about it
    cosine: float
    foot_a: Array  # (3,) [m], where it meets a
    foot_b: Array  # (3,) [m]


def screws_of(rows: Sequence[Row]) -> list[Screw]:
    """The axes of the joints of a chain whose positions are zero."""
    moving = moving_rows(rows)
    frames = base_transforms(rows, np.zeros(len(moving)))
    return [
        Screw(rows[index].joint == "revolute", frames[index, :3, 2], frames[index, :3, 3])
        for index in moving
    ]


def vector_product(u: Array, v: Array) -> Array:
    """``u x v`` of two single vectors; ``numpy.cross`` takes ten times as long."""
    return np.array(cross(u.tolist(), v.tolist()))


def motion(screw: Screw, q: float) -> Array:
    """Rigid motion of a joint, (4, 4)."""
    M = np.eye(4)
    if not screw.turns:
        M[:3, 3] = q * screw.z
        return M
    M[:3, :3] = rotation(screw.z, q)
    M[:3, 3] = screw.o - M[:3, :3] @ screw.o
    return M


def rotation(z: Array, angle: float) -> Array:
    """Rotation about the unit vector z by an angle [rad], (3, 3)."""
    x, y, w = z.tolist()
    K = np.array([[0.0, -w, y], [w, 0.0, -x], [-y, x, 0.0]])
    R: Array = np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K)
    return R


def motions(screws: Sequence[Screw], q: Sequence[float]) -> Array:
    """Product of the motions of some joints, (4, 4)."""
    M = np.eye(4)
    for screw, position in zip(screws, q, strict=True):
        M = M @ motion(screw, position)
    return M


def inverse(X: Array) -> Array:
    """Inverse of a rigid motion, (4, 4)."""
    M = np.eye(4)
    M[:3, :3] = X[:3, :3].T
    M[:3, 3] = -X[:3, :3].T @ X[:3, 3]
    return M


def moved(screw: Screw, X: Array) -> Screw:
    """The axis after a rigid motion; ``X M(q) X^-1`` is the motion about it."""
    return Screw(screw.turns, X[:3, :3] @ screw.z, moved_point(X, screw.o))


def moved_point(X: Array, p: Array) -> Array:
    """The point after a rigid motion, (3,) [m]."""
    point: Array = X[:3, :3] @ p + X[:3, 3]
    return point


def carried(screw: Screw, t: Array, p: Array) -> Array:
    """The point p at positions t (k,) of a joint, (k, 3) [m]."""
    if not screw.turns:
        path: Array = p + t[:, np.newaxis] * screw.z
        return path
    return screw.o + turned(screw.z, t, p - screw.o)


def turned(z: Array, t: Array, v: Array) -> Array:
    """The vector v turned about z by angles t (k,) [rad], (k, 3)."""
    along = (z @ v) * z
    circle: Array = (
        along
        + np.cos(t)[:, np.newaxis] * (v - along)
        + np.sin(t)[:, np.newaxis] * vector_product(z, v)
    )
    return circle


def angle_about(z: Array, u: Array, v: Array) -> float:
    """Angle [rad] about z from the half-plane of u to that of v."""
    across_u, across_v = vector_product(z, u), vector_product(z, v)
    return math.atan2(z @ vector_product(across_u, across_v), across_u @ across_v)


def angle_between(u: Array, v: Array) -> float:
    """Angle between two vectors, 0 ... pi [rad], accurate where it is small."""
    return math.atan2(float(np.linalg.norm(vector_product(u, v))), float(u @ v))


def perpendicular(z: Array) -> Array:
    """Some unit vector at right angles to z."""
    axis = np.eye(3)[int(np.argmin(np.abs(z)))]
    across = axis - (z @ axis) * z
    unit: Array = across / np.linalg.norm(across)
    return unit


def are_parallel(u: Array, v: Array) -> bool:
    """Whether two unit vectors are parallel, either way round."""
    return float(np.linalg.norm(vector_product(u, v))) < PARALLEL


def common_normal(a: Screw, b: Screw) -> Normal:
    """The common normal of two axes; that through ``a.o`` if they are parallel."""
    across, way = vector_product(a.z, b.z), b.o - a.o
    sine, cosine = float(np.linalg.norm(across)), float(a.z @ b.z)
    if sine < PARALLEL:
        foot_b = b.o - (way @ b.z) * b.z
        distance = float(np.linalg.norm(foot_b - a.o))
        n = (foot_b - a.o) / distance if distance > 0.0 else perpendicular(a.z)
        n = n - (n @ a.z) * a.z
        n = n / np.linalg.norm(n) if np.linalg.norm(n) > 0.5 else perpendicular(a.z)
        return Normal(n, distance, 0.0, cosine, a.o, foot_b)
    n = across / sine
    along_a = float(vector_product(way, b.z) @ n) / sine
    along_b = float(vector_product(way, a.z) @ n) / sine
    foot_a, foot_b = a.o + along_a * a.z, b.o + along_b * b.z
    return Normal(n, float(way @ n), sine, cosine, foot_a, foot_b)
