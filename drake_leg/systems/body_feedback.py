"""Feedback on the pose of a walking robot's body."""

from __future__ import annotations

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.plan import difference
from drake_leg.units import require_positive


class BodyFeedback(LeafSystem):
    """Adds to the commanded twist what brings the body back to its commanded pose.

    The feet that stand integrate the twist, so that a lasting force leaves no lasting error. For
    the feet that swing, the block integrates what levels the body: where they land next, its
    attitude and height are corrected, but its course is the planned one.

    ============== ==== ==== ============ ====================================================
    port           kind size unit         meaning
    ============== ==== ==== ============ ====================================================
    ``command``    in   6    rad/s, m/s   commanded twist of the body B, in B; rotation first
    ``pose``       in   12   -, m         commanded R_GB row by row, then p_GB
    ``sensed``     in   7    -, m         the body's quaternion (w, x, y, z), place in the world
    ``correction`` out  6    rad/s, m/s   ``rate`` times the difference of the poses
    ``twist``      out  6    rad/s, m/s   command and correction
    ``levelling``  out  3    rad, rad, m  its integral: roll, pitch, height
    ============== ==== ==== ============ ====================================================

    Parameters
    ----------
    X_WG : (4, 4) ndarray
        Pose of the ground.
    rate : float
        At which a difference decays [1/s].
    time_step : float
        [s].
    """

    def __init__(self, X_WG: Array, rate: float, time_step: float) -> None:
        LeafSystem.__init__(self)
        require_positive("the rate of the body's feedback", rate, "1/s")
        require_positive("the time step", time_step, "s")
        self._R_GW, self._p_WG = X_WG[:3, :3].T.copy(), X_WG[:3, 3].copy()
        self._rate, self._time_step = rate, time_step
        self._command = self.DeclareVectorInputPort("command", 6)
        self._pose = self.DeclareVectorInputPort("pose", 12)
        self._sensed = self.DeclareVectorInputPort("sensed", 7)
        self._correction = self.DeclareVectorOutputPort("correction", 6, self._calc_correction)
        self.DeclareVectorOutputPort("twist", 6, self._calc_twist)
        state = self.DeclareDiscreteState(3)
        self.DeclareStateOutputPort("levelling", state)
        self.DeclarePeriodicDiscreteUpdateEvent(time_step, 0.0, self._level)

    def _calc_correction(self, context: Context, correction: BasicVector) -> None:
        pose, sensed = self._pose.Eval(context), self._sensed.Eval(context)
        X_GB = np.eye(4)
        X_GB[:3, :3], X_GB[:3, 3] = pose[:9].reshape(3, 3), pose[9:]
        R_WS = Quaternion(sensed[:4] / np.linalg.norm(sensed[:4])).rotation()
        p_GS = self._R_GW @ (sensed[4:] - self._p_WG)
        off = difference(X_GB, self._R_GW @ R_WS, p_GS)
        correction.SetFromVector([self._rate * part for part in off])

    def _calc_twist(self, context: Context, twist: BasicVector) -> None:
        twist.SetFromVector(self._command.Eval(context) + self._correction.Eval(context))

    def _level(self, context: Context, state: DiscreteValues) -> None:
        roll, pitch, _, _, _, up = self._correction.Eval(context).tolist()
        before = context.get_discrete_state_vector().CopyToVector()
        state.set_value(before + self._time_step * np.array([roll, pitch, up]))
