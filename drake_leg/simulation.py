"""From a diagram to what its scopes recorded: integrator, stops, progress.

Drake's error control has a trap: when it rejects a step it puts the old state back without
telling the caches, so that whatever depends on the state alone (a plant's kinematics) is used
stale in the repeated step. Runs with error control therefore go without caching; runs at a
given step, the default, reject nothing and keep it.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import Context, Diagram, EventStatus
from pydrake.systems.primitives import VectorLogSink

from drake_leg.errors import (
    InvalidValueError,
    JointLimitError,
    LostMotionError,
    SingularConfigurationError,
    StepBudgetError,
    UnstableRunError,
)
from drake_leg.integrator import IntegratorSettings
from drake_leg.kinematics.batches import Array
from drake_leg.robot import require_positive
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.prescribed_motion import PrescribedMotion

STEP_BUDGET = 2_000_000  # steps that one run may take
SINGULAR_BELOW = 1e-5  # normalised determinant at which a run stops
NEARLY_SINGULAR = 0.02  # normalised determinant below which the joints must follow closely
LARGEST_LAG = 1e-7  # [rad or m] of the joints behind their prescribed motion there
APPROACH = 0.05  # part of the determinant that a step changes, at most
LARGEST_TURN = 0.05  # [rad or m] of a joint in a step
GROWTH = 1.2  # from one step to the next, at most
SHRINK = 1.5  # from one trial to the next
SMALLEST_STEP = 1e-13  # [s]
RUNAWAY = 1e9  # [rad, rad/s, m, m/s]: no joint of these robots gets there but by instability

Start = Callable[[Diagram, Context], None]
Progress = Callable[[float], None]


@dataclass(frozen=True, kw_only=True)
class Run:
    """What a simulation left."""

    time: Array  # [s], (rows,)
    scopes: dict[str, Array]  # by scope name, (rows, size)
    stopped_at: float | None  # [s]; None when it ran through
    stop_reason: str | None
    wall_time: float  # [s], of AdvanceTo

    @property
    def real_time_factor(self) -> float:
        """Simulated time over the wall time of ``AdvanceTo``."""
        return float(self.time[-1]) / self.wall_time if self.wall_time > 0.0 else math.inf


def simulate(
    diagram: Diagram,
    *,
    start: Start,
    duration: float,
    settings: IntegratorSettings | None = None,
    progress: Progress | None = None,
) -> Run:
    """Run a diagram and collect its scopes.

    A run stops early, and says why, where the inverse Jacobian becomes singular, where a joint
    leaves its limits, where the
    step budget is spent, where the integrator gives up, and on Ctrl-C; what was recorded until
    then is returned.

    Parameters
    ----------
    diagram : Diagram
        With per-step logs as scopes.
    start : callable
        ``start(diagram, context)`` sets the initial state.
    duration : float
        [s].
    settings : IntegratorSettings, optional
        Runge-Kutta of order 5 at steps of 40 ms by default.
    progress : callable, optional
        Called with the simulated time [s] after every step.

    Returns
    -------
    Run
        Rows are the integrator's own steps.

    Raises
    ------
    InvalidValueError
        If the duration is not positive, or needs more steps than the budget, or if Drake refuses
        the initial state.
    SingularConfigurationError, JointLimitError
        If the robot is singular, or outside its joint limits, at the start.
    """
    settings = settings or IntegratorSettings()
    require_positive("the duration", duration, "s")
    if duration / settings.max_step > STEP_BUDGET:
        raise InvalidValueError(
            f"{duration!r} s at steps of {settings.max_step!r} s are more than the "
            f"{STEP_BUDGET} steps a run may take: choose a shorter duration or a larger step"
        )
    simulator = Simulator(diagram)
    ResetIntegratorFromFlags(simulator, settings.scheme, settings.max_step)
    integrator = simulator.get_mutable_integrator()
    context = simulator.get_mutable_context()
    if settings.accuracy is None:
        integrator.set_fixed_step_mode(True)
    else:
        integrator.set_target_accuracy(settings.accuracy)
        context.DisableCaching()
    _start(start, diagram, context)

    watch = _Watch(diagram, context, settings.max_step)
    steps = 0

    def after_step(root: Context) -> EventStatus:
        nonlocal steps
        steps += 1
        now = root.get_time()
        if progress:
            progress(now)
        if steps > STEP_BUDGET:
            raise StepBudgetError(steps=steps, time=now)
        greatest = np.abs(root.get_continuous_state_vector().CopyToVector()).max()
        blown_up = UnstableRunError(time=now, max_step=settings.max_step, scheme=settings.scheme)
        if not math.isfinite(greatest):
            raise blown_up
        watch.check_limits(root)
        step = watch.next_step(root)
        if greatest > RUNAWAY:
            raise blown_up
        integrator.set_maximum_step_size(step)
        return EventStatus.DidNothing()

    watch.check_limits(context)
    simulator.Initialize()
    integrator.set_maximum_step_size(watch.next_step(context))
    simulator.set_monitor(after_step)
    reason = None
    began = clock.perf_counter()
    try:
        simulator.AdvanceTo(duration)
    except KeyboardInterrupt:
        reason = "interrupted"
    except (
        JointLimitError,
        LostMotionError,
        SingularConfigurationError,
        StepBudgetError,
        UnstableRunError,
    ) as error:
        reason = str(error)
    except (RuntimeError, SystemExit) as error:
        reason = f"the integrator gave up: {' '.join(str(error).split())}"
    wall_time = clock.perf_counter() - began
    times, scopes = _read_scopes(diagram, context)
    return Run(
        time=times,
        scopes=scopes,
        stopped_at=None if reason is None else float(times[-1]),
        stop_reason=reason,
        wall_time=wall_time,
    )


def _start(start: Start, diagram: Diagram, context: Context) -> None:
    """Set the initial state, and see that the motion has a beginning."""
    try:
        start(diagram, context)
        diagram.EvalTimeDerivatives(context)
    except (RuntimeError, SystemExit) as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(
            f"the simulation cannot start from these numbers: Drake says {reason}"
        ) from None


class _Watch:
    """Keeps the steps fine near a singularity, and stops the run where it is met.

    The joints' rates and accelerations tell beforehand how far a step will change the
    determinant. Steps that change it by a small part approach a zero without ever jumping
    across, and pass close by it without losing the line.
    """

    def __init__(self, diagram: Diagram, context: Context, max_step: float) -> None:
        self._blocks = [s for s in diagram.GetSystems() if isinstance(s, InverseJacobian)]
        self._motions = [s for s in diagram.GetSystems() if isinstance(s, PrescribedMotion)]
        self._plants = [s for s in diagram.GetSystems() if isinstance(s, MultibodyPlant)]
        self._signs = [1.0 for _ in self._blocks]
        self._max_step = max_step
        self._step = max_step
        for index, block in enumerate(self._blocks):
            determinant = block.normalised_determinant(block.GetMyContextFromRoot(context))
            self._signs[index] = math.copysign(1.0, determinant)

    def check_limits(self, root: Context) -> None:
        """Stop where a joint has left its limits: a continuous plant does not heed them."""
        for plant in self._plants:
            q = plant.GetPositions(plant.GetMyContextFromRoot(root))
            low, high = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
            outside = np.flatnonzero((q < low) | (q > high))
            if len(outside):
                names = plant.GetPositionNames(
                    add_model_instance_prefix=False, always_add_suffix=False
                )
                raise JointLimitError(
                    joint=names[outside[0]],
                    position=q[outside[0]],
                    limits=(low[outside[0]], high[outside[0]]),
                    time=root.get_time(),
                )

    def next_step(self, root: Context) -> float:
        lag = max(
            (motion.lag(motion.GetMyContextFromRoot(root)) for motion in self._motions),
            default=0.0,
        )
        step = min(GROWTH * self._step, self._max_step)
        for sign, block in zip(self._signs, self._blocks, strict=True):
            context = block.GetMyContextFromRoot(root)
            now = block.normalised_determinant(context)
            if sign * now <= SINGULAR_BELOW:
                raise block.singular(context)
            if lag > LARGEST_LAG and sign * now < NEARLY_SINGULAR:
                raise LostMotionError(time=root.get_time(), lag=lag)
            while step > SMALLEST_STEP:
                turn, drift = block.look_ahead(context, step)
                if turn <= LARGEST_TURN and drift <= APPROACH:
                    break
                step /= SHRINK
        self._step = max(step, SMALLEST_STEP)
        return self._step


def _read_scopes(diagram: Diagram, context: Context) -> tuple[Array, dict[str, Array]]:
    logs = {
        system.get_name(): system.FindLog(context)
        for system in diagram.GetSystems()
        if isinstance(system, VectorLogSink)
    }
    rows = min(log.num_samples() for log in logs.values())
    first = next(iter(logs.values()))
    times = np.array(first.sample_times()[:rows])
    return times, {name: np.array(log.data().T[:rows]) for name, log in logs.items()}
