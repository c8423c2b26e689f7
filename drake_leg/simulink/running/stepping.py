"""How a run gets from one time to the next: by Drake's simulator, or by Rosenbrock steps.

Where signals alone are integrated, some of them fast filters, an explicit integrator would take
some steps for each of their time constants, however smooth their inputs are.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence

from pydrake.systems.analysis import (
    ApplySimulatorConfig,
    InitializeParams,
    Simulator,
    SimulatorConfig,
)
from pydrake.systems.framework import Context, Diagram, EventStatus

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.rosenbrock import Rates, Rosenbrock, StepError

ROSENBROCK = "rodas5p"
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
    shortest : float
        The shortest step [s].
    watch : callable
        Looks at the context after each step.
    """

    def __init__(
        self,
        diagram: Diagram,
        context: Context,
        config: SimulatorConfig,
        *,
        shortest: float,
        watch: Callable[[Context], EventStatus],
    ) -> None:
        self.config, self.context = config, context
        self._shortest, self._watch = shortest, watch
        self._simulator = Simulator(diagram, context)
        self._simulator.set_monitor(watch)
        self._configure()
        self._own: Rosenbrock | None = None
        self._own_steps = 0
        self._corners: Sequence[float] = ()

    def take_own_steps(self, rates: Rates, corners: Sequence[float]) -> None:
        """Go by Rosenbrock steps.

        Parameters
        ----------
        rates : callable
            Derivatives of all states.
        corners : sequence of float
            Times at which they may jump, and the end, which no step goes beyond.
        """
        self._corners = corners
        self._own = Rosenbrock(
            rates,
            self.context.get_time(),
            self.context.get_continuous_state_vector().CopyToVector(),
            accuracy=self.config.accuracy,
            longest=self.config.max_step_size,
            shortest=self._shortest,
        )

    @property
    def integrator(self) -> str:
        """Name of the integrator: Drake's, or that of the Rosenbrock method."""
        return self.config.integration_scheme if self._own is None else ROSENBROCK

    @property
    def steps(self) -> int:
        """How many steps were taken."""
        own = 0 if self._own is None else self._own.steps
        return own + self._own_steps + int(self._simulator.get_num_steps_taken())

    def begin(self) -> None:
        """Let happen what happens at the start."""
        if self._own is None:
            self._simulator.Initialize()

    def advance(self, time: float, is_over: Callable[[], bool]) -> None:
        """Go on to a time, or to where it is over."""
        if self._own is not None and self._advance_own(self._own, time, is_over):
            return
        self._simulator.AdvanceTo(time)

    def finish_events(self) -> None:
        """Let happen what happens at the time that is reached."""
        self._simulator.AdvancePendingEvents()

    def change(self, scheme: str) -> None:
        """Go on by another integrator of Drake's."""
        self.config.integration_scheme = scheme
        self._configure()
        self._simulator.Initialize(InitializeParams(suppress_initialization_events=True))

    def close(self) -> None:
        """Watch no longer."""
        self._simulator.clear_monitor()

    def _configure(self) -> None:
        ApplySimulatorConfig(self.config, self._simulator)
        self._simulator.get_mutable_integrator().set_requested_minimum_step_size(self._shortest)

    def _advance_own(self, own: Rosenbrock, time: float, is_over: Callable[[], bool]) -> bool:
        """Go on by own steps; where they fail, Drake goes on from the last of them."""
        try:
            while own.t < time:
                own.step(self._corners[bisect_right(self._corners, own.t)])
                self._put(own.t)
                self._watch(self.context)
                if is_over():
                    return True
        except (StepError, InvalidValueError, ArithmeticError, ValueError, IndexError):
            self._put(own.t)
            self._own, self._own_steps = None, own.steps
            self._simulator.Initialize(InitializeParams(suppress_initialization_events=True))
            return False
        self._put(time)
        return True

    def _put(self, time: float) -> None:
        assert self._own is not None
        self.context.SetTimeAndContinuousState(time, self._own.at(time))
