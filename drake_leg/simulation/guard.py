"""Shortens a run's time steps near a singularity, and stops the run at one."""

from __future__ import annotations

import math
from typing import NamedTuple

from pydrake.systems.framework import Context, Diagram

from drake_leg.diagrams.disturbance import is_disturbed
from drake_leg.errors import LostMotionError
from drake_leg.singularity.look_ahead import SMALLEST_STEP, step_through, step_towards
from drake_leg.systems.foot_push import FootPush
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.kinematic_loop import KinematicLoop
from drake_leg.systems.prescribed_motion import PrescribedMotion

NEARLY_SINGULAR = 0.02  # normalized determinant below which the joints must follow closely
LARGEST_LAG = 1e-6  # [rad or m] of the joints behind their prescribed motion there
GROWTH = 1.2  # from one step to the next, at most


class _Watched(NamedTuple):
    block: InverseJacobian | KinematicLoop
    sign: float  # of the determinant at the start


class Guard:
    """Chooses each step so that the run cannot jump across a singularity, and stops it there.

    ``singularity.look_ahead`` computes how long a step may be.

    Disturbed joints do not follow their prescribed motion: their sensed rates count, and a lag is
    no error of the integration.

    Parameters
    ----------
    diagram : Diagram
        With or without inverse Jacobian blocks or kinematic loops.
    context : Context
        Its root context at the start.
    max_step : float
        [s].
    guarded : bool
        Whether to watch the inverse Jacobians; pushes are always met by a step of their own.
    """

    def __init__(
        self, diagram: Diagram, context: Context, max_step: float, *, guarded: bool = True
    ) -> None:
        systems = diagram.GetSystems()
        self._watched = []
        for block in systems if guarded else ():
            if isinstance(block, InverseJacobian | KinematicLoop):
                q = block.posture(block.GetMyContextFromRoot(context))
                determinant = block.robot.normalised_determinant(q)
                self._watched.append(_Watched(block, math.copysign(1.0, determinant)))
        self._disturbed = is_disturbed(diagram)
        self._motions = [s for s in systems if isinstance(s, PrescribedMotion)]
        self._pushes = [s for s in systems if isinstance(s, FootPush)]
        self._max_step = max_step
        self._step = max_step

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to guard."""
        return not (self._watched or self._pushes)

    def next_step(self, root: Context) -> float:
        """Return the longest next step.

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
            Where the joints do not follow their motion closely enough to tell.
        """
        step = min(GROWTH * self._step, self._max_step)
        for push in self._pushes:
            step = min(step, push.longest_step(root.get_time()))
        for block, sign in self._watched:
            if block.robot.is_exact:
                step = self._towards(root, block, sign, step)
            else:
                at = block.instant(block.GetMyContextFromRoot(root))
                step = step_through(block.robot, at, step, disturbed=self._disturbed)
        self._step = max(step, SMALLEST_STEP)
        return self._step

    def _towards(
        self, root: Context, block: InverseJacobian | KinematicLoop, sign: float, step: float
    ) -> float:
        """Shorten a step so that it approaches a singularity without crossing it."""
        robot, context = block.robot, block.GetMyContextFromRoot(root)
        q = block.posture(context)
        now = sign * robot.normalised_determinant(q)
        if now <= 0.0:
            raise robot.singular(q, root.get_time())
        if now < NEARLY_SINGULAR and not self._disturbed:
            self._require_following(root)
        at = block.instant(context)
        shortened = step_towards(robot, at, now, step, disturbed=self._disturbed)
        if shortened is None:
            raise robot.singular(q, root.get_time())
        return shortened

    def _require_following(self, root: Context) -> None:
        for motion in self._motions:
            lag = motion.lag(motion.GetMyContextFromRoot(root))
            if lag > LARGEST_LAG:
                raise LostMotionError(time=root.get_time(), lag=lag)
