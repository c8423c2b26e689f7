"""Any serial chain in Khalil's (modified DH) convention: transforms, foot pose, Jacobian.

Frame 0 is the base B; frame i belongs to row i; the last frame is the foot F. Batches of joint
positions may have any shape in front of the last axis.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array, finite_vectors
from drake_leg.robot.robot import Row


def moving_rows(rows: Sequence[Row]) -> list[int]:
    """Indices of the rows that have a joint position, in order."""
    return [index for index, row in enumerate(rows) if row.joint != "fixed"]


def row_transform(row: Row, q: ArrayLike = 0.0) -> Array:
    """Transform X_PC from a row's frame C to the frame P before it, (..., 4, 4), report A, eq. 1.

    ``X = Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``, with ``q`` (...) [rad or m] added to
    ``theta`` (revolute) or to ``r`` (prismatic); a fixed row ignores ``q``.
    """
    position = np.asarray(q, dtype=np.float64)
    theta = row.theta + (position if row.joint == "revolute" else np.zeros_like(position))
    r = row.r + (position if row.joint == "prismatic" else np.zeros_like(position))
    c, s = np.cos(theta), np.sin(theta)
    ca, sa = np.cos(row.alpha), np.sin(row.alpha)
    X_PC = np.zeros((*position.shape, 4, 4))
    X_PC[..., 0, 0], X_PC[..., 0, 1], X_PC[..., 0, 3] = c, -s, row.d
    X_PC[..., 1, 0], X_PC[..., 1, 1], X_PC[..., 1, 2], X_PC[..., 1, 3] = (
        s * ca,
        c * ca,
        -sa,
        -r * sa,
    )
    X_PC[..., 2, 0], X_PC[..., 2, 1], X_PC[..., 2, 2], X_PC[..., 2, 3] = s * sa, c * sa, ca, r * ca
    X_PC[..., 3, 3] = 1.0
    return X_PC


def row_transform_rate(row: Row, q: ArrayLike = 0.0) -> Array:
    """Derivative of ``row_transform`` by the joint position, (..., 4, 4); zero for a fixed row."""
    X_PC = row_transform(row, q)
    generator = np.zeros((4, 4))
    if row.joint == "revolute":
        generator[0, 1], generator[1, 0] = -1.0, 1.0
    elif row.joint == "prismatic":
        generator[2, 3] = 1.0
    rate: Array = X_PC @ generator
    return rate


def base_transforms(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Transforms from every row's frame to the base, (..., n, 4, 4); the last one is the foot's.

    ``X_B[i] = X_B[i-1] @ row_transform(rows[i], q_i)`` for a table of n rows, of which m move, at q
    (..., m) [rad or m] (report A, eq. 6-8; report B, 1.4 and 2.4).

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in m, or is not finite.
    """
    moving = moving_rows(rows)
    positions = finite_vectors("q", q, len(moving))
    X_B = np.empty((*positions.shape[:-1], len(rows), 4, 4))
    X_BC = np.eye(4)
    for index, row in enumerate(rows):
        value = positions[..., moving.index(index)] if index in moving else np.zeros(())
        X_BC = X_BC @ row_transform(row, value)
        X_B[..., index, :, :] = X_BC
    return X_B


def foot_pose(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Pose X_BF of the last frame in the base, (..., 4, 4), as the last of ``base_transforms``."""
    return base_transforms(rows, q)[..., -1, :, :]


def jacobian(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Jacobian of the foot by the direct method (z x OE), rotation first as Drake has it.

    ``[w_BF; v_BF] = Jv_BF @ qdot``; a revolute joint makes ``[z; z x OF]``, a prismatic one
    ``[0; z]`` (report A, eq. 9-15; eq. 9-12 lack the joint rates in print).

    Returns
    -------
    Jv_BF : (..., 6, m) ndarray
        Rows 0-2 angular, rows 3-5 translational, in the base frame [rad, m per rad or m].

    Raises
    ------
    InvalidValueError
        If ``q`` (..., m) does not end in m, or is not finite.
    """
    X_B = base_transforms(rows, q)
    p_BF = X_B[..., -1, :3, 3]
    moving = moving_rows(rows)
    Jv_BF = np.zeros((*X_B.shape[:-3], 6, len(moving)))
    for column, index in enumerate(moving):
        z_B = X_B[..., index, :3, 2]
        if rows[index].joint == "revolute":
            Jv_BF[..., :3, column] = z_B
            Jv_BF[..., 3:, column] = np.cross(z_B, p_BF - X_B[..., index, :3, 3])
        else:
            Jv_BF[..., 3:, column] = z_B
    return Jv_BF


def jacobian_by_differentiation(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Jacobian of the foot by the indirect method: the derivative of its pose (report A, appendix).

    ``v = dp/dq``, and the angular part from ``[w]x = dR/dq R^T``; no cross product is taken, so
    that it is a witness of ``jacobian``, whose shape it has.
    """
    moving = moving_rows(rows)
    positions = finite_vectors("q", q, len(moving))
    R_FB = np.swapaxes(foot_pose(rows, positions)[..., :3, :3], -1, -2)
    Jv_BF = np.empty((*positions.shape[:-1], 6, len(moving)))
    for column, index in enumerate(moving):
        rate = np.eye(4)
        for i, row in enumerate(rows):
            value = positions[..., moving.index(i)] if i in moving else np.zeros(())
            rate = rate @ (row_transform_rate if i == index else row_transform)(row, value)
        spin = rate[..., :3, :3] @ R_FB
        Jv_BF[..., 0, column] = spin[..., 2, 1]
        Jv_BF[..., 1, column] = spin[..., 0, 2]
        Jv_BF[..., 2, column] = spin[..., 1, 0]
        Jv_BF[..., 3:, column] = rate[..., :3, 3]
    return Jv_BF
