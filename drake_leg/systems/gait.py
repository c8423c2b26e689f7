"""The gait of a walking robot: from the motion of its body to the motion of its feet."""

from __future__ import annotations

import math

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.walking.plan import Plan

PULL = 0.5  # of the way to the planned place, in a time step
_FUNCTIONS = (math.cos, math.sin)


class GaitBlock(LeafSystem):
    """Computes the velocities of the feet for a velocity of the body.

    A foot that stands is at rest on the ground, so that in the body's frame it moves as the body
    does not; a foot that swings has the velocity of its swing, too, and is drawn to its planned
    place in the body's frame, against the drift of the integrators. A foot that stands is drawn in
    height alone: contacts hold its velocity, with the Jacobian of a step's beginning, and so it has
    the same drift along the ground. Where the body's pose is fed back, it is not drawn at all, and
    a swing ends where it lands under a levelled body. Where the feet sense the ground, their places
    come from a ``TouchDown`` block.

    ============== ==== ==== ============ ====================================================
    port           kind size unit         meaning
    ============== ==== ==== ============ ====================================================
    ``twist``      in   6    rad/s, m/s   of the body B, in B; rotation first
    ``q``          in   3 n  rad          joint positions, as integrated, leg by leg
    ``levelling``  in   3    rad, rad, m  roll, pitch and height that were added (optional)
    ``feet``       in   3 n  m            feet in B (optional, with the next two)
    ``swing``      in   3 n  m/s          velocities of the feet in the ground's frame, in B
    ``rests``      in   n    -            1 where a foot is at rest on the ground
    ``v``          out  3 n  m/s          velocities of the feet in B, leg by leg
    ============== ==== ==== ============ ====================================================

    Parameters
    ----------
    plan : Plan
        Of the feet.
    legs : Movable
        All of them, in the order of the plan's feet.
    """

    def __init__(self, plan: Plan, legs: Movable) -> None:
        LeafSystem.__init__(self)
        self._plan, self._legs = plan, legs
        joints = legs.joints
        self._pull = PULL / plan.step  # [1/s]
        self._twist = self.DeclareVectorInputPort("twist", 6)
        self._q = self.DeclareVectorInputPort("q", joints)
        self._levelling = self.DeclareVectorInputPort("levelling", 3)
        self._feet = self.DeclareVectorInputPort("feet", joints)
        self._swing = self.DeclareVectorInputPort("swing", joints)
        self._rests = self.DeclareVectorInputPort("rests", joints // 3)
        self.DeclareVectorOutputPort("v", joints, self._calc_v)

    def _calc_v(self, context: Context, v: BasicVector) -> None:
        wx, wy, wz, vx, vy, vz = self._twist.Eval(context).tolist()
        feet = iter(self._legs.task_position(self._q.Eval(context).tolist(), _FUNCTIONS))
        is_fed_back = self._levelling.HasValue(context)
        roll, pitch, up = self._levelling.Eval(context).tolist() if is_fed_back else (0.0, 0.0, 0.0)
        found: list[float] = []
        for (px, py, pz), (sx, sy, sz), rests, x, y, z in zip(
            *self._planned(context), feet, feet, feet, strict=True
        ):
            aside = 0.0 if rests else self._pull
            upwards = 0.0 if rests and is_fed_back else self._pull
            found += (
                sx - (vx + wy * z - wz * y) + aside * (px - pitch * z - x),
                sy - (vy + wz * x - wx * z) + aside * (py + roll * z - y),
                sz - (vz + wx * y - wy * x) + upwards * (pz - up - roll * y + pitch * x - z),
            )
        v.SetFromVector(found)

    def _planned(self, context: Context) -> tuple[list[list[float]], list[list[float]], list[bool]]:
        """Planned feet and their velocities, (n, 3), and whether each is at rest, (n,)."""
        if not self._feet.HasValue(context):
            row = self._plan.at(context.get_time())
            return row.feet.tolist(), row.swing.tolist(), row.down.tolist()
        feet, swing = (
            port.Eval(context).reshape(-1, 3).tolist() for port in (self._feet, self._swing)
        )
        return feet, swing, (self._rests.Eval(context) > 0.5).tolist()
