"""The runs by name: title, options, and what carries them out.

Drake is imported only when a run is carried out, so that help is quick.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from drake_leg.errors import InvalidValueError
from drake_leg.runs.options import (
    DampedPendulumOptions,
    EllipseOptions,
    FreePendulumOptions,
    LegAOptions,
    LegBOptions,
    RunOptions,
    ScaraOptions,
    SpringPendulumOptions,
    StraightOptions,
)

if TYPE_CHECKING:
    from pydrake.systems.framework import Diagram

    from drake_leg.robot.robot import Robot
    from drake_leg.runs.outcome import Outcome
    from drake_leg.simulation.run import Progress, Start

STEP = "the step"


@dataclass(frozen=True, kw_only=True)
class RunKind:
    """One name on the command line."""

    title: str
    motion: str = ""  # what is moved along, where the title does not say it
    shows: str  # figures of the reports that it reproduces
    options: type[RunOptions]
    module: str  # in this package, with functions run, diagram and robot

    @property
    def heading(self) -> str:
        """The title with the motion."""
        return f"{self.title}: {self.motion}" if self.motion else self.title

    def run(self, options: Any, progress: Progress | None = None) -> Outcome:  # noqa: ANN401
        """Simulate."""
        outcome: Outcome = self._loaded().run(options, progress)
        return outcome

    def diagram(self, options: Any) -> tuple[Diagram, Start]:  # noqa: ANN401
        """Build what is simulated, and say how it starts."""
        built: tuple[Diagram, Start] = self._loaded().diagram(options)
        return built

    def robot(self, options: Any) -> Robot:  # noqa: ANN401
        """Return what moves."""
        robot: Robot = self._loaded().robot(options)
        return robot

    def _loaded(self) -> Any:  # noqa: ANN401 - a module
        return import_module(f"drake_leg.runs.{self.module}")


@dataclass(frozen=True, kw_only=True)
class OwnRobot(RunKind):
    """The straight step of a robot of a person's own."""

    own: Robot
    motion: str = STEP
    shows: str = ""
    options: type[RunOptions] = StraightOptions
    module: str = "leg"

    def run(self, options: Any, progress: Progress | None = None) -> Outcome:  # noqa: ANN401
        """Simulate."""
        outcome: Outcome = self._loaded().run_robot(self.own, options, progress)
        return outcome

    def diagram(self, options: Any) -> tuple[Diagram, Start]:  # noqa: ANN401
        """Build what is simulated, and say how it starts."""
        built: tuple[Diagram, Start] = self._loaded().robot_diagram(self.own, options)
        return built

    def robot(self, _options: Any) -> Robot:  # noqa: ANN401
        """Return what moves."""
        return self.own


RUNS = {
    "pendulum": RunKind(
        title="Free pendulum",
        shows="A 5, A 7",
        options=FreePendulumOptions,
        module="pendulum",
    ),
    "pendulum-damped": RunKind(
        title="Damped pendulum",
        shows="A 6, A 8",
        options=DampedPendulumOptions,
        module="pendulum",
    ),
    "pendulum-spring": RunKind(
        title="Pendulum with a spring",
        shows="A 6 as it was meant",
        options=SpringPendulumOptions,
        module="pendulum",
    ),
    "leg-a": RunKind(
        title="Hexabot leg A",
        motion=STEP,
        shows="A 11-16",
        options=LegAOptions,
        module="leg",
    ),
    "leg-b": RunKind(
        title="Hexabot leg B",
        motion=STEP,
        shows="B 8-12",
        options=LegBOptions,
        module="leg",
    ),
    "ellipse": RunKind(
        title="Leg B on an ellipse",
        shows="A 2.1",
        options=EllipseOptions,
        module="ellipse",
    ),
    "scara": RunKind(
        title="SCARA arm",
        motion="the straight line",
        shows="B 1",
        options=ScaraOptions,
        module="scara",
    ),
}


def run_kind(name: str) -> RunKind:
    """Look a run up by its name on the command line.

    Raises
    ------
    InvalidValueError
        If there is no such run.
    """
    if name not in RUNS:
        raise InvalidValueError(f"there is no run {name!r}; the runs are {', '.join(RUNS)}")
    return RUNS[name]
