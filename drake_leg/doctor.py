"""What can be said of a posture before anyone simulates: rank, singularities, room to move."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, within_turns
from drake_leg.kinematics.chain_stroke import chain_stroke
from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian, is_hexabot_leg
from drake_leg.kinematics.leg_inverse import branches
from drake_leg.kinematics.scara import ScaraGeometry, branch_angles, is_scara, task_jacobian
from drake_leg.kinematics.singularity import RankReport, examine
from drake_leg.kinematics.stroke import (
    Stroke,
    greatest_amplitude,
    leg_stroke,
    scara_stroke,
)
from drake_leg.quantities import require_positive
from drake_leg.robot import Robot, Segment


@dataclass(frozen=True, kw_only=True)
class Nearness:
    """How near a posture is to a singular family."""

    family: str  # stretch or hip-axis
    measure: float  # 0 on the family, 1 farthest from it
    meaning: str  # the measure in words


@dataclass(frozen=True, kw_only=True)
class Solution:
    """One way of putting the foot at a point."""

    name: str
    q: tuple[float, ...] | None  # [rad]; None where out of reach
    within_limits: bool


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """Everything the doctor says of a posture; lengths in m, angles in rad."""

    rank: RankReport
    nearness: tuple[Nearness, ...]  # nearest first; empty for a chain without named families
    forward: Stroke | None  # None where the chain has not three joints, or is singular already
    backward: Stroke | None
    greatest_amplitude: float | None  # [m/s], at the frequency asked for
    solutions: tuple[Solution, ...] | None  # of the inverse kinematics; None where not asked for

    def as_json(self) -> dict[str, Any]:
        """Return the numbers under the command line's keys, with angles in degrees.

        Returns
        -------
        dict
        """
        lost = self.rank.lost_directions
        solutions = self.solutions or ()
        return {
            "rank": self.rank.rank,
            "sigma_min_m": self.rank.sigma_min,
            "manipulability": self.rank.manipulability,
            "nearest_family": self.nearness[0].family if self.nearness else None,
            "lost_direction": lost[-1].tolist() if len(lost) else None,
            "stroke_forward_m": _finite(self.forward.length if self.forward else None),
            "stroke_backward_m": _finite(self.backward.length if self.backward else None),
            "max_amplitude_m_s": _finite(self.greatest_amplitude),
            "branches_deg": [_degrees(s.q) for s in solutions if s.q is not None],
            "branches": [
                {"name": s.name, "q_deg": _degrees(s.q), "within_limits": s.within_limits}
                for s in solutions
            ],
        }


def examine_posture(
    robot: Robot,
    q: Sequence[float],
    *,
    direction: Sequence[float] = (1.0, 0.0, 0.0),
    frequency: float = 1.0,
    foot: Sequence[float] | None = None,
) -> Diagnosis:
    """Examine a posture of a robot.

    Parameters
    ----------
    robot : Robot
        A leg, the SCARA, or any chain.
    q : (n,) sequence of float
        Joint positions [rad or m]; the SCARA's three angles.
    direction : (3,) sequence of float
        Of the stroke, in the base frame.
    frequency : float
        Of the sine whose greatest amplitude is asked for [rad/s].
    foot : (3,) sequence of float, optional
        Point whose inverse kinematics is asked for [m].

    Returns
    -------
    Diagnosis

    Raises
    ------
    InvalidValueError
        If a number of joints is wrong, or a value makes no sense.
    """
    require_positive("the frequency", frequency, "rad/s")
    patient = _patient(robot)
    J = patient.jacobian(q)
    rank = examine(J)
    forward = backward = None
    regular = rank.rank == rank.full_rank
    if regular and (isinstance(patient, _Scara) or len(robot.moving) == rank.rank == 3):
        forward = patient.stroke(q, direction)
        backward = patient.stroke(q, [-value for value in direction])
    return Diagnosis(
        rank=rank,
        nearness=tuple(sorted(patient.nearness(q), key=lambda near: near.measure)),
        forward=forward,
        backward=backward,
        greatest_amplitude=greatest_amplitude(forward, frequency) if forward else None,
        solutions=None if foot is None else patient.solutions(q, foot),
    )


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _degrees(q: Sequence[float] | None) -> list[float] | None:
    return None if q is None else [math.degrees(angle) for angle in q]


def _limits(segment: Segment) -> tuple[float, float]:
    lower, upper = segment.mechanics.lower, segment.mechanics.upper
    return (-math.inf if lower is None else lower, math.inf if upper is None else upper)


def _inside(q: Sequence[float], limits: Sequence[tuple[float, float]]) -> bool:
    return all(within_turns(angle, *pair) for angle, pair in zip(q, limits, strict=True))


class _Leg:
    """The hexabot's leg, in closed form."""

    def __init__(self, robot: Robot) -> None:
        self._leg = LegGeometry.from_robot(robot)
        self._limits = [_limits(segment) for segment in robot.moving]

    def jacobian(self, q: Sequence[float]) -> Array:
        return foot_jacobian(self._leg, q)

    def nearness(self, q: Sequence[float]) -> list[Nearness]:
        leg = self._leg
        longest = leg.l1 + leg.l2 + leg.l3
        reach = leg.l1 + leg.l2 * math.cos(q[1]) + leg.l3 * math.cos(q[1] + q[2])
        return [
            Nearness(
                family="stretch",
                measure=abs(math.sin(q[2])),
                meaning=f"|sin q3| = {abs(math.sin(q[2])):.4g}; at 0 it is stretched or folded",
            ),
            Nearness(
                family="hip-axis",
                measure=abs(reach) / longest,
                meaning=f"the foot is {abs(reach):.4g} m from the hip axis, of {longest:.4g} m",
            ),
        ]

    def stroke(self, q: Sequence[float], direction: Sequence[float]) -> Stroke:
        return leg_stroke(self._leg, q, direction)

    def solutions(self, _q: Sequence[float], foot: Sequence[float]) -> tuple[Solution, ...]:
        return tuple(
            Solution(name=branch.name, q=branch.q, within_limits=branch.within_limits)
            for branch in branches(self._leg, foot, self._limits)
        )


class _Scara:
    """The SCARA arm, in closed form; its rank is that of the horizontal motion."""

    def __init__(self, robot: Robot) -> None:
        self._arm = ScaraGeometry.from_robot(robot)
        self._limits = [_limits(segment) for segment in robot.moving[:3]]

    def jacobian(self, q: Sequence[float]) -> Array:
        return task_jacobian(self._arm, q[:3])[:2, :2]

    def nearness(self, q: Sequence[float]) -> list[Nearness]:
        measure = abs(math.sin(q[1]))
        meaning = f"|sin q2| = {measure:.4g}; the arm is stretched or folded at 0"
        return [Nearness(family="stretch", measure=measure, meaning=meaning)]

    def stroke(self, q: Sequence[float], direction: Sequence[float]) -> Stroke:
        return scara_stroke(self._arm, q[:3], direction)

    def solutions(self, q: Sequence[float], foot: Sequence[float]) -> tuple[Solution, ...]:
        """Keep the yaw of the posture; the height is the lift's alone."""
        names = ("elbow left", "elbow right")
        angles = branch_angles(self._arm, [foot[0], foot[1], sum(q[:3])])
        return tuple(
            Solution(name=name, q=tuple(q), within_limits=_inside(q, self._limits))
            if all(map(math.isfinite, q))
            else Solution(name=name, q=None, within_limits=False)
            for name, q in zip(names, angles.tolist(), strict=True)
        )


class _Chain:
    """Any chain, numerically; its rank is that of the foot's translation."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def jacobian(self, q: Sequence[float]) -> Array:
        return jacobian(self._robot.rows, q)[3:]

    def nearness(self, _q: Sequence[float]) -> list[Nearness]:
        return []

    def stroke(self, q: Sequence[float], direction: Sequence[float]) -> Stroke:
        return chain_stroke(self._robot.rows, q, direction).stroke

    def solutions(self, _q: Sequence[float], _foot: Sequence[float]) -> tuple[Solution, ...]:
        raise InvalidValueError(
            f"the inverse kinematics of {self._robot.name!r} has no closed form here; "
            "it is known for the hexabot's leg and the SCARA"
        )


def _patient(robot: Robot) -> _Leg | _Scara | _Chain:
    if is_hexabot_leg(robot):
        return _Leg(robot)
    return _Scara(robot) if is_scara(robot) else _Chain(robot)
