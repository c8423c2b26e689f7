"""A push on a frame of a plant, from outside."""

from __future__ import annotations

import math

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.multibody.tree import Frame
from pydrake.systems.framework import Context, LeafSystem

from drake_leg.kinematics.motions import Push

STEPS_OF_PUSH = 20  # steps of the integrator, at least, while it lasts
NEVER_AGAIN = 1e12  # [s], period of an event that happens once


class FootPush(LeafSystem):
    """The force of a push at the origin of a frame, for the plant's ``applied_spatial_force``.

    ================== ==== ======== ==================================================
    port               kind size     meaning
    ================== ==== ======== ==================================================
    ``spatial_forces`` out  abstract one force [N] in the world frame, without a moment
    ================== ==== ======== ==================================================

    The integrator ends a step where the push begins, and one where it ends.

    Parameters
    ----------
    frame : Frame
        Of a plant, fixed to one of its bodies.
    push : Push
        Its force over time; the plant's base frame is the world's.
    """

    def __init__(self, frame: Frame, push: Push) -> None:
        super().__init__()
        self.push = push
        self._body = frame.body().index()
        self._p_BoFo_B = frame.GetFixedPoseInBodyFrame().translation()
        self.DeclareAbstractOutputPort(
            "spatial_forces",
            lambda: AbstractValue.Make([ExternallyAppliedSpatialForce()]),
            self._calc_forces,
            {self.time_ticket()},
        )
        for instant in (push.at, push.end):
            self.DeclarePeriodicPublishEvent(NEVER_AGAIN, instant, _nothing)

    def longest_step(self, time: float) -> float:
        """Return how long a step may be, for the push to be seen.

        Parameters
        ----------
        time : float
            At the beginning of the step [s].

        Returns
        -------
        float
            [s]; infinite before and after the push.
        """
        pushing = self.push.at <= time < self.push.end
        return self.push.lasting / STEPS_OF_PUSH if pushing else math.inf

    def _calc_forces(self, context: Context, forces: AbstractValue) -> None:
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self._body
        applied.p_BoBq_B = self._p_BoFo_B
        applied.F_Bq_W = SpatialForce(np.zeros(3), self.push.at_time(context.get_time()))
        forces.set_value([applied])


def _nothing(context: Context) -> None:
    """Happen: an event's time ends a step of the integrator."""
