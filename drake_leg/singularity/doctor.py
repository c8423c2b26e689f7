"""Examines a posture before any simulation: rank, nearest singularities, strokes, limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import freedoms, geometry_of, joint_positions, movable
from drake_leg.kinematics.euler import euler_angles
from drake_leg.kinematics.feet import feet, lift_limits, limits_of
from drake_leg.kinematics.khalil import chain_length, foot_pose, jacobian
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.robot.robot import Robot, require_robot
from drake_leg.robot.tree import require_one_foot
from drake_leg.singularity.diagnosis import Diagnosis, Outside
from drake_leg.singularity.families import Families, families_of
from drake_leg.singularity.rank import ROUNDING, examine, examine_whole
from drake_leg.singularity.stroke import (
    STRAIGHT,
    Stroke,
    chain_stroke,
    closed_stroke,
    greatest_amplitude,
    unit,
)
from drake_leg.units import beyond, require_positive


def examine_posture(
    robot: Robot,
    q: Sequence[float],
    *,
    direction: Sequence[float] | None = None,
    frequency: float | None = None,
    foot: Sequence[float] | None = None,
    yaw: float | None = None,
    rpy: Sequence[float] | None = None,
) -> Diagnosis:
    """Examine a posture of a robot.

    Parameters
    ----------
    robot : Robot
        A leg, the SCARA, or any chain.
    q : (n,) sequence of float
        Joint positions [rad or m]; the SCARA's lift may be left out.
    direction : (3,) sequence of float, optional
        Of the stroke, in the base frame; x by default.
    frequency : float, optional
        Of the sine along the direction whose greatest amplitude is computed [rad/s]; 1 by default.
    foot : (3,) sequence of float, optional
        Point for the inverse kinematics [m].
    yaw, rpy : float and (3,) sequence of float, optional
        Orientation of the foot there, as in ``feet`` [rad].

    Returns
    -------
    Diagnosis
        Position of the foot, rank, singular values, strokes both ways and, where ``foot`` is
        given, the joint positions that put the foot there; lengths in m, angles in rad.

    Raises
    ------
    InvalidValueError
        If the number of joint positions is wrong, a value is invalid, or what goes with another
        argument is given without it.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import LEG_B, examine_posture
    >>> q = [radians(90), radians(-50), radians(-90)]
    >>> found = examine_posture(LEG_B, q, direction=(1, 0, 0))
    >>> found.rank.rank
    3
    >>> round(found.forward.length, 4), found.forward.family  # how far the foot can go [m]
    (0.1882, 'stretch')
    """
    require_robot(robot)
    require_one_foot(robot)
    if frequency is not None and direction is None:
        raise InvalidValueError("a frequency needs a direction", advice="give `direction`, too")
    for name, value in (("yaw", yaw), ("rpy", rpy)):
        if value is not None and foot is None:
            raise InvalidValueError(f"{name} goes with a point", advice="give `foot`, too")
    frequency = 1.0 if frequency is None else frequency
    require_positive("the frequency", frequency, "rad/s")
    way = (1.0, 0.0, 0.0) if direction is None else direction
    unit(way)  # refuses what is not a direction, even where there is no stroke
    geometry = geometry_of(robot)
    least = 3 if isinstance(geometry, ScaraGeometry) else None
    q = joint_positions("q", robot, q, least=least)
    families = families_of(geometry)
    lifted = _lifted(robot, q)
    X_BF = foot_pose(robot.rows, lifted)
    size = chain_length(robot.rows)
    J = families.translation_jacobian(q) if families else jacobian(robot.rows, lifted)[3:]
    rank = examine(J, ROUNDING * size)
    most = freedoms(robot.rows)[0].rank
    moved = movable(robot, lifted) if most else None
    forward = backward = None
    if _is_regular(moved, lifted, ROUNDING * size):
        forward = _limited(robot, families, q, way, moved)
        backward = _limited(robot, families, q, [-value for value in way], moved)
    x, y, z = X_BF[:3, 3].tolist()
    yaw_there, pitch, roll = euler_angles("ZYX", X_BF[:3, :3]).tolist()
    many = len(robot.moving) > 3
    return Diagnosis(
        position=(x, y, z if len(q) == len(lifted) else None),
        orientation=(roll, pitch, yaw_there),
        moved=families.moved if families else "the foot's translation",
        rank=rank,
        most_rank=min(most, rank.full_rank),
        whole=examine_whole(robot.rows, lifted, size) if many else None,
        nearness=families.nearness(q) if families else (),
        outside=_outside(robot, q),
        holds_orientation=moved is not None and moved.keeps_orientation,
        forward=forward,
        backward=backward,
        greatest_amplitude=greatest_amplitude(forward, frequency) if forward else None,
        feet=None if foot is None else feet(robot, foot, q=q, yaw=yaw, rpy=rpy),
    )


def _is_regular(moved: Movable | None, q: Sequence[float], rounding: float) -> bool:
    """Whether the foot can make every commanded motion in a posture."""
    return moved is None or examine(moved.jacobian_in_lengths(q), rounding).rank == moved.size


def _lifted(robot: Robot, q: Sequence[float]) -> Sequence[float]:
    """Add a SCARA's lift if it was left out: only the height depends on it."""
    if isinstance(geometry_of(robot), ScaraGeometry) and len(q) == 3:
        low, high = lift_limits(robot)
        return [*q, low if math.isfinite(low) else min(high, 0.0)]
    return q


def _outside(robot: Robot, q: Sequence[float]) -> tuple[Outside, ...]:
    joints = robot.moving[: len(q)]
    return tuple(
        Outside(segment=joint, position=float(position))
        for joint, position, (low, high) in zip(joints, q, limits_of(joints), strict=True)
        if beyond(position, low, high)
    )


def _limited(
    robot: Robot,
    families: Families | None,
    q: Sequence[float],
    direction: Sequence[float],
    moved: Movable | None,
) -> Stroke:
    """Stroke to the first singularity, or to a joint limit before it."""
    lifted, limits = _lifted(robot, q), limits_of(robot.moving)
    already = _outside(robot, lifted)
    if already:
        return Stroke(length=0.0, family=None, joint=already[0].segment.joint)
    known = closed_stroke(families, q[:3], direction) if families else None
    if known is not None and not np.isfinite(limits).any():
        return known
    names = [str(joint.joint) for joint in robot.moving]
    found = chain_stroke(
        robot.rows,
        lifted,
        direction,
        moved=moved,
        farthest=None if known is None else known.length,
        limits=dict(zip(names, limits, strict=True)),
    ).stroke
    if known is not None and found.joint is None:
        return known
    curved = moved is not None and moved.varies
    leaves = curved and found.joint is None and found.length < STRAIGHT * chain_length(robot.rows)
    return replace(found, length=0.0) if leaves else found
