"""The SCARA's run: its tool on a straight horizontal line."""

from __future__ import annotations

import numpy as np

from drake_leg.diagrams import scara
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.movable import smallest_singular_value
from drake_leg.kinematics.paths import CommandedMotion, straight_path
from drake_leg.kinematics.scara import (
    MovableScara,
    ScaraGeometry,
    inverse_kinematics,
    lift_position,
    task_jacobian,
    tool_position,
)
from drake_leg.quantities import joint_entries
from drake_leg.recording import Recording
from drake_leg.robots import scara as scara_robot
from drake_leg.runs.disturbance import disturbance_of, step_under
from drake_leg.runs.foresight import (
    Plan,
    control_findings,
    control_of,
    singularity_findings,
    step_for,
)
from drake_leg.runs.options import ScaraOptions
from drake_leg.runs.outcome import Outcome, outcome_of
from drake_leg.runs.tip import (
    default_step,
    exact_tip,
    tip_columns,
    tip_findings,
    tip_inaccuracy,
    torque_error,
)
from drake_leg.simulation import Progress, simulate
from drake_leg.singularity.forecast import SineStep


def run_scara(options: ScaraOptions, progress: Progress | None = None) -> Outcome:
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
    along = np.array(config.direction)
    plan = _plan(config, options.duration)
    step = step_for(default_step(config.frequency), config.control)
    step = step_under(step, config.disturbance)
    settings = options.integrator_settings(step)
    forecast = plan.checked(config.robot.name, force=options.force)
    run = simulate(
        scara.build(config),
        start=start_on_motion,
        duration=options.duration,
        settings=settings,
        progress=progress,
    )
    arm = ScaraGeometry.from_robot(config.robot)
    path = plan.motion(config.amplitude, run.time)
    start = tool_position(arm, (*config.q0, lift_position(arm, config.R)))
    q = run.scopes["joint positions"]
    yaw, yaw0 = q[:, :3].sum(axis=1), sum(config.q0)
    sigma_min = smallest_singular_value(task_jacobian(arm, q[:, :3])[:, :2, :2])
    det_j = run.scopes["singularity check"][:, 0]
    columns = tip_columns(config.robot, run, ("dx[m/s]", "dy[m/s]", "dyaw[rad/s]"))
    columns |= {"yaw[rad]": yaw, "det_j[m^2]": det_j, "sigma_min[m]": sigma_min}
    task = start + path.displacement
    task[:, 2] = yaw0
    exact = {
        **exact_tip(start, path, inverse_kinematics(arm, task, like=config.q0)),
        "yaw": np.full_like(yaw, yaw0),
    }
    across = np.eye(3) - np.outer(along, along)
    findings = {
        **joint_entries("q0", config.q0, [False, False, False]),
        **control_findings(config.control),
        **tip_findings(run, start, path, along, across, config.disturbance),
        "max_yaw_error_rad": float(np.abs(yaw - yaw0).max()),
        "max_torque_error_n_m": torque_error(config.robot, run, config.gravity, config.disturbance),
        "sigma_min_m": float(sigma_min.min()),
        "det_j_min_m2": float(det_j.min()),
        "det_j_max_m2": float(det_j.max()),
    }
    findings["inaccuracy"] = tip_inaccuracy(findings, path, config.control, settings, "tool")
    findings |= singularity_findings(
        plan.robot, run, forecast, config.robot.name, disturbed=config.disturbance.acts
    )
    return outcome_of(
        config.robot, run, settings, options.duration, Recording(columns), exact, findings, "tool"
    )


def _plan(config: scara.ScaraConfig, duration: float) -> Plan:
    arm = ScaraGeometry.from_robot(config.robot)

    def motion(amplitude: float, time: Array) -> CommandedMotion:
        return straight_path(
            time,
            amplitude=amplitude,
            frequency=config.frequency,
            direction=np.array(config.direction),
        )

    return Plan(
        robot=MovableScara(arm, lift_position(arm, config.R)),
        q0=config.q0,
        control=config.control,
        motion=motion,
        amplitude=config.amplitude,
        frequency=config.frequency,
        duration=duration,
        step=SineStep(
            amplitude=config.amplitude, frequency=config.frequency, direction=config.direction
        ),
    )


def scara_config(options: ScaraOptions) -> scara.ScaraConfig:
    """Say how the diagram of the SCARA's move is built.

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    """
    robot = scara_robot(
        l1=options.l1, l2=options.l2, density=options.density, damping=options.si_damping()
    )
    return scara.ScaraConfig(
        robot=robot,
        q0=options.posture(),
        R=options.tool_height,
        amplitude=options.amplitude,
        frequency=options.frequency,
        direction=options.unit_direction(),
        gravity=options.gravity,
        control=control_of(options, robot.moving[:3]),
        disturbance=disturbance_of(options),
    )
