"""Joints that follow a given motion, with the torque computed: Simscape's motion input."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.controllers import InverseDynamics
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import MatrixGain, Multiplexer

from drake_leg.errors import InvalidValueError
from drake_leg.robot import require_non_negative

# Pulls the joints back onto the prescribed motion against the integrator's rounding: so weak
# that it does not stiffen the loop, so that a step of 40 ms stays accurate.
STIFFNESS = 4.0  # [1/s^2]


class PrescribedMotion(Diagram):
    """Torques that make every joint of a plant follow its prescribed motion.

    ``tau = M (qddot + 2 sqrt(k) (qdot - qdot_s) + k (q - q_s)) + C - g - tau_passive`` at the
    sensed state (q_s, qdot_s): with the three inputs consistent and the joints starting on the
    motion, they stay on it and the torque is exactly that of inverse dynamics.

    ========== ===== ====== ======== =============================================
    port       kind  size   unit     meaning
    ========== ===== ====== ======== =============================================
    ``state``  in    2 n    rad, /s  the plant's state (positions, then velocities)
    ``q``      in    n      rad      prescribed positions
    ``qdot``   in    n      rad/s    their first derivative
    ``qddot``  in    n      rad/s^2  their second derivative
    ``torque`` out   n      N*m      actuation, in the plant's actuator order
    ========== ===== ====== ======== =============================================

    Parameters
    ----------
    plant : MultibodyPlant
        Finalised, fully actuated, on a fixed base.
    stiffness : float
        k, of the pull towards the motion [1/s^2].

    Raises
    ------
    InvalidValueError
        If the plant has joints without actuators, or the stiffness is negative.
    """

    def __init__(self, plant: MultibodyPlant, stiffness: float = STIFFNESS) -> None:
        super().__init__()
        require_non_negative("the motion's stiffness", stiffness, "1/s^2")
        n = plant.num_velocities()
        if not plant.num_actuators() == plant.num_positions() == n:
            raise InvalidValueError(
                f"{plant.get_name()!r} has {n} joint positions and {plant.num_actuators()} "
                "actuators; every joint needs one to follow a prescribed motion"
            )
        one = np.eye(n)
        pull, brake = stiffness * one, 2.0 * stiffness**0.5 * one
        builder = DiagramBuilder()
        signals = builder.AddNamedSystem("q, qdot, state, qddot", Multiplexer([n, n, 2 * n, n]))
        reference = builder.AddNamedSystem(
            "acceleration", MatrixGain(np.hstack([pull, brake, -pull, -brake, one]))
        )
        dynamics = builder.AddNamedSystem(
            "inverse dynamics",
            InverseDynamics(plant, InverseDynamics.InverseDynamicsMode.kInverseDynamics),
        )
        actuators = builder.AddNamedSystem("actuators", MatrixGain(plant.MakeActuationMatrix().T))

        for index, name in enumerate(("q", "qdot", "state", "qddot")):
            port = builder.ExportInput(signals.get_input_port(index), name)
            if name == "state":
                builder.ConnectInput(port, dynamics.GetInputPort("estimated_state"))
        builder.Connect(signals.get_output_port(), reference.get_input_port())
        builder.Connect(reference.get_output_port(), dynamics.GetInputPort("desired_acceleration"))
        builder.Connect(dynamics.GetOutputPort("generalized_force"), actuators.get_input_port())
        builder.ExportOutput(actuators.get_output_port(), "torque")
        builder.BuildInto(self)
        self._positions = n
        self._q = self.GetInputPort("q")
        self._state = self.GetInputPort("state")

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
        sensed = self._state.Eval(context)[: self._positions]
        return float(np.abs(self._q.Eval(context) - sensed).max())
