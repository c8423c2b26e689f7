"""The SCARA's run: its tool on a straight horizontal line."""

from __future__ import annotations

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.diagrams.scara import ScaraConfig, build
from drake_leg.kinematics.movable import smallest_singular_value
from drake_leg.kinematics.scara import inverse_kinematics, task_jacobian, tool_position
from drake_leg.robot.robot import Robot
from drake_leg.runs.configs import scara_config
from drake_leg.runs.options import ScaraOptions
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


def run(options: ScaraOptions, progress: Progress | None = None) -> Outcome:
    """Drive the tool along a straight line, yaw and height constant.

    Parameters
    ----------
    options : ScaraOptions
        Posture, move, lengths, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    SingularConfigurationError
        If the arm is stretched or folded where it starts.
    """
    options.refuse_ignored()
    config = scara_config(options)
    return _compared(config, options, follow(config, build, options, progress))


def diagram(options: ScaraOptions) -> tuple[Diagram, Start]:
    """Build what ``run`` simulates, and say how it starts."""
    return build(scara_config(options)), start_on_motion


def robot(options: ScaraOptions) -> Robot:
    """Return what moves."""
    return scara_config(options).robot


def _compared(config: ScaraConfig, options: ScaraOptions, followed: Followed) -> Outcome:
    """Compare what the tool did with its command."""
    robot, motion, run = config.robot, config.motion, followed.run
    start = tool_position(config.geometry, (*config.q0, config.lift))
    q = run.scopes["joint positions"]
    yaw, yaw0 = q[:, :3].sum(axis=1), sum(config.q0)
    sigma_min = smallest_singular_value(task_jacobian(config.geometry, q[:, :3])[:, :2, :2])
    det_j = run.scopes["singularity check"][:, 0]
    columns = tip_columns(robot, run, ("dx[m/s]", "dy[m/s]", "dyaw[rad/s]"))
    columns |= {"yaw[rad]": yaw, "det_j[m^2]": det_j, "sigma_min[m]": sigma_min}
    task = start + motion.displacement(run.time)
    task[:, 2] = yaw0
    q_exact = inverse_kinematics(config.geometry, task, like=config.q0)
    findings = {
        **joint_entries("q0", config.q0, [False, False, False]),
        **control_findings(config.control, robot),
        **tip_findings(run, start, motion, config.disturbance),
        "max_yaw_error_rad": float(np.abs(yaw - yaw0).max()),
        "max_torque_error_n_m": torque_error(robot, run, config.gravity, config.disturbance),
        "sigma_min_m": float(sigma_min.min()),
        "det_j_min_m2": float(det_j.min()),
        "det_j_max_m2": float(det_j.max()),
    }
    findings["inaccuracy"] = tip_inaccuracy(
        findings, run, motion, config.control, followed.settings, "tool"
    )
    exact = {**exact_tip(start, motion, run.time, q_exact), "yaw": np.full_like(yaw, yaw0)}
    return outcome_of(
        robot,
        run,
        followed.settings,
        options.duration,
        Recording(columns),
        exact,
        {**findings, **followed.met},
        "tool",
    )
