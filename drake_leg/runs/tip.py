"""What a foot or a tool did, compared with the motion that it was to follow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.kinematics.chain import base_rotation
from drake_leg.kinematics.khalil import Array, jacobian
from drake_leg.kinematics.motions import SineStep
from drake_leg.robot.robot import Robot
from drake_leg.runs.options import INVERSE, NONE
from drake_leg.runs.outcome import finer, inaccuracy
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.recording import lettered, numbered, without_sign_jumps
from drake_leg.simulation.run import Run
from drake_leg.simulation.torques import torques_along, torques_by_equation

OFF_COMMAND = 1e-6  # [m]: a tip that is farther from its command than this is off it
BAND = 1e-3  # [m]: the same for a tip that something disturbs


def tip_columns(robot: Robot, run: Run, command: Sequence[str]) -> dict[str, Array]:
    """Collect time, input, command, joints, tip and torques by header.

    ``command`` has the headers of the three commanded velocities.
    """
    kinds = [segment.row.joint for segment in robot.moving]
    length = ["rad" if kind == "revolute" else "m" for kind in kinds]
    force = ["N*m" if kind == "revolute" else "N" for kind in kinds]
    columns = {"time[s]": run.time, "input[m/s]": run.scopes["input"][:, 0]}
    columns |= dict(zip(command, run.scopes["commanded velocities"].T, strict=True))
    for name, scope, units in (
        ("q", "joint positions", length),
        ("qdot", "joint velocities", [f"{unit}/s" for unit in length]),
        ("qddot", "joint accelerations", [f"{unit}/s^2" for unit in length]),
    ):
        columns |= numbered(name, units, run.scopes[scope])
    columns |= lettered("", "xyz", "m", run.scopes["foot positions"])
    columns |= lettered("v", "xyz", "m/s", run.scopes["foot velocities"])
    columns |= lettered("q", "wxyz", "", without_sign_jumps(run.scopes["Q"]))
    columns |= lettered("w", "xyz", "rad/s", run.scopes["foot angular velocities"])
    if "joint torques" in run.scopes:
        columns |= numbered("tau", force, run.scopes["joint torques"])
    if "torques asked for" in run.scopes:
        columns |= numbered("tau_asked", force, run.scopes["torques asked for"])
    return columns


def exact_tip(start: Array, motion: SineStep, time: Array, q: Array | None) -> dict[str, Array]:
    """Name the exact values of a tip's columns by column, without unit.

    ``start`` (3,) is where the motion starts [m], ``q`` (rows, 3) the exact angles [rad], if known.
    """
    exact = lettered("", "xyz", "", start + motion.displacement(time))
    exact |= lettered("v", "xyz", "", motion.velocity(time))
    if q is not None:
        exact |= {f"q{i + 1}": q[:, i] for i in range(3)}
    return exact


def control_findings(control: Control, robot: Robot) -> dict[str, Any]:
    """Report how the command was followed: entries of the summary."""
    moved = robot.moving[: len(control.q0_error)]
    units = ["m" if segment.row.joint == "prismatic" else "rad" for segment in moved]
    error: dict[str, Any] = {"q0_error_rad": list(control.q0_error)}
    if "m" in units:
        error = {"q0_error": list(control.q0_error), "q0_error_units": units}
    return {
        "inverse": control.inverse.method,
        "correction_1_s": control.correction,
        **error,
    }


def tip_findings(
    run: Run, start: Array, motion: SineStep, disturbance: Disturbance
) -> dict[str, Any]:
    """Compare the tip's motion with its exact path from ``start``, (3,) [m], for the summary."""
    moved = run.scopes["foot positions"] - start
    along = np.array(motion.direction)
    velocity_error = run.scopes["foot velocities"] - motion.velocity(run.time)
    off = np.linalg.norm(moved - motion.displacement(run.time), axis=1)
    return {
        "stroke_m": float(np.ptp(moved @ along)),
        "max_position_error_m": float(off.max()),
        "greatest_distance_from_command_m": float(off.max()),
        "time_off_command_s": float(np.diff(run.time)[off[1:] > OFF_COMMAND].sum()),
        "distance_from_command_at_the_end_m": float(off[-1]),
        "max_off_axis_m": _greatest(moved @ motion.across),
        "off_command_m": OFF_COMMAND,
        "max_velocity_error_m_s": _greatest(velocity_error),
        "disturbance": _cost(run, off, disturbance) if disturbance.acts else None,
    }


def _cost(run: Run, distance: Array, disturbance: Disturbance) -> dict[str, Any]:
    """Report the effect of a disturbance; ``distance`` (rows,) is the tip's off its command [m]."""
    from scipy.integrate import trapezoid  # slow to load

    push = disturbance.push
    given = run.scopes["joint torques"]
    asked = run.scopes.get("torques asked for", given)
    lag = run.scopes["joint positions"] - run.scopes["prescribed positions"]
    steps = np.diff(run.time)
    off, cut = distance > BAND, (asked != given).any(axis=1)
    power = (given * run.scopes["joint velocities"]).sum(axis=1)
    work_of_push = 0.0
    if push is not None:
        pushed = (push.at_time(run.time) * run.scopes["foot velocities"]).sum(axis=1)
        work_of_push = float(trapezoid(pushed, run.time))
    return {
        "push_n": None if push is None else list(push.force),
        "push_at_s": None if push is None else push.at,
        "push_for_s": None if push is None else push.lasting,
        "mass_error": disturbance.mass_error,
        "torque_limit": disturbance.torque_limit,
        "stiffness_1_s2": disturbance.pull,
        "greatest_joint_lag": float(np.abs(lag).max()),
        "band_m": BAND,
        "time_off_band_s": float(steps[off[1:]].sum()),
        "greatest_torque_given": float(np.abs(given).max()),
        "greatest_torque_asked": float(np.abs(asked).max()),
        "time_at_torque_limit_s": float(steps[cut[1:]].sum()),
        "work_of_joints_j": float(trapezoid(power, run.time)),
        "work_of_push_j": work_of_push,
    }


def tip_inaccuracy(
    findings: Mapping[str, Any],
    run: Run,
    motion: SineStep,
    control: Control,
    settings: IntegratorSettings,
    what: str,
) -> str | None:
    """Explain that the integration is the cause of a tip's visible error, if it is.

    ``findings`` are those of ``tip_findings``, with the filters' time constant if there are any;
    ``what`` is foot or tool.
    """
    explained = (
        findings["disturbance"] is not None
        or "filter_time_constant_s" in findings
        or not control.inverse.is_exact
        or any(control.q0_error)
    )
    if explained:
        return None
    span = float(np.ptp(motion.displacement(run.time), axis=0).max())
    return inaccuracy(findings["max_position_error_m"], span, what, "m", finer(settings))


def torque_error(
    robot: Robot, run: Run, gravity: float, disturbance: Disturbance, dynamics: str
) -> float | None:
    """Greatest error of the recorded torques [N*m or N]; None where there are none.

    Torques that drove a plant are compared with Drake's inverse dynamics at the recorded positions,
    velocities and accelerations, less the effect of a push. Torques that are inverse dynamics are
    compared with the equation of motion, ``M qddot + C qdot - tau_g + d qdot + k (q - q_0)``.
    """
    if dynamics == NONE:
        return None
    if dynamics == INVERSE:
        exact = torques_by_equation(robot, gravity, run)
    else:
        exact = torques_along(robot, gravity, run) - push_torques(robot, run, disturbance)
    return float(np.abs(run.scopes["joint torques"] - exact).max())


def push_torques(robot: Robot, run: Run, disturbance: Disturbance) -> Array:
    """Return the joint torques that a push on the tip causes: ``J^T F``, (rows, n) [N*m or N]."""
    q = run.scopes["joint positions"]
    if disturbance.push is None:
        return np.zeros_like(q)
    Jv = jacobian(robot.rows, q)[:, 3:, :]
    force = disturbance.push.at_time(run.time) @ base_rotation(robot)  # in the base frame
    torques: Array = np.einsum("rij,ri->rj", Jv, force)
    return torques


def exceeded_limits(robot: Robot, run: Run) -> list[str]:
    """Report which joints exceeded their speed or effort limits."""
    said = []
    for index, segment in enumerate(robot.moving):
        slides = segment.row.joint == "prismatic"
        of_speed = (1.0, "m/s") if slides else (math.degrees(1.0), "deg/s")
        for what, scope, limit, (size, unit) in (
            ("speed", "joint velocities", segment.mechanics.velocity, of_speed),
            ("effort", "joint torques", segment.mechanics.effort, (1.0, "N" if slides else "N*m")),
        ):
            if scope not in run.scopes:
                continue
            greatest = float(np.abs(run.scopes[scope][:, index]).max())
            if limit is not None and greatest > limit:
                said.append(
                    f"joint {segment.joint} takes {what} {size * greatest:.4g} {unit}, its limit "
                    f"is {size * limit:.4g} {unit}"
                )
    return said


def _greatest(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())
