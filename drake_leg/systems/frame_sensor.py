"""Senses the pose and motion of a frame: Simscape's 6-DOF Joint and Transform Sensor."""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType
from typing import TypedDict

from numpy.typing import ArrayLike
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.euler import gimbal_distance, require_sequence
from drake_leg.kinematics.khalil import Array
from drake_leg.systems.block import Block
from drake_leg.systems.relative_motion import RelativeMotion, Where


class MeasurementFrame(TypedDict):
    """Simscape's single setting for both the axes of a vector and its observer."""

    expressed_in: Where
    observed_in: Where


MEASUREMENT_FRAMES = MappingProxyType(
    {
        "World": MeasurementFrame(expressed_in="world", observed_in="world"),
        "Base": MeasurementFrame(expressed_in="base", observed_in="base"),
        "Follower": MeasurementFrame(expressed_in="follower", observed_in="follower"),
        "Non-Rotating Base": MeasurementFrame(expressed_in="base", observed_in="world"),
        "Non-Rotating Follower": MeasurementFrame(expressed_in="follower", observed_in="world"),
    }
)


class FrameSensor(Block):
    """Senses pose and motion of a frame F, the follower, relative to a frame B, the base.

    Both frames may move. Vectors are expressed in the axes of a frame E (``expressed_in``), and
    their derivatives are taken as an observer in a frame O sees them (``observed_in``).

    ======================== ==== ==== ======= =================================================
    port                     kind size unit    meaning
    ======================== ==== ==== ======= =================================================
    ``state``                in   n    rad, /s the plant's state (positions, then velocities)
    ``acceleration`` (a)     in   n_v  rad/s^2 the plant's port ``generalized_acceleration``
    ``position``             out  3    m       p_BF, from B's origin to F's, in E
    ``velocity``             out  3    m/s     derivative of p_BF as observed in O, in E
    ``quaternion``           out  4    --      of R_BF: w, x, y, z
    ``angular_velocity``     out  3    rad/s   w_BF, the *body rates*, in E
    ``rotation_matrix`` (r)  out  9    --      R_BF, row by row
    ``angles`` (e)           out  3    rad     Euler angles of R_BF, principal values
    ``angle_rates`` (e)      out  3    rad/s   the *Bushing joint's rates*: of the angles
    ``gimbal_distance`` (e)  out  1    rad     of the second angle from gimbal lock: 0 ... pi/2
    ``acceleration`` (a)     out  3    m/s^2   derivative of the velocity as observed in O, in E
    ``angular_acceleration`` out  3    rad/s^2 (a) derivative of w_BF as observed in O, in E
    ``angle_accelerations``  out  3    rad/s^2 (a, e) second derivatives of the angles
    ======================== ==== ==== ======= =================================================

    Ports marked (a) exist with ``acceleration=True``, (r) with ``rotation_matrix=True``, (e) with
    ``euler="..."``.

    By default B observes: the outputs are the spatial velocity and acceleration of F in B. A frame
    at rest on a turning base has velocity 0; its acceleration in B is free of the base's
    acceleration, Coriolis and centrifugal terms. With ``observed_in="world"`` the velocity is the
    difference between both origins' velocities in the world. Simscape's Transform Sensor has one
    setting for both; ``MEASUREMENT_FRAMES`` has its five values, as in
    ``FrameSensor(plant, F, B, **MEASUREMENT_FRAMES["Non-Rotating Base"])``. Simscape's joints sense
    as with "Base".

    Body rates are the components of one vector along the axes of one frame; a Bushing joint's
    rates belong to three axes that are not at right angles. The two differ unless the frame turns
    about one axis only. Rotation outputs depend on neither setting. In gimbal lock the angles still
    describe the rotation, with the first angle 0, and the rates and accelerations are the smallest
    possible ones; they are never NaN, so that logging them cannot stop a run. Do not
    trust them where ``gimbal_distance`` is small. ``euler.continuous_angles`` removes the jumps
    from recorded angles.

    The block computes in a scratch context of the plant; nothing in it outlives a call.

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
    acceleration : bool
        Sense accelerations too; the port ``acceleration`` must then be connected.
    euler : str, optional
        A sequence such as "XYZ", the Bushing joint's: one of ``euler.SEQUENCES``.
    rotation_matrix : bool
        Sense the rotation as a matrix too.

    Raises
    ------
    InvalidValueError
        If the plant is not finalized, a frame is another plant's, or a choice is unknown.

    References
    ----------
    Report A, section 2.5 (the 6-DOF joint from the world to the sphere); Simscape Multibody,
    Transform Sensor, parameter Measurement Frame.

    Examples
    --------
    >>> from drake_leg import LEG_B, FrameSensor, build_plant
    >>> plant = build_plant(LEG_B)
    >>> sensor = FrameSensor(plant, plant.GetFrameByName("frame_4"))
    >>> context = sensor.CreateDefaultContext()
    >>> state = [0, 0, 0, 2, 0, 0]  # stretched along x; the hip turns at 2 rad/s
    >>> _ = sensor.GetInputPort("state").FixValue(context, state)
    >>> sensor.GetOutputPort("velocity").Eval(context).round(6).tolist()  # [m/s]
    [0.0, 0.5, 0.0]
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        frame: Frame,
        base: Frame | None = None,
        *,
        expressed_in: Where = "base",
        observed_in: Where = "base",
        acceleration: bool = False,
        euler: str | None = None,
        rotation_matrix: bool = False,
    ) -> None:
        Block.__init__(
            self,
            plant,
            frame,
            base,
            expressed_in=expressed_in,
            observed_in=observed_in,
            acceleration=acceleration,
            euler=euler,
            rotation_matrix=rotation_matrix,
        )
        require_kind("acceleration", acceleration, bool)
        require_kind("rotation_matrix", rotation_matrix, bool)
        self._motion = RelativeMotion(
            plant, frame, base, expressed_in=expressed_in, observed_in=observed_in
        )
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self._declare("position", 3, RelativeMotion.position)
        self._declare("velocity", 3, RelativeMotion.velocity)
        self._declare("quaternion", 4, RelativeMotion.quaternion)
        self._declare("angular_velocity", 3, RelativeMotion.angular_velocity)
        if rotation_matrix:
            self._declare("rotation_matrix", 9, lambda motion: motion.rotation().ravel())
        if euler is not None:
            self._declare_angles(euler)
        if acceleration:
            self._declare_accelerations(plant.num_velocities(), euler)

    def _declare_angles(self, euler: str) -> None:
        require_sequence(euler)
        if not isinstance(self, LeafSystem):
            raise InvalidValueError(
                f"{self.__class__.__name__} has no derivatives of Euler angles",
                advice="leave `euler` out, and use the port rotation_matrix",
            )
        self._declare("angles", 3, lambda motion: motion.angles(euler))
        self._declare("angle_rates", 3, lambda motion: motion.angle_rates(euler))
        self._declare(
            "gimbal_distance", 1, lambda motion: [gimbal_distance(euler, motion.angles(euler))]
        )

    def _declare_accelerations(self, velocities: int, euler: str | None) -> None:
        self._vdot = self.DeclareVectorInputPort("acceleration", velocities)
        self._declare_with_vdot("acceleration", RelativeMotion.acceleration)
        self._declare_with_vdot("angular_acceleration", RelativeMotion.angular_acceleration)
        if euler is not None:
            self._declare_with_vdot(
                "angle_accelerations", lambda motion, vdot: motion.angle_accelerations(euler, vdot)
            )

    def _declare(self, name: str, size: int, sense: Callable[[RelativeMotion], ArrayLike]) -> None:
        def calc(context: Context, sensed: BasicVector) -> None:
            sensed.SetFromVector(sense(self._motion.at(self._state.Eval(context))))

        self.DeclareVectorOutputPort(name, size, calc, {self._state.ticket()})

    def _declare_with_vdot(
        self, name: str, sense: Callable[[RelativeMotion, Array], ArrayLike]
    ) -> None:
        def calc(context: Context, sensed: BasicVector) -> None:
            vdot = self._vdot.Eval(context)
            sensed.SetFromVector(sense(self._motion.at(self._state.Eval(context)), vdot))

        tickets = {self._state.ticket(), self._vdot.ticket()}
        self.DeclareVectorOutputPort(name, 3, calc, tickets)
