"""Makes joints follow a prescribed motion, and computes the torque: Simscape's motion input."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint
from pydrake.systems.controllers import InverseDynamics
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import MatrixGain, Multiplexer

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.systems.partial_dynamics import (
    PartialInverseDynamics,
    joints_of_one_axis,
    require_plant,
)
from drake_leg.units import require_non_negative

# Pulls the joints back onto the prescribed motion against the integrator's rounding; weak enough
# not to stiffen the loop, so that steps of 40 ms stay accurate.
STIFFNESS = 4.0  # [1/s^2]

A_MOTION = "a prescribed motion"  # needs actuators
OTHER_FORCES = ("actuation", "applied_generalized_force", "applied_spatial_force", "contact_force")


class PrescribedMotion(Diagram):
    """Computes the torques that make joints of a plant follow their prescribed motion.

    The joints get the accelerations ``qddot + 2 sqrt(k) (qdot - qdot_s) + k (q - q_s)`` at the
    sensed state (q_s, qdot_s), by inverse dynamics: with the three inputs consistent and the joints
    starting on the motion, they stay on it. The torque accounts for inertia, gravity, springs,
    dampers and, where only some joints are driven, the motion of the others.

    ===================== ===== ======== ======== ==============================================
    port                  kind  size     unit     meaning
    ===================== ===== ======== ======== ==============================================
    ``state``             in    nq + nv  rad, /s  the plant's state (positions, then velocities)
    ``q``                 in    n        rad      prescribed positions
    ``qdot``              in    n        rad/s    their first derivative
    ``qddot``             in    n        rad/s^2  their second derivative
    ``torque``            out   n        N*m      of the driven joints
    ``generalized_force`` out   nv       N*m      the same torques, for all velocities of the plant
    ===================== ===== ======== ======== ==============================================

    Without ``joints`` every joint is driven: ``torque`` is in the plant's actuator order, for its
    ``actuation``. With ``joints`` the plant is any continuous one, on a fixed or a floating base,
    with torque-driven and free joints beside the driven ones; vectors are in the order of
    ``joints``, and ``generalized_force`` goes to the plant's ``applied_generalized_force``, so that
    the driven joints need no actuators. Four more inputs, all optional, then tell the block what
    else acts on the plant (see ``PartialInverseDynamics``): ``actuation`` of torque-driven joints,
    ``applied_generalized_force`` of other blocks, which is passed on in ``generalized_force``,
    ``applied_spatial_force`` and ``contact_force``.

    An ``InputFilter`` supplies the derivatives of a signal whose derivatives are not known.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized; without ``joints``, fully actuated and on a fixed base.
    joints : iterable of str or Joint, optional
        The driven joints, revolute or prismatic; all by default.
    stiffness : float
        k, of the pull toward the motion [1/s^2].
    believed : MultibodyPlant, optional
        Model that the torque is computed for, by default the plant itself: the same joints, with
        other masses.

    Raises
    ------
    InvalidValueError
        If every joint is driven and one has no actuator, if the joints named are not joints of one
        axis, if the plant has constraints, or if the stiffness is negative.

    Examples
    --------
    >>> from drake_leg import PENDULUM, PrescribedMotion, build_plant
    >>> plant = build_plant(PENDULUM)
    >>> block = PrescribedMotion(plant, ["pivot"])
    >>> context = block.CreateDefaultContext()
    >>> for name, value in (("q", [0.0]), ("qdot", [0.0]), ("qddot", [0.0]), ("state", [0.0, 0.0])):
    ...     _ = block.GetInputPort(name).FixValue(context, value)
    >>> block.GetOutputPort("torque").Eval(context).round(4).tolist()  # holds m g L / 2 [N*m]
    [-0.0785]
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        joints: Iterable[str | Joint] | None = None,
        *,
        stiffness: float = STIFFNESS,
        believed: MultibodyPlant | None = None,
    ) -> None:
        super().__init__()
        require_non_negative("the motion's stiffness", stiffness, "1/s^2")
        require_plant(plant)
        if believed is not None:
            require_plant(believed)
        self._plant = plant
        self._believed = plant if believed is None else believed
        if joints is None:
            require_actuators(plant, A_MOTION, advice="or name the joints that follow it")
            n = plant.num_velocities()
            driven_q, driven_v = np.arange(n), np.arange(n)
        else:
            driven = joints_of_one_axis(self._believed, joints)
            driven_q = np.array([joint.position_start() for joint in driven])
            driven_v = np.array([joint.velocity_start() for joint in driven])
        self._driven_q, self._driven_v = driven_q, driven_v

        builder = DiagramBuilder()
        n, states = len(driven_v), plant.num_multibody_states()
        signals = builder.AddNamedSystem("q, qdot, state, qddot", Multiplexer([n, n, states, n]))
        reference = builder.AddNamedSystem(
            "acceleration", MatrixGain(self._reference_matrix(stiffness))
        )
        builder.Connect(signals.get_output_port(), reference.get_input_port())
        for index, name in enumerate(("q", "qdot", "state", "qddot")):
            builder.ExportInput(signals.get_input_port(index), name)
        if joints is None:
            self._add_full_dynamics(builder)
        else:
            self._add_partial_dynamics(builder, driven)
        if plant.time_step() > 0.0:
            raise InvalidValueError(
                f"the plant {plant.get_name()!r} is discrete; motion is prescribed to a plant "
                "that is continuous in time, with time_step 0"
            )
        builder.BuildInto(self)
        self._q = self.GetInputPort("q")
        self._state = self.GetInputPort("state")

    @property
    def plant(self) -> MultibodyPlant:
        """The plant whose joints it drives."""
        return self._plant

    @property
    def knows_its_plant(self) -> bool:
        """Whether the torque is computed for the true plant."""
        return self._believed is self._plant

    def lag(self, context: Context) -> float:
        """Greatest distance of a joint from its prescribed position.

        Parameters
        ----------
        context : Context
            This system's own.

        Returns
        -------
        float
            [rad or m].
        """
        sensed = self._state.Eval(context)[self._driven_q]
        return float(np.abs(self._q.Eval(context) - sensed).max())

    def start(self, context: Context, plant_context: Context) -> None:
        """Put the driven joints on their motion; the other ones stay where they are.

        Parameters
        ----------
        context : Context
            This system's own.
        plant_context : Context
            The plant's; its state is set.

        Raises
        ------
        InvalidValueError
            If the motion or its derivatives are not connected.
        """
        positions = self._plant.GetPositions(plant_context)
        positions[self._driven_q] = self._wired(context, "q")
        self._plant.SetPositions(plant_context, positions)  # the derivatives may depend on them
        velocities = self._plant.GetVelocities(plant_context)
        velocities[self._driven_v] = self._wired(context, "qdot")
        self._plant.SetVelocities(plant_context, velocities)
        self._wired(context, "qddot")

    def _wired(self, context: Context, name: str) -> Array:
        port = self.GetInputPort(name)
        if not port.HasValue(context):
            raise InvalidValueError(
                f"the input {name!r} of {self.get_name()!r} is not connected; wire the motion's "
                "derivatives, or get them from an InputFilter"
            )
        value: Array = port.Eval(context)
        return value

    def _reference_matrix(self, stiffness: float) -> Array:
        """Matrix from (q, qdot, state, qddot) to the driven joints' accelerations."""
        n, nq = len(self._driven_v), self._plant.num_positions()
        pull, brake = stiffness, 2.0 * stiffness**0.5
        sensed = np.zeros((n, self._plant.num_multibody_states()))
        sensed[np.arange(n), self._driven_q] = -pull
        sensed[np.arange(n), nq + self._driven_v] = -brake
        one = np.eye(n)
        return np.hstack([pull * one, brake * one, sensed, one])

    def _add_full_dynamics(self, builder: DiagramBuilder) -> None:
        """Add Drake's inverse dynamics of the whole plant, which is fast."""
        plant = self._believed
        mode = InverseDynamics.InverseDynamicsMode.kInverseDynamics
        dynamics = builder.AddNamedSystem("inverse dynamics", InverseDynamics(plant, mode))
        actuators = builder.AddNamedSystem("actuators", MatrixGain(plant.MakeActuationMatrix().T))
        force = dynamics.GetOutputPort("generalized_force")
        reference = builder.GetSubsystemByName("acceleration").get_output_port()
        builder.Connect(reference, dynamics.GetInputPort("desired_acceleration"))
        builder.Connect(force, actuators.get_input_port())
        builder.ConnectInput("state", dynamics.GetInputPort("estimated_state"))
        builder.ExportOutput(actuators.get_output_port(), "torque")
        builder.ExportOutput(force, "generalized_force")

    def _add_partial_dynamics(self, builder: DiagramBuilder, driven: list[Joint]) -> None:
        dynamics = builder.AddNamedSystem(
            "inverse dynamics", PartialInverseDynamics(self._believed, driven)
        )
        reference = builder.GetSubsystemByName("acceleration").get_output_port()
        builder.Connect(reference, dynamics.GetInputPort("acceleration"))
        builder.ConnectInput("state", dynamics.GetInputPort("state"))
        for name in OTHER_FORCES:
            builder.ExportInput(dynamics.GetInputPort(name), name)
        for name in ("torque", "generalized_force"):
            builder.ExportOutput(dynamics.GetOutputPort(name), name)


def require_actuators(plant: MultibodyPlant, what: str, advice: str = "") -> None:
    """Require an actuator at every joint, which ``what`` needs."""
    n = plant.num_velocities()
    if not plant.num_actuators() == plant.num_positions() == n:
        raise InvalidValueError(
            f"{plant.get_name()!r} has {plant.num_positions()} joint positions and "
            f"{plant.num_actuators()} actuators; {what} needs one at every joint",
            advice=advice,
        )
