"""Simulates joints that follow their motion exactly: the kinematic loop, then their torques.

Nothing disturbs such joints, so that their plant need not be integrated a second time: what it
takes to move them is Drake's inverse dynamics at each row of the recording.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from pydrake.systems.framework import Context, Diagram

from drake_leg.diagrams import kinematic_loop
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.kinematic_loop import SCOPE, equation_of
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import JointLimitError, SingularConfigurationError
from drake_leg.kinematics.euler import quaternions
from drake_leg.kinematics.khalil import Array, foot_pose_and_jacobian
from drake_leg.kinematics.loop import KinematicEquation
from drake_leg.progress import held
from drake_leg.robot.robot import Robot
from drake_leg.simulation.all_steps import all_steps_of
from drake_leg.simulation.guard import NEARLY_SINGULAR
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import INTERRUPTED, Progress, Run, Scopes, simulate
from drake_leg.simulation.torques import torques_along
from drake_leg.singularity.inverse import Damped
from drake_leg.singularity.look_ahead import NEAR_APPROACH
from drake_leg.units import beyond

Config = HexabotLegConfig | ScaraConfig

ACCURATE = 2e-9  # of the arm's length: a foot that is nearer than this to its command follows it


@dataclass(frozen=True, kw_only=True)
class Stepping:
    """How a motion's run is stepped, and whether it needs a guard."""

    settings: Sequence[IntegratorSettings]  # to try until one is accurate; the last one at least
    is_clear: bool  # no singularity is foreseen
    progress: Progress | None = None


def follow(
    config: Config, duration: float, stepping: Stepping, *, torques: bool = True
) -> tuple[Run, IntegratorSettings]:
    """Simulate the joints of a configuration's motion, which nothing disturbs.

    Where the motion is clear, steps are constant, and the run is checked at its end; if the foot is
    not where it should be, it is repeated with a guard.

    Parameters
    ----------
    config : HexabotLegConfig, EllipseConfig or ScaraConfig
        Robot, posture and motion.
    duration : float
        Simulated time [s].
    stepping : Stepping
        Of the kinematic loop.
    torques : bool
        Whether to compute the joints' torques, for which the links must have masses.

    Returns
    -------
    Run, IntegratorSettings
        With the scopes of the leg's diagram; and the settings that were taken.

    Raises
    ------
    JointLimitError, SingularConfigurationError
        If a joint is outside its limits at the start, or the robot is singular there.
    InvalidValueError
        If the run would take more steps than it may, or torques are asked for and a joint has no
        actuator.
    """
    began = clock.perf_counter()
    run, taken = _joints_of(config, duration, stepping)

    def complete() -> Run:
        ended = within_limits(config.robot, run)
        if torques:
            ended.scopes["joint torques"] = torques_along(config.robot, config.gravity, ended)
        return ended

    run = to_its_end(complete)
    return replace(run, wall_time=clock.perf_counter() - began), taken


def to_its_end(compute: Callable[[], Run]) -> Run:
    """Compute what belongs to a recording; an interrupt waits, and is then noted in the run."""
    run = None
    try:
        with held():
            run = compute()
    except KeyboardInterrupt:
        if run is None:  # nothing holds interrupts back, as in a notebook
            raise
        return replace(run, stopped_at=float(run.time[-1]), stop_reason=INTERRUPTED)
    return run


def follow_below_limit(
    config: Config, duration: float, stepping: Stepping
) -> tuple[Run, IntegratorSettings] | None:
    """Follow the motion if a torque limit, the only disturbance, is never reached; else None."""
    disturbance = config.disturbance
    if disturbance.torque_limit is None or replace(disturbance, torque_limit=None) != UNDISTURBED:
        return None
    if not config.robot.is_actuated:
        return None
    run, taken = follow(config, duration, stepping)
    if run.stop_reason == INTERRUPTED:
        return _as_if_disturbed(run), taken
    size = np.abs(run.scopes["joint torques"])
    between = np.abs(np.diff(size, axis=0)).max(initial=0.0)  # rows, a torque may be this greater
    if run.stop_reason or not size.max() + between < disturbance.torque_limit:
        return None
    return _as_if_disturbed(run), taken


def _as_if_disturbed(run: Run) -> Run:
    """Add the scopes of a disturbed diagram, in which nothing acts."""
    run.scopes["torques asked for"] = run.scopes["joint torques"]
    run.scopes["prescribed positions"] = run.scopes["joint positions"]
    return run


def simulate_plant(
    config: Config, diagram: Diagram, duration: float, stepping: Stepping
) -> tuple[Run, IntegratorSettings]:
    """Simulate the diagram of a configuration with its plant, whose joints may be disturbed.

    Where the motion is clear, it is tried without a guard, as in ``follow``.
    """
    began = clock.perf_counter()
    run, taken = _plant_of(config, diagram, duration, stepping)
    return replace(run, wall_time=clock.perf_counter() - began), taken


def _plant_of(
    config: Config, diagram: Diagram, duration: float, stepping: Stepping
) -> tuple[Run, IntegratorSettings]:
    equation, progress, last = equation_of(config), stepping.progress, stepping.settings[-1]
    disturbance = config.disturbance
    away = disturbance.longest_step if disturbance.push else None
    for trial in _trials_of_plant(disturbance, stepping):
        run = simulate(
            diagram,
            duration,
            settings=trial,
            longest_step=away,
            progress=progress,
            guarded=False,
        )
        if run.stop_reason == INTERRUPTED:
            return run, trial
        if _is_smooth(run) if disturbance.acts else _is_accurate(config, equation, run):
            return run, trial
    done = simulate(diagram, duration, settings=last, longest_step=away, progress=progress)
    return done, last


def _trials_of_plant(disturbance: Disturbance, stepping: Stepping) -> Sequence[IntegratorSettings]:
    """Settings to try without a guard; weak joints may go anywhere, and need one."""
    if disturbance.torque_limit is not None:
        return ()
    return _trials(stepping)[-1:] if disturbance.acts else _trials(stepping)


def _is_smooth(run: Run) -> bool:
    """Whether the determinant changed so little in each step that no guard would shorten it."""
    det_j = run.scopes["singularity check"][:, 0]
    if run.stop_reason or not (det_j * det_j[0] > 0.0).all():
        return False
    return bool((np.abs(np.diff(det_j)) <= NEAR_APPROACH * np.abs(det_j[:-1])).all())


def _trials(stepping: Stepping) -> Sequence[IntegratorSettings]:
    """Settings to try without a guard."""
    return stepping.settings if stepping.is_clear else ()


def _joints_of(
    config: Config, duration: float, stepping: Stepping
) -> tuple[Run, IntegratorSettings]:
    """Simulate the loop: without a guard where that is as accurate, else with one."""
    equation, progress = equation_of(config), stepping.progress
    exact = replace(equation, robot=config.movable, top_speed=math.inf)
    for trial in _trials(stepping) if _can_be_exact(config, equation) else ():
        joints = _unguarded(config, exact, duration, trial, progress)
        if joints.stop_reason not in (None, INTERRUPTED):
            continue
        run = to_its_end(partial(_with_scopes, config, exact, joints))
        if run.stop_reason == INTERRUPTED or _is_accurate(config, equation, run):
            return run, trial
    last, loop = stepping.settings[-1], kinematic_loop.build(config)
    joints = simulate(loop, duration, settings=last, progress=progress)
    return to_its_end(partial(_with_scopes, config, equation, joints)), last


def _can_be_exact(config: Config, equation: KinematicEquation) -> bool:
    """Whether it is worth a trial with the exact inverse.

    Behind filters it cannot be told afterwards where an inexact one would have acted.
    """
    if equation.time_constant is not None and not equation.robot.is_exact:
        return False
    return _starts_regular(config)


def _starts_regular(config: Config) -> bool:
    """Whether the exact inverse exists at the start."""
    moved = config.movable
    try:
        moved.rates(config.start, [0.0] * moved.size)
    except SingularConfigurationError:
        return False
    return True


def _unguarded(
    config: Config,
    exact: KinematicEquation,
    duration: float,
    settings: IntegratorSettings,
    progress: Progress | None,
) -> Run:
    """Simulate the loop with the exact inverse, at constant steps."""
    found = all_steps_of(exact, config.start, duration, settings, progress)
    if found is not None:
        return found

    def start(_: Diagram, context: Context) -> None:
        context.SetContinuousState(exact.start(config.start))

    loop = kinematic_loop.unguarded(exact, config.start)
    return simulate(
        loop, duration, start=start, settings=settings, progress=progress, guarded=False
    )


def _is_accurate(config: Config, equation: KinematicEquation, run: Run) -> bool:
    """Whether a run with the exact inverse is what a guarded run would be.

    The foot is where its command puts it, the Jacobian stays regular, and neither a damping nor a
    limit would have acted.
    """
    det_j = run.scopes["singularity check"][:, 0]
    if run.stop_reason or not (det_j * det_j[0] > 0.0).all():
        return False
    if equation.time_constant is not None:
        least = NEARLY_SINGULAR * config.movable.determinant_scale
        return bool(np.abs(det_j).min() > least)
    off = np.linalg.norm(run.scopes["foot positions"] - _feet(config, run.time), axis=1)
    if not off.max() <= ACCURATE * config.movable.length:
        return False
    return equation.robot.is_exact or _stays_exact(config, equation, run)


def _feet(config: Config, time: Array) -> Array:
    """Where the command puts the foot, (rows, 3) [m]: an error of the start decays."""
    start = config.movable.foot(config.q0)
    off = config.movable.foot(config.start) - start
    decay = np.exp(-config.control.correction * time)
    feet: Array = start + config.motion.displacement(time) + np.multiply.outer(decay, off)
    return feet


def _stays_exact(config: Config, equation: KinematicEquation, run: Run) -> bool:
    """Whether an inexact inverse is exact along a run, and the command below its top speed."""
    damped = equation.robot
    if not isinstance(damped, Damped):
        return False
    moved, n = config.movable, config.movable.joints
    q, qdot = (run.scopes[f"joint {name}"][:, :n] for name in ("positions", "velocities"))
    speed = np.linalg.norm(run.scopes["foot velocities"], axis=1)
    return bool(speed.max() < equation.top_speed) and damped.is_exact_along(
        q, qdot, moved.sigma_mins(q)
    )


def _with_scopes(config: Config, equation: KinematicEquation, run: Run) -> Run:
    """Compute what the scopes of the whole diagram show from the motion of the joints."""
    moved, det_j = _joint_motion(equation, run.time, run.scopes[SCOPE])
    return replace(run, scopes=scopes_of(config, run.time, _with_rest(config, moved), det_j))


def scopes_of(
    config: Config, time: Array, joints: tuple[Array, ...], determinants: Array
) -> Scopes:
    """Compute what the scopes of a diagram show besides torques.

    ``joints`` are positions, velocities and accelerations (rows, n), ``determinants`` (rows, 1).
    """
    rows, motion = config.robot.rows, config.motion
    q, qdot, qddot = joints
    X_BF, J = foot_pose_and_jacobian(rows, q)
    V_BF = np.einsum("rij,rj->ri", J, qdot)
    gain = config.gain if isinstance(config, HexabotLegConfig) else 1.0
    return Scopes(
        {
            "input": motion.amplitude / gain * np.sin(motion.frequency * time)[:, np.newaxis],
            "foot positions": X_BF[:, :3, 3],
            "foot velocities": V_BF[:, 3:],
            "Q": quaternions(X_BF[:, :3, :3]),
            "foot angular velocities": V_BF[:, :3],
            "joint positions": q,
            "joint velocities": qdot,
            "joint accelerations": qddot,
            "commanded velocities": motion.velocity(time),
            "singularity check": determinants,
        }
    )


def _joint_motion(
    equation: KinematicEquation, time: Array, states: Array
) -> tuple[tuple[Array, ...], Array]:
    """Positions, velocities and accelerations (rows, n), and determinants (rows, 1)."""
    robot = equation.robot
    found = equation.motion_formula(time, states.T, (np.cos, np.sin))
    if found is not None:
        moved = tuple(np.array(part).T for part in found)
        fed_back = np.array(equation.fed_back(states.T)).T
        return moved, robot.determinants(fed_back)[:, np.newaxis]
    parts, determinants = [], []
    for t, state in zip(time.tolist(), states.tolist(), strict=True):  # in one posture at a time
        parts.append(equation.joint_motion(t, state))
        determinants.append([robot.determinant(equation.fed_back(state))])
    return tuple(np.array(part) for part in zip(*parts, strict=True)), np.array(determinants)


def _with_rest(config: Config, moved: tuple[Array, ...]) -> tuple[Array, ...]:
    """Add the joint that rests, if there is one: a SCARA's lift."""
    if not isinstance(config, ScaraConfig):
        return moved
    rows = len(moved[0])
    resting = (config.lift, 0.0, 0.0)
    return tuple(
        np.column_stack([part, np.full(rows, at)]) for part, at in zip(moved, resting, strict=True)
    )


def within_limits(robot: Robot, run: Run) -> Run:
    """End a run at the first row in which a joint is outside its limits."""
    q = run.scopes["joint positions"]
    last, joint = len(q), 0
    for index, segment in enumerate(robot.moving):
        low, high = segment.mechanics.hard_bounds
        if math.isinf(low) and math.isinf(high):
            continue
        within = [beyond(at, low, high) == 0.0 for at in q[:last, index].tolist()]
        if not all(within):
            last, joint = within.index(False), index
    if last == len(q):
        return run
    segment, time = robot.moving[joint], float(run.time[last])
    error = JointLimitError(
        joint=str(segment.joint),
        position=float(q[last, joint]),
        limits=segment.mechanics.hard_bounds,
        time=time,
        slides=segment.row.joint == "prismatic",
        advice="choose another posture or a smaller amplitude",
    )
    if last == 0:
        raise error
    return replace(
        run,
        time=run.time[: last + 1],
        scopes=Scopes({name: values[: last + 1] for name, values in run.scopes.items()}),
        stopped_at=time,
        stop_reason=str(error),
        stopped_by=error,
    )
