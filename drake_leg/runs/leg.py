"""The leg's runs: a straight step and an ellipse; the step of any robot of three joints, too."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams import ellipse, hexabot_leg
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.integrator import IntegratorSettings
from drake_leg.kinematics.arms import ChainArm, ScaraArm, arm_of
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.encounter import SineStep
from drake_leg.kinematics.khalil import foot_pose, jacobian
from drake_leg.kinematics.leg import LegGeometry, is_hexabot_leg
from drake_leg.kinematics.leg_inverse import inverse_kinematics
from drake_leg.kinematics.paths import UP, CommandedMotion, elliptic_path, straight_path
from drake_leg.kinematics.rates import smallest_singular_value
from drake_leg.models.state_targets import initial_state
from drake_leg.recording import Recording
from drake_leg.robot import Robot
from drake_leg.robots import LegVariant
from drake_leg.robots import hexabot_leg as leg_robot
from drake_leg.runs.foresight import (
    Motion,
    Plan,
    control_findings,
    control_of,
    singularity_findings,
    step_for,
)
from drake_leg.runs.options import (
    EllipseOptions,
    LegBOptions,
    LegOptions,
    StepOptions,
    StraightOptions,
)
from drake_leg.runs.outcome import Outcome, outcome_of
from drake_leg.runs.tip import default_step, exact_tip, tip_columns, tip_findings, torque_error
from drake_leg.simulation import Progress, Run, Start, simulate

Config = TypeVar("Config", bound=hexabot_leg.HexabotLegConfig)

STEP_OF_FILTER = 1.5  # greatest step over the filters' time constant; 2 is unstable with Euler


def run_straight(
    variant: LegVariant, options: LegBOptions, progress: Progress | None = None
) -> Outcome:
    """Make the foot step along a straight line.

    Parameters
    ----------
    variant : {"A", "B"}
        Whose leg.
    options : LegBOptions
        Posture, step, lengths, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Returns
    -------
    Outcome
        Compared with ``paths.straight_path``.

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    SingularConfigurationError
        If the leg is singular where it starts.
    """
    return run_robot(leg_of(variant, options), options, progress)


def run_robot(robot: Robot, options: StraightOptions, progress: Progress | None = None) -> Outcome:
    """Make the foot of any robot of three joints step along a straight line.

    Parameters
    ----------
    robot : Robot
        With three joint positions.
    options : StraightOptions
        Posture, in degrees where a joint turns and in m where it slides, step, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Returns
    -------
    Outcome
        Compared with ``paths.straight_path``.

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the robot has not three joint positions.
    SingularConfigurationError
        If the robot is singular where it starts.
    """
    config = straight_config(robot, options)
    along = np.array(config.direction)

    def motion(amplitude: float, time: Array) -> CommandedMotion:
        return straight_path(time, amplitude=amplitude, frequency=config.frequency, direction=along)

    step = SineStep(
        amplitude=config.amplitude, frequency=config.frequency, direction=config.direction
    )
    across = np.eye(3) - np.outer(along, along)
    plan = _plan(config, options, motion, step)
    outcome = _carry_out(plan, config, options, hexabot_leg.build, across, progress)
    exceeded = {"limits_exceeded": _exceeded_limits(robot, outcome.recording)}
    return replace(outcome, robot=robot, summary={**outcome.summary, **exceeded})


def run_ellipse(options: EllipseOptions, progress: Progress | None = None) -> Outcome:
    """Make the foot of leg B go round an ellipse in a vertical plane.

    Parameters
    ----------
    options : EllipseOptions
        Posture, ellipse, lengths, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Returns
    -------
    Outcome
        Compared with ``paths.elliptic_path``; off-axis means out of the ellipse's plane.

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    SingularConfigurationError
        If the leg is singular where it starts.
    """
    config = ellipse_config(options)
    along = np.array(config.direction)

    def motion(amplitude: float, time: Array) -> CommandedMotion:
        return elliptic_path(
            time,
            amplitude=amplitude,
            frequency=config.frequency,
            direction=along,
            lift=config.lift,
        )

    across = np.cross(along, UP)[:, np.newaxis]
    plan = _plan(config, options, motion, None)
    return _carry_out(plan, config, options, ellipse.build, across, progress)


def straight_config(robot: Robot, options: StraightOptions) -> hexabot_leg.HexabotLegConfig:
    """Say how the diagram of a straight step is built.

    Parameters
    ----------
    robot : Robot
        With three joint positions.
    options : StraightOptions
        Posture and step.

    Returns
    -------
    HexabotLegConfig

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the robot has not three joint positions.
    """
    _require_mass(robot)
    return hexabot_leg.HexabotLegConfig(
        robot=_unsaturated(robot),
        q0=_posture(robot, options),
        amplitude=options.amplitude,
        frequency=options.frequency,
        direction=options.unit_direction(),
        gain=options.gain,
        gravity=options.gravity,
        filter_time_constant=options.filter_time_constant,
        feedback=options.feedback,
        control=control_of(options, robot.moving),
    )


def straight_diagram(robot: Robot, options: StraightOptions) -> tuple[Diagram, Start]:
    """Build what the straight step simulates.

    Parameters
    ----------
    robot : Robot
        With three joint positions.
    options : StraightOptions
        Posture and step.

    Returns
    -------
    (Diagram, callable)
        And how it starts.

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the robot has not three joint positions.
    """
    return hexabot_leg.build(straight_config(robot, options)), start_on_motion


def ellipse_config(options: EllipseOptions) -> ellipse.EllipseConfig:
    """Say how the diagram of an elliptic step is built.

    Parameters
    ----------
    options : EllipseOptions
        Posture and ellipse.

    Returns
    -------
    EllipseConfig

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
    )


def _plan(
    config: hexabot_leg.HexabotLegConfig,
    options: StepOptions,
    motion: Motion,
    step: SineStep | None,
) -> Plan:
    arm = arm_of(config.robot)
    return Plan(
        arm=ChainArm(config.robot) if isinstance(arm, ScaraArm) else arm,
        q0=config.q0,
        control=config.control,
        motion=motion,
        amplitude=config.amplitude,
        frequency=config.frequency,
        duration=options.duration,
        step=step,
        filtered=config.filter_time_constant is not None,
    )


def _carry_out(
    plan: Plan,
    config: Config,
    options: StepOptions,
    build: Callable[[Config], Diagram],
    across: Array,
    progress: Progress | None,
) -> Outcome:
    """Look ahead, simulate, and compare with the command."""
    settings = options.integrator_settings(_default_step(config))
    forecast = plan.checked(config.robot.name, force=options.force)
    run = simulate(
        build(config),
        start=start_on_motion,
        duration=options.duration,
        settings=settings,
        progress=progress,
    )
    path = plan.motion(config.amplitude, run.time)
    outcome = _outcome(config, options, settings, run, path, across)
    met = singularity_findings(plan.arm, run, forecast, config.robot.name)
    return replace(outcome, summary={**outcome.summary, **met})


def _default_step(config: hexabot_leg.HexabotLegConfig) -> float:
    """Greatest step for the sine and, where there are any, for the filters' fast decay [s]."""
    step = step_for(default_step(config.frequency), config.control)
    filtered = config.filter_time_constant
    return step if filtered is None else min(step, STEP_OF_FILTER * filtered)


def _unsaturated(robot: Robot) -> Robot:
    """Take the effort limits off: the torque of a prescribed motion is what the motion takes."""
    return replace(
        robot,
        segments=tuple(
            replace(segment, mechanics=replace(segment.mechanics, effort=None, velocity=None))
            for segment in robot.segments
        ),
    )


def _exceeded_limits(robot: Robot, recording: Recording) -> list[str]:
    """Say which joints took more speed or effort than they have."""
    said = []
    for number, segment in enumerate(robot.moving, start=1):
        for what, column, limit in (
            ("speed", f"qdot{number}", segment.mechanics.velocity),
            ("effort", f"tau{number}", segment.mechanics.effort),
        ):
            greatest = float(np.abs(recording[column]).max())
            if limit is not None and greatest > limit:
                said.append(
                    f"joint {segment.joint} takes {what} {greatest:.4g}, its limit is {limit:.4g}"
                )
    return said


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


def leg_of(variant: LegVariant, options: LegOptions) -> Robot:
    """Return the leg that the options describe.

    Parameters
    ----------
    variant : {"A", "B"}
        Whose leg.
    options : LegOptions
        Lengths, density, damping.

    Returns
    -------
    Robot

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


def _as_options(robot: Robot, q0: Sequence[float]) -> list[float]:
    """Give a posture as --q0 takes it."""
    return [
        round(math.degrees(q), 9) if segment.row.joint == "revolute" else q
        for q, segment in zip(q0, robot.moving, strict=True)
    ]


def _posture(robot: Robot, options: StraightOptions) -> tuple[float, float, float]:
    """Take q0 in rad where a joint turns, in m where it slides, or the robot's state targets."""
    angles = options.posture()
    if len(robot.moving) != 3:
        return angles
    q1, q2, q3 = (
        angle if segment.row.joint == "revolute" else math.degrees(angle)
        for angle, segment in zip(angles, robot.moving, strict=True)
    )
    if (q1, q2, q3) == (0.0, 0.0, 0.0):  # where nobody said anything
        q1, q2, q3 = initial_state(robot).q
    joints = (str(segment.joint) for segment in robot.moving)
    initial_state(robot, {joint: (q, 0.0) for joint, q in zip(joints, (q1, q2, q3), strict=True)})
    return q1, q2, q3


def _outcome(
    config: hexabot_leg.HexabotLegConfig,
    options: StepOptions,
    settings: IntegratorSettings,
    run: Run,
    path: CommandedMotion,
    across: Array,
) -> Outcome:
    robot = config.robot
    start = foot_pose(robot.rows, config.q0)[:3, 3]
    J = jacobian(robot.rows, run.scopes["joint positions"])[:, 3:, :]
    sigma_min = smallest_singular_value(J)
    det_j = run.scopes["singularity check"][:, 0]
    power = sum(segment.row.joint == "revolute" for segment in robot.moving)
    columns = tip_columns(robot, run)
    columns |= {f"det_j[m^{power}]": det_j, "sigma_min[m]": sigma_min}
    exact = exact_tip(start, path, _exact_angles(config, start + path.displacement))
    findings = {
        "q0_deg": options.q0 if any(options.q0) else _as_options(robot, config.q0),
        **control_findings(config.control),
        **tip_findings(run, start, path, np.array(config.direction), across),
        "max_torque_error_n_m": torque_error(robot, run, config.gravity),
        "sigma_min_m": float(sigma_min.min()),
        f"det_j_min_m{power}": float(det_j.min()),
        f"det_j_max_m{power}": float(det_j.max()),
    }
    if config.filter_time_constant is not None:
        behind = run.scopes["foot positions"][-1] - (start + path.displacement[-1])
        findings["filter_time_constant_s"] = config.filter_time_constant
        findings["end_error_m"] = behind.tolist()  # of the filters' making
    return outcome_of(robot, run, settings, options.duration, Recording(columns), exact, findings)


def _exact_angles(config: hexabot_leg.HexabotLegConfig, feet: Array) -> Array | None:
    """Return the closed form's joint angles; there is none for a robot from a file."""
    if not is_hexabot_leg(config.robot):
        return None
    return inverse_kinematics(LegGeometry.from_robot(config.robot), feet, like=config.q0)
