"""Applies an external push to a frame of a plant."""

from __future__ import annotations

import math

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.math import SpatialForce_
from pydrake.multibody.plant import ExternallyAppliedSpatialForce_
from pydrake.multibody.tree import Frame
from pydrake.systems.framework import Context

from drake_leg.kinematics.differentiable import value_of
from drake_leg.kinematics.motions import Push
from drake_leg.systems.block import Block

STEPS_OF_PUSH = 20  # steps of the integrator, at least, while it lasts
NEVER_AGAIN = 1e12  # [s], period of an event that happens once


class FootPush(Block):
    """Pushes at the origin of a frame, through the plant's ``applied_spatial_force``.

    ================== ==== ======== ==================================================
    port               kind size     meaning
    ================== ==== ======== ==================================================
    ``spatial_forces`` out  abstract one force [N] in the world frame, without a moment;
                                     none before and after the push
    ================== ==== ======== ==================================================

    The integrator ends a step when the push begins, and another when it ends.

    Parameters
    ----------
    frame : Frame
        Frame fixed to a body of the plant.
    push : Push
        Force over time, in the world frame.
    """

    def __init__(self, frame: Frame, push: Push) -> None:
        Block.__init__(self, frame, push)
        self.push = push
        self._body = frame.body().index()
        self._p_BoFo_B = frame.GetFixedPoseInBodyFrame().translation()
        self.DeclareAbstractOutputPort(
            "spatial_forces",
            lambda: AbstractValue.Make([ExternallyAppliedSpatialForce_[self.scalar]()]),
            self._calc_forces,
            {self.time_ticket()},
        )
        for instant in (push.at, push.end):
            self.DeclarePeriodicPublishEvent(NEVER_AGAIN, instant, _nothing)

    def longest_step(self, time: float) -> float:
        """Return the longest step that still resolves the push.

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
        time = value_of(context.get_time())
        if not self.push.at < time < self.push.end:
            forces.set_value([])
            return
        applied = ExternallyAppliedSpatialForce_[self.scalar]()
        applied.body_index = self._body
        applied.p_BoBq_B = self._p_BoFo_B
        force = self.push.at_time(time)
        applied.F_Bq_W = SpatialForce_[self.scalar](np.zeros(3), force)
        forces.set_value([applied])


def _nothing(context: Context) -> None:
    """Do nothing: the event only ends a step of the integrator."""
