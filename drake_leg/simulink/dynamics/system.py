"""The mechanism of a Simulink model as a Drake diagram: its plant, and what acts on it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydrake.systems.framework import (
    BasicVector,
    Context,
    Diagram,
    DiagramBuilder,
    LeafSystem,
)

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.acting import Acting
from drake_leg.simulink.dynamics.applied import LawOfContact
from drake_leg.simulink.dynamics.at_ports import AtPorts
from drake_leg.simulink.dynamics.driven import DrivenMechanism, is_driven
from drake_leg.simulink.dynamics.start import start_of, unguided_loops
from drake_leg.simulink.model import Model
from drake_leg.simulink.multibody.bodies import Mechanism, mechanism_of
from drake_leg.simulink.multibody.connections import refuse
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.plant import mechanism_plant, prove_mechanism
from drake_leg.simulink.networks.reflection import Reflected

Contact = LawOfContact


class MechanismSystem(AtPorts, Diagram):
    """The plant of a mechanism, driven and sensed at the ports of its Simulink model.

    ============ ==== ======== =====================================================
    port         kind size     meaning
    ============ ==== ======== =====================================================
    ``u``        in   n        signals that enter the mechanism, in SI: ``inputs``
    ``sensed``   out  m        what depends on the state alone: ``sensed``
    ``now``      out  m        the same, but only what `read_at_once` named
    ``efforts``  out  k        what depends on ``u``, too: ``efforts``
    ``state``    out  nq + nv  of the plant: positions, then velocities
    ============ ==== ======== =====================================================

    Entries of the vectors belong to ports of Simscape, such as ``12#rconn:2``. A force or a torque
    that is an input has its width; a motion has three entries: position, velocity, acceleration.
    Inputs are 0 where ``u`` is not connected. All states are continuous.
    """

    def __init__(self, acting: Acting) -> None:
        super().__init__()
        self._acting = acting
        builder = DiagramBuilder()
        plant = builder.AddNamedSystem("plant", acting.plant)
        forces = builder.AddNamedSystem("forces", _Forces(acting))
        builder.Connect(plant.get_state_output_port(), forces.GetInputPort("state"))
        builder.Connect(
            plant.get_generalized_acceleration_output_port(), forces.GetInputPort("vdot")
        )
        builder.Connect(
            forces.GetOutputPort("force"), plant.get_applied_generalized_force_input_port()
        )
        builder.ExportInput(forces.GetInputPort("u"), "u")
        for name in ("sensed", "now", "efforts"):
            builder.ExportOutput(forces.GetOutputPort(name), name)
        builder.ExportOutput(plant.get_state_output_port(), "state")
        builder.BuildInto(self)

    def respond(self, state: Array, u: Array) -> Array:
        """Return ``efforts`` at a state (nq + nv,) of the plant and inputs (n,), at no context."""
        acting = self._acting
        acting.moment.move_to(state)
        return acting.respond(u, acting.accelerations(u))

    @property
    def is_driven(self) -> bool:
        """Whether motions alone say how it moves."""
        return is_driven(self._acting)

    def driven(self) -> DrivenMechanism:
        """Return the same mechanism without states, where motions alone say how it moves."""
        return DrivenMechanism(self._acting, self)

    def CreateDefaultContext(self) -> Context:
        """Return a context at the state targets, where loops are closed."""
        context = super().CreateDefaultContext()
        self.start(context)
        return context

    def unguided_loops(self, u: Array | None = None) -> list[str]:
        """Name the joints at which loops close while no state target says to which side."""
        return unguided_loops(self._acting, u)

    @property
    def contact(self) -> Contact:
        """The law of contact."""
        return self._acting.contact

    @property
    def touches(self) -> bool:
        """Whether bodies may touch, which makes its equations stiff."""
        return self._acting.applied.touches

    def start(self, context: Context, u: Array | None = None) -> None:
        """Set the state where the mechanism starts: at its state targets, loops closed.

        Parameters
        ----------
        context : Context
            That of this system alone, or that of the whole diagram that holds it.
        u : (n,), optional
            The inputs at the start; driven axes are at their motions there.

        Raises
        ------
        InvalidValueError
            If loops cannot be closed there, or an input is not finite.
        """
        if u is not None:
            self._acting.require_finite(u)
        plant, state = self._acting.plant, start_of(self._acting, u)
        plant.SetPositionsAndVelocities(plant.GetMyMutableContextFromRoot(context), state)

    def follow(self, context: Context) -> None:
        """Put driven axes exactly on their motions, against the integrator's errors.

        Between two steps of a simulator it takes the little that they are off away: by a
        Runge-Kutta integrator of order 3, some 1e-8 of the motion at an accuracy of 1e-6.

        Parameters
        ----------
        context : Context
            That of this system alone, or that of the whole diagram that holds it.
        """
        own = self.GetMyMutableContextFromRoot(context)
        port = self.GetInputPort("u")
        if self.motions and port.HasValue(own):
            u = port.Eval(own)
            self._acting.require_finite(u)
            plant = self._acting.plant
            plant_context = plant.GetMyMutableContextFromRoot(context)
            state = plant.GetPositionsAndVelocities(plant_context)
            plant.SetPositionsAndVelocities(plant_context, self._acting.joints.followed(state, u))


class _Forces(LeafSystem):
    """Computes what acts on the plant, and what is sensed.

    It computes at a scratch context of the plant; what it keeps of a state is only to not compute
    it twice.
    """

    def __init__(self, acting: Acting) -> None:
        super().__init__()
        self._acting = acting
        plant = acting.plant
        nv = plant.num_velocities()
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self._u = self.DeclareVectorInputPort("u", acting.inputs.size)
        self._vdot = self.DeclareVectorInputPort("vdot", nv)
        self._no_input = np.zeros(acting.inputs.size)
        state, u, vdot = self._state.ticket(), self._u.ticket(), self._vdot.ticket()
        self.DeclareVectorOutputPort("force", nv, self._calc_force, {state, u})
        self.DeclareVectorOutputPort("sensed", acting.sensed.size, self._calc_sensed, {state})
        self.DeclareVectorOutputPort("now", acting.sensed.size, self._calc_now, {state})
        self.DeclareVectorOutputPort(
            "efforts", acting.efforts.size, self._calc_efforts, {state, u, vdot}
        )

    def _inputs(self, context: Context) -> Array:
        u: Array = self._u.Eval(context) if self._u.HasValue(context) else self._no_input
        return u

    def _calc_force(self, context: Context, force: BasicVector) -> None:
        acting = self._acting
        acting.moment.move_to(self._state.Eval(context))
        force.SetFromVector(acting.solved(self._inputs(context)).force)

    def _calc_sensed(self, context: Context, sensed: BasicVector) -> None:
        self._acting.moment.move_to(self._state.Eval(context))
        sensed.SetFromVector(self._acting.sense(self._state.Eval(context)))

    def _calc_now(self, context: Context, sensed: BasicVector) -> None:
        self._acting.moment.move_to(self._state.Eval(context))
        sensed.SetFromVector(self._acting.sense_now(self._state.Eval(context)))

    def _calc_efforts(self, context: Context, efforts: BasicVector) -> None:
        self._acting.moment.move_to(self._state.Eval(context))
        efforts.SetFromVector(self._acting.respond(self._inputs(context), self._vdot.Eval(context)))


def mechanism_dynamics(
    model: Model,
    mechanism: Mechanism | None = None,
    *,
    contact: Contact = "smooth",
    where: Sequence[Path] = (),
    reflected: Sequence[Reflected] = (),
) -> MechanismSystem:
    """Build the mechanism of a model with all that acts on it.

    Contact is by the blocks' law, or by Drake's. By ``smooth`` it never pulls; by ``pulling`` its
    damper may pull while two bodies part: Simscape states neither. By ``drake`` it is Drake's point
    contact, with the blocks' stiffness, damping and friction. Geometry of CAD programs that touches
    is looked for in the folders ``where``; a contact whose geometry is not found is left out.
    What networks add to the inertia of joints is ``reflected``.

    Raises
    ------
    InvalidValueError
        That lists all that is missing; if the plant differs from its blocks.
    """
    mechanism = mechanism or mechanism_of(model)
    proof = prove_mechanism(mechanism, mechanism_plant(mechanism))
    if not proof.holds:
        raise InvalidValueError(f"{proof.difference()}: it does not run")
    acting = Acting(
        model,
        mechanism,
        where=where,
        contact=contact,
        reflected=reflected,
    )
    refuse(acting.problems)
    return MechanismSystem(acting)
