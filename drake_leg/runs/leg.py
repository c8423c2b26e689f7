"""The leg's runs: a straight step and an ellipse; the straight step of any other robot, too."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams import ellipse, hexabot_leg
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.integrator import IntegratorSettings
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import foot_pose, jacobian
from drake_leg.kinematics.leg import LegGeometry, inverse_kinematics
from drake_leg.kinematics.movable import Movable, smallest_singular_value
from drake_leg.kinematics.of_robot import geometry_of
from drake_leg.kinematics.paths import UP, CommandedMotion, elliptic_path, straight_path
from drake_leg.kinematics.rotation import rotation_matrices
from drake_leg.quantities import joint_entries
from drake_leg.recording import Recording
from drake_leg.robot import Robot
from drake_leg.robots import LegVariant
from drake_leg.runs.disturbance import step_under
from drake_leg.runs.foresight import (
    Motion,
    Plan,
    control_findings,
    singularity_findings,
    step_for,
)
from drake_leg.runs.leg_setup import ellipse_config, leg_of, straight_config
from drake_leg.runs.options import (
    EllipseOptions,
    LegBOptions,
    StepOptions,
    StraightOptions,
)
from drake_leg.runs.outcome import Outcome, outcome_of
from drake_leg.runs.tip import (
    default_step,
    exact_tip,
    tip_columns,
    tip_findings,
    tip_inaccuracy,
    torque_error,
)
from drake_leg.simulation import Progress, Run, simulate
from drake_leg.singularity.forecast import SineStep

Config = TypeVar("Config", bound=hexabot_leg.HexabotLegConfig)

STEP_OF_FILTER = 1.5  # greatest step over the filters' time constant; 2 is unstable with Euler


def run_straight(
    variant: LegVariant, options: LegBOptions, progress: Progress | None = None
) -> Outcome:
    """Make the foot step along a straight line.

    Parameters
    ----------
    options : LegBOptions
        Posture, step, lengths, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    SingularConfigurationError
        If the leg is singular where it starts.
    """
    return run_robot(leg_of(variant, options), options, progress)


def run_robot(robot: Robot, options: StraightOptions, progress: Progress | None = None) -> Outcome:
    """Make the foot of any robot step along a straight line.

    Parameters
    ----------
    robot : Robot
        Any whose foot can make the step.
    options : StraightOptions
        Posture, in degrees where a joint turns and in m where it slides, step, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the foot cannot go that way.
    SingularConfigurationError
        If the robot is singular where it starts.
    """
    options.refuse_ignored()
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
    options.refuse_ignored()
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


def _plan(
    config: hexabot_leg.HexabotLegConfig,
    options: StepOptions,
    motion: Motion,
    step: SineStep | None,
) -> Plan:
    return Plan(
        robot=config.movable(),
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
    met = singularity_findings(
        plan.robot, run, forecast, config.robot.name, disturbed=config.disturbance.acts
    )
    return replace(outcome, summary={**outcome.summary, **met})


def _default_step(config: hexabot_leg.HexabotLegConfig) -> float:
    """Greatest step for the sine and, where there are any, for the filters' fast decay [s]."""
    step = step_for(default_step(config.frequency), config.control)
    step = step_under(step, config.disturbance)
    filtered = config.filter_time_constant
    return step if filtered is None else min(step, STEP_OF_FILTER * filtered)


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
                size, unit = _typed(what, slides=segment.row.joint == "prismatic")
                said.append(
                    f"joint {segment.joint} takes {what} {size * greatest:.4g} {unit}, its limit "
                    f"is {size * limit:.4g} {unit}"
                )
    return said


def _typed(what: str, *, slides: bool) -> tuple[float, str]:
    """Return the unit of a speed or an effort as a person gives it, and how many make an SI one."""
    if what == "effort":
        return 1.0, "N" if slides else "N*m"
    return (1.0, "m/s") if slides else (math.degrees(1.0), "deg/s")


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
    moved = config.movable()
    J = moved.twists.T @ jacobian(robot.rows, run.scopes["joint positions"])
    sigma_min = smallest_singular_value(np.array(moved.row_lengths)[:, np.newaxis] * J)
    det_j = run.scopes["singularity check"][:, 0]
    name, unit = _determinant(robot, moved)
    columns = tip_columns(robot, run)
    columns |= {f"{name}[{unit}]" if unit else name: det_j, "sigma_min[m]": sigma_min}
    exact = exact_tip(start, path, _exact_angles(config, start + path.displacement))
    findings = {
        **joint_entries("q0", config.q0, [s.row.joint == "prismatic" for s in robot.moving]),
        "task": "pose" if moved.keeps_orientation else "position",
        "direction": list(config.direction),
        **control_findings(config.control),
        **tip_findings(run, start, path, np.array(config.direction), across, config.disturbance),
        "max_torque_error_n_m": torque_error(robot, run, config.gravity, config.disturbance),
        "sigma_min_m": float(sigma_min.min()),
        f"{name}_min_{unit}".replace("^", "").rstrip("_"): float(det_j.min()),
        f"{name}_max_{unit}".replace("^", "").rstrip("_"): float(det_j.max()),
    }
    if moved.keeps_orientation:
        R_BF = foot_pose(robot.rows, config.q0)[:3, :3]
        findings["max_rotation_error_rad"] = _greatest_turn(R_BF, run.scopes["Q"])
    if config.filter_time_constant is not None:
        behind = run.scopes["foot positions"][-1] - (start + path.displacement[-1])
        findings["filter_time_constant_s"] = config.filter_time_constant
        findings["end_error_m"] = behind.tolist()  # of the filters' making
    findings["inaccuracy"] = tip_inaccuracy(findings, path, config.control, settings, "foot")
    return outcome_of(robot, run, settings, options.duration, Recording(columns), exact, findings)


def _determinant(robot: Robot, moved: Movable) -> tuple[str, str]:
    """Name what the singularity check records, and its unit: none where a redundant one mixes."""
    sliding = sum(segment.row.joint == "prismatic" for segment in robot.moving)
    power = int(np.linalg.matrix_rank(moved.twists[3:])) - sliding
    if not moved.is_redundant:
        return "det_j", f"m^{power}"
    return "manipulability", "" if sliding else f"m^{power}"


def _greatest_turn(R_BF: Array, quaternions: Array) -> float:
    """Greatest angle by which a foot has turned from a rotation that it should keep [rad]."""
    off = rotation_matrices(quaternions) - R_BF
    farthest = np.linalg.norm(off, axis=(1, 2))  # 2 sqrt(2) sin(angle / 2)
    return float(2.0 * np.arcsin(np.minimum(farthest / math.sqrt(8.0), 1.0)).max())


def _exact_angles(config: hexabot_leg.HexabotLegConfig, feet: Array) -> Array | None:
    """Return the closed form's joint angles; there is none for a robot from a file."""
    geometry = geometry_of(config.robot)
    if not isinstance(geometry, LegGeometry):
        return None
    return inverse_kinematics(geometry, feet, like=config.q0)
