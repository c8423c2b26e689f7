"""Witnesses of a proof: each computes the same quantities in its own way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydrake.multibody.tree import JacobianWrtVariable, MultibodyForces

from drake_leg.kinematics.khalil import Array
from drake_leg.models.plant import build_plant
from drake_leg.robot.robot import Robot, frame_name

Function = Callable[[Array], Array]  # of configurations (N, m), with the same first axis


class Testimony(NamedTuple):
    """How one witness computes one quantity."""

    quantity: str
    witness: str
    function: Function


def one_by_one(function: Function, configurations: Array) -> Array:
    """Evaluate a function of one configuration (m,) for each of several (N, m)."""
    return np.array([function(q) for q in configurations])


def widened(J: Array, columns: Sequence[int], joints: int) -> Array:
    """Put columns (..., 6, k) among those of all joints, (..., 6, joints); the others are 0."""
    wide = np.zeros((*J.shape[:-1], joints))
    wide[..., columns] = J
    return wide


class DrakeWitness:
    """Drake's foot and Jacobian: a plant parsed from a robot's SDF, with a scratch context.

    ``InvalidValueError`` is raised if Drake's strict parser refuses the SDF.
    """

    def __init__(self, robot: Robot) -> None:
        self._plant = build_plant(robot)
        self._context = self._plant.CreateDefaultContext()
        frames = range(len(robot.rows) + 1)
        self._frames = [self._plant.GetFrameByName(frame_name(index)) for index in frames]
        joints = [self._plant.GetJointByName(str(segment.joint)) for segment in robot.moving]
        self._positions = [joint.position_start() for joint in joints]
        self._velocities = [joint.velocity_start() for joint in joints]

    def foot(self, q: Array, row: int = -1) -> Array:
        """Pose X_BF (4, 4) [-, m] of a row's frame, at joint positions (m,) [rad or m]."""
        return self.pose(q, 0, row)

    def pose(self, q: ArrayLike, first: int, last: int) -> Array:
        """Pose (4, 4) [-, m] of one frame in another, by their indices."""
        self._set(q)
        frames = self._frames[first], self._frames[last]
        X: Array = self._plant.CalcRelativeTransform(self._context, *frames).GetAsMatrix4()
        return X

    def jacobian(self, q: ArrayLike, row: int = -1) -> Array:
        """Spatial Jacobian Jv_BF (6, m) of a row's frame, rotation first, in the base frame."""
        self._set(q)
        base, foot = self._frames[0], self._frames[row]
        spatial: Array = self._plant.CalcJacobianSpatialVelocity(
            self._context, JacobianWrtVariable.kV, foot, np.zeros(3), base, base
        )
        return spatial[:, self._velocities]

    def torques(self, q: Array, qdot: Array, qddot: Array, base: Array) -> tuple[Array, Array]:
        """Torques of a motion, (m,), and the wrench on a floating base, (6,), moment first.

        ``base`` has its angular velocity and acceleration and the acceleration of its origin, and
        the wrench is about that, all in the world, (3, 3) [rad/s, rad/s^2, m/s^2, N*m, N]. Springs
        and dampers are left out.
        """
        self._set(q)
        v, vdot = np.zeros((2, self._plant.num_velocities()))
        v[self._velocities], vdot[self._velocities] = qdot, qddot
        # Drake puts the velocities of a floating base first, its rotation before its translation.
        floating = len(v) > len(qdot)
        if floating:
            v[:3], vdot[:3], vdot[3:6] = base
        self._plant.SetVelocities(self._context, v)
        none = MultibodyForces(self._plant)
        needed = self._plant.CalcInverseDynamics(self._context, vdot, none)
        needed -= self._plant.CalcGravityGeneralizedForces(self._context)
        return needed[self._velocities], needed[:6] if floating else np.zeros(6)

    def _set(self, q: ArrayLike) -> None:
        positions = self._plant.GetPositions(self._context)
        positions[self._positions] = q
        self._plant.SetPositions(self._context, positions)
