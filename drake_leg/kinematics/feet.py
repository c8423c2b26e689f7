"""Inverse kinematics: joint positions for a foot, in closed form or numerically."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import geometry_of, joint_positions, joints_in_words
from drake_leg.kinematics.euler import euler_rotation
from drake_leg.kinematics.inverse.closed_form import closed_forms
from drake_leg.kinematics.inverse.geometry import inverse_geometry
from drake_leg.kinematics.inverse.search import Limits, find_postures
from drake_leg.kinematics.khalil import (
    Array,
    one_vector,
    table_length,
    within_turns,
)
from drake_leg.kinematics.leg import LegGeometry, branches
from drake_leg.kinematics.scara import ScaraGeometry, branch_angles
from drake_leg.robot.robot import Robot, Segment, require_robot
from drake_leg.robot.tree import require_one_foot
from drake_leg.units import beyond, require_angle


def ranges(robot: Robot) -> list[tuple[float, float]]:
    """Least and greatest position of every joint [rad or m].

    Its limits; without them a full turn, or twice the table's length.
    """
    length = _longest(robot)
    return [_range(segment, length) for segment in robot.moving]


def _longest(robot: Robot) -> float:
    """Greatest ``table_length`` of the branches [m]."""
    return max(table_length(robot.rows[:row]) for row in robot.leaves.values())


def _range(segment: Segment, length: float) -> tuple[float, float]:
    lower, upper = segment.mechanics.lower, segment.mechanics.upper
    span = 2.0 * (length if segment.row.joint == "prismatic" else math.pi)
    if lower is None:
        lower = -span / 2.0 if upper is None else upper - span
    return lower, lower + span if upper is None else upper


def random_configurations(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    """Draw configurations of m joints, (count, m) [rad or m], uniform within every range."""
    lower, upper = np.transpose(ranges(robot))
    return rng.uniform(lower, upper, (count, len(lower)))


def greatest_reach(robot: Robot) -> float:
    """Upper bound of any tip's distance from the base [m]: the table's lengths and the strokes."""
    strokes = (
        max(map(abs, bounds))
        for bounds, segment in zip(ranges(robot), robot.moving, strict=True)
        if segment.row.joint == "prismatic"
    )
    return _longest(robot) + sum(strokes)


@dataclass(frozen=True, kw_only=True)
class Solution:
    """One way of putting the foot at a point."""

    name: str
    q: tuple[float, ...] | None  # [rad or m], every joint; None where out of reach
    within_limits: bool


@dataclass(frozen=True, kw_only=True)
class Feet:
    """All ways of putting a robot's foot at a point."""

    solutions: tuple[Solution, ...]
    heading: str  # one line: how many, whether these are all, what was assumed
    units: tuple[str, ...]  # in which each joint's position is shown: deg or m


def limits_of(joints: Sequence[Segment]) -> Limits:
    """Lower and upper limits of the joints [rad or m], infinite where there is none."""
    return [joint.mechanics.bounds for joint in joints]


def units_of(robot: Robot) -> tuple[str, ...]:
    """Unit in which each joint's position is shown: ``deg`` or ``m``."""
    return tuple("deg" if joint.row.joint == "revolute" else "m" for joint in robot.moving)


def feet(
    robot: Robot,
    foot: Sequence[float],
    *,
    q: Sequence[float] | None = None,
    yaw: float | None = None,
    rpy: Sequence[float] | None = None,
) -> Feet:
    """Find the joint positions that put a robot's foot at a point (3,) [m], in the base frame.

    The leg and the SCARA have closed forms. A SCARA's tool has the yaw [rad], or else that of the
    posture q. The foot of a chain of more than three joints has the roll, pitch and yaw ``rpy``
    about the base's x, y, z [rad], or else any orientation.
    """
    require_robot(robot)
    require_one_foot(robot)
    foot = one_vector("the foot", foot, 3).tolist()
    if q is not None:
        q = joint_positions("q", robot, q, least=min(3, len(robot.moving)))
    if yaw is not None:
        require_angle("the yaw", yaw)
    if rpy is not None:
        rpy = one_vector("rpy", rpy, 3).tolist()
    geometry = geometry_of(robot)
    if isinstance(geometry, ScaraGeometry):
        return _scara_feet(robot, geometry, foot, q, yaw, rpy)
    if yaw is not None:
        otherwise = ", or give the orientation by `rpy`" if len(robot.moving) > 3 else ""
        raise InvalidValueError(
            f"a yaw is for a SCARA's tool; {robot.name!r} is not a SCARA",
            advice=f"leave it out{otherwise}",
        )
    if rpy is not None and len(robot.moving) <= 3:
        raise InvalidValueError(
            f"the foot of {robot.name!r} cannot choose its orientation, with "
            f"{joints_in_words(robot)}",
            advice="leave `rpy` out",
        )
    if isinstance(geometry, LegGeometry):
        return _leg_feet(robot, geometry, foot)
    return _chain_feet(robot, foot, rpy)


def _leg_feet(robot: Robot, leg: LegGeometry, foot: Sequence[float]) -> Feet:
    found = branches(leg, foot, limits_of(robot.moving))
    return Feet(
        solutions=tuple(
            Solution(name=branch.name, q=branch.q, within_limits=branch.within_limits)
            for branch in found
        ),
        heading="all four branches, in closed form",
        units=units_of(robot),
    )


def _scara_feet(
    robot: Robot,
    arm: ScaraGeometry,
    foot: Sequence[float],
    q: Sequence[float] | None,
    yaw: float | None,
    rpy: Sequence[float] | None,
) -> Feet:
    if rpy is not None:
        raise InvalidValueError("a SCARA's tool only yaws", advice="give `yaw` instead of `rpy`")
    whose = "as asked for"
    if yaw is None:
        if q is None:
            raise InvalidValueError(
                "a SCARA's tool has a yaw in addition to its position",
                advice="give `yaw`, or the posture whose yaw it keeps by `q`",
            )
        yaw, whose = float(sum(q[:3])), "that of the posture"
    limits = [*limits_of(robot.moving[:3]), lift_limits(robot)]
    lift = arm.height - foot[2]
    solutions = [
        _solution(robot, name, [*angles, lift], limits)
        for name, angles in zip(
            ("elbow left", "elbow right"),
            branch_angles(arm, [foot[0], foot[1], yaw]).tolist(),
            strict=True,
        )
    ]
    low, high = limits[3]
    heading = f"both branches, in closed form, at yaw {math.degrees(yaw):.6g} deg, {whose}"
    if beyond(lift, low, high):
        heading += (
            f"; the lift would be at {lift:.6g} m, outside {low:.6g} ... {high:.6g} m: the tool is "
            f"{arm.height - high:.6g} ... {arm.height - low:.6g} m high"
        )
    return Feet(solutions=tuple(solutions), heading=heading, units=units_of(robot))


def lift_limits(robot: Robot) -> tuple[float, float]:
    """Range of a SCARA's lift [m]: its limits, or else those of the report's table."""
    arm = ScaraGeometry.from_robot(robot)
    ((low, high),) = limits_of(robot.moving[3:4])
    if math.isinf(low) and math.isinf(high) and arm.height > arm.lowest:
        return 0.0, arm.height - arm.lowest
    return low, high


def _chain_feet(robot: Robot, foot: Sequence[float], rpy: Sequence[float] | None) -> Feet:
    limits = limits_of(robot.moving)
    rotation = None if rpy is None else euler_rotation("ZYX", [rpy[2], rpy[1], rpy[0]])
    exact = None
    if closed_forms(robot.rows, pose=rotation is not None):
        exact = inverse_geometry(robot, foot if rotation is None else _pose(foot, rotation))
    if exact is not None and not exact.infinitely_many:
        q, heading = exact.solutions, exact.heading
    else:
        found = find_postures(robot.rows, foot, rotation, limits=limits)
        q = found.q
        heading = _found(robot, len(q), found.nearest, rpy, many=found.infinitely_many)
    solutions = tuple(
        _solution(robot, f"posture {number}", one, limits)
        for number, one in enumerate(q.tolist(), start=1)
    )
    return Feet(solutions=solutions, heading=heading, units=units_of(robot))


def _pose(p: Sequence[float], R: Array) -> Array:
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, p
    return X


def _found(
    robot: Robot, count: int, nearest: float, rpy: Sequence[float] | None, *, many: bool
) -> str:
    """Heading of a numerical search: how many postures, and whether there may be more."""
    if not count:
        return f"no posture found; the nearest that was found misses by {nearest:.6g} m"
    if many and rpy is None and len(robot.moving) > 3:
        return (
            f"{count} found of infinitely many: {joints_in_words(robot)} reach a point in any of "
            "many orientations; choose one by rpy"
        )
    if many:
        return f"{count} found of infinitely many: joints can move while the foot stays"
    return f"{count} found from many starts; there may be more"


def _solution(robot: Robot, name: str, q: Sequence[float], limits: Limits) -> Solution:
    if not all(map(math.isfinite, q)):
        return Solution(name=name, q=None, within_limits=False)
    inside = all(
        within_turns(value, low, high)
        if segment.row.joint == "revolute"
        else not beyond(value, low, high)
        for value, (low, high), segment in zip(q, limits, robot.moving, strict=True)
    )
    return Solution(name=name, q=tuple(np.asarray(q).tolist()), within_limits=inside)
