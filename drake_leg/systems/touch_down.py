"""Feet that end their swings where they touch the ground."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    BasicVector,
    Context,
    DiscreteValues,
    LeafSystem,
    ValueProducer,
)

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.plan import Plan
from drake_leg.kinematics.walking.touch_down import Footholds, Footing, Search, after, footing
from drake_leg.units import require_positive


class TouchDown(LeafSystem):
    """Corrects planned feet by the ground that they feel, early or late.

    A foot that is loaded in the second half of its swing stays where it is; one that is not loaded
    at its planned touch-down searches downwards. The mathematics is in
    ``kinematics/walking/touch_down.py``; the footholds are the block's discrete state.

    ============= ==== ==== ============ ===================================================
    port          kind size unit         meaning
    ============= ==== ==== ============ ===================================================
    ``force``     in   3 n  N            of the ground on the feet, in its frame, leg by leg
    ``felt``      in   3 n  m            sensed feet in the body's frame, leg by leg
    ``levelling`` in   3    rad, rad, m  roll, pitch and height that were added (optional)
    ``body``      in   7    -, m         sensed pose, where its place is fed back (optional)
    ``feet``      out  3 n  m            feet in the planned body's frame B, leg by leg
    ``swing``     out  3 n  m/s          their velocities in the ground's frame, in B
    ``rests``     out  n    -            1 where a foot is at rest on the ground
    ``ground``    out  2    m, m/s       height of the ground under the body, and its rate
    ``states``    out  n    -            0 on time, 1 early, 2 late, 3 not found, 4 searches,
                                         5 swings, 6 lands as planned
    ============= ==== ==== ============ ===================================================

    Parameters
    ----------
    plan : Plan
        Of the feet.
    search : Search
        What a foot feels, and how it searches.
    X_WG : (4, 4) ndarray
        Pose of the ground.
    """

    def __init__(self, plan: Plan, search: Search, X_WG: Array) -> None:
        LeafSystem.__init__(self)
        require_positive("the time step", plan.step, "s")
        self._plan, self._search = plan, search
        self._normal, self._origin = X_WG[:3, 2].copy(), X_WG[:3, 3].copy()
        row = plan.at(0.0)
        n = len(row.feet)
        self._force = self.DeclareVectorInputPort("force", 3 * n)
        self._felt = self.DeclareVectorInputPort("felt", 3 * n)
        self._levelling = self.DeclareVectorInputPort("levelling", 3)
        self._body = self.DeclareVectorInputPort("body", 7)
        start = Footholds.planned(row.feet @ row.X_GB[:3, :3].T + row.X_GB[:3, 3])
        self.DeclareDiscreteState(start.values)
        state = {self.time_ticket(), self.xd_ticket()}
        here = ValueProducer(lambda: AbstractValue.Make(None), self._calc_footing)
        self._footing = self.DeclareCacheEntry("footing", here, state)
        self.DeclareVectorOutputPort("feet", 3 * n, self._calc_feet, state)
        self.DeclareVectorOutputPort("swing", 3 * n, self._calc_swing, state)
        self.DeclareVectorOutputPort("rests", n, self._calc_rests, state)
        self.DeclareVectorOutputPort("ground", 2, self._calc_ground, {self.xd_ticket()})
        self.DeclareVectorOutputPort("states", n, self._calc_states, {self.xd_ticket()})
        self.DeclarePeriodicDiscreteUpdateEvent(plan.step, 0.0, self._feel)

    def _now(self, context: Context) -> Footholds:
        return Footholds.of(context.get_discrete_state_vector().CopyToVector())

    def _calc_footing(self, context: Context, found: AbstractValue) -> None:
        row = self._plan.at(context.get_time())
        found.set_value(footing(self._now(context), row, self._plan.step))

    def _calc_feet(self, context: Context, feet: BasicVector) -> None:
        here: Footing = self._footing.Eval(context)
        feet.SetFromVector(here.feet.ravel())

    def _calc_swing(self, context: Context, swing: BasicVector) -> None:
        here: Footing = self._footing.Eval(context)
        swing.SetFromVector(here.swing.ravel())

    def _calc_rests(self, context: Context, rests: BasicVector) -> None:
        here: Footing = self._footing.Eval(context)
        rests.SetFromVector(here.rests.astype(np.float64))

    def _calc_ground(self, context: Context, ground: BasicVector) -> None:
        now = self._now(context)
        ground.SetFromVector([now.height, now.climb])

    def _calc_states(self, context: Context, states: BasicVector) -> None:
        states.SetFromVector(self._now(context).states)

    def _feel(self, context: Context, state: DiscreteValues) -> None:
        now, row = self._now(context), self._plan.at(context.get_time())
        felt = self._felt.Eval(context).reshape(-1, 3)
        offset = up = 0.0
        if self._levelling.HasValue(context):
            roll, pitch, up = self._levelling.Eval(context).tolist()
            felt = felt + np.cross([roll, pitch, 0.0], felt) + np.array([0.0, 0.0, up])
        if self._body.HasValue(context):
            height = float(self._normal @ (self._body.Eval(context)[4:] - self._origin))
            offset = height - (float(row.X_GB[2, 3]) + now.height) - up
        then = after(
            now,
            row,
            self._force.Eval(context).reshape(-1, 3),
            felt,
            search=self._search,
            step=self._plan.step,
            offset=offset,
        )
        state.set_value(then.values)
