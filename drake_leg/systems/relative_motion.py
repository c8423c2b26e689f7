"""Computes the motion of one frame of a plant relative to another, for any observer."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from pydrake.autodiffutils import AutoDiffXd
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, Frame_, JacobianWrtVariable

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import angle_accelerations, angle_rates, euler_angles
from drake_leg.kinematics.khalil import Array
from drake_leg.systems.partial_dynamics import require_plant

Where = Literal["base", "follower", "world"]


class RelativeMotion:
    """Pose, velocity and acceleration of a frame F, the follower, relative to a frame B, the base.

    Both frames may move. Vectors are expressed in the axes of a frame E. The observer is in a frame
    O, in which B turns with w_OB: ``v_O = v_B + w_OB x p`` and ``a_O = a_B + alpha_OB x p + 2 w_OB
    x v_B + w_OB x (w_OB x p)``, where p, v_B and a_B are the position, velocity and acceleration of
    F's origin in B.

    All is computed in a scratch context, whose state ``at`` sets.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized.
    frame : Frame
        F, a frame of the plant.
    base : Frame, optional
        B, a frame of the plant; by default the world.
    expressed_in : {"base", "follower", "world"}
        E.
    observed_in : {"base", "follower", "world"}
        O.

    Raises
    ------
    InvalidValueError
        If the plant is not finalized, a frame is another plant's, or a choice is unknown.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        frame: Frame,
        base: Frame | None = None,
        *,
        expressed_in: Where = "base",
        observed_in: Where = "base",
    ) -> None:
        require_plant(plant)
        self._plant, self._F = plant, _own(plant, frame)
        self._B = plant.world_frame() if base is None else _own(plant, base)
        frames = {"base": self._B, "follower": self._F, "world": plant.world_frame()}
        self._E = frames[_place("expressed_in", expressed_in)]
        self._O = frames[_place("observed_in", observed_in)]
        self._O_is_B = self._O.index() == self._B.index()
        self._scratch = plant.CreateDefaultContext()

    def at(self, state: Array) -> RelativeMotion:
        """Set the state (positions, then velocities), and return this object."""
        self._plant.SetPositionsAndVelocities(self._scratch, state)
        return self

    def position(self) -> Array:
        """Position of F's origin from B's: p_BF_E, (3,) [m]."""
        p_BF: Array = self._F.CalcPose(self._scratch, self._B).translation()
        if self._E is not self._B:
            p_BF = self._B.CalcRotationMatrix(self._scratch, self._E).multiply(p_BF)
        return p_BF

    def velocity(self) -> Array:
        """Velocity of F's origin, the derivative of the position as observed in O; in E [m/s]."""
        v_B = self._velocity_in_base()
        return v_B if self._O_is_B else v_B + np.cross(self._w_OB(), self.position())

    def acceleration(self, vdot: Array) -> Array:
        """Acceleration of F's origin, the derivative of the velocity as observed in O.

        ``vdot`` (n_v,) has the plant's generalized accelerations; the result is in E [m/s^2].
        """
        a_B = self._spatial_acceleration(vdot, self._F, self._B, self._E)[3:]
        if self._O_is_B:
            return a_B
        p, v_B, w_OB = self.position(), self._velocity_in_base(), self._w_OB()
        alpha_OB = self._spatial_acceleration(vdot, self._B, self._O, self._E)[:3]
        centripetal = np.cross(w_OB, np.cross(w_OB, p))
        a_O: Array = a_B + np.cross(alpha_OB, p) + 2.0 * np.cross(w_OB, v_B) + centripetal
        return a_O

    def rotation(self) -> Array:
        """Rotation of F relative to B: R_BF, (3, 3)."""
        R_BF: Array = self._F.CalcRotationMatrix(self._scratch, self._B).matrix()
        return R_BF

    def quaternion(self) -> Array:
        """Quaternion of R_BF: w, x, y, z, with w not negative."""
        R_BF = self._F.CalcRotationMatrix(self._scratch, self._B)
        wxyz: Array = R_BF.ToQuaternion().wxyz()
        return wxyz

    def angular_velocity(self) -> Array:
        """Angular velocity of F in B, w_BF_E [rad/s]: the same for every observer."""
        return self._angular_velocity(self._F, self._B, self._E)

    def angular_acceleration(self, vdot: Array) -> Array:
        """Derivative of the angular velocity as observed in O, in E [rad/s^2]."""
        alpha_B = self._spatial_acceleration(vdot, self._F, self._B, self._E)[:3]
        return (
            alpha_B if self._O_is_B else alpha_B + np.cross(self._w_OB(), self.angular_velocity())
        )

    def angles(self, sequence: str) -> Array:
        """Euler angles of R_BF in one of ``euler.SEQUENCES``, principal values [rad]."""
        return euler_angles(sequence, self.rotation())

    def angle_rates(self, sequence: str) -> Array:
        """Derivatives of the Euler angles, (3,) [rad/s]."""
        w_BF_B = self._angular_velocity(self._F, self._B, self._B)
        return angle_rates(sequence, self.angles(sequence), w_BF_B)

    def angle_accelerations(self, sequence: str, vdot: Array) -> Array:
        """Second derivatives of the Euler angles, (3,) [rad/s^2]."""
        angles, rates = self.angles(sequence), self.angle_rates(sequence)
        alpha_BF_B = self._spatial_acceleration(vdot, self._F, self._B, self._B)[:3]
        return angle_accelerations(sequence, angles, rates, alpha_BF_B)

    def _velocity_in_base(self) -> Array:
        v_B: Array = self._F.CalcSpatialVelocity(self._scratch, self._B, self._E).translational()
        return v_B

    def _w_OB(self) -> Array:
        return self._angular_velocity(self._B, self._O, self._E)

    def _angular_velocity(self, frame: Frame, measured_in: Frame, axes: Frame) -> Array:
        w: Array = frame.CalcAngularVelocity(self._scratch, measured_in, axes)
        return w

    def _spatial_acceleration(
        self, vdot: Array, frame: Frame, measured_in: Frame, axes: Frame
    ) -> Array:
        """Angular, then translational acceleration of a frame: ``J vdot + dJ/dt v``."""
        where = (self._scratch, JacobianWrtVariable.kV, frame, np.zeros(3), measured_in, axes)
        J = self._plant.CalcJacobianSpatialVelocity(*where)
        A: Array = J @ vdot + self._plant.CalcBiasSpatialAcceleration(*where).get_coeffs()
        return A


def _own(plant: MultibodyPlant, frame: Frame) -> Frame:
    if not isinstance(frame, Frame | Frame_[AutoDiffXd]):
        name = frame if isinstance(frame, str) else "foot"
        raise InvalidValueError(
            f"{shown(frame)} is not a frame; take one from the plant, as "
            f"plant.GetFrameByName({name!r})"
        )
    if frame.GetParentPlant() is not plant:
        raise InvalidValueError(
            f"the frame {frame.name()!r} is not of the plant {plant.get_name()!r}; take it from "
            "this plant's GetFrameByName"
        )
    return frame


def _place(setting: str, place: str) -> str:
    if place not in get_args(Where):
        raise InvalidValueError(
            f"{setting} is {place!r}; it must be one of {', '.join(get_args(Where))}"
        )
    return place
