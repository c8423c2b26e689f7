"""Simulates a diagram to its end, or until it must stop.

Drake's error control has a trap: when it rejects a step it puts the old state back without
telling the caches, so that whatever depends on the state alone (a plant's kinematics) is used
stale in the repeated step. Runs with error control therefore go without caching; runs at a
given step, the default, reject nothing and keep it.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, PrismaticJoint
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import Context, Diagram, EventStatus
from pydrake.systems.primitives import VectorLogSink

from drake_leg.arguments import BUILDERS, require_callable, require_kind, shown
from drake_leg.diagrams.disturbance import is_disturbed
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import (
    DrakeLegError,
    InvalidValueError,
    JointLimitError,
    LostMotionError,
    SingularConfigurationError,
    StepBudgetError,
    UnstableRunError,
    did_you_mean,
)
from drake_leg.kinematics.khalil import Array
from drake_leg.progress import interrupts_kept
from drake_leg.robot.robot import html_table
from drake_leg.simulation.guard import Guard
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.units import beyond, require_positive

STEP_BUDGET = 2_000_000  # steps that one run may take
INTERRUPTED = "interrupted"  # why a run stopped
STEPS_PER_STAGE = 100  # of a run of constant steps, between two checks
NO_STAGES = "explicit_euler"  # for diagrams whose state is discrete: nothing is integrated
RUNAWAY = 1e9  # [rad, rad/s, m, m/s]: no joint of these robots gets there but by instability
STOPS = (
    JointLimitError,
    LostMotionError,
    SingularConfigurationError,
    StepBudgetError,
    UnstableRunError,
)

Start = Callable[[Diagram, Context], None]
Progress = Callable[[float], None]
LongestStep = Callable[[float], float]  # time -> how far the next step may go, [s]


class Scopes(dict[str, Array]):
    """What scopes recorded, (rows, size) each, by the scope's name."""

    def __missing__(self, name: object) -> Array:
        """Refuse the name of a scope that is not there.

        Raises
        ------
        InvalidValueError
            With the names of those that are.
        """
        raise InvalidValueError(
            f"there is no scope {shown(name)}; the simulation has {', '.join(self)}",
            advice=did_you_mean(name, self),
        )


@dataclass(frozen=True, kw_only=True)
class Run:
    """Result of a simulation: its time steps and scopes, and why it stopped."""

    time: Array  # [s], (rows,)
    scopes: Scopes  # by scope name, (rows, size)
    stopped_at: float | None  # [s]; None when it ran through
    stop_reason: str | None
    wall_time: float  # [s], of the simulation, without building its diagram
    stopped_by: DrakeLegError | None = None  # where one of this package's errors was the reason

    def _repr_html_(self) -> str:
        rows = []
        for name, values in self.scopes.items():
            first, last = (", ".join(f"{value:.4g}" for value in values[i]) for i in (0, -1))
            rows.append((name, values.shape[1], first, last))
        return html_table(("scope", "size", "first", "last"), rows, title=self._headline)

    def __repr__(self) -> str:
        return f"<Run: {self._headline}>"

    @property
    def _headline(self) -> str:
        """The simulation in one line."""
        stop = f"; stopped: {self.stop_reason}" if self.stop_reason else ""
        return f"Simulated {self.time[-1]:.4g} s in {len(self.time)} rows{stop}"

    @property
    def real_time_factor(self) -> float:
        """Simulated time over the wall time of the simulation."""
        return float(self.time[-1]) / self.wall_time if self.wall_time > 0.0 else math.inf


def simulate(
    diagram: Diagram,
    duration: float | None = None,
    *,
    start: Start | None = None,
    max_step: float | None = None,
    settings: IntegratorSettings | None = None,
    longest_step: LongestStep | None = None,
    progress: Progress | None = None,
    guarded: bool = True,
) -> Run:
    """Run a diagram and collect its scopes.

    A run stops early, and says why, where the inverse Jacobian becomes singular, where a joint
    leaves its limits, where the step budget is spent, where the integrator gives up, and on
    Ctrl-C; what was recorded until then is returned.

    Parameters
    ----------
    diagram : Diagram
        With per-step logs as scopes.
    duration : float
        Simulated time [s]; it must be given.
    start : callable, optional
        ``start(diagram, context)`` sets the initial state. By default the joints start on their
        prescribed motion, or, where no motion drives them, at the diagram's default state.
    max_step : float, optional
        Longest time step [s]; by default that of the settings.
    settings : IntegratorSettings, optional
        Runge-Kutta of order 5 at steps of 40 ms by default.
    longest_step : callable, optional
        Of the simulated time [s]: how far the next step may go, where that is less than the
        settings allow.
    progress : callable, optional
        Called with the simulated time [s] from time to time.
    guarded : bool
        Whether steps become shorter near a singularity, so that the run stops at it. Without a
        guard, steps are constant and quicker: for motions that are known to stay far from one.

    Returns
    -------
    Run
        Rows are the integrator's own steps.

    Raises
    ------
    InvalidValueError
        If there is no diagram with scopes, if the duration is not positive or needs more steps than
        the budget, or if Drake refuses the initial state.
    SingularConfigurationError, JointLimitError
        If the robot is singular, or outside its joint limits, at the start.

    Examples
    --------
    >>> from drake_leg import PENDULUM, PendulumConfig, build_pendulum, simulate
    >>> diagram = build_pendulum(PendulumConfig(robot=PENDULUM, q0=0.0))
    >>> result = simulate(diagram, duration=0.5)
    >>> result.stopped_at is None, result.time[-1]
    (True, np.float64(0.5))
    >>> sorted(result.scopes)
    ['acceleration', 'energy', 'q', 'w']
    """
    builder = BUILDERS.get(type(diagram).__name__)
    require_kind(
        "diagram",
        diagram,
        Diagram,
        advice=f"build it first, as {builder}(config)"
        if builder
        else "build one, as build_hexabot_leg(HexabotLegConfig()), or put it into one with "
        "Drake's DiagramBuilder",
    )
    if not any(isinstance(system, VectorLogSink) for system in diagram.GetSystems()):
        raise InvalidValueError(
            "the diagram has no scope, so that nothing would be recorded",
            advice="add one with add_scope",
        )
    require_callable("start", start)
    require_callable("longest_step", longest_step)
    require_callable("progress", progress)
    require_kind("guarded", guarded, bool)
    settings = IntegratorSettings() if settings is None else settings
    require_kind("settings", settings, IntegratorSettings)
    if max_step is not None:
        settings = replace(settings, max_step=max_step)
    if duration is None:
        raise InvalidValueError("there is no duration", advice="give it, as `duration=2.0`")
    require_steps(duration, settings)
    begin = start or start_on_motion

    def watched(diagram: Diagram, context: Context) -> _Watch:
        return _Watch(diagram, context, settings, longest_step, progress, guarded=guarded)

    done = _simulated(diagram, duration, settings, begin, watched)
    failed = done.stop_reason not in (None, INTERRUPTED) and done.stopped_by is None
    if failed or isinstance(done.stopped_by, UnstableRunError):  # at which step?
        done = _simulated(diagram, duration, settings, begin, watched, every_step=True)
    return done


def require_steps(duration: float, settings: IntegratorSettings) -> None:
    """Refuse a duration [s] that is not positive, or that takes more steps than the budget."""
    require_positive("the duration", duration, "s")
    if duration / settings.max_step > STEP_BUDGET:
        raise InvalidValueError(
            f"{duration:g} s at steps of {settings.max_step:g} s are more than the "
            f"{STEP_BUDGET} steps a run may take",
            advice="choose a shorter duration or a larger `max_step` and, where a light link's "
            "damping or a stiff spring forbids that, `integrator='radau3'`",
        )


def _simulated(
    diagram: Diagram,
    duration: float,
    settings: IntegratorSettings,
    start: Start,
    watched: Callable[[Diagram, Context], _Watch],
    *,
    every_step: bool = False,
) -> Run:
    """Simulate from the start, and check the run after every step, or from time to time."""
    simulator = _simulator(diagram, settings)
    context = simulator.get_mutable_context()
    _start(start, diagram, context)
    watch = watched(diagram, context)
    simulator.Initialize()
    stages = None
    if every_step or watch.sees_every_step:
        _watch_steps(simulator, watch)
    else:
        stages = watch.stages(duration)
    began = clock.perf_counter()
    reason, cause = _advance(simulator, watch, duration, stages)
    wall_time = clock.perf_counter() - began
    times, scopes = _read_scopes(diagram, context)
    return Run(
        time=times,
        scopes=scopes,
        stopped_at=None if reason is None else float(times[-1]),
        stop_reason=reason,
        wall_time=wall_time,
        stopped_by=cause,
    )


def _simulator(diagram: Diagram, settings: IntegratorSettings) -> Simulator:
    simulator = Simulator(diagram)
    has_state = simulator.get_context().num_continuous_states() > 0
    scheme = settings.scheme if has_state or settings.accuracy else NO_STAGES
    ResetIntegratorFromFlags(simulator, scheme, settings.max_step)
    integrator = simulator.get_mutable_integrator()
    if settings.accuracy is None:
        integrator.set_fixed_step_mode(True)
    else:
        integrator.set_target_accuracy(settings.accuracy)
        simulator.get_mutable_context().DisableCaching()
    return simulator


def _advance(
    simulator: Simulator, watch: _Watch, duration: float, stages: list[float] | None
) -> tuple[str | None, DrakeLegError | None]:
    """Advance to the end; return why it stopped before, and the error of this package if any.

    A run that is not checked after every step is checked at the end of each stage [s].
    """
    try:
        with interrupts_kept():
            if stages is None:
                simulator.AdvanceTo(duration)
            for end in stages or ():
                simulator.AdvanceTo(end)
                watch.see(simulator.get_context())
    except KeyboardInterrupt:
        return INTERRUPTED, None
    except STOPS as error:
        return str(error), error.with_traceback(None)  # which would hold the diagram
    except (RuntimeError, SystemExit) as error:
        return f"the integrator gave up: {' '.join(str(error).split())}", None
    finally:
        simulator.clear_monitor()  # it holds the integrator, which holds all
    return None, None


def _watch_steps(simulator: Simulator, watch: _Watch) -> None:
    """Check the run after each step, and choose the next one."""
    integrator = simulator.get_mutable_integrator()

    def after_step(root: Context) -> EventStatus:
        watch.see(root)
        integrator.set_maximum_step_size(watch.next_step(root))
        return EventStatus.DidNothing()

    integrator.set_maximum_step_size(watch.next_step(simulator.get_context()))
    simulator.set_monitor(after_step)


def _start(start: Start, diagram: Diagram, context: Context) -> None:
    """Set the initial state, and check that its derivatives exist."""
    try:
        start(diagram, context)
        diagram.EvalTimeDerivatives(context)
    except (RuntimeError, SystemExit) as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(
            f"the simulation cannot start from these numbers: Drake says {reason}"
        ) from None


class _Watch:
    """Checks a run after every step, and limits the next step."""

    def __init__(
        self,
        diagram: Diagram,
        context: Context,
        settings: IntegratorSettings,
        longest_step: LongestStep | None,
        progress: Progress | None,
        *,
        guarded: bool,
    ) -> None:
        self._guard = Guard(diagram, context, settings.max_step, guarded=guarded)
        self._limits = _Limits(diagram)
        self._settings, self._longest_step, self._progress = settings, longest_step, progress
        self._steps = 0
        self._limits.check(context)

    @property
    def sees_every_step(self) -> bool:
        """Whether a run may have to stop at a step, or to shorten one."""
        if self._settings.accuracy is not None or self._longest_step is not None:
            return True
        return not (self._guard.is_idle and self._limits.is_idle)

    def stages(self, duration: float) -> list[float]:
        """Times [s] at which a run of constant steps is checked."""
        step = self._settings.max_step
        stages = range(1, math.ceil(duration / (step * STEPS_PER_STAGE)))
        # Products as Drake's own, lest a discrete plant's step be a rounding error from a stage.
        return [*(step * (STEPS_PER_STAGE * stage) for stage in stages), duration]

    def see(self, root: Context) -> None:
        """Raise where the run must not continue."""
        self._steps += 1
        now = root.get_time()
        if self._progress:
            self._progress(now)
        if self._steps > STEP_BUDGET:
            raise StepBudgetError(steps=self._steps, time=now)
        greatest = np.abs(root.get_continuous_state_vector().CopyToVector()).max(initial=0.0)
        if not greatest <= RUNAWAY:
            raise UnstableRunError(
                time=now, max_step=self._settings.max_step, scheme=self._settings.scheme
            )
        self._limits.check(root)

    def next_step(self, root: Context) -> float:
        """Return the longest next step [s]."""
        step = self._guard.next_step(root)
        if self._longest_step is None:
            return step
        return min(step, self._longest_step(root.get_time()))


class _Limits:
    """The joint limits of the continuous plants that have any; a discrete plant stops at them."""

    def __init__(self, diagram: Diagram) -> None:
        weaker = ", or a weaker disturbance" if is_disturbed(diagram) else ""
        self._advice = f"choose another posture or a smaller amplitude{weaker}"
        self._limited = []
        for plant in diagram.GetSystems():
            if isinstance(plant, MultibodyPlant) and plant.time_step() == 0.0:
                low, high = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
                if np.isfinite(low).any() or np.isfinite(high).any():
                    self._limited.append((plant, low.tolist(), high.tolist()))

    @property
    def is_idle(self) -> bool:
        """Whether no joint has limits."""
        return not self._limited

    def check(self, root: Context) -> None:
        """Raise where a joint has left its limits."""
        for plant, low, high in self._limited:
            q = plant.GetPositions(plant.GetMyContextFromRoot(root)).tolist()
            for index, position in enumerate(q):
                if beyond(position, low[index], high[index]):
                    joint = _joint_at(plant, index)
                    raise JointLimitError(
                        joint=joint.name(),
                        position=position,
                        limits=(low[index], high[index]),
                        time=root.get_time(),
                        slides=isinstance(joint, PrismaticJoint),
                        advice=self._advice,
                    )


def _joint_at(plant: MultibodyPlant, position: int) -> Joint:
    """Find the joint that has a position."""
    joints = (plant.get_joint(index) for index in plant.GetJointIndices())
    return next(
        joint for joint in joints if 0 <= position - joint.position_start() < joint.num_positions()
    )


def _read_scopes(diagram: Diagram, context: Context) -> tuple[Array, Scopes]:
    logs = {
        system.get_name(): system.FindLog(context)
        for system in diagram.GetSystems()
        if isinstance(system, VectorLogSink)
    }
    rows = min(log.num_samples() for log in logs.values())
    first = next(iter(logs.values()))
    times = np.array(first.sample_times()[:rows])
    return times, Scopes({name: np.array(log.data().T[:rows]) for name, log in logs.items()})
