"""Drake's word on a robot: foot and Jacobian from the plant that its SDF makes."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from drake_leg.kinematics.batches import Array
from drake_leg.models.plant import build_plant
from drake_leg.names import frame_name
from drake_leg.robot import Robot


class DrakeWitness:
    """A plant parsed from a robot's SDF and a scratch context.

    Raises
    ------
    InvalidValueError
        If Drake's strict parser refuses the SDF.
    """

    def __init__(self, robot: Robot) -> None:
        self._plant = build_plant(robot)
        self._context = self._plant.CreateDefaultContext()
        self._base = self._plant.GetFrameByName(frame_name(0))
        self._foot = self._plant.GetFrameByName(frame_name(len(robot.rows)))
        joints = [self._plant.GetJointByName(str(segment.joint)) for segment in robot.moving]
        self._positions = [joint.position_start() for joint in joints]
        self._velocities = [joint.velocity_start() for joint in joints]

    def foot(self, q: Array) -> Array:
        """Pose of the last row's frame in the base.

        Parameters
        ----------
        q : (m,) ndarray
            Joint positions in the table's order [rad or m].

        Returns
        -------
        X_BF : (4, 4) ndarray
            Homogeneous transform [-, m].
        """
        self._set(q)
        X_BF = self._plant.CalcRelativeTransform(self._context, self._base, self._foot)
        pose: Array = X_BF.GetAsMatrix4()
        return pose

    def jacobian(self, q: Array) -> Array:
        """Spatial Jacobian of the last row's frame, rotation first.

        Parameters
        ----------
        q : (m,) ndarray
            Joint positions in the table's order [rad or m].

        Returns
        -------
        Jv_BF : (6, m) ndarray
            In the base frame [rad, m per rad or m].
        """
        self._set(q)
        spatial: Array = self._plant.CalcJacobianSpatialVelocity(
            self._context, JacobianWrtVariable.kV, self._foot, np.zeros(3), self._base, self._base
        )
        return spatial[:, self._velocities]

    def _set(self, q: Array) -> None:
        positions = np.zeros(self._plant.num_positions())
        positions[self._positions] = q
        self._plant.SetPositions(self._context, positions)
