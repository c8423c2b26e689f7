"""The command of a walking robot: where its body should be, and how it should move."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.walking.plan import Plan


class BodyCommand(LeafSystem):
    """Commands the body of a walking robot, as its plan says.

    Where feet sense the ground, the body follows its height.

    ============ ==== ==== ============ ====================================================
    port         kind size unit         meaning
    ============ ==== ==== ============ ====================================================
    ``ground``   in   2    m, m/s       height of the ground, and its rate (optional)
    ``twist``    out  6    rad/s, m/s   of the body B in the ground's frame, in B; rotation first
    ``pose``     out  12   -, m         R_GB row by row, then p_GB
    ============ ==== ==== ============ ====================================================
    """

    def __init__(self, plan: Plan) -> None:
        LeafSystem.__init__(self)
        self._plan = plan
        self._ground = self.DeclareVectorInputPort("ground", 2)
        now = {self.time_ticket(), self._ground.ticket()}
        self.DeclareVectorOutputPort("twist", 6, self._calc_twist, now)
        self.DeclareVectorOutputPort("pose", 12, self._calc_pose, now)

    def _calc_twist(self, context: Context, twist: BasicVector) -> None:
        row = self._plan.at(context.get_time())
        if self._ground.HasValue(context):
            climb = float(self._ground.Eval(context)[1])
            twist.SetFromVector([*row.twist[:3], *(row.twist[3:] + climb * row.X_GB[2, :3])])
        else:
            twist.SetFromVector(row.twist)

    def _calc_pose(self, context: Context, pose: BasicVector) -> None:
        X_GB = self._plan.at(context.get_time()).X_GB
        x, y, z = X_GB[:3, 3].tolist()
        if self._ground.HasValue(context):
            z += float(self._ground.Eval(context)[0])
        pose.SetFromVector([*X_GB[:3, :3].ravel().tolist(), x, y, z])
