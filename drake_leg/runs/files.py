"""A run's figures as files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.pictures.plots.style import save
from drake_leg.runs.outcome import Outcome


def figure_files(title: str, outcome: Outcome) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """List a run's figures: file name without ending, and what writes the file into a folder."""
    for file_name, draw in figures_of_run(
        outcome.subject, title, outcome.robot, outcome.recording, outcome.summary
    ):
        yield file_name, partial(_write, draw, file_name)


def _write(draw: Callable[[], Figure], file_name: str, folder: Path) -> None:
    save(draw(), folder, file_name)
