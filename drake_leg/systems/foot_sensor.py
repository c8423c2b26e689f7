"""What a walking robot feels in its feet."""

from __future__ import annotations

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.legs import Legs


class FootSensor(LeafSystem):
    """Senses the force of the ground on each foot.

    Forces follow from the contacts' torques at the joints, through the legs' Jacobians.

    =========== ==== ======= ========== ======================================================
    port        kind size    unit       meaning
    =========== ==== ======= ========== ======================================================
    ``q``       in   3 n     rad        joint positions, as sensed, leg by leg
    ``contact`` in   6 + 3 n N*m, N     generalized contact forces of the last time step
    ``body``    in   7       -, m       the body's quaternion (w, x, y, z); its place is not used
    ``force``   out  3 n     N          in the ground's frame, leg by leg
    ``feet``    out  3 n     m          feet p_BF in the body's frame, leg by leg
    =========== ==== ======= ========== ======================================================

    Parameters
    ----------
    legs : Legs
        Of the robot.
    X_WG : (4, 4) ndarray
        Pose of the ground.
    """

    def __init__(self, legs: Legs, X_WG: Array) -> None:
        LeafSystem.__init__(self)
        n = legs.count
        self._legs, self._R_WG = legs, X_WG[:3, :3].copy()
        self._q = self.DeclareVectorInputPort("q", 3 * n)
        self._contact = self.DeclareVectorInputPort("contact", 6 + 3 * n)
        self._body = self.DeclareVectorInputPort("body", 7)
        self.DeclareVectorOutputPort("force", 3 * n, self._calc_force)
        self.DeclareVectorOutputPort("feet", 3 * n, self._calc_feet, {self._q.ticket()})

    def _calc_force(self, context: Context, force: BasicVector) -> None:
        q, torques = self._q.Eval(context), self._contact.Eval(context)[6:]
        in_body = self._legs.forces(q.reshape(-1, 3), torques.reshape(-1, 3))
        quaternion = self._body.Eval(context)[:4]
        R_WB = Quaternion(quaternion / np.linalg.norm(quaternion)).rotation()
        force.SetFromVector((in_body @ (R_WB.T @ self._R_WG)).ravel())

    def _calc_feet(self, context: Context, feet: BasicVector) -> None:
        feet.SetFromVector(self._legs.feet(self._q.Eval(context).reshape(-1, 3)).ravel())
