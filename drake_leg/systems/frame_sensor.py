"""Where a frame is in the world and how it moves: the 6-DOF joint used as a sensor."""

from __future__ import annotations

from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame
from pydrake.systems.framework import BasicVector, Context, LeafSystem


class FrameSensor(LeafSystem):
    """Position, velocity, rotation and angular velocity of a frame F in the world W.

    ===================== ===== ===== ======== =============================================
    port                  kind  size  unit     meaning
    ===================== ===== ===== ======== =============================================
    ``state``             in    n     rad, /s  the plant's state (positions, then velocities)
    ``position``          out   3     m        p_WF
    ``velocity``          out   3     m/s      v_WF, velocity of F's origin
    ``quaternion``        out   4     --       of R_WF: w, x, y, z
    ``angular_velocity``  out   3     rad/s    w_WF, in the world's axes
    ===================== ===== ===== ======== =============================================

    The plant's own context for the computation is scratch: nothing in it outlives a call.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalised.
    frame : Frame
        A frame of the plant.

    References
    ----------
    Report A, section 2.5 (the 6-DOF joint from the world to the sphere).
    """

    def __init__(self, plant: MultibodyPlant, frame: Frame) -> None:
        super().__init__()
        self._plant = plant
        self._frame = frame
        self._scratch = plant.CreateDefaultContext()
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        state = {self._state.ticket()}
        self.DeclareVectorOutputPort("position", 3, self._calc_position, state)
        self.DeclareVectorOutputPort("velocity", 3, self._calc_velocity, state)
        self.DeclareVectorOutputPort("quaternion", 4, self._calc_quaternion, state)
        self.DeclareVectorOutputPort("angular_velocity", 3, self._calc_angular_velocity, state)

    def _plant_context(self, context: Context) -> Context:
        self._plant.SetPositionsAndVelocities(self._scratch, self._state.Eval(context))
        return self._scratch

    def _V_WF(self, context: Context) -> SpatialVelocity:
        return self._frame.CalcSpatialVelocityInWorld(self._plant_context(context))

    def _calc_position(self, context: Context, position: BasicVector) -> None:
        X_WF = self._frame.CalcPoseInWorld(self._plant_context(context))
        position.SetFromVector(X_WF.translation())

    def _calc_velocity(self, context: Context, velocity: BasicVector) -> None:
        velocity.SetFromVector(self._V_WF(context).translational())

    def _calc_quaternion(self, context: Context, quaternion: BasicVector) -> None:
        X_WF = self._frame.CalcPoseInWorld(self._plant_context(context))
        quaternion.SetFromVector(X_WF.rotation().ToQuaternion().wxyz())

    def _calc_angular_velocity(self, context: Context, angular_velocity: BasicVector) -> None:
        angular_velocity.SetFromVector(self._V_WF(context).rotational())
