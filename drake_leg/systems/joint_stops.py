"""Enforces joint limits, which a continuous-time plant does not do by itself."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import BasicVector, Context

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.joint_stop import stop_force, stored_energy
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.systems.block import Block
from drake_leg.systems.partial_dynamics import joints_of_one_axis


class JointStops(Block):
    """Pushes joints back into their limits with Simscape's smoothed spring and damper.

    At a depth x beyond its bound, growing at the rate v, a joint is pushed back by
    ``(3 s^2 - 2 s^3) max(0, k x + d v)`` with ``s = x / width`` in 0 ... 1.

    ===================== ===== ======= ======== =============================================
    port                  kind  size    unit     meaning
    ===================== ===== ======= ======== =============================================
    ``state``             in    nq + nv rad, /s  the plant's state (positions, then velocities)
    ``generalized_force`` out   nv      N*m      for the plant's ``applied_generalized_force``
    ``energy``            out   1       J        stored in the springs of the stops
    ===================== ===== ======= ======== =============================================

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized.
    mechanics : mapping of str to JointMechanics
        By joint name; limits without a stop are ignored.

    Raises
    ------
    InvalidValueError
        If there is no such joint, if it has more than one axis, or if none has a stop.

    Examples
    --------
    >>> from drake_leg import PENDULUM, JointStops, build_plant
    >>> from drake_leg.robot.joint_mechanics import HardStop, JointMechanics
    >>> mechanics = JointMechanics(upper=1.0, upper_stop=HardStop.rotational())
    >>> block = JointStops(build_plant(PENDULUM), {"pivot": mechanics})
    >>> context = block.CreateDefaultContext()
    >>> _ = block.GetInputPort("state").FixValue(context, [1.01, 0.0])  # 0.01 rad too far
    >>> bool(block.GetOutputPort("generalized_force").Eval(context)[0] < 0)
    True
    """

    def __init__(self, plant: MultibodyPlant, mechanics: Mapping[str, JointMechanics]) -> None:
        Block.__init__(self, plant, mechanics)
        if not isinstance(mechanics, Mapping):
            raise InvalidValueError(
                f"the mechanics are {shown(mechanics)}; they must be a mapping from the names of "
                "joints to their JointMechanics"
            )
        for name, acting in mechanics.items():
            if not isinstance(acting, JointMechanics):
                raise InvalidValueError(
                    f"the mechanics of joint {name!r} are {acting!r}; they must be JointMechanics"
                )
        stopped = {name: acting for name, acting in mechanics.items() if acting.stops}
        self.mechanics: Mapping[str, JointMechanics] = stopped
        joints = joints_of_one_axis(plant, stopped)
        nq, nv = plant.num_positions(), plant.num_velocities()
        self._stops = [
            (joint.position_start(), nq + joint.velocity_start(), joint.velocity_start(), *bound)
            for joint, acting in zip(joints, stopped.values(), strict=True)
            for bound in acting.stops
        ]
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        used = {self._state.ticket()}
        self.DeclareVectorOutputPort("generalized_force", nv, self._calc_force, used)
        self.DeclareVectorOutputPort("energy", 1, self._calc_energy, used)

    def _calc_force(self, context: Context, force: BasicVector) -> None:
        state = self._state.Eval(context)
        total = np.zeros(force.size(), dtype=state.dtype)
        for at, rate, index, side, bound, stop in self._stops:
            depth = side * (state[at] - bound)
            if depth > 0.0:
                total[index] -= side * stop_force(stop, depth, side * state[rate])
        force.SetFromVector(total)

    def _calc_energy(self, context: Context, energy: BasicVector) -> None:
        state = self._state.Eval(context)
        stored = (
            stored_energy(stop, max(0.0, side * (state[at] - bound)))
            for at, _, _, side, bound, stop in self._stops
        )
        energy.SetFromVector([sum(stored)])
