"""The straight step: of the hexabot's leg, and of any other robot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, build
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.kinematics.chain import geometry_of
from drake_leg.kinematics.euler import rotation_matrices
from drake_leg.kinematics.khalil import Array, foot_pose, jacobian
from drake_leg.kinematics.leg import LegGeometry, inverse_kinematics
from drake_leg.kinematics.movable import Movable, smallest_singular_value
from drake_leg.robot.robot import Robot
from drake_leg.runs.configs import leg_of, require_regular_start, straight_config
from drake_leg.runs.options import LegBOptions, LegOptions, StepOptions, StraightOptions
from drake_leg.runs.outcome import Outcome, outcome_of
from drake_leg.runs.tip import (
    Followed,
    control_findings,
    exact_tip,
    follow,
    tip_columns,
    tip_findings,
    tip_inaccuracy,
    torque_error,
)
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import Progress, Start
from drake_leg.units import joint_entries


def run(options: LegBOptions, progress: Progress | None = None) -> Outcome:
    """Make the foot of leg A or B step along a straight line; see ``run_robot``."""
    return run_robot(leg_of(options), options, progress)


def diagram(options: LegBOptions) -> tuple[Diagram, Start]:
    """Build the diagram that ``run`` simulates; return it with its start."""
    return robot_diagram(leg_of(options), options)


def robot(options: LegOptions) -> Robot:
    """Return the robot that moves."""
    return leg_of(options)


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
    if options.q0 is None:
        require_regular_start(config)
    followed = follow(config, build, options, progress, lag=config.filter_time_constant)
    outcome = compared(config, options, followed)
    exceeded = {"limits_exceeded": _exceeded_limits(robot, outcome.recording)}
    return replace(outcome, summary={**outcome.summary, **exceeded})


def robot_diagram(robot: Robot, options: StraightOptions) -> tuple[Diagram, Start]:
    """Build the diagram that ``run_robot`` simulates; return it with its start.

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the foot cannot go that way.
    """
    return build(straight_config(robot, options)), start_on_motion


def compared(config: HexabotLegConfig, options: StepOptions, followed: Followed) -> Outcome:
    """Compare the foot's motion with its command."""
    robot, moved, motion, run = config.robot, config.movable, config.motion, followed.run
    X_BF = foot_pose(robot.rows, config.q0)
    start = X_BF[:3, 3]
    J = moved.twists.T @ jacobian(robot.rows, run.scopes["joint positions"])
    sigma_min = smallest_singular_value(np.array(moved.row_lengths)[:, np.newaxis] * J)
    det_j = run.scopes["singularity check"][:, 0]
    name, unit = _determinant(robot, moved)
    columns = tip_columns(robot, run)
    columns |= {f"{name}[{unit}]" if unit else name: det_j, "sigma_min[m]": sigma_min}
    end = start + motion.displacement(run.time)
    findings = {
        **joint_entries("q0", config.q0, [s.row.joint == "prismatic" for s in robot.moving]),
        "task": "pose" if moved.keeps_orientation else "position",
        "direction": list(motion.direction),
        **control_findings(config.control, robot),
        **tip_findings(run, start, motion, config.disturbance),
        "max_torque_error_n_m": torque_error(robot, run, config.gravity, config.disturbance),
        "sigma_min_m": float(sigma_min.min()),
        f"{name}_min_{unit}".replace("^", "").rstrip("_"): float(det_j.min()),
        f"{name}_max_{unit}".replace("^", "").rstrip("_"): float(det_j.max()),
    }
    if moved.keeps_orientation:
        findings["max_rotation_error_rad"] = _greatest_turn(X_BF[:3, :3], run.scopes["Q"])
    if config.filter_time_constant is not None:
        behind = run.scopes["foot positions"][-1] - end[-1]
        findings["filter_time_constant_s"] = config.filter_time_constant
        findings["end_error_m"] = behind.tolist()  # caused by the filters
    findings["inaccuracy"] = tip_inaccuracy(
        findings, run, motion, config.control, followed.settings, "foot"
    )
    return outcome_of(
        robot,
        run,
        followed.settings,
        options.duration,
        Recording(columns),
        exact_tip(start, motion, run.time, _exact_angles(config, end)),
        {**findings, **followed.met},
    )


def _exceeded_limits(robot: Robot, recording: Recording) -> list[str]:
    """Report which joints exceeded their speed or effort limits."""
    said = []
    for number, segment in enumerate(robot.moving, start=1):
        for what, column, limit in (
            ("speed", f"qdot{number}", segment.mechanics.velocity),
            ("effort", f"tau{number}", segment.mechanics.effort),
        ):
            greatest = float(np.abs(recording[column]).max())
            if limit is not None and greatest > limit:
                size, unit = _unit_of(what, slides=segment.row.joint == "prismatic")
                said.append(
                    f"joint {segment.joint} takes {what} {size * greatest:.4g} {unit}, its limit "
                    f"is {size * limit:.4g} {unit}"
                )
    return said


def _unit_of(what: str, *, slides: bool) -> tuple[float, str]:
    """Return the factor from SI to the displayed unit of speed or effort, and its name."""
    if what == "effort":
        return 1.0, "N" if slides else "N*m"
    return (1.0, "m/s") if slides else (math.degrees(1.0), "deg/s")


def _determinant(robot: Robot, moved: Movable) -> tuple[str, str]:
    """Name the singularity check's quantity and its unit, which a redundant robot may not have."""
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


def _exact_angles(config: HexabotLegConfig, feet: Array) -> Array | None:
    """Return the closed form's joint angles; there is none for a robot from a file."""
    geometry = geometry_of(config.robot)
    if not isinstance(geometry, LegGeometry):
        return None
    return inverse_kinematics(geometry, feet, like=config.q0)
