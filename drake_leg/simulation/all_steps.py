"""Runs the kinematic loop without its diagram: Runge-Kutta steps that are solved all at once."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence

import numpy as np

from drake_leg.diagrams.kinematic_loop import SCOPE
from drake_leg.kinematics.all_steps import all_steps
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.loop import KinematicEquation
from drake_leg.progress import held
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import INTERRUPTED, Progress, Run, Scopes, require_steps

SCHEME = "runge_kutta5"  # whose steps ``kinematics.all_steps`` finds
BLOCK = 1024  # steps at once, between which a run reports its progress and can be interrupted
ROUNDING = 1e-12  # of a step: less than that is no step of its own


def all_steps_of(
    equation: KinematicEquation,
    start: Sequence[float],
    duration: float,
    settings: IntegratorSettings,
    progress: Progress | None = None,
) -> Run | None:
    """Simulate the loop from joints at ``start`` (n,): the rows of its diagram, to rounding.

    None where the diagram must be simulated: by another integrator, with error control or input
    filters, of a robot without closed form, or through a singularity.
    """
    if settings.scheme != SCHEME or settings.accuracy is not None:
        return None
    require_steps(duration, settings)
    began, time = clock.perf_counter(), _times(duration, settings.max_step)
    rows, reason = np.array([start]), None
    try:
        for first in range(0, len(time) - 1, BLOCK):
            block = time[first : first + BLOCK + 1]
            with held():
                found = all_steps(equation, rows[-1].tolist(), block)
                if found is None:
                    return None
                rows = np.concatenate([rows, found[1:]])
            if progress:
                progress(float(block[-1]))
    except KeyboardInterrupt:
        if len(rows) == 1:  # nothing holds interrupts back, as in a notebook
            raise
        reason = INTERRUPTED
    time = time[: len(rows)]
    return Run(
        time=time,
        scopes=Scopes({SCOPE: rows}),
        stopped_at=None if reason is None else float(time[-1]),
        stop_reason=reason,
        wall_time=clock.perf_counter() - began,
    )


def _times(duration: float, step: float) -> Array:
    """Times from 0 to the duration, (rows,) [s]; the last step may be shorter."""
    steps = math.ceil(duration / step * (1.0 - ROUNDING))
    times: Array = np.append(step * np.arange(steps), duration)
    return times
