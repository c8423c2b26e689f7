"""The command of a walking robot: where its body should be, and how it should move."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.walking.plan import Plan


class BodyCommand(LeafSystem):
    """Commands the body of a walking robot, as its plan says.

    ============ ==== ==== ============ ====================================================
    port         kind size unit         meaning
    ============ ==== ==== ============ ====================================================
    ``twist``    out  6    rad/s, m/s   of the body B in the ground's frame, in B; rotation first
    ``pose``     out  12   -, m         R_GB row by row, then p_GB
    ============ ==== ==== ============ ====================================================
    """

    def __init__(self, plan: Plan) -> None:
        LeafSystem.__init__(self)
        self._plan = plan
        now = {self.time_ticket()}
        self.DeclareVectorOutputPort("twist", 6, self._calc_twist, now)
        self.DeclareVectorOutputPort("pose", 12, self._calc_pose, now)

    def _calc_twist(self, context: Context, twist: BasicVector) -> None:
        twist.SetFromVector(self._plan.at(context.get_time()).twist)

    def _calc_pose(self, context: Context, pose: BasicVector) -> None:
        X_GB = self._plan.at(context.get_time()).X_GB
        pose.SetFromVector([*X_GB[:3, :3].ravel().tolist(), *X_GB[:3, 3].tolist()])
