"""The runs by name: title, options, and what carries them out.

Drake is imported only when a run is carried out, so that help is quick.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from drake_leg.errors import InvalidValueError
from drake_leg.runs.options import (
    DampedPendulumOptions,
    EllipseOptions,
    FreePendulumOptions,
    LegAOptions,
    LegBOptions,
    LegOptions,
    RunOptions,
    ScaraOptions,
    SpringPendulumOptions,
)

if TYPE_CHECKING:
    from pydrake.systems.framework import Context, Diagram

    from drake_leg.robot import Robot
    from drake_leg.runs.outcome import Outcome

Progress = Callable[[float], None]
Start = Callable[["Diagram", "Context"], None]


STEP = "the step"


@dataclass(frozen=True, kw_only=True)
class RunKind:
    """One name on the command line."""

    title: str
    motion: str = ""  # what is moved along, where the title does not say it
    shows: str  # figures of the reports that it reproduces
    options: type[RunOptions]
    run: Callable[[Any, Progress | None], Outcome]
    diagram: Callable[[Any], tuple[Diagram, Start]]  # what it simulates, and how that starts
    robot: Callable[[Any], Robot]  # what moves

    @property
    def heading(self) -> str:
        """The title with the motion."""
        return f"{self.title}: {self.motion}" if self.motion else self.title


def _pendulum(options: Any, progress: Progress | None = None) -> Outcome:  # noqa: ANN401
    from drake_leg.runs.pendulum import run_pendulum

    return run_pendulum(options, progress)


def _leg_a(options: LegAOptions, progress: Progress | None = None) -> Outcome:
    from drake_leg.runs.leg import run_straight

    return run_straight("A", options, progress)


def _leg_b(options: LegBOptions, progress: Progress | None = None) -> Outcome:
    from drake_leg.runs.leg import run_straight

    return run_straight("B", options, progress)


def _ellipse(options: EllipseOptions, progress: Progress | None = None) -> Outcome:
    from drake_leg.runs.leg import run_ellipse

    return run_ellipse(options, progress)


def _scara(options: ScaraOptions, progress: Progress | None = None) -> Outcome:
    from drake_leg.runs.scara import run_scara

    return run_scara(options, progress)


def _pendulum_diagram(options: Any) -> tuple[Diagram, Start]:  # noqa: ANN401
    from drake_leg.diagrams.mechanism import start_at_targets
    from drake_leg.diagrams.pendulum import build
    from drake_leg.runs.pendulum import pendulum_config

    config = pendulum_config(options)
    return build(config), start_at_targets(config.robot)


def _leg_a_diagram(options: LegAOptions) -> tuple[Diagram, Start]:
    from drake_leg.runs.leg_setup import leg_of, straight_diagram

    return straight_diagram(leg_of("A", options), options)


def _leg_b_diagram(options: LegBOptions) -> tuple[Diagram, Start]:
    from drake_leg.runs.leg_setup import leg_of, straight_diagram

    return straight_diagram(leg_of("B", options), options)


def _ellipse_diagram(options: EllipseOptions) -> tuple[Diagram, Start]:
    from drake_leg.diagrams.ellipse import build
    from drake_leg.diagrams.mechanism import start_on_motion
    from drake_leg.runs.leg_setup import ellipse_config

    return build(ellipse_config(options)), start_on_motion


def _scara_diagram(options: ScaraOptions) -> tuple[Diagram, Start]:
    from drake_leg.diagrams.mechanism import start_on_motion
    from drake_leg.diagrams.scara import build
    from drake_leg.runs.scara import scara_config

    return build(scara_config(options)), start_on_motion


def _pendulum_robot(options: Any) -> Robot:  # noqa: ANN401
    from drake_leg.runs.pendulum import pendulum_config

    return pendulum_config(options).robot


def _leg_a_robot(options: LegOptions) -> Robot:
    from drake_leg.runs.leg_setup import leg_of

    return leg_of("A", options)


def _leg_b_robot(options: LegOptions) -> Robot:
    from drake_leg.runs.leg_setup import leg_of

    return leg_of("B", options)


def _scara_robot(options: ScaraOptions) -> Robot:
    from drake_leg.runs.scara import scara_config

    return scara_config(options).robot


RUNS = {
    "pendulum": RunKind(
        title="Free pendulum",
        shows="A 5, A 7",
        options=FreePendulumOptions,
        run=_pendulum,
        diagram=_pendulum_diagram,
        robot=_pendulum_robot,
    ),
    "pendulum-damped": RunKind(
        title="Damped pendulum",
        shows="A 6, A 8",
        options=DampedPendulumOptions,
        run=_pendulum,
        diagram=_pendulum_diagram,
        robot=_pendulum_robot,
    ),
    "pendulum-spring": RunKind(
        title="Pendulum with a spring",
        shows="A 6 as it was meant",
        options=SpringPendulumOptions,
        run=_pendulum,
        diagram=_pendulum_diagram,
        robot=_pendulum_robot,
    ),
    "leg-a": RunKind(
        title="Hexabot leg A",
        motion=STEP,
        shows="A 11-16",
        options=LegAOptions,
        run=_leg_a,
        diagram=_leg_a_diagram,
        robot=_leg_a_robot,
    ),
    "leg-b": RunKind(
        title="Hexabot leg B",
        motion=STEP,
        shows="B 8-12",
        options=LegBOptions,
        run=_leg_b,
        diagram=_leg_b_diagram,
        robot=_leg_b_robot,
    ),
    "ellipse": RunKind(
        title="Leg B on an ellipse",
        shows="A 2.1",
        options=EllipseOptions,
        run=_ellipse,
        diagram=_ellipse_diagram,
        robot=_leg_b_robot,
    ),
    "scara": RunKind(
        title="SCARA arm",
        motion="the straight line",
        shows="B 1",
        options=ScaraOptions,
        run=_scara,
        diagram=_scara_diagram,
        robot=_scara_robot,
    ),
}


def run_kind(name: str) -> RunKind:
    """Look a run up.

    Parameters
    ----------
    name : str
        As on the command line.

    Raises
    ------
    InvalidValueError
        If there is no such run.
    """
    if name not in RUNS:
        raise InvalidValueError(f"there is no run {name!r}; the runs are {', '.join(RUNS)}")
    return RUNS[name]
