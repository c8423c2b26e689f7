"""Where and when a commanded motion meets a singularity, known before anything moves."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from drake_leg.kinematics.arms import ChainArm, ClosedArm
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.chain_stroke import chain_stroke
from drake_leg.kinematics.edges import (
    Approach,
    Path,
    approaches,
    breaks_of_line,
    line,
)
from drake_leg.kinematics.encounter import Forecast, Graze, encounter_at
from drake_leg.kinematics.motions import SineStep

GRAZE = 1e-6  # of the arm's length: passing nearer than this to an edge is grazing it
# Parts of the path before a meeting at which the joints are read: the last where the singularity
# itself leaves one of them open, the ones between where rounding puts it out of reach.
BACK = (0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-9)
SAME_POSTURE = 1e-3  # [rad]
PER_PERIOD = 720  # points of a curved path over a period
MOST_POINTS = 200_000  # of a curved path
HALVINGS = 50  # of the interval in which the greatest amplitude of a curved path lies


def forecast_step(
    arm: ClosedArm | ChainArm, q0: Sequence[float], step: SineStep, duration: float
) -> Forecast:
    """Say what a straight step meets: in closed form, for a chain numerically.

    ``s = (2 A / w) sin^2(w t / 2)`` is the way, so that the way to the edge gives the instant.

    Parameters
    ----------
    q0 : (3,) sequence of float
        Where it starts [rad or m], not singular.
    duration : float
        Of the run [s].
    """
    end = step.way(duration)
    if end == 0.0:
        return Forecast()
    if isinstance(arm, ChainArm):
        return _forecast_chain(arm, q0, step, end)
    path = line(arm.foot(q0), step.heading)
    breaks = breaks_of_line(arm.extremes(arm.foot(q0), step.heading), end)
    found = approaches(arm.edges(q0), path, breaks)
    forecast = _forecast(arm, q0, path, found)
    if forecast.encounter:
        way = forecast.encounter.time
        greatest = way * step.frequency / 2.0
        timed = replace(forecast.encounter, time=step.time(way), greatest_amplitude=greatest)
        return Forecast(encounter=timed)
    if forecast.graze:
        return Forecast(graze=replace(forecast.graze, time=step.time(forecast.graze.time)))
    return forecast


def forecast_path(
    arm: ClosedArm,
    q0: Sequence[float],
    path: Callable[[float], Path],
    *,
    amplitude: float,
    period: float,
    duration: float,
) -> Forecast:
    """Say what a curved motion meets, on a path sampled finely and then solved.

    Parameters
    ----------
    q0 : (3,) sequence of float
        Where it starts [rad], not singular.
    path : callable
        ``path(amplitude)(times)`` gives points (n, 3) [m].
    amplitude : float
        [m/s].
    period : float
        Over which the path turns [s].
    duration : float
        Of what has to be looked at [s].
    """
    count = min(max(int(PER_PERIOD * duration / period), PER_PERIOD), MOST_POINTS)
    times = np.linspace(0.0, duration, count + 1)
    edges = arm.edges(q0)

    def meets(size: float) -> bool:
        found = approaches(edges, path(math.copysign(size, amplitude)), times)
        return any(approach.clearance <= 0.0 for approach in found)

    found = approaches(edges, path(amplitude), times)
    forecast = _forecast(arm, q0, path(amplitude), found)
    if forecast.encounter is None:
        return forecast
    low, high = 0.0, abs(amplitude)
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if meets(middle) else (middle, high)
    greatest = None if meets(0.0) else low
    return Forecast(encounter=replace(forecast.encounter, greatest_amplitude=greatest))


def _forecast(arm: ClosedArm, q0: Sequence[float], path: Path, found: list[Approach]) -> Forecast:
    """Describe the first meeting, or the closest graze, at its parameter on the path."""
    size = arm.edges(q0).size
    met = [approach for approach in found if approach.clearance <= 0.0]
    if not met:
        near = min(found, key=lambda approach: approach.clearance)
        if near.clearance >= GRAZE * size:
            return Forecast()
        return Forecast(
            graze=Graze(time=near.parameter, family=near.family, clearance=near.clearance)
        )
    first = min(met, key=lambda approach: approach.parameter)
    here = path(np.array([first.parameter]))[0]
    q = _posture_at(arm, q0, path, first)
    encounter = replace(
        encounter_at(arm, q.tolist(), first.parameter),
        family=first.family,
        foot=tuple(here.tolist()),
        grazing=first.family == "stretch" and first.clearance > -GRAZE * size,
    )
    return Forecast(encounter=encounter)


def _posture_at(arm: ClosedArm, q0: Sequence[float], path: Path, first: Approach) -> Array:
    """Return the joints' limit on the way to a meeting: there itself some may be open."""
    points = path(first.parameter * (1.0 - np.array(BACK)))
    reference = arm.posture(points[-1], q0)
    if first.family == "hip-axis":
        return reference
    for point in points:
        q = arm.posture(point, q0)
        if np.abs(q - reference).max() < SAME_POSTURE:  # not if it is NaN
            return q
    return reference


def _forecast_chain(arm: ChainArm, q0: Sequence[float], step: SineStep, end: float) -> Forecast:
    stroke, q = chain_stroke(arm.rows, q0, step.heading, task=arm.task, farthest=end)
    if stroke.length > end:
        return Forecast()
    found = encounter_at(arm, q.tolist(), step.time(stroke.length))
    greatest = stroke.length * step.frequency / 2.0
    return Forecast(encounter=replace(found, greatest_amplitude=greatest, numerical=True))
