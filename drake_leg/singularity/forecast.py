"""Forecasts where and when a commanded motion meets a singularity, before any simulation."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import MovableChain
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import Floats, Movable
from drake_leg.singularity.families import (
    Approach,
    Families,
    Family,
    Path,
    approaches,
    families_of,
    line,
)
from drake_leg.singularity.stroke import approaches_on_line, chain_stroke, signed
from drake_leg.units import joint_entries

GRAZE = 1e-6  # of the arm's length: passing nearer than this to an edge is grazing it
# Parts of the path before an encounter at which the posture is computed: at the singularity itself
# a joint may be undetermined, and just before it rounding may put the point out of reach.
BACK = (0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-9)
SAME_POSTURE = 1e-3  # [rad]
PER_PERIOD = 720  # points of a curved path over a period
# Part of the greatest singular value of the foot's translation: while the smallest one is greater,
# the foot can move in all directions.
STILL_MOVES = 1e-3
MOST_POINTS = 200_000  # of a curved path
HALVINGS = 50  # of the interval in which the greatest amplitude of a curved path lies


@dataclass(frozen=True, kw_only=True)
class Encounter:
    """An encounter with a singular family."""

    time: float  # [s]
    family: Family | None  # None where families have no names
    q: tuple[float, ...]  # [rad or m]
    foot: tuple[float, ...]  # base frame [m]
    lost_direction: tuple[float, ...]  # unit vector, base frame
    loses_turning: bool = False  # about that direction, not translation along it
    greatest_amplitude: float | None  # [m/s], below which the motion stays inside; None: unknown
    grazing: bool = False  # the command leaves the workspace by less than forecast.GRAZE
    numerical: bool = False  # found by small steps, not in closed form
    turning: tuple[bool, ...] = (True, True, True)  # joint by joint: revolute, not prismatic

    def describe(self) -> str:
        """Description for the middle of a sentence."""
        family = f" ({self.family} family)" if self.family else ""
        about = "about " if self.numerical else ""
        at = f"{self.time:.{6 if self.numerical else 9}f}"
        joints = ", ".join(
            f"{_listed([math.degrees(value)], 4)} deg" if turns else f"{_listed([value], 6)} m"
            for value, turns in zip(self.q, self.turning, strict=True)
        )
        lost = "turning left about" if self.loses_turning else "motion left along"
        amplitude = self.greatest_amplitude
        inside = f"; an amplitude below {amplitude:.9g} m/s stays inside" if amplitude else ""
        return (
            f"singular{family} at t = {about}{at} s, with the foot at ({_listed(self.foot, 6)}) m, "
            f"the joints at ({joints}) and no {lost} "
            f"({_listed(self.lost_direction, 4)}){inside}"
        )

    def as_json(self) -> dict[str, Any]:
        """Return its numbers, with the joint positions in deg, or m where a joint slides."""
        return {
            "family": self.family,
            "time_s": self.time,
            "foot_m": list(self.foot),
            **joint_entries("q", self.q, [not turns for turns in self.turning]),
            "lost_direction": list(self.lost_direction),
            "loses_turning": self.loses_turning,
            "greatest_amplitude_m_s": self.greatest_amplitude,
            "grazing": self.grazing,
        }


@dataclass(frozen=True, kw_only=True)
class Graze:
    """A pass close to an edge of the workspace."""

    time: float  # [s]
    family: Family
    clearance: float  # [m]

    def describe(self) -> str:
        """Description in a sentence."""
        return (
            f"the command passes within {self.clearance:.3g} m of the {self.family} family "
            f"at t = {self.time:.9f} s"
        )


@dataclass(frozen=True, kw_only=True)
class Forecast:
    """The first encounter of a motion, or its closest pass; neither if the way is clear."""

    encounter: Encounter | None = None
    graze: Graze | None = None


def encounter_at(
    robot: Movable, q: Sequence[float], time: float, greatest_amplitude: float | None = None
) -> Encounter:
    """Describe a singular posture that a run has reached at a time [s].

    ``greatest_amplitude`` [m/s] would have stayed inside the workspace, if it is known.
    """
    posture = tuple(float(value) for value in q)
    families = families_of(robot.geometry)
    return Encounter(
        time=time,
        family=families.nearness(posture)[0].family if families else None,
        q=posture,
        foot=tuple(robot.foot(posture).tolist()),
        lost_direction=lost_direction(robot, posture),
        loses_turning=loses_turning(robot, posture),
        greatest_amplitude=greatest_amplitude,
        turning=robot.turning,
    )


def loses_turning(robot: Movable, q: Floats) -> bool:
    """Whether a singular posture loses only a rotation: the foot still moves in all directions."""
    _, sigma, moved = _translations(robot, q)
    return bool(robot.keeps_orientation and sigma[moved - 1] > STILL_MOVES * sigma[0])


def lost_direction(robot: Movable, q: Floats) -> tuple[float, float, float]:
    """Direction in which the foot of a singular posture moves least, or about which it turns least.

    A unit vector in the base frame, its first nonzero component positive: of a translation or,
    if only a rotation is lost, of its axis.
    """
    U, _, moved = _translations(robot, q)
    lost = U[:, moved - 1]
    if loses_turning(robot, q):
        U, _, _ = np.linalg.svd(robot.jacobian_in_lengths(q))
        lost = robot.twists[:3] @ U[:, -1]
        lost = lost / np.linalg.norm(lost)
    x, y, z = signed(lost, 1e-9).tolist()
    return x, y, z


def _translations(robot: Movable, q: Floats) -> tuple[Array, Array, int]:
    """Directions, singular values and dimension of the foot's translation."""
    moved = int(np.linalg.matrix_rank(robot.twists[3:]))
    U, sigma, _ = np.linalg.svd(robot.twists[3:] @ robot.jacobian_in_lengths(q))
    return U, sigma, moved


def _listed(values: Sequence[float], digits: int) -> str:
    return ", ".join(f"{round(value, digits) + 0.0:.{digits}f}" for value in values)


def forecast_step(robot: Movable, q0: Sequence[float], step: SineStep, duration: float) -> Forecast:
    """Forecast a straight step from q0 over a run's duration [s].

    The distance is ``s = (2 A / w) sin^2(w t / 2)``, so that the distance to the edge determines
    the time: in closed form, or numerically for a chain.
    """
    end = step.way(duration)
    if end == 0.0:
        return Forecast()
    families = families_of(robot.geometry)
    if families is None:
        return _forecast_chain(robot, q0, step, end)
    start = robot.foot(q0)
    found = approaches_on_line(families, q0, start, step.heading, end)
    forecast = _forecast(robot, families, q0, line(start, step.heading), found)
    if forecast.encounter:
        way = forecast.encounter.time
        greatest = way * step.frequency / 2.0
        timed = replace(forecast.encounter, time=step.time(way), greatest_amplitude=greatest)
        return Forecast(encounter=timed)
    if forecast.graze:
        return Forecast(graze=replace(forecast.graze, time=step.time(forecast.graze.time)))
    return forecast


def forecast_path(
    robot: Movable,
    q0: Sequence[float],
    path: Callable[[float], Path],
    *,
    amplitude: float,
    period: float,
    duration: float,
) -> Forecast:
    """Forecast a curved motion: its path is sampled finely, then encounters are solved for.

    ``path(amplitude)(times)`` gives points (n, 3) [m]; the motion starts from q0 (3,) [rad], not
    singular, with an amplitude [m/s] and a period [s], and is foreseen for a duration [s].
    """
    count = min(max(int(PER_PERIOD * duration / period), PER_PERIOD), MOST_POINTS)
    times = np.linspace(0.0, duration, count + 1)
    families = families_of(robot.geometry)
    if families is None:
        raise InvalidValueError("a curved motion is foreseen only for a robot with closed forms")
    edges = families.edges(q0)

    def meets(size: float) -> bool:
        found = approaches(edges, path(math.copysign(size, amplitude)), times)
        return any(approach.clearance <= 0.0 for approach in found)

    found = approaches(edges, path(amplitude), times)
    forecast = _forecast(robot, families, q0, path(amplitude), found)
    if forecast.encounter is None:
        return forecast
    low, high = 0.0, abs(amplitude)
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if meets(middle) else (middle, high)
    greatest = None if meets(0.0) else low
    return Forecast(encounter=replace(forecast.encounter, greatest_amplitude=greatest))


def _forecast(
    robot: Movable,
    families: Families,
    q0: Sequence[float],
    path: Path,
    found: list[Approach],
) -> Forecast:
    """Describe the first encounter, or the closest graze, at its parameter on the path."""
    size = families.edges(q0).size
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
    q = _posture_at(families, q0, path, first)
    encounter = replace(
        encounter_at(robot, q.tolist(), first.parameter),
        family=first.family,
        foot=tuple(here.tolist()),
        grazing=first.family == "stretch" and first.clearance > -GRAZE * size,
    )
    return Forecast(encounter=encounter)


def _posture_at(families: Families, q0: Sequence[float], path: Path, first: Approach) -> Array:
    """Limit of the posture toward an encounter, at which a joint may be undetermined."""
    points = path(first.parameter * (1.0 - np.array(BACK)))
    reference = families.posture(points[-1], q0)
    if first.family == "hip-axis":
        return reference
    for point in points:
        q = families.posture(point, q0)
        if np.abs(q - reference).max() < SAME_POSTURE:  # not if it is NaN
            return q
    return reference


def _forecast_chain(robot: Movable, q0: Sequence[float], step: SineStep, end: float) -> Forecast:
    if not isinstance(robot, MovableChain):
        raise InvalidValueError("a straight motion is foreseen only for a chain or closed forms")
    stroke, q = chain_stroke(robot.rows, q0, step.heading, moved=robot, farthest=end)
    if stroke.length > end:
        return Forecast()
    found = encounter_at(robot, q.tolist(), step.time(stroke.length))
    greatest = stroke.length * step.frequency / 2.0
    return Forecast(encounter=replace(found, greatest_amplitude=greatest, numerical=True))
