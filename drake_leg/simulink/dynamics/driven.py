"""A mechanism whose every axis follows a motion: nothing of it has to be integrated."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
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
        first = np.array([motion.entries.start for motion in joints.motions])
        self._of_velocities = np.linalg.inv(joints.S[order])
        self._accelerations = first + 2
        nq = len(order)
        self._T = np.zeros((2 * nq, acting.inputs.size))  # state = T u + c
        self._T[:nq, first] = np.linalg.inv(joints.A[order])
        self._T[nq:, first + 1] = self._of_velocities
        self._c = np.zeros(2 * nq)
        self._c[:nq] = -self._T[:nq, first] @ joints.b[order]
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
        state: Array = self._T @ u + self._c
        return state

    def now_at(self, u: Array) -> Array:
        """Return what is read at once, at inputs."""
        acting, state = self._acting, self.state_at(u)
        if acting.reads_places:
            acting.moment.move_to(state)
        return acting.sense_now(state)

    @property
    def sensing(self) -> NDArray[np.bool_]:
        """Which entries of what is read at once may depend on which inputs, (m, n)."""
        found: NDArray[np.bool_] = self._acting.sensing @ (self._T != 0.0)
        return found

    def start(self, context: Context, u: Array | None = None) -> None:
        """Do nothing: it has no state."""

    def follow(self, context: Context) -> None:
        """Do nothing: it is exactly on its motions."""

    def _calc_state(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.state_at(self._u.Eval(context)))

    def _calc_sensed(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._acting.sense(self._moved(context)))

    def _calc_now(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.now_at(self._u.Eval(context)))

    def _moved(self, context: Context) -> Array:
        state = self.state_at(self._u.Eval(context))
        self._acting.moment.move_to(state)
        return state

    def _calc_efforts(self, context: Context, output: BasicVector) -> None:
        u: Any = self._u.Eval(context)
        self._acting.moment.move_to(self.state_at(u))
        vdot = self._of_velocities @ u[self._accelerations]
        output.SetFromVector(self._acting.respond(u, vdot))
