"""Witnesses of a proof: each computes the same quantities in its own way."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydrake.multibody.tree import JacobianWrtVariable

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

    def _set(self, q: ArrayLike) -> None:
        positions = self._plant.GetPositions(self._context)
        positions[self._positions] = q
        self._plant.SetPositions(self._context, positions)
