"""One walk along a chain, in plain floats: the foot, its Jacobian and the Jacobian's rate.

This is what runs inside a simulation; ``khalil`` has the same for batches, by matrices.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Row

Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)


class Sweep(NamedTuple):
    """A chain in a posture, in the base frame."""

    turning: tuple[bool, ...]  # of every moving row: revolute, not prismatic
    axes: tuple[Vector, ...]  # z of every moving row
    origins: tuple[Vector, ...]  # of every moving row [m]
    foot: Vector  # [m]
    rotation: tuple[Vector, Vector, Vector]  # x, y, z of the last frame


def sweep(rows: Sequence[Row], q: Sequence[float]) -> Sweep:
    """Walk from the base to the foot.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which n rows move.
    q : (n,) sequence of float
        Joint positions [rad or m].
    """
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

    Parameters
    ----------
    here : Sweep
        The chain in its posture.

    Returns
    -------
    Jv_BF : (6, n) ndarray
        Rows 0-2 angular, rows 3-5 translational, as ``khalil.jacobian``.
    """
    columns = [
        (*z, *_cross(z, _sum(1.0, here.foot, -1.0, o))) if turns else (*ZERO, *z)
        for turns, z, o in zip(here.turning, here.axes, here.origins, strict=True)
    ]
    return np.array(columns, dtype=np.float64).T


def foot_jacobian_rate(here: Sweep, qdot: Sequence[float]) -> Array:
    """Derivative of the Jacobian in time, while the joints move.

    An axis turns with the body before it, ``dz/dt = w x z``, and an origin moves with it.

    Parameters
    ----------
    here : Sweep
        The chain in its posture.
    qdot : (n,) sequence of float
        Rates of the joints [rad/s or m/s].

    Returns
    -------
    (6, n) ndarray
        dJv_BF/dt.
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
    """Twist that takes the foot from one pose to another; a small one is exact.

    Parameters
    ----------
    here, goal : Sweep
        The chain in two postures.

    Returns
    -------
    (6,) ndarray
        Turning, then translation, base frame.
    """
    turning = ZERO
    for axis, there in zip(here.rotation, goal.rotation, strict=True):
        turning = _sum(1.0, turning, 0.5, _cross(axis, there))
    return np.array([*turning, *_sum(1.0, goal.foot, -1.0, here.foot)])


def _sum(a: float, u: Vector, b: float, v: Vector) -> Vector:
    return a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]


def _cross(u: Vector, v: Vector) -> Vector:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
