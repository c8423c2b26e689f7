"""How a run gets from one time to the next: by Drake's simulator, or by steps of our own.

Where something is stiff, an explicit integrator would take some steps for each of the shortest
time constants, however smooth the motion is: contacts, dampers, fast filters. Rosenbrock steps are
as long as the accuracy lets them be, and need fewer evaluations than Drake's implicit integrators.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from pydrake.systems.analysis import (
    ApplySimulatorConfig,
    InitializeParams,
    Simulator,
    SimulatorConfig,
)
from pydrake.systems.framework import Context, Diagram, EventStatus

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.rosenbrock import Array, Rates
from drake_leg.simulink.running.solution import Solution, StepError
from drake_leg.simulink.running.sparsity import Pattern


class Watch(Protocol):
    """Looks at every step."""

    def __call__(self, context: Context) -> EventStatus:
        """Look at the end of a step, which may be corrected."""

    def follow(self, context: Context) -> None:
        """Put driven axes on their motions."""


class Events(Protocol):
    """What happens between steps."""

    def next_sample(self, time: float) -> float:
        """Return the first time after one at which something happens [s]."""

    def happen(self, root: Context) -> bool:
        """Let happen what happens at the time of a context; tell whether anything did."""

    def signs(self, root: Context) -> Array:
        """Return the signs of the signals whose changes let something happen."""


STIFF = "radau3"  # Drake's integrator for what is stiff
EDGE, ROUNDING = 1e-12, 4e-16  # [s], and of the time: how exactly an edge is located
CHATTER = 1e-5  # of the longest step: a step that is cut so soon lets the next one be whole
PASSED_OVER = 100.0  # shortest steps
IN_A_ROW = 3  # of the shortest steps whose error is not controlled
PACE = 50_000  # evaluations after which a run is asked how far it has come
MOST_EVALUATIONS = 1_000_000  # of a whole run, at its pace; beyond, its accuracy is coarser
FAST = 10.0  # least quotient of the longest step and the time constant of a filter


class Stepper:
    """Takes the context of a diagram to later times.

    Parameters
    ----------
    diagram : Diagram
        What is integrated.
    context : Context
        Its context, at the start.
    config : SimulatorConfig
        Drake's integrator, the accuracy and the longest step.
    accuracy : float
        Of own steps.
    shortest : float
        The shortest step [s].
    watch : Watch
        Looks at the context after each step.
    events : Events
        What happens between steps.
    """

    def __init__(
        self,
        diagram: Diagram,
        context: Context,
        config: SimulatorConfig,
        *,
        accuracy: float,
        shortest: float,
        watch: Watch,
        events: Events,
    ) -> None:
        self.config, self.context = config, context
        self._accuracy, self._shortest, self._watch = accuracy, shortest, watch
        self._events = events
        self._simulator = Simulator(diagram, context)
        self._simulator.set_monitor(watch)
        self._configure()
        self._own: Solution | None = None
        self.first_accuracy = config.accuracy
        self.relaxed: float | None = None  # [s], from where on the accuracy is coarser
        self.forced: list[float] = []  # [s], where the shortest steps were taken
        self.damped: tuple[float, float] | None = None  # [s], since when swings are, and accuracy
        self.hurried: tuple[float, float] | None = None  # [s], since when, and the accuracy
        self._paced = 0, 0.0  # evaluations, and time [s], when it was asked last
        self._in_a_row = 0
        self._before = 0  # steps of what integrated before
        self._idle = 0  # steps of Drake's simulator that took no time
        self._corners: Sequence[float] = ()
        self._edge = -math.inf  # [s], where a step was cut soon after it began

    def take_own_steps(
        self,
        rates: Callable[[], Rates],
        corners: Sequence[float],
        pattern: Pattern | None = None,
        *,
        has_edges: bool = False,
        coarsest: float = 0.0,
    ) -> None:
        """Go by own steps from here on.

        Parameters
        ----------
        rates : callable
            Returns the derivatives of all states, as they are until something happens.
        corners : sequence of float
            Times at which they may jump, and the end, which no step goes beyond.
        pattern : (n, n), optional
            Which rates may depend on which states.
        has_edges : bool
            Whether something happens where signals change their sign: steps end there.
        coarsest : float
            Accuracy up to which fast swings may be damped, and a run may be hurried.
        """
        self._corners, self._rates, self._has_edges = corners, rates, has_edges
        self._own = Solution(
            tentative(rates()),
            self.context.get_time(),
            self._states(),
            accuracy=self._accuracy,
            longest=self.config.max_step_size,
            shortest=self._shortest,
            coarsest=coarsest,
            pattern=pattern,
        )
        self._paced = 0, self.context.get_time()

    @property
    def integrator(self) -> str:
        """Name of the integrator: Drake's, or those of own steps."""
        if self._own is None:
            return str(self.config.integration_scheme)
        return " and ".join(sorted(self._own.methods, reverse=True))

    @property
    def is_stiff(self) -> bool:
        """Whether it goes on well where the model is stiff."""
        return self._own is not None or self.integrator == STIFF

    @property
    def has_states(self) -> bool:
        """Whether anything is integrated."""
        return bool(self.context.num_continuous_states())

    @property
    def accuracy(self) -> float | None:
        """Accuracy of the integration, None of fixed steps."""
        if self._own is not None:
            return self._own.accuracy
        return self.config.accuracy if self.config.use_error_control else None

    @property
    def steps(self) -> int:
        """How many steps were taken."""
        own = 0 if self._own is None else self._own.steps
        return own + self._before + int(self._simulator.get_num_steps_taken()) - self._idle

    def begin(self) -> None:
        """Let happen what happens at the start."""
        if self._own is None:
            self._simulator.Initialize()
        else:
            self._happen(self._own)
            self._watch(self.context)

    def advance(self, time: float, is_over: Callable[[], bool]) -> bool:
        """Go on to a time, or to where it is over; tell whether the time was reached."""
        if self._own is not None:
            if self._advance_own(self._own, time, is_over):
                return self._own.t >= time
            self._before += self._own.steps
            self._own = None
            self._restart()
        self._idle += time == self.context.get_time()
        self._simulator.AdvanceTo(time)
        return not is_over()

    def pass_over(self, time: float) -> bool:
        """Go on to a time that is some of the shortest steps away; tell whether it is.

        A jump of a signal at that time can leave no step short enough to end there.
        """
        if time - self.context.get_time() > PASSED_OVER * self._shortest:
            return False
        self.context.SetTime(time)
        self._restart()
        return True

    def relax(self, accuracy: float) -> bool:
        """Go on at a coarser accuracy; tell whether it is one."""
        if not self.config.use_error_control or self.config.accuracy >= accuracy:
            return False
        self.relaxed = self.context.get_time()
        self.config.accuracy = accuracy
        self._configure()
        self._restart()
        return True

    def force(self) -> bool:
        """Take the shortest step whatever its error; tell whether that were few in a row.

        Simulink's solvers do so, too, and warn.
        """
        now = self.context.get_time()
        is_next = self.forced and now - self.forced[-1] < PASSED_OVER * self._shortest
        self._in_a_row = self._in_a_row + 1 if is_next else 1
        if self._in_a_row > IN_A_ROW:
            return False
        self.forced.append(now)
        self._restart()
        integrator = self._simulator.get_mutable_integrator()
        integrator.set_throw_on_minimum_step_size_violation(False)
        self._simulator.AdvanceTo(now + self._shortest)
        integrator.set_throw_on_minimum_step_size_violation(True)
        return True

    def finish_events(self) -> None:
        """Let happen what happens at the time that is reached."""
        if self._own is None:
            self._idle += 1
            self._simulator.AdvancePendingEvents()
        elif self._own.t == self.context.get_time():
            self._happen(self._own)

    def _happen(self, own: Solution) -> None:
        """Let happen what happens before the next step."""
        if self._events.happen(self.context):
            own.change(self._states(), tentative(self._rates()))

    def change(self, scheme: str) -> None:
        """Go on by another integrator of Drake's."""
        self.config.integration_scheme = scheme
        self._configure()
        self._restart()

    def close(self) -> None:
        """Watch no longer."""
        self._simulator.clear_monitor()

    def _configure(self) -> None:
        self.config.start_time = self.context.get_time()  # else Drake would set it to 0
        ApplySimulatorConfig(self.config, self._simulator)
        self._simulator.get_mutable_integrator().set_requested_minimum_step_size(self._shortest)

    def _restart(self) -> None:
        self._before += int(self._simulator.get_num_steps_taken()) - self._idle
        self._simulator.Initialize(InitializeParams(suppress_initialization_events=True))
        self._idle = int(self._simulator.get_num_steps_taken())

    def _advance_own(self, own: Solution, time: float, is_over: Callable[[], bool]) -> bool:
        """Go on by own steps; tell whether they went well, else the last good one is in place."""
        while own.t < time and not is_over():
            if self.context.get_time() != own.t:
                self._put(own, own.t)
            self._happen(own)
            signs = self._events.signs(self.context) if self._has_edges else None
            corner = self._corners[bisect_right(self._corners, own.t)]
            try:
                own.step(min(corner, self._events.next_sample(own.t)))
            except StepError:
                self._put(own, own.t)
                return False
            self._put(own, own.t)
            if signs is not None:
                self._end_at_edge(own, signs)
            self._watch(self.context)  # which may put driven axes on their motions
            own.correct(self._states())
            self.damped = own.damped
            self._keep_pace(own)
        self._put(own, min(time, own.t))
        if time < own.t:
            self._watch.follow(self.context)
        return True

    def _keep_pace(self, own: Solution) -> None:
        """Let the accuracy be coarser where the run would take too many evaluations."""
        evaluations, time = self._paced
        spent = own.evaluations - evaluations
        if spent < PACE:
            return
        self._paced = own.evaluations, own.t
        too_slow = spent * self._corners[-1] > MOST_EVALUATIONS * (own.t - time)
        if too_slow and own.relax():
            since = own.t if self.hurried is None else self.hurried[0]
            self.hurried = since, own.accuracy

    def _end_at_edge(self, own: Solution, signs: Array) -> None:
        """Cut a step where a signal that lets something happen has changed its sign.

        A signal that changes it at every step is passed over, as steps would become too short.
        """
        start, end = own.began, own.t
        if start - self._edge < self._shortest or not self._differs(own, end, signs):
            return
        first = start
        while end - start > max(EDGE, ROUNDING * end):
            middle = 0.5 * (start + end)
            start, end = (start, middle) if self._differs(own, middle, signs) else (middle, end)
        own.cut(end)
        self._put(own, end)
        self._edge = end if end - first < CHATTER * self.config.max_step_size else -math.inf

    def _differs(self, own: Solution, time: float, signs: Array) -> bool:
        self._put(own, time)
        return not np.array_equal(self._events.signs(self.context), signs)

    def _put(self, own: Solution, time: float) -> None:
        self.context.SetTimeAndContinuousState(time, own.at(time))

    def _states(self) -> Array:
        states: Array = self.context.get_continuous_state_vector().CopyToVector()
        return states


def tentative(rates: Rates) -> Rates:
    """Let rates that cannot be computed be no numbers, so that the step becomes shorter.

    Drake ends Python where positions are not finite.
    """

    def attempted(t: float, x: Array) -> Array:
        if math.isfinite(x.sum()):
            try:
                return rates(t, x)
            except (RuntimeError, InvalidValueError, ArithmeticError, ValueError, IndexError):
                pass
        return np.full(x.size, np.nan)

    return attempted
