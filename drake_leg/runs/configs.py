"""Builds the robot and the config of a run's diagram from the options of the run.

An option that makes no sense raises InvalidValueError.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.diagrams.ellipse import EllipseConfig
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.pendulum import PendulumConfig
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.motions import Push
from drake_leg.kinematics.movable import SINGULAR_BELOW
from drake_leg.robot.joint_mechanics import (
    JointMechanics,
    StateTarget,
    initial_state,
    starting_posture,
)
from drake_leg.robot.robot import Robot, Segment
from drake_leg.robot.robots import hexabot_leg, pendulum, scara
from drake_leg.runs.options import (
    EllipseOptions,
    LegOptions,
    PendulumOptions,
    ScaraOptions,
    SpringPendulumOptions,
    StepOptions,
    StraightOptions,
)
from drake_leg.singularity.inverse import Inverse
from drake_leg.singularity.stroke import first_direction

CORRECTION = 5.0  # [1/s], of a damped or limited inverse where none is asked for
PUSH_AT, PUSH_FOR = 2.0, 0.1  # [s]


def leg_of(options: LegOptions) -> Robot:
    """Return the leg that the options describe."""
    return hexabot_leg(
        options.variant,
        l1=options.l1,
        l2=options.l2,
        l3=options.l3,
        density=options.density,
        damping=options.si_damping(),
    )


def straight_config(robot: Robot, options: StraightOptions) -> HexabotLegConfig:
    """Return the config of the straight step of any robot."""
    _require_mass(robot)
    q0 = _posture(robot, options)
    direction = None
    if options.direction is None:
        direction = first_direction(robot, movable(robot, q0, options.task), q0)
    return HexabotLegConfig(
        robot=robot,
        q0=q0,
        task=options.task,
        motion=options.motion(direction),
        gain=options.gain,
        gravity=options.gravity,
        filter_time_constant=options.filter_time_constant,
        feedback=options.feedback,
        control=control_of(options, robot.moving),
        disturbance=disturbance_of(options),
    )


def ellipse_config(options: EllipseOptions) -> EllipseConfig:
    """Return the config of the elliptic step."""
    robot = leg_of(options)
    return EllipseConfig(
        robot=robot,
        q0=options.posture(),
        motion=options.motion(),
        gravity=options.gravity,
        filter_time_constant=options.filter_time_constant,
        control=control_of(options, robot.moving),
        disturbance=disturbance_of(options),
    )


def scara_config(options: ScaraOptions) -> ScaraConfig:
    """Return the config of the SCARA's move."""
    robot = scara(
        l1=options.l1, l2=options.l2, density=options.density, damping=options.si_damping()
    )
    return ScaraConfig(
        robot=robot,
        q0=options.posture(),
        R=options.tool_height,
        motion=options.motion(),
        gravity=options.gravity,
        control=control_of(options, robot.moving[:3]),
        disturbance=disturbance_of(options),
    )


def pendulum_config(options: PendulumOptions) -> PendulumConfig:
    """Return the config of the pendulum."""
    if len(options.size) != 3:
        raise InvalidValueError(
            f"the size is {options.size}; it must be length, width and height in m, "
            "as 0.4,0.01,0.01"
        )
    length, width, height = options.size
    robot = pendulum(
        size=(length, width, height), density=options.density, mechanics=_mechanics(options)
    )
    return PendulumConfig(robot=robot, q0=options.start(), gravity=options.gravity)


def control_of(options: StepOptions, joints: Sequence[Segment]) -> Control:
    """Return how the joints follow their command: inverse, correction, error of the start."""
    rate = options.rate_limit
    if rate is not None and all(joint.row.joint == "prismatic" for joint in joints):
        raise InvalidValueError(
            "the rate limit is for joints that turn, and none of these does", advice="leave it out"
        )
    inverse = Inverse(
        method=options.inverse,
        damped_below=options.damped_below,
        rate_limit=None if rate is None else math.radians(rate),
    )
    correction = options.correction
    if correction is None:
        correction = 0.0 if inverse.is_exact else CORRECTION
    error = [0.0] * len(joints) if options.q0_error is None else options.q0_error
    return Control(
        inverse=inverse,
        correction=correction,
        q0_error=tuple(joint_values("q0_error", error, joints)),
    )


def disturbance_of(options: StepOptions) -> Disturbance:
    """Return the disturbance of a run."""
    return Disturbance(
        push=_push(options),
        mass_error=options.mass_error,
        torque_limit=options.torque_limit,
        stiffness=options.stiffness,
    )


def joint_values(name: str, values: Sequence[float], joints: Sequence[Segment]) -> list[float]:
    """Convert values in degrees for joints that turn, in m for joints that slide, to rad and m."""
    if len(values) != len(joints) or not all(map(math.isfinite, values)):
        raise InvalidValueError(
            f"{name} is {list(values)}; it must be {len(joints)} finite numbers, one for each "
            "joint: degrees where it turns, m where it slides"
        )
    return [
        math.radians(value) if joint.row.joint == "revolute" else value
        for value, joint in zip(values, joints, strict=True)
    ]


def _push(options: StepOptions) -> Push | None:
    if options.push is None:
        for name in ("push_at", "push_for"):
            value = getattr(options, name)
            if value is not None:
                raise InvalidValueError(
                    f"{name} is {value!r} and there is no push",
                    advice="give its force, as `push=(0, 0, 0.1)`",
                )
        return None
    if len(options.push) != 3:
        raise InvalidValueError(
            f"the push is {options.push}; it must be three numbers in N, as 0,0,0.1"
        )
    x, y, z = options.push
    push = Push(
        force=(x, y, z),
        at=PUSH_AT if options.push_at is None else options.push_at,
        lasting=PUSH_FOR if options.push_for is None else options.push_for,
    )
    if push.at >= options.duration:
        raise InvalidValueError(
            f"the push begins at {push.at:g} s, and the run is over at {options.duration:g} s",
            advice="choose an earlier `push_at` or a longer `duration`",
        )
    return push


def _posture(robot: Robot, options: StraightOptions) -> tuple[float, ...]:
    """Return q0 of the options [rad or m], by default the robot's starting posture."""
    if options.q0 is None:
        q0 = starting_posture(robot)
    else:
        q0 = tuple(joint_values("q0", options.q0, robot.moving))
    joints = (str(segment.joint) for segment in robot.moving)
    initial_state(robot, {joint: (q, 0.0) for joint, q in zip(joints, q0, strict=True)})
    return q0


def require_regular_start(config: HexabotLegConfig) -> None:
    """Refuse a default start that is singular: the exact inverse cannot leave it."""
    sigma_min = config.movable.sigma_min(config.q0)
    if config.inverted.is_exact and sigma_min < SINGULAR_BELOW * config.movable.length:
        raise SingularConfigurationError(
            q=config.q0,
            sigma_min=sigma_min,
            problem=f"{config.robot.name} is singular in its default start posture",
            advice="choose one with `q0`",
        )


def _require_mass(robot: Robot) -> None:
    """Require a mass beyond every joint: without one its motion has no equation."""
    mass_beyond = False
    for segment in reversed(robot.segments):
        link = segment.link
        mass_beyond |= link is not None and (link.solid or link.inertial) is not None
        if segment.row.joint != "fixed" and not mass_beyond:
            raise InvalidValueError(
                f"{robot.name}: nothing beyond joint {segment.joint} has a mass",
                advice="give its row, or one after it, a [row.solid] or a [row.inertial]",
            )


def _mechanics(options: PendulumOptions) -> JointMechanics:
    mechanics = JointMechanics(
        damping=options.si_damping(),
        actuated=False,
        position_target=StateTarget(value=options.start()),
        velocity_target=StateTarget(value=math.radians(options.velocity_target)),
        **options.limits(),
    )
    if not isinstance(options, SpringPendulumOptions):
        return mechanics
    return replace(
        mechanics,
        spring_stiffness=options.si_stiffness(),
        equilibrium_position=options.equilibrium(),
    )
