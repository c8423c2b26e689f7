"""The planned torques of a walking robot's joints."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.walking.plan import Plan


class FeedForward(LeafSystem):
    """Feeds the planned torques of the joints to the servos: they carry the robot's weight.

    ============ ==== ==== ============ ====================================================
    port         kind size unit         meaning
    ============ ==== ==== ============ ====================================================
    ``torque``   out  3 n  N*m          of the joints, leg by leg
    ============ ==== ==== ============ ====================================================
    """

    def __init__(self, plan: Plan) -> None:
        LeafSystem.__init__(self)
        self._plan = plan
        size = len(plan.at(0.0).torques)
        self.DeclareVectorOutputPort("torque", size, self._calc_torque, {self.time_ticket()})

    def _calc_torque(self, context: Context, torque: BasicVector) -> None:
        torque.SetFromVector(self._plan.at(context.get_time()).torques)
