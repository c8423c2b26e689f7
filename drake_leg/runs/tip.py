"""What the runs have in common in which a foot or a tool follows a commanded path."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydrake.multibody.tree import MultibodyForces

from drake_leg.diagrams.control import Control
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.integrator import ROW_INTERVAL, IntegratorSettings
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.joint_stop import limit_force
from drake_leg.kinematics.paths import CommandedMotion
from drake_leg.models.plant import build_plant
from drake_leg.recording import lettered, numbered, without_sign_jumps
from drake_leg.robot import Robot
from drake_leg.runs.accuracy import finer, inaccuracy
from drake_leg.runs.disturbance import disturbance_findings, push_torques
from drake_leg.simulation import Run

OFF_COMMAND = 1e-6  # [m]: a tip that is farther from its command than this is off it
STEPS_PER_PERIOD = 150


def default_step(frequency: float) -> float:
    """Greatest step for a sine: its period in 150, and at most 40 ms.

    Parameters
    ----------
    frequency : float
        [rad/s].

    Returns
    -------
    float
        [s]; 40 ms where the frequency makes no sense (it is refused elsewhere).
    """
    if not (math.isfinite(frequency) and frequency > 0.0):
        return ROW_INTERVAL
    return min(ROW_INTERVAL, 2.0 * math.pi / (STEPS_PER_PERIOD * frequency))


def tip_columns(
    robot: Robot, run: Run, command: Sequence[str] = ("dx[m/s]", "dy[m/s]", "dz[m/s]")
) -> dict[str, Array]:
    """Name what the scopes of a motion-driven robot recorded.

    Parameters
    ----------
    robot : Robot
        Its joints give the units.
    run : Run
        With the scopes of ``mechanism.add_mechanism_scopes``.
    command : sequence of str
        Headers of the three commanded velocities.

    Returns
    -------
    dict
        Header to column: time, input, command, joints, tip, torques.
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
    columns |= numbered("tau", force, run.scopes["joint torques"])
    if "torques asked for" in run.scopes:
        columns |= numbered("tau_asked", force, run.scopes["torques asked for"])
    return columns


def tip_findings(
    run: Run,
    start: Array,
    path: CommandedMotion,
    along: Array,
    across: Array,
    disturbance: Disturbance,
) -> dict[str, Any]:
    """Compare the tip's motion with its exact path.

    Parameters
    ----------
    start : (3,) ndarray
        Exact position of the tip at the start [m].
    path : CommandedMotion
        Exact motion from there, at the run's instants.
    along : (3,) ndarray
        Unit vector of the step.
    across : (3, k) ndarray
        Orthonormal directions in which the tip must not move.
    disturbance : Disturbance
        What kept it from its path.

    Returns
    -------
    dict
        Entries of the summary, in m and m/s.
    """
    measured = run.scopes["foot positions"]
    moved = measured - start
    velocity_error = run.scopes["foot velocities"] - path.velocity
    off = np.linalg.norm(moved - path.displacement, axis=1)
    return {
        "stroke_m": float(np.ptp(moved @ along)),
        "max_position_error_m": float(off.max()),
        "greatest_distance_from_command_m": float(off.max()),
        "time_off_command_s": float(np.diff(run.time)[off[1:] > OFF_COMMAND].sum()),
        "distance_from_command_at_the_end_m": float(off[-1]),
        "max_off_axis_m": _greatest(moved @ across),
        "off_command_m": OFF_COMMAND,
        "max_velocity_error_m_s": _greatest(velocity_error),
        **disturbance_findings(run, off, disturbance),
    }


def tip_inaccuracy(
    findings: Mapping[str, Any],
    path: CommandedMotion,
    control: Control,
    settings: IntegratorSettings,
    what: str,
) -> str | None:
    """Say that the integration is to blame for a tip that is not where it was sent.

    Parameters
    ----------
    findings : mapping
        As ``tip_findings`` gives them, with the filters' time constant if there are any.
    control : Control
        What else may take a tip off its command.
    settings : IntegratorSettings
        How time was stepped.

    Returns
    -------
    str or None
        None where the error cannot be seen, or something that was asked for explains it.
    """
    explained = (
        findings["disturbance"] is not None
        or "filter_time_constant_s" in findings
        or not control.inverse.is_exact
        or any(control.q0_error)
    )
    if explained:
        return None
    span = float(np.ptp(path.displacement, axis=0).max())
    return inaccuracy(findings["max_position_error_m"], span, what, "m", finer(settings))


def _greatest(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())


def torque_error(
    robot: Robot, run: Run, gravity: float, disturbance: Disturbance = UNDISTURBED
) -> float:
    """Greatest difference between the recorded torques and Drake's inverse dynamics.

    Inverse dynamics is evaluated on a plant of its own, at the recorded positions, velocities
    and accelerations; what a push does at the joints is taken off.

    Parameters
    ----------
    gravity : float
        [m/s^2].
    disturbance : Disturbance
        With the push, or without.

    Returns
    -------
    float
        [N*m] or [N].
    """
    plant = build_plant(robot, gravity=gravity)
    context = plant.CreateDefaultContext()
    forces = MultibodyForces(plant)
    joints = [run.scopes[f"joint {name}"] for name in ("positions", "velocities", "accelerations")]
    exact = np.empty_like(joints[0])
    for row, (q, qdot, qddot) in enumerate(zip(*joints, strict=True)):
        plant.SetPositions(context, q)
        plant.SetVelocities(context, qdot)
        plant.CalcForceElementsContribution(context, forces)
        exact[row] = plant.CalcInverseDynamics(context, qddot, forces)
    for index, segment in enumerate(robot.moving):
        exact[:, index] -= limit_force(segment.mechanics, joints[0][:, index], joints[1][:, index])
    exact -= push_torques(robot, run, disturbance)
    return float(np.abs(run.scopes["joint torques"] - exact).max())


def exact_tip(start: Array, path: CommandedMotion, angles: Array | None) -> Mapping[str, Array]:
    """Name the exact values of the columns of a tip's run.

    Parameters
    ----------
    start : (3,) ndarray
        [m].
    path : CommandedMotion
        Exact motion from there.
    angles : (rows, 3) ndarray or None
        Exact joint angles [rad], where they are known.

    Returns
    -------
    dict
        Column name, without unit, to exact values.
    """
    exact = lettered("", "xyz", "", start + path.displacement)
    exact |= lettered("v", "xyz", "", path.velocity)
    if angles is not None:
        exact |= {f"q{i + 1}": angles[:, i] for i in range(3)}
    return exact
