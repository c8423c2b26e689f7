"""A mechanism whose every axis follows a motion: nothing of it has to be integrated."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.acting import Acting
from drake_leg.simulink.dynamics.at_ports import AtPorts
from drake_leg.simulink.multibody.mass import Array


def is_driven(acting: Acting) -> bool:
    """Tell whether motions alone say how a mechanism moves: it is a tree, every axis driven."""
    joints, plant = acting.joints, acting.plant
    motions = {motion.axis for motion in joints.motions}
    whole = len(motions) == len(joints.axes) == plant.num_velocities() == plant.num_positions()
    return whole and not joints.balls and not acting.constraints


class DrivenMechanism(AtPorts, LeafSystem):
    """A mechanism whose every axis follows a motion.

    Its ports are those of `MechanismSystem`; it has no state, and its positions and velocities are
    exactly those of its motions.

    ============ ==== ======== =====================================================
    port         kind size     meaning
    ============ ==== ======== =====================================================
    ``u``        in   n        position, velocity, acceleration of each axis, in SI
    ``sensed``   out  m        what depends on positions and velocities
    ``now``      out  m        the same, but only what `read_at_once` named
    ``efforts``  out  k        what depends on accelerations, too
    ``state``    out  nq + nv  of the plant: positions, then velocities
    ============ ==== ======== =====================================================

    Raises
    ------
    InvalidValueError
        If an axis of the mechanism is not driven, or a loop closes.
    """

    def __init__(self, acting: Acting, owner: object = None) -> None:
        super().__init__()
        self._owner = owner  # of the plant, which lives as long
        if not is_driven(acting):
            raise InvalidValueError("an axis of the mechanism follows no motion: integrate it")
        self._acting = acting
        joints = acting.joints
        order = [motion.axis for motion in joints.motions]
        self._first = np.array([motion.entries.start for motion in joints.motions])
        self._of_positions = np.linalg.inv(joints.A[order])
        self._offset = joints.b[order]
        self._of_velocities = np.linalg.inv(joints.S[order])
        self._u = self.DeclareVectorInputPort("u", acting.inputs.size)
        for name, size in (
            ("sensed", acting.sensed.size),
            ("now", acting.sensed.size),
            ("efforts", acting.efforts.size),
            ("state", acting.plant.num_multibody_states()),
        ):
            self.DeclareVectorOutputPort(name, size, getattr(self, f"_calc_{name}"))

    def state_at(self, u: Array) -> Array:
        """Return positions and velocities of the plant at inputs."""
        self._acting.require_finite(u)
        q = self._of_positions @ (u[self._first] - self._offset)
        return np.concatenate([q, self._of_velocities @ u[self._first + 1]])

    def start(self, context: Context, u: Array | None = None) -> None:
        """Do nothing: it has no state."""

    def follow(self, context: Context) -> None:
        """Do nothing: it is exactly on its motions."""

    def _calc_state(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.state_at(self._u.Eval(context)))

    def _calc_sensed(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._acting.sense(self._moved(context)))

    def _calc_now(self, context: Context, output: BasicVector) -> None:
        acting = self._acting
        reads_places = acting.reads_places
        state = self._moved(context) if reads_places else self.state_at(self._u.Eval(context))
        output.SetFromVector(acting.sense_now(state))

    def _moved(self, context: Context) -> Array:
        state = self.state_at(self._u.Eval(context))
        self._acting.moment.move_to(state)
        return state

    def _calc_efforts(self, context: Context, output: BasicVector) -> None:
        u: Any = self._u.Eval(context)
        self._acting.moment.move_to(self.state_at(u))
        vdot = self._of_velocities @ u[self._first + 2]
        output.SetFromVector(self._acting.respond(u, vdot))
