"""What keeps a run's steps fine near a singularity, and stops it where one is met."""

from __future__ import annotations

import math
from typing import NamedTuple

from pydrake.systems.framework import Context, Diagram

from drake_leg.diagrams.disturbance import is_disturbed
from drake_leg.errors import LostMotionError
from drake_leg.systems.foot_push import FootPush
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.prescribed_motion import PrescribedMotion

TIME_LEFT = 5e-10  # [s] before the instant of a singularity, at which a run stops
NEARLY_SINGULAR = 0.02  # normalised determinant below which the joints must follow closely
LARGEST_LAG = 1e-6  # [rad or m] of the joints behind their prescribed motion there
APPROACH = 0.03  # part of the determinant that a step changes, at most
NEAR, NEAR_APPROACH = 0.3, 0.02  # below this normalised determinant it is this part
LARGEST_TURN = 0.05  # [rad or m] of a joint in a step
GROWTH = 1.2  # from one step to the next, at most
SHRINK = 1.5  # from one trial to the next
SMALLEST_STEP = 1e-13  # [s]
DAMPED_STEP = 1.5  # of the time constant of a damped inverse, at most


class _Watched(NamedTuple):
    block: InverseJacobian
    sign: float  # of the determinant at the start


class Guard:
    """Chooses every next step so that no singularity is jumped across, and stops before it.

    The joints' rates and accelerations tell beforehand how far a step will change the
    determinant. Steps that change it by a small part approach a zero in a geometric sequence of
    instants, whether it falls linearly (the foot comes to the hip axis) or like the root of the
    time that is left (the leg stretches): where the determinant over its rate of change is less
    than ``TIME_LEFT``, the zero is not farther than that. A motion that turns away before, however
    near, goes on.

    Joints that are disturbed do not follow their motion: what they do is told by their sensed
    rates, and a lag is no error of the integration.

    Parameters
    ----------
    diagram : Diagram
        With inverse-Jacobian blocks, or without.
    context : Context
        Its root context at the start.
    max_step : float
        [s].
    """

    def __init__(self, diagram: Diagram, context: Context, max_step: float) -> None:
        systems = diagram.GetSystems()
        self._watched = []
        for block in systems:
            if isinstance(block, InverseJacobian):
                determinant = block.normalised_determinant(block.GetMyContextFromRoot(context))
                self._watched.append(_Watched(block, math.copysign(1.0, determinant)))
        self._disturbed = is_disturbed(diagram)
        self._motions = [s for s in systems if isinstance(s, PrescribedMotion)]
        self._pushes = [s for s in systems if isinstance(s, FootPush)]
        self._max_step = max_step
        self._step = max_step

    def next_step(self, root: Context) -> float:
        """Return how far the next step may go.

        Parameters
        ----------
        root : Context
            Of the diagram, after a step.

        Returns
        -------
        float
            [s].

        Raises
        ------
        SingularConfigurationError
            Where a singularity is reached.
        LostMotionError
            Where the joints do not follow closely enough to tell.
        """
        step = min(GROWTH * self._step, self._max_step)
        for push in self._pushes:
            step = min(step, push.longest_step(root.get_time()))
        for block, sign in self._watched:
            context = block.GetMyContextFromRoot(root)
            if block.is_exact:
                step = self._towards(root, block, context, sign, step)
            else:
                step = self._through(block, context, step)
        self._step = max(step, SMALLEST_STEP)
        return self._step

    def _towards(
        self, root: Context, block: InverseJacobian, context: Context, sign: float, step: float
    ) -> float:
        """Shorten a step so that it comes nearer to a singularity, and not across."""
        now = sign * block.normalised_determinant(context)
        if now <= 0.0:
            raise block.singular(context)
        if now < NEARLY_SINGULAR and not self._disturbed:
            self._require_following(root)
        ahead = block.look_ahead(context, disturbed=self._disturbed)
        approach = NEAR_APPROACH if now < NEAR else APPROACH
        while step > SMALLEST_STEP:
            turn, change = ahead(step)
            if turn <= LARGEST_TURN and change <= approach:
                break
            step /= SHRINK
        if step < TIME_LEFT and ahead.time_left(step) < TIME_LEFT:
            raise block.singular(context)
        return step

    def _require_following(self, root: Context) -> None:
        for motion in self._motions:
            lag = motion.lag(motion.GetMyContextFromRoot(root))
            if lag > LARGEST_LAG:
                raise LostMotionError(time=root.get_time(), lag=lag)

    def _through(self, block: InverseJacobian, context: Context, step: float) -> float:
        """Shorten a step of a damped inverse to what its rates can follow."""
        ahead = block.look_ahead(context, disturbed=self._disturbed)
        slowest, stiffness = block.stiffness(context)
        least = DAMPED_STEP / slowest if slowest > 0.0 else step
        while step > least:
            turn, change = ahead(step)
            if turn <= LARGEST_TURN and change <= APPROACH:
                break
            step /= SHRINK
        while step > (kink := block.step_at_kink(context, step)):
            step = max(step / 2.0, kink)
        return min(step, DAMPED_STEP / stiffness) if stiffness > 0.0 else step
