"""The run of a robot with closed loops: its active joints swing, or it is released from rest."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams.closed_loop import TORQUES, ClosedLoopConfig, build
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot, Segment
from drake_leg.runs.options import LoopOptions
from drake_leg.runs.outcome import Outcome, finer, outcome_of, shows
from drake_leg.runs.step import STEPS_PER_PERIOD, joint_values
from drake_leg.simulation.integrator import ERROR_CONTROLLED as CONTROLLED
from drake_leg.simulation.integrator import ROW_INTERVAL, IntegratorSettings
from drake_leg.simulation.recording import Recording, numbered
from drake_leg.simulation.run import Progress, Run, Start, simulate
from drake_leg.singularity.diagnosis import Outside
from drake_leg.systems.closed_loop import TreeDynamics

STEP_OF_FALL = 0.005  # [s]
ACCURACY_OF_FALL = 1e-8  # of a released robot, which may pass singular assemblies at speed


def run(robot: Robot, options: LoopOptions, progress: Progress | None = None) -> Outcome:
    """Simulate a robot with closed loops.

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the loops do not close.
    SingularConfigurationError
        If the active joints do not determine the posture where it starts.
    """
    config = config_of(robot, options)
    longest = STEP_OF_FALL
    if config.amplitude is not None:
        longest = min(ROW_INTERVAL, 2.0 * np.pi / (STEPS_PER_PERIOD * config.frequency))
    settings = options.integrator_settings(longest)
    if config.amplitude is None and settings.accuracy is None and settings.scheme in CONTROLLED:
        settings = replace(settings, accuracy=ACCURACY_OF_FALL)
    done = simulate(build(config), duration=options.duration, settings=settings, progress=progress)
    recording = Recording(_columns(config, done))
    return outcome_of(
        robot,
        done,
        settings,
        options.duration,
        recording,
        {},
        _findings(config, done, settings),
        "loops",
    )


def diagram(robot: Robot, options: LoopOptions) -> tuple[Diagram, Start]:
    """Build the diagram of a run; return it with its start."""
    return build(config_of(robot, options)), start_on_motion


def config_of(robot: Robot, options: LoopOptions) -> ClosedLoopConfig:
    """Return the config of a run's diagram; an option that makes no sense is refused."""
    active = [segment for segment in robot.moving if segment.mechanics.actuated]
    q0 = None
    if options.q0 is not None and len(options.q0) == len(robot.moving):
        q0 = tuple(joint_values("q0", options.q0, robot.moving))
    elif options.q0 is not None:
        given = dict(zip(_names(active), joint_values("q0", options.q0, active), strict=True))
        start = zip(_names(robot.moving), starting_posture(robot), strict=True)
        q0 = tuple(given.get(name, value) for name, value in start)
    swing = options.swing
    if swing is None and options.frequency is not None:
        raise InvalidValueError(
            "a frequency means nothing without a motion", advice="give `swing`, too"
        )
    return ClosedLoopConfig(
        robot=robot,
        q0=q0,
        amplitude=None if swing is None else tuple(joint_values("swing", swing, active)),
        frequency=1.0 if options.frequency is None else options.frequency,
        gravity=options.gravity,
    )


def _names(joints: tuple[Segment, ...] | list[Segment]) -> list[str]:
    return [str(segment.joint) for segment in joints]


def _columns(config: ClosedLoopConfig, done: Run) -> dict[str, Array]:
    robot, loops = config.robot, config.loops
    turning = [segment.row.joint == "revolute" for segment in robot.moving]
    lengths = ["rad" if turns else "m" for turns in turning]
    columns = {"time[s]": done.time}
    for name, scope, per in (
        ("q", "joint positions", ""),
        ("qdot", "joint velocities", "/s"),
        ("qddot", "joint accelerations", "/s^2"),
    ):
        columns |= numbered(name, [f"{unit}{per}" for unit in lengths], done.scopes[scope])
    for loop, position in zip(robot.loops, done.scopes["cut joints"].T, strict=True):
        turns = robot.segments[loop.cut - 1].row.joint == "revolute"
        columns[f"{loop.joint}[{'rad' if turns else 'm'}]"] = position
    if config.amplitude is not None:
        for index, column in enumerate(loops.active_columns):
            unit = "N*m" if turning[column] else "N"
            columns[f"tau{column + 1}[{unit}]"] = done.scopes[TORQUES][:, index]
    q = done.scopes["joint positions"]
    columns["sigma_min"] = np.array([loops.sigma_min(posture) for posture in q])  # of J_p
    columns["energy[J]"] = done.scopes["energy"][:, 0]
    columns["closure[m]"] = done.scopes["closure"][:, 0]
    return columns


def _findings(config: ClosedLoopConfig, done: Run, settings: IntegratorSettings) -> dict[str, Any]:
    energy, q = done.scopes["energy"][:, 0], done.scopes["joint positions"]
    lost = np.abs(energy - energy[0] - _work(config, done)).max()
    damped = any(segment.mechanics.damping for segment in config.robot.moving)
    return {
        "active": list(config.loops.active),
        "passive": list(config.loops.passive),
        "cut": list(config.loops.cuts),
        "dynamics": "released" if config.amplitude is None else "driven",
        "max_closure_m": float(done.scopes["closure"].max()),
        "energy_error_j": None if damped else float(lost),
        "energy_range_j": float(np.ptp(energy)),
        "inaccuracy": None if damped else _change_of_energy(config, done, settings, float(lost)),
        "limits_exceeded": [
            Outside(segment=segment, position=farthest).sentence
            for segment, positions in zip(config.robot.moving, q.T, strict=True)
            for farthest in (float(positions.min()), float(positions.max()))
            if not segment.mechanics.bounds[0] <= farthest <= segment.mechanics.bounds[1]
        ],
    }


def _change_of_energy(
    config: ClosedLoopConfig, done: Run, settings: IntegratorSettings, lost: float
) -> str | None:
    """Explain that a released robot has another energy than at its start; None if it has not."""
    if config.amplitude is not None:
        return None
    tree = TreeDynamics(build_plant(config.robot, gravity=config.gravity), config.loops.joints)
    greatest = 0.0
    rates = done.scopes["joint velocities"]
    for q, qdot in zip(done.scopes["joint positions"], rates, strict=True):
        tree.set(q, qdot)
        greatest = max(greatest, float(qdot @ tree.mass_matrix() @ qdot) / 2.0)
    if not shows(lost, greatest):
        return None
    return (
        f"the energy has changed by up to {lost:.2g} J, and the motion has up to {greatest:.3g} J: "
        f"what was recorded is another motion; {finer(settings)}"
    )


def _work(config: ClosedLoopConfig, done: Run) -> Array:
    """Work of the active joints since the start, at every row [J]."""
    if config.amplitude is None:
        return np.zeros(len(done.time))
    from scipy.integrate import cumulative_simpson  # slow to load

    rates = done.scopes["joint velocities"][:, config.loops.active_columns]
    power = (done.scopes[TORQUES] * rates).sum(axis=1)
    work: Array = cumulative_simpson(power, x=done.time, initial=0)
    return work
