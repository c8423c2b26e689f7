"""What the leg's runs simulate: robots, postures and diagrams, read off a run's options."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pydrake.systems.framework import Diagram

from drake_leg.diagrams import ellipse, hexabot_leg
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.of_robot import movable
from drake_leg.models.state_targets import initial_state, starting_posture
from drake_leg.robot import Robot
from drake_leg.robots import LegVariant
from drake_leg.robots import hexabot_leg as leg_robot
from drake_leg.runs.disturbance import disturbance_of
from drake_leg.runs.foresight import (
    control_of,
)
from drake_leg.runs.options import (
    EllipseOptions,
    LegOptions,
    StraightOptions,
    joint_values,
)
from drake_leg.simulation import Start
from drake_leg.singularity.directions import first_direction


def leg_of(variant: LegVariant, options: LegOptions) -> Robot:
    """Return the leg that the options describe.

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    """
    return leg_robot(
        variant,
        l1=options.l1,
        l2=options.l2,
        l3=options.l3,
        density=options.density,
        damping=options.si_damping(),
    )


def straight_config(robot: Robot, options: StraightOptions) -> hexabot_leg.HexabotLegConfig:
    """Say how the diagram of a straight step is built.

    Parameters
    ----------
    robot : Robot
        Any whose foot can make the step.

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the foot cannot go that way.
    """
    _require_mass(robot)
    q0 = _posture(robot, options)
    return hexabot_leg.HexabotLegConfig(
        robot=_unsaturated(robot),
        q0=q0,
        keep=options.task,
        amplitude=options.amplitude,
        frequency=options.frequency,
        direction=_direction(robot, options, q0),
        gain=options.gain,
        gravity=options.gravity,
        filter_time_constant=options.filter_time_constant,
        feedback=options.feedback,
        control=control_of(options, robot.moving),
        disturbance=disturbance_of(options),
    )


def straight_diagram(robot: Robot, options: StraightOptions) -> tuple[Diagram, Start]:
    """Build what the straight step simulates.

    Parameters
    ----------
    robot : Robot
        Any whose foot can make the step.

    Returns
    -------
    (Diagram, callable)
        And how it starts.

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the foot cannot go that way.
    """
    return hexabot_leg.build(straight_config(robot, options)), start_on_motion


def ellipse_config(options: EllipseOptions) -> ellipse.EllipseConfig:
    """Say how the diagram of an elliptic step is built.

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    """
    robot = leg_of("B", options)
    return ellipse.EllipseConfig(
        robot=robot,
        q0=options.posture(),
        amplitude=options.amplitude,
        frequency=options.frequency,
        direction=options.unit_direction(),
        lift=options.lift,
        gravity=options.gravity,
        filter_time_constant=options.filter_time_constant,
        control=control_of(options, robot.moving),
        disturbance=disturbance_of(options),
    )


def _posture(robot: Robot, options: StraightOptions) -> tuple[float, ...]:
    """Take q0 in rad where a joint turns, in m where it slides, or where the robot begins."""
    if options.q0 is None:
        q0 = starting_posture(robot)
    else:
        q0 = tuple(joint_values("q0", options.q0, robot.moving))
    joints = (str(segment.joint) for segment in robot.moving)
    initial_state(robot, {joint: (q, 0.0) for joint, q in zip(joints, q0, strict=True)})
    return q0


def _direction(
    robot: Robot, options: StraightOptions, q0: Sequence[float]
) -> tuple[float, float, float]:
    """Take the direction that was asked for, or the first one that the foot can go along."""
    if options.direction is None:
        return first_direction(robot, movable(robot, q0, options.task), q0)
    return options.unit_direction()


def _unsaturated(robot: Robot) -> Robot:
    """Take the effort limits off: the torque of a prescribed motion is what the motion takes."""
    return replace(
        robot,
        segments=tuple(
            replace(segment, mechanics=replace(segment.mechanics, effort=None, velocity=None))
            for segment in robot.segments
        ),
    )


def _require_mass(robot: Robot) -> None:
    """Refuse a robot with a joint that moves nothing: its motion has no equation."""
    mass_beyond = False
    for segment in reversed(robot.segments):
        link = segment.link
        mass_beyond |= link is not None and (link.solid or link.inertial) is not None
        if segment.row.joint != "fixed" and not mass_beyond:
            raise InvalidValueError(
                f"{robot.name}: nothing beyond joint {segment.joint} has a mass; give its row, or "
                "one after it, a [row.solid] or a [row.inertial]"
            )
