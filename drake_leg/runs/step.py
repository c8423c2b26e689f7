"""The runs in which a foot or a tool follows a motion: legs, any other robot, ellipse, SCARA."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams import ellipse, hexabot_leg, scara
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.diagrams.ellipse import EllipseConfig
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.chain import geometry_of, movable
from drake_leg.kinematics.euler import rotation_matrices
from drake_leg.kinematics.khalil import Array, foot_pose
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.leg import inverse_kinematics as inverse_of_leg
from drake_leg.kinematics.motions import Push, SineStep
from drake_leg.kinematics.movable import SINGULAR_BELOW, Movable, smallest_singular_value
from drake_leg.kinematics.scara import inverse_kinematics as inverse_of_scara
from drake_leg.kinematics.scara import task_jacobian, tool_position
from drake_leg.robot.joint_mechanics import initial_state, starting_posture
from drake_leg.robot.robot import Robot, Segment
from drake_leg.runs.foresight import foresee, require_passable, singularity_findings
from drake_leg.runs.options import (
    FORWARD,
    INVERSE,
    NONE,
    EllipseOptions,
    ScaraOptions,
    StepOptions,
    StraightOptions,
)
from drake_leg.runs.outcome import Outcome, outcome_of
from drake_leg.runs.peaks import peak_findings
from drake_leg.runs.tip import (
    control_findings,
    exact_tip,
    exceeded_limits,
    tip_columns,
    tip_findings,
    tip_inaccuracy,
    torque_error,
)
from drake_leg.simulation.following import Stepping, follow, follow_below_limit, simulate_plant
from drake_leg.simulation.integrator import ROW_INTERVAL, IntegratorSettings
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import Progress, Run, Start
from drake_leg.singularity.inverse import Inverse
from drake_leg.singularity.stroke import first_direction
from drake_leg.units import joint_entries

CORRECTION = 5.0  # [1/s], of a damped or limited inverse where none is asked for
PUSH_AT, PUSH_FOR = 2.0, 0.1  # [s]

STEPS_PER_PERIOD = 150
TRIALS = (30, 60)  # steps per period, tried where the foot's error can be measured
STEP_OF_LIMITED_RATES = 0.010  # [s], longest step where rates may meet their limits in kinks
STEP_OF_LIMITED_TORQUES = 0.005  # [s], the same of torques
STEP_OF_CORRECTION = 0.5  # greatest step times the correction's gain
STEP_OF_PULL = 1.0  # greatest step times the square root of the motion's stiffness
STEP_OF_ERROR = 0.25  # the same where a mass error keeps the joints off their motion
STEP_OF_FILTER = 1.5  # greatest step over the filters' time constant; 2 is unstable with Euler
TRANSIENT = 0.095  # [s^(1/3)] times the constant to the 2/3: resolves how the filters start

TipOptions = StraightOptions | EllipseOptions | ScaraOptions
Config = HexabotLegConfig | EllipseConfig | ScaraConfig

BUILD: dict[type[Config], Callable[[Any], Diagram]] = {
    HexabotLegConfig: hexabot_leg.build,
    EllipseConfig: ellipse.build,
    ScaraConfig: scara.build,
}


# --- a run -----------------------------------------------------------------------------------


def run(robot: Robot, options: TipOptions, progress: Progress | None = None) -> Outcome:
    """Make a robot's foot or tool follow the motion of the options.

    ``progress`` is called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If an option makes no sense, or the foot cannot go that way.
    SingularConfigurationError
        If the robot is singular where it starts, or will be and its inverse is exact.
    """
    options.refuse_ignored()
    config = config_of(robot, options)
    if options.q0 is None:
        require_regular_start(config)
    control, disturbance, motion = config.control, config.disturbance, config.motion
    lag = _filters(config)
    moved, q0, name = config.movable, config.q0, robot.title
    forecast = foresee(moved, motion, control, q0, options.duration, lagging=lag is not None)
    require_passable(name, moved, control, q0, None if options.force else forecast)
    stepping = Stepping(
        settings=_settings(options, config),
        is_clear=forecast.encounter is None and forecast.graze is None,
        progress=None if progress is None else _rising(progress),
    )
    dynamics, done, settings = _simulated(config, options, stepping)
    met = singularity_findings(moved, done, forecast, name, disturbed=disturbance.acts)
    columns, exact, findings = _compared(config, done, dynamics)
    what: Literal["foot", "tool"] = "tool" if isinstance(config, ScaraConfig) else "foot"
    findings["inaccuracy"] = tip_inaccuracy(findings, done, motion, control, settings, what)
    findings |= {"dynamics": dynamics} | met
    if type(config) is HexabotLegConfig:
        findings["limits_exceeded"] = exceeded_limits(robot, done)
    return outcome_of(
        robot, done, settings, options.duration, Recording(columns), exact, findings, what
    )


def _simulated(
    config: Config, options: TipOptions, stepping: Stepping
) -> tuple[str, Run, IntegratorSettings]:
    """Simulate by the dynamics of the options; return them, and the settings that were taken."""
    dynamics, duration = options.chosen_dynamics(), options.duration
    if dynamics != FORWARD:
        return dynamics, *follow(config, duration, stepping, torques=dynamics == INVERSE)
    if options.dynamics is None and stepping.is_clear:
        followed = follow_below_limit(config, duration, stepping)
        if followed:
            return INVERSE, *followed
        if config.disturbance.acts and not _has_own_steps(options):
            from drake_leg.simulation.disturbed import follow_disturbed  # slow to load

            disturbed = follow_disturbed(config, duration, stepping.progress)
            if disturbed:
                return FORWARD, *disturbed
    diagram = BUILD[type(config)](config)
    return FORWARD, *simulate_plant(config, diagram, duration, stepping)


def diagram(robot: Robot, options: TipOptions) -> tuple[Diagram, Start]:
    """Build the diagram of a run, with its plant; return it with its start."""
    config = config_of(robot, options)
    return BUILD[type(config)](config), start_on_motion


def _rising(progress: Progress) -> Progress:
    """Report a simulated time only when it is later than all before, though runs are repeated."""
    latest = 0.0

    def tell(time: float) -> None:
        nonlocal latest
        if time > latest:
            latest = time
            progress(time)

    return tell


def _settings(options: TipOptions, config: Config) -> list[IntegratorSettings]:
    """Return the integrator's settings to try, one after the other, until one is accurate.

    The last one needs no trial. Only steps that the motion alone bounds may be longer.
    """
    known = (config.motion, config.control, config.disturbance, _filters(config))
    is_measured = _filters(config) is None  # a lag hides the foot's error
    if _has_own_steps(options) or not is_measured:
        return [options.integrator_settings(longest_step(*known))]
    steps = [longest_step(*known, per_period=count) for count in (*TRIALS, STEPS_PER_PERIOD)]
    return [options.integrator_settings(step) for step in sorted(set(steps), reverse=True)]


def _has_own_steps(options: TipOptions) -> bool:
    """Whether the options say how time is stepped."""
    is_chosen = options.integrator != IntegratorSettings().scheme or options.accuracy is not None
    return is_chosen or options.max_step is not None


def longest_step(
    motion: SineStep,
    control: Control,
    disturbance: Disturbance,
    lag: float | None = None,
    *,
    per_period: int = STEPS_PER_PERIOD,
) -> float:
    """Choose the longest step [s] that resolves all that is fast in a run: at most 40 ms.

    ``lag`` is the time constant of the joints' input filters [s].
    """
    steps = [ROW_INTERVAL, 2.0 * math.pi / (per_period * motion.frequency)]
    if control.inverse.method == "limited":
        steps.append(STEP_OF_LIMITED_RATES)
    if control.correction > 0.0:
        steps.append(STEP_OF_CORRECTION / control.correction)
    if disturbance.torque_limit is not None:
        steps.append(STEP_OF_LIMITED_TORQUES)
    if disturbance.pull > 0.0:
        part = STEP_OF_ERROR if disturbance.mass_error else STEP_OF_PULL
        steps.append(part / math.sqrt(disturbance.pull))
    if lag is not None:
        steps.append(min(STEP_OF_FILTER * lag, TRANSIENT * lag ** (2.0 / 3.0)))
    return min(steps)


def _filters(config: Config) -> float | None:
    """Time constant of the joints' input filters [s], if there are any."""
    return None if isinstance(config, ScaraConfig) else config.filter_time_constant


# --- from the options to the diagram's config ------------------------------------------------


def config_of(robot: Robot, options: TipOptions) -> Config:
    """Return the config of a run's diagram; an option that makes no sense is refused."""
    followed: dict[str, Any] = {
        "robot": robot,
        "gravity": options.gravity,
        "disturbance": disturbance_of(options),
    }
    if isinstance(options, ScaraOptions):
        return ScaraConfig(
            q0=options.posture(),
            R=options.tool_height,
            motion=options.motion(),
            control=control_of(options, robot.moving[:3]),
            **followed,
        )
    followed["control"] = control_of(options, robot.moving)
    if isinstance(options, EllipseOptions):
        return EllipseConfig(
            q0=options.posture(),
            motion=options.motion(),
            filter_time_constant=options.filter_time_constant,
            **followed,
        )
    return _straight(robot, options, followed)


def _straight(robot: Robot, options: StraightOptions, followed: dict[str, Any]) -> HexabotLegConfig:
    """Return the config of the straight step of any robot."""
    if options.chosen_dynamics() != NONE:
        _require_mass(robot)
    if options.q0 is None:
        q0 = starting_posture(robot)
    else:
        q0 = tuple(joint_values("q0", options.q0, robot.moving))
    joints = (str(segment.joint) for segment in robot.moving)
    initial_state(robot, {joint: (q, 0.0) for joint, q in zip(joints, q0, strict=True)})
    direction = None
    if options.direction is None:
        direction = first_direction(robot, movable(robot, q0, options.task), q0)
    return HexabotLegConfig(
        q0=q0,
        task=options.task,
        motion=options.motion(direction),
        gain=options.gain,
        filter_time_constant=options.filter_time_constant,
        feedback=options.feedback,
        **followed,
    )


def control_of(options: StepOptions, joints: Sequence[Segment]) -> Control:
    """Return how the joints follow their command: inverse, correction, error of the start."""
    rate = options.rate_limit
    if rate is not None and all(joint.row.joint == "prismatic" for joint in joints):
        raise InvalidValueError(
            "the rate limit is for joints that turn, and none of these does", advice="leave it out"
        )
    inverse = Inverse(
        method=options.inverse,
        damped_below=options.damped_below,
        rate_limit=None if rate is None else math.radians(rate),
    )
    correction = options.correction
    if correction is None:
        correction = 0.0 if inverse.is_exact else CORRECTION
    error = [0.0] * len(joints) if options.q0_error is None else options.q0_error
    return Control(
        inverse=inverse,
        correction=correction,
        q0_error=tuple(joint_values("q0_error", error, joints)),
    )


def disturbance_of(options: StepOptions) -> Disturbance:
    """Return the disturbance of a run."""
    return Disturbance(
        push=_push(options),
        mass_error=options.mass_error,
        torque_limit=options.torque_limit,
        stiffness=options.stiffness,
    )


def _push(options: StepOptions) -> Push | None:
    if options.push is None:
        for name in ("push_at", "push_for"):
            value = getattr(options, name)
            if value is not None:
                raise InvalidValueError(
                    f"{name} is {value!r} and there is no push",
                    advice="give its force, as `push=[0, 0, 0.1]`",
                )
        return None
    x, y, z = options.push
    push = Push(
        force=(x, y, z),
        at=PUSH_AT if options.push_at is None else options.push_at,
        lasting=PUSH_FOR if options.push_for is None else options.push_for,
    )
    if push.at >= options.duration:
        raise InvalidValueError(
            f"the push begins at {push.at:g} s, and the run is over at {options.duration:g} s",
            advice="choose an earlier `push_at` or a longer `duration`",
        )
    return push


def joint_values(name: str, values: Sequence[float], joints: Sequence[Segment]) -> list[float]:
    """Convert values in degrees for joints that turn, in m for joints that slide, to rad and m."""
    if len(values) != len(joints):
        raise InvalidValueError(
            f"{name} is {list(values)}; it must be {len(joints)} finite numbers, one for each "
            "joint: degrees where it turns, m where it slides"
        )
    return [
        math.radians(value) if joint.row.joint == "revolute" else value
        for value, joint in zip(values, joints, strict=True)
    ]


def require_regular_start(config: Config) -> None:
    """Refuse a default start that is singular: the exact inverse cannot leave it."""
    sigma_min = config.movable.sigma_min(config.q0)
    if config.control.inverse.is_exact and sigma_min < SINGULAR_BELOW * config.movable.length:
        raise SingularConfigurationError(
            q=config.q0,
            sigma_min=sigma_min,
            problem=f"{config.robot.name} is singular in its default start posture",
            advice="choose one with `q0`",
        )


def _require_mass(robot: Robot) -> None:
    """Require a mass beyond every joint: without one its motion has no equation."""
    mass_beyond = False
    for segment in reversed(robot.segments):
        link = segment.link
        mass_beyond |= link is not None and link.has_mass
        if segment.row.joint != "fixed" and not mass_beyond:
            raise InvalidValueError(
                f"{robot.name}: nothing beyond joint {segment.joint} has a mass",
                advice="give its row, or one after it, a [row.solid] or a [row.inertial], or in a "
                ".par file numbers for XX ... M",
            )


# --- the comparison with the exact motion ----------------------------------------------------


class _View(NamedTuple):
    """What only one kind of run has to compare, in addition to what all have."""

    start: Array  # (3,) [m], of the foot or tool
    q: Array | None  # (rows, 3) [rad], exact; None where there is no closed form
    sigma_min: Array  # (rows,) [m]
    determinant: tuple[str, str]  # name and unit
    command: tuple[str, str, str]  # headers of the commanded velocities
    columns: dict[str, Array]
    exact: dict[str, Array]
    task: dict[str, Any]  # entries of the summary: what was commanded
    errors: dict[str, Any]
    others: dict[str, Any]


def _compared(
    config: Config, run: Run, dynamics: str
) -> tuple[dict[str, Array], dict[str, Array], dict[str, Any]]:
    """Compare the tip's motion with its command: columns, exact columns, entries of the summary."""
    robot, motion, disturbance = config.robot, config.motion, config.disturbance
    view = _of_scara(config, run) if isinstance(config, ScaraConfig) else _of_foot(config, run)
    det_j = run.scopes["singularity check"][:, 0]
    name, unit = view.determinant
    columns = tip_columns(robot, run, view.command) | view.columns
    columns |= {f"{name}[{unit}]" if unit else name: det_j, "sigma_min[m]": view.sigma_min}
    suffix = f"_{unit}".replace("^", "").rstrip("_")
    moving = robot.moving[: len(config.q0)]
    findings = {
        **joint_entries("q0", config.q0, [s.row.joint == "prismatic" for s in moving]),
        **({"tip": list(robot.tips)[-1]} if len(robot.tips) > 1 else {}),
        **view.task,
        **control_findings(config.control, robot),
        **tip_findings(run, view.start, motion, disturbance),
        **view.errors,
        "max_torque_error_n_m": torque_error(robot, run, config.gravity, disturbance, dynamics),
        "sigma_min_m": float(view.sigma_min.min()),
        f"{name}_min{suffix}": float(det_j.min()),
        f"{name}_max{suffix}": float(det_j.max()),
        **peak_findings(robot, run, config.gravity),
        **view.others,
    }
    return columns, exact_tip(view.start, motion, run.time, view.q) | view.exact, findings


def _of_foot(config: HexabotLegConfig, run: Run) -> _View:
    robot, moved = config.robot, config.movable
    X_BF = foot_pose(robot.rows, config.q0)
    start = X_BF[:3, 3]
    feet = start + config.motion.displacement(run.time)
    geometry = geometry_of(robot)
    q = None  # there is no closed form for other robots
    if isinstance(geometry, LegGeometry):
        q = inverse_of_leg(geometry, feet, like=config.q0)
    others: dict[str, Any] = {}
    if moved.keeps_orientation:
        others["max_rotation_error_rad"] = _greatest_turn(X_BF[:3, :3], run.scopes["Q"])
    if config.filter_time_constant is not None:
        others["filter_time_constant_s"] = config.filter_time_constant
        behind = run.scopes["foot positions"][-1] - feet[-1]
        others["end_error_m"] = behind.tolist()  # caused by the filters
    return _View(
        start=start,
        q=q,
        sigma_min=moved.sigma_mins(run.scopes["joint positions"]),
        determinant=_determinant(robot, moved),
        command=("dx[m/s]", "dy[m/s]", "dz[m/s]"),
        columns={},
        exact={},
        task={
            "task": "pose" if moved.keeps_orientation else "position",
            "direction": list(config.motion.direction),
        },
        errors={},
        others=others,
    )


def _of_scara(config: ScaraConfig, run: Run) -> _View:
    geometry, q = config.geometry, run.scopes["joint positions"]
    start = tool_position(geometry, (*config.q0, config.lift))
    yaw, yaw0 = q[:, :3].sum(axis=1), sum(config.q0)
    task = start + config.motion.displacement(run.time)
    task[:, 2] = yaw0
    return _View(
        start=start,
        q=inverse_of_scara(geometry, task, like=config.q0),
        sigma_min=smallest_singular_value(task_jacobian(geometry, q[:, :3])[:, :2, :2]),
        determinant=("det_j", "m^2"),
        command=("dx[m/s]", "dy[m/s]", "dyaw[rad/s]"),
        columns={"yaw[rad]": yaw},
        exact={"yaw": np.full_like(yaw, yaw0)},
        task={},
        errors={"max_yaw_error_rad": float(np.abs(yaw - yaw0).max())},
        others={},
    )


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
