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
    RunOptions,
    ScaraOptions,
    SpringPendulumOptions,
)

if TYPE_CHECKING:
    from drake_leg.runs.outcome import Outcome

Progress = Callable[[float], None]


@dataclass(frozen=True, kw_only=True)
class RunKind:
    """One name on the command line."""

    title: str
    shows: str  # figures of the reports that it reproduces
    options: type[RunOptions]
    run: Callable[[Any, Progress | None], Outcome]


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


RUNS = {
    "pendulum": RunKind(
        title="Free pendulum",
        shows="A 5, A 7",
        options=FreePendulumOptions,
        run=_pendulum,
    ),
    "pendulum-damped": RunKind(
        title="Damped pendulum",
        shows="A 6, A 8",
        options=DampedPendulumOptions,
        run=_pendulum,
    ),
    "pendulum-spring": RunKind(
        title="Pendulum with a spring",
        shows="A 6 as it was meant",
        options=SpringPendulumOptions,
        run=_pendulum,
    ),
    "leg-a": RunKind(
        title="Hexabot leg A",
        shows="A 11-16",
        options=LegAOptions,
        run=_leg_a,
    ),
    "leg-b": RunKind(
        title="Hexabot leg B",
        shows="B 8-12",
        options=LegBOptions,
        run=_leg_b,
    ),
    "ellipse": RunKind(
        title="Leg B on an ellipse",
        shows="A 2.1",
        options=EllipseOptions,
        run=_ellipse,
    ),
    "scara": RunKind(
        title="SCARA arm",
        shows="B 1",
        options=ScaraOptions,
        run=_scara,
    ),
}


def run_kind(name: str) -> RunKind:
    """Look a run up.

    Parameters
    ----------
    name : str
        As on the command line.

    Returns
    -------
    RunKind

    Raises
    ------
    InvalidValueError
        If there is no such run.
    """
    if name not in RUNS:
        raise InvalidValueError(f"there is no run {name!r}; the runs are {', '.join(RUNS)}")
    return RUNS[name]
