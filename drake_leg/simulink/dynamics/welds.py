"""Keeps the two parts of a body together that was split to open a loop."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from drake_leg.simulink.dynamics.moment import Moment
from drake_leg.simulink.dynamics.opening import Weld
from drake_leg.simulink.dynamics.solver import PULL, Constraint
from drake_leg.simulink.dynamics.turns import rotvec
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.multibody.mass import Array

_ORIGIN = np.zeros(3)


class Welded(Constraint):
    """Six rows: the part neither turns nor moves in the body [rad/s^2, m/s^2]."""

    def __init__(self, weld: Weld) -> None:
        self.weld = weld

    def __len__(self) -> int:
        """Return 6."""
        return 6

    def gap(self, moment: Moment) -> Array:
        """Return how far the part is turned and moved from its place, in the body [rad, m]."""
        X_WB, X_WP = moment.body_pose(self.weld.body), moment.body_pose(self.weld.part)
        X_BE, R_BW = self.weld.X_BE, X_WB[:, :3].T
        turn = rotvec(R_BW @ X_WP[:, :3] @ X_BE[:3, :3].T)
        return np.concatenate([turn, R_BW @ (X_WP[:, 3] - X_WB[:, 3]) - X_BE[:3, 3]])

    def jacobian(self, moment: Moment) -> Array:
        """Return the twist of the part in the body per velocity of the plant, (6, nv)."""
        body, part = (moment.bodies[n].body_frame() for n in (self.weld.body, self.weld.part))
        J: Array = moment.plant.CalcJacobianSpatialVelocity(
            moment.context, JacobianWrtVariable.kV, part, _ORIGIN, body, body
        )
        return J

    def rows(self, moment: Moment) -> tuple[Array, Array]:
        """Return J (6, nv) and c (6,)."""
        body, part = (moment.bodies[n].body_frame() for n in (self.weld.body, self.weld.part))
        J = self.jacobian(moment)
        bias = moment.plant.CalcBiasSpatialAcceleration(
            moment.context, JacobianWrtVariable.kV, part, _ORIGIN, body, body
        ).get_coeffs()
        return J, -bias - 2.0 * PULL * (J @ moment.v) - PULL**2 * self.gap(moment)

    def act(self, moment: Moment, multipliers: Array, wrenches: Wrenches) -> None:
        """Add the wrenches on the part, and their opposites on the body."""
        R_WB, p = moment.body_pose(self.weld.body)[:, :3], moment.body_pose(self.weld.part)[:, 3]
        torque, force = R_WB @ multipliers[:3], R_WB @ multipliers[3:]
        wrenches.add(moment, self.weld.part, p, force, torque)
        wrenches.add(moment, self.weld.body, p, -force, -torque)
