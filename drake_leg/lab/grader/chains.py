"""A robot's chain at many samples, its lengths drawn as freely as its joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import moving_rows
from drake_leg.lab.grader.claims import FIRST_LENGTH, Claim
from drake_leg.robot.robot import JointType, Row


@dataclass(frozen=True, kw_only=True)
class Chain:
    """A Khalil table of n rows, of which m move, at N samples."""

    joints: tuple[JointType, ...]  # of the rows
    d: Array  # (N, n), in any unit of lengths
    alpha: Array  # (N, n) [rad]
    r: Array  # (N, n), without the position of a sliding joint
    theta: Array  # (N, n) [rad], without the position of a turning joint
    q: Array  # (N, m) [rad or the unit of lengths]

    @property
    def moving(self) -> list[int]:
        """The rows that move, counted from 0."""
        return [index for index, joint in enumerate(self.joints) if joint != "fixed"]

    def positions(self, joint: JointType) -> Array:
        """Spread the positions of turning or of sliding joints over the rows, (N, n)."""
        spread = np.zeros_like(self.theta)
        for column, index in enumerate(self.moving):
            if self.joints[index] == joint:
                spread[:, index] = self.q[:, column]
        return spread

    def about_x(self) -> Array:
        """Every row's turn and shift about x, (N, n, 4, 4)."""
        X = np.broadcast_to(np.eye(4), (*self.alpha.shape, 4, 4)).copy()
        X[..., 1, 1] = X[..., 2, 2] = np.cos(self.alpha)
        X[..., 2, 1] = np.sin(self.alpha)
        X[..., 1, 2] = -X[..., 2, 1]
        X[..., 0, 3] = self.d
        return X

    def about_z(self) -> Array:
        """Every row's turn and shift about z, with the joint's position, (N, n, 4, 4)."""
        theta = self.theta + self.positions("revolute")
        X = np.broadcast_to(np.eye(4), (*theta.shape, 4, 4)).copy()
        X[..., 0, 0] = X[..., 1, 1] = np.cos(theta)
        X[..., 1, 0] = np.sin(theta)
        X[..., 0, 1] = -X[..., 1, 0]
        X[..., 2, 3] = self.r + self.positions("prismatic")
        return X

    def steps(self) -> Array:
        """Transforms from every row's frame to the frame before it, (N, n, 4, 4).

        ``X = Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``.
        """
        return self.about_x() @ self.about_z()

    def frames(self) -> Array:
        """Poses of the frames 0 to n in the base, (N, n + 1, 4, 4)."""
        return running_products(self.steps())

    def jacobian(self) -> Array:
        """Jacobian of the last frame by the direct method, rotation first, (N, 6, m)."""
        X_B = self.frames()
        return twists(self, X_B[:, 1:], X_B[:, -1, :3, 3])


def chain_of(rows: Sequence[Row], q: Array, metres: float) -> Chain:
    """Write a robot's table once for every sample of its joint positions.

    Parameters
    ----------
    q : (N, m) ndarray
        Joint positions [rad or m].
    metres : float
        [m] of the chain's unit of lengths.
    """

    def column(name: str, unit: float) -> Array:
        return np.tile([getattr(row, name) / unit for row in rows], (len(q), 1))

    sliding = [rows[index].joint == "prismatic" for index in moving_rows(rows)]
    return Chain(
        joints=tuple(row.joint for row in rows),
        d=column("d", metres),
        alpha=column("alpha", 1.0),
        r=column("r", metres),
        theta=column("theta", 1.0),
        q=q / np.where(sliding, metres, 1.0),
    )


def running_products(steps: Array) -> Array:
    """Multiply transforms from the left: 1, X1, X1 X2, ..., (N, n + 1, 4, 4)."""
    products = [np.broadcast_to(np.eye(4), (*steps.shape[:1], 4, 4))]
    for index in range(steps.shape[1]):
        products.append(products[-1] @ steps[:, index])
    return np.stack(products, axis=1)


def twists(chain: Chain, axes: Array, point: Array) -> Array:
    """Twist that every joint's rate brings about at a point: ``[z; z x OP]``, or ``[0; z]``.

    Parameters
    ----------
    axes : (N, n, 4, 4) ndarray
        For every row, the frame about or along whose z axis it moves.
    point : (N, 3) ndarray
        P, in the base frame.

    Returns
    -------
    (N, 6, m) ndarray
        Rotation first; a sliding joint turns nothing.
    """
    columns = []
    for index in chain.moving:
        z, p = axes[:, index, :3, 2], axes[:, index, :3, 3]
        turns = chain.joints[index] == "revolute"
        halves = (z, np.cross(z, point - p)) if turns else (np.zeros_like(z), z)
        columns.append(np.concatenate(halves, axis=-1))
    return np.stack(columns, axis=-1)


def right_values(claim: Claim, chain: Chain) -> Array:
    """Evaluate what is claimed at N samples, (N, r, c), in the chain's unit of lengths."""
    if claim.is_pose:
        return claimed_part(claim, between(chain.frames(), *claim.frames))
    return claimed_part(claim, chain.jacobian())


def between(X_B: Array, first: int, last: int) -> Array:
    """Pose of one frame in another, (N, 4, 4), of the poses of all frames in the base."""
    relative: Array = np.linalg.inv(X_B[:, first]) @ X_B[:, last]
    return relative


def claimed_part(claim: Claim, whole: Array) -> Array:
    """Take what is claimed, (N, r, c), out of a pose or a Jacobian of six rows, rotation first."""
    if claim.kind == "position":
        return whole[:, : max(claim.shape), 3].reshape(-1, *claim.shape)
    if claim.is_pose:
        return whole[:, : claim.shape[0], : claim.shape[1]]
    Jv_BF = whole[:, list(claim.rows)]
    if claim.kind == "jacobian":
        return Jv_BF[..., : claim.shape[1]]
    determinants: Array = np.linalg.det(Jv_BF[..., : len(claim.rows)])
    return determinants[:, np.newaxis, np.newaxis]


def scales(claim: Claim, length: float) -> Array:
    """Say how large the entries of a claim can be, (r, c): 1 in a rotation, or a length."""
    scale = np.ones(claim.shape)
    if claim.kind == "transform":
        scale[:3, 3] = length
    elif claim.kind == "position":
        scale[:] = length
    elif claim.kind == "jacobian":
        scale[[row >= FIRST_LENGTH for row in claim.rows]] = length
    else:
        scale[:] = length ** sum(row >= FIRST_LENGTH for row in claim.rows)
    return scale
