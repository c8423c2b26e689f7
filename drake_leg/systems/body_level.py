"""A walking robot's body that is levelled by the direction of gravity alone."""

from __future__ import annotations

import math

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.plan import levelling_twist
from drake_leg.units import require_positive


class BodyLevel(LeafSystem):
    """Turns the body until its roll and pitch, against gravity, are the planned ones.

    It knows what an inertial measurement unit knows: which way is up. Heading and place are not
    used. What it has turned already is its state, by which the commanded twist is turned, too, so
    that on a slope a level body moves along the slope.

    ============== ==== ==== ============ ====================================================
    port           kind size unit         meaning
    ============== ==== ==== ============ ====================================================
    ``command``    in   6    rad/s, m/s   commanded twist of the body B, in B; rotation first
    ``pose``       in   12   -, m         commanded R_GB row by row, then p_GB, not used
    ``sensed``     in   7    -, m         the body's quaternion (w, x, y, z); its place is not used
    ``twist``      out  6    rad/s, m/s   command and correction
    ``levelling``  out  3    rad, rad, m  roll, pitch that were added, and 0
    ============== ==== ==== ============ ====================================================

    Parameters
    ----------
    rate : float
        At which an error decays [1/s].
    time_step : float
        [s].
    """

    def __init__(self, rate: float, time_step: float) -> None:
        LeafSystem.__init__(self)
        require_positive("the rate of the body's levelling", rate, "1/s")
        require_positive("the time step", time_step, "s")
        self._rate, self._time_step = rate, time_step
        self._command = self.DeclareVectorInputPort("command", 6)
        self._pose = self.DeclareVectorInputPort("pose", 12)
        self._sensed = self.DeclareVectorInputPort("sensed", 7)
        self.DeclareVectorOutputPort("twist", 6, self._calc_twist)
        state = self.DeclareDiscreteState(3)
        self.DeclareStateOutputPort("levelling", state)
        self.DeclarePeriodicDiscreteUpdateEvent(time_step, 0.0, self._level)

    def _correction(self, context: Context) -> Array:
        planned = self._pose.Eval(context)[6:9]  # upwards, in B
        quaternion = self._sensed.Eval(context)[:4]
        sensed = Quaternion(quaternion / np.linalg.norm(quaternion)).rotation()[2]
        return self._rate * levelling_twist(planned, sensed)

    def _calc_twist(self, context: Context, twist: BasicVector) -> None:
        roll, pitch, _ = context.get_discrete_state_vector().CopyToVector().tolist()
        command = self._command.Eval(context)
        turned = [_turned(part, roll, pitch) for part in (command[:3], command[3:])]
        twist.SetFromVector([*(turned[0] + self._correction(context)), *turned[1]])

    def _level(self, context: Context, state: DiscreteValues) -> None:
        roll, pitch, _ = self._correction(context).tolist()
        before = context.get_discrete_state_vector().CopyToVector()
        state.set_value(before + self._time_step * np.array([roll, pitch, 0.0]))


def _turned(vector: Array, roll: float, pitch: float) -> Array:
    """Vector (3,) in the frame that roll and pitch turned."""
    angle = math.hypot(roll, pitch)
    if angle == 0.0:
        return vector
    axis = np.array([roll, pitch, 0.0]) / angle
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(c * vector - s * np.cross(axis, vector) + (1.0 - c) * (axis @ vector) * axis)
