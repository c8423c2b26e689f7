"""The runs by name: title, options, and what carries them out.

Drake is imported only when a run is carried out, so that help is quick.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.robot.file_names import ENDINGS, is_robot_file
from drake_leg.robot.hexapods import HEXAPODS
from drake_leg.robot.robot import Robot
from drake_leg.runs.options import (
    EllipseOptions,
    LegAOptions,
    LegBOptions,
    LoopOptions,
    OwnOptions,
    RunOptions,
    ScaraOptions,
)
from drake_leg.runs.pendulum_options import (
    DampedPendulumOptions,
    FreePendulumOptions,
    PendulumOptions,
    SpringPendulumOptions,
)
from drake_leg.runs.walk_options import WalkOptions

if TYPE_CHECKING:
    from pydrake.systems.framework import Diagram

    from drake_leg.runs.outcome import Outcome
    from drake_leg.simulation.run import Progress, Start

STEP = "the step"
LOOPS = "its loops closed"
WALK = "walking on the ground"


@dataclass(frozen=True, kw_only=True)
class RunKind:
    """What can be run: by its name, or the straight step of a user's own robot."""

    title: str
    motion: str = ""  # of the foot or tool, unless the title says it
    shows: str = ""  # the figures of the reports that it reproduces
    options: type[RunOptions]
    own: Robot | None = None  # of the user

    @property
    def heading(self) -> str:
        """The title with the motion."""
        return f"{self.title}: {self.motion}" if self.motion else self.title

    def run(self, options: Any, progress: Progress | None = None) -> Outcome:  # noqa: ANN401
        """Simulate."""
        posed = self.posed(options)
        outcome: Outcome = self._module().run(self.robot(options), posed, progress)
        return outcome

    def diagram(self, options: Any) -> tuple[Diagram, Start]:  # noqa: ANN401
        """Build the diagram that is simulated; return it with its start."""
        built: tuple[Diagram, Start] = self._module().diagram(
            self.robot(options), self.posed(options)
        )
        return built

    def robot(self, options: Any) -> Robot:  # noqa: ANN401
        """Return the robot that moves."""
        if isinstance(options, WalkOptions):
            return options.the_robot
        tip = options.tip if isinstance(options, OwnOptions) else None
        if self.own is not None and self.own.loops:
            return self.own
        robot: Robot = options.robot() if self.own is None else self.own.at_tip(tip)
        return robot

    def posed(self, options: Any) -> Any:  # noqa: ANN401
        """Let a report's robot that is given as one's own start where its own run does."""
        if self.own is None or options.q0 is not None:
            return options
        return dataclasses.replace(options, q0=reports_posture(self.own))

    def _module(self) -> Any:  # noqa: ANN401
        name = "pendulum" if issubclass(self.options, PendulumOptions) else "step"
        name = "closed_loop" if issubclass(self.options, LoopOptions) else name
        name = "walk" if issubclass(self.options, WalkOptions) else name
        return import_module(f"drake_leg.runs.{name}")


RUNS = {
    "pendulum": RunKind(title="Free pendulum", shows="A 5, A 7", options=FreePendulumOptions),
    "pendulum-damped": RunKind(
        title="Damped pendulum", shows="A 6, A 8", options=DampedPendulumOptions
    ),
    "pendulum-spring": RunKind(
        title="Pendulum with a spring", shows="A 6, as intended", options=SpringPendulumOptions
    ),
    "leg-a": RunKind(title="Hexabot leg A", motion=STEP, shows="A 11-16", options=LegAOptions),
    "leg-b": RunKind(title="Hexabot leg B", motion=STEP, shows="B 8-12", options=LegBOptions),
    "ellipse": RunKind(title="Leg B on an ellipse", shows="A 2.1", options=EllipseOptions),
    "scara": RunKind(
        title="SCARA arm", motion="the straight line", shows="B 1", options=ScaraOptions
    ),
    "hexapod": RunKind(title="Hexapod", motion=WALK, options=WalkOptions),
}


_HEXAPODS = {robot.name: robot for robot in HEXAPODS}


def run_kind(what: str | Path | Robot) -> RunKind:
    """Look up a run by its name; a robot, or one from a file, makes the straight step.

    So does one leg of a hexapod.

    Raises
    ------
    InvalidValueError
        If there is no such run, or the file cannot be read.
    """
    if isinstance(what, str) and what in RUNS:
        return RUNS[what]
    if isinstance(what, str):
        what = _HEXAPODS.get(what, what)
    if isinstance(what, str | Path) and is_robot_file(what):
        from drake_leg.robot.robot_file import load_robot  # with readers that help does not need

        what = load_robot(what)
    if isinstance(what, Robot) and what.loops:
        return RunKind(title=what.title, motion=LOOPS, options=LoopOptions, own=what)
    if isinstance(what, Robot):
        return RunKind(title=what.title, motion=STEP, options=OwnOptions, own=what)
    named = isinstance(what, str | Path)
    given = repr(str(what)) if named else shown(what)
    own = f"a robot of your own is a file that ends in {ENDINGS}"
    raise InvalidValueError(
        f"there is no run {given}; the runs are {', '.join(RUNS)}",
        advice=did_you_mean(what, RUNS, own if named else f"{own}, or a Robot"),
    )


def reports_posture(robot: Robot) -> list[float] | None:
    """Return where the run of a report's leg or SCARA starts [deg, or m of its lift]."""
    for name in ("leg-a", "leg-b", "scara"):
        options: Any = RUNS[name].options()
        if robot != options.robot():
            continue
        if not isinstance(options, ScaraOptions):
            return list(options.q0)
        from drake_leg.kinematics.scara import ScaraGeometry, lift_position

        return [*options.q0, lift_position(ScaraGeometry.from_robot(robot), options.tool_height)]
    return None
