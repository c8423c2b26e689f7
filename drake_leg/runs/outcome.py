"""The outcome of a run: its recording and its summary."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import Run

if TYPE_CHECKING:
    from drake_leg.pictures.plots.of_runs import Subject

BEST = IntegratorSettings().scheme
SHOWN = 0.01  # of a motion's range: about the width of a curve in a small figure
NOTHING = 1e-6  # [rad or m], an error that never matters


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """A recording, its exact counterpart and its summary."""

    robot: Robot
    recording: Recording
    exact: Mapping[str, Array]  # by column name: the exact values, where they are known
    summary: Mapping[str, Any]  # as in summary.json
    subject: Subject  # of the figures

    def write(self, folder: Path, name: str) -> None:
        """Write ``recording.csv`` and ``summary.json`` of the run of a name into a folder."""
        self.recording.write_csv(folder / "recording.csv")
        summary = json.dumps({"run": name, **self.summary}, indent=2, allow_nan=False)
        (folder / "summary.json").write_text(f"{summary}\n", encoding="utf-8")


def outcome_of(
    robot: Robot,
    run: Run,
    settings: IntegratorSettings,
    duration: float,
    recording: Recording,
    exact: Mapping[str, Array],
    findings: Mapping[str, Any],
    subject: Subject = "foot",
) -> Outcome:
    """Assemble a run's outcome; its summary has the entries of all runs, then ``findings``."""
    common = {
        "robot": robot.name,
        "duration_s": duration,
        "stopped_at_s": run.stopped_at,
        "stop_reason": run.stop_reason,
        "integrator": settings.scheme,
        "accuracy": settings.accuracy,
        "max_step_s": settings.max_step,
        "rows": len(run.time),
        "real_time_factor": run.real_time_factor,
    }
    return Outcome(
        robot=robot,
        recording=recording,
        exact=exact,
        summary={**common, **findings},
        subject=subject,
    )


def shows(error: float, span: float) -> bool:
    """Return whether an error can be seen in a figure of the motion.

    ``error`` is the largest distance from the exact motion, ``span`` the range of that [rad or m].
    Where nothing moves, an error counts from ``NOTHING`` on.
    """
    return not error <= max(SHOWN * span, NOTHING)


def finer(settings: IntegratorSettings) -> str:
    """Advise how to make an integration more accurate."""
    if settings.accuracy is None:
        remedy = "choose a smaller `max_step`"
    else:
        remedy = "choose a finer `accuracy`"
    return remedy if settings.scheme == BEST else f"{remedy} or `integrator={BEST!r}`"


def inaccuracy(error: float, span: float, what: str, unit: str, remedy: str) -> str | None:
    """Explain that a run differs visibly from the commanded motion; None if it does not."""
    if not shows(error, span):
        return None
    return (
        f"the {what} is up to {error:.2g} {unit} from the exact motion, which goes through "
        f"{span:.3g} {unit}: what was recorded is another motion; {remedy}"
    )
