"""The gait of a walking robot: from the motion of its body to the motion of its feet."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.walking.plan import WalkPlan

PULL = 0.5  # of the way to the planned place, in a time step
_FUNCTIONS = (math.cos, math.sin)


class GaitBlock(LeafSystem):
    """Computes the velocities of the feet for a velocity of the body.

    A foot that stands is at rest on the ground, so that in the body's frame it moves as the body
    does not; a foot that swings has the velocity of its swing, too. Each foot is drawn to its
    planned place in the body's frame, against the drift of the integrators; where the body's pose
    is fed back, only while it swings.

    ============ ==== ==== ============ ====================================================
    port         kind size unit         meaning
    ============ ==== ==== ============ ====================================================
    ``twist``    in   6    rad/s, m/s   of the body B, in B; rotation first
    ``q``        in   3 n  rad          joint positions, as integrated, leg by leg
    ``v``        out  3 n  m/s          velocities of the feet in B, leg by leg
    ============ ==== ==== ============ ====================================================

    Parameters
    ----------
    plan : WalkPlan
        Of the feet.
    legs : sequence of Movable
        In the order of the plan's feet.
    draws_standing_feet : bool
        Whether standing feet are drawn to their planned places, too.
    """

    def __init__(
        self, plan: WalkPlan, legs: Sequence[Movable], *, draws_standing_feet: bool
    ) -> None:
        LeafSystem.__init__(self)
        self._plan, self._legs, self._draws_all = plan, tuple(legs), draws_standing_feet
        self._pull = PULL / plan.step  # [1/s]
        self._twist = self.DeclareVectorInputPort("twist", 6)
        self._q = self.DeclareVectorInputPort("q", 3 * len(self._legs))
        self.DeclareVectorOutputPort("v", 3 * len(self._legs), self._calc_v)

    def _calc_v(self, context: Context, v: BasicVector) -> None:
        wx, wy, wz, vx, vy, vz = self._twist.Eval(context).tolist()
        q = self._q.Eval(context).tolist()
        row = self._plan.at(context.get_time())
        found: list[float] = []
        for number, (leg, wanted, swing, down) in enumerate(
            zip(self._legs, row.feet.tolist(), row.swing.tolist(), row.down.tolist(), strict=True)
        ):
            x, y, z = leg.task_position(q[3 * number : 3 * number + 3], _FUNCTIONS)
            pull = self._pull if self._draws_all or not down else 0.0
            found += (
                swing[0] - (vx + wy * z - wz * y) + pull * (wanted[0] - x),
                swing[1] - (vy + wz * x - wx * z) + pull * (wanted[1] - y),
                swing[2] - (vz + wx * y - wy * x) + pull * (wanted[2] - z),
            )
        v.SetFromVector(found)
