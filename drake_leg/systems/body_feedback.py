"""Feedback on the pose of a walking robot's body."""

from __future__ import annotations

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.plan import difference
from drake_leg.units import require_positive


class BodyFeedback(LeafSystem):
    """Adds to the commanded twist what brings the body back to its commanded pose.

    The feet that stand integrate the twist, so that a lasting force leaves no lasting error.

    ============ ==== ==== ============ ====================================================
    port         kind size unit         meaning
    ============ ==== ==== ============ ====================================================
    ``command``  in   6    rad/s, m/s   commanded twist of the body B, in B; rotation first
    ``pose``     in   12   -, m         commanded R_GB row by row, then p_GB
    ``sensed``   in   7    -, m         the body's quaternion (w, x, y, z) and place in the world
    ``twist``    out  6    rad/s, m/s   the command, and ``rate`` times the difference of the poses
    ============ ==== ==== ============ ====================================================

    Parameters
    ----------
    X_WG : (4, 4) ndarray
        Pose of the ground.
    rate : float
        At which a difference decays [1/s].
    """

    def __init__(self, X_WG: Array, rate: float) -> None:
        LeafSystem.__init__(self)
        require_positive("the rate of the body's feedback", rate, "1/s")
        self._R_GW, self._p_WG, self._rate = X_WG[:3, :3].T.copy(), X_WG[:3, 3].copy(), rate
        self._command = self.DeclareVectorInputPort("command", 6)
        self._pose = self.DeclareVectorInputPort("pose", 12)
        self._sensed = self.DeclareVectorInputPort("sensed", 7)
        self.DeclareVectorOutputPort("twist", 6, self._calc_twist)

    def _calc_twist(self, context: Context, twist: BasicVector) -> None:
        pose, sensed = self._pose.Eval(context), self._sensed.Eval(context)
        X_GB = np.eye(4)
        X_GB[:3, :3], X_GB[:3, 3] = pose[:9].reshape(3, 3), pose[9:]
        R_WS = Quaternion(sensed[:4] / np.linalg.norm(sensed[:4])).rotation()
        p_GS = self._R_GW @ (sensed[4:] - self._p_WG)
        off = difference(X_GB, self._R_GW @ R_WS, p_GS)
        command = self._command.Eval(context).tolist()
        twist.SetFromVector(
            [wanted + self._rate * error for wanted, error in zip(command, off, strict=True)]
        )
