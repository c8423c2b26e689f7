"""The SCARA's run: its tool on a straight horizontal line."""

from __future__ import annotations

import numpy as np

from drake_leg.diagrams import scara
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.kinematics.paths import straight_path
from drake_leg.kinematics.rates import smallest_singular_value
from drake_leg.kinematics.scara import (
    ScaraGeometry,
    inverse_kinematics,
    lift_position,
    task_jacobian,
    tool_position,
)
from drake_leg.recording import Recording
from drake_leg.robots import scara as scara_robot
from drake_leg.runs.options import ScaraOptions
from drake_leg.runs.outcome import Outcome, outcome_of
from drake_leg.runs.tip import default_step, exact_tip, tip_columns, tip_findings, torque_error
from drake_leg.simulation import Progress, simulate


def run_scara(options: ScaraOptions, progress: Progress | None = None) -> Outcome:
    """Drive the tool along a straight line, yaw and height constant.

    Parameters
    ----------
    options : ScaraOptions
        Posture, move, lengths, integrator.
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
        If the arm is stretched or folded where it starts.
    """
    config = scara_config(options)
    settings = options.integrator_settings(default_step(config.frequency))
    run = simulate(
        scara.build(config),
        start=start_on_motion,
        duration=options.duration,
        settings=settings,
        progress=progress,
    )
    arm = ScaraGeometry.from_robot(config.robot)
    along = np.array(config.direction)
    path = straight_path(
        run.time, amplitude=config.amplitude, frequency=config.frequency, direction=along
    )
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
    findings = {
        "q0_deg": options.q0,
        **tip_findings(run, start, path, along, np.eye(3) - np.outer(along, along)),
        "max_yaw_error_rad": float(np.abs(yaw - yaw0).max()),
        "max_torque_error_n_m": torque_error(config.robot, run, config.gravity),
        "sigma_min_m": float(sigma_min.min()),
        "det_j_min_m2": float(det_j.min()),
        "det_j_max_m2": float(det_j.max()),
    }
    return outcome_of(
        config.robot, run, settings, options.duration, Recording(columns), exact, findings
    )


def scara_config(options: ScaraOptions) -> scara.ScaraConfig:
    """Say how the diagram of the SCARA's move is built.

    Parameters
    ----------
    options : ScaraOptions
        Posture, move, lengths.

    Returns
    -------
    ScaraConfig

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    """
    return scara.ScaraConfig(
        robot=scara_robot(
            l1=options.l1, l2=options.l2, density=options.density, damping=options.si_damping()
        ),
        q0=options.posture(),
        R=options.tool_height,
        amplitude=options.amplitude,
        frequency=options.frequency,
        direction=options.unit_direction(),
        gravity=options.gravity,
    )
