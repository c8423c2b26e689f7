"""The figures of a run: as files, and by name, drawn when they are asked for."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from io import BytesIO
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.pictures.plots.style import save
from drake_leg.runs.outcome import Outcome

DPI = 110  # of the figure that a notebook shows


def figure_drawers(title: str, outcome: Outcome) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """List a run's figures: name, and what draws it."""
    yield from figures_of_run(
        outcome.subject, title, outcome.robot, outcome.recording, outcome.summary
    )


def figure_files(
    title: str, outcome: Outcome, formats: Sequence[str]
) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """List a run's figures: file name without ending, and what writes its files into a folder."""
    for name, draw in figure_drawers(title, outcome):
        yield name, partial(_write, draw, name, formats)


def _write(draw: Callable[[], Figure], name: str, formats: Sequence[str], folder: Path) -> None:
    save(draw(), folder, name, formats)


def png_address(figure: Figure) -> str:
    """Return a figure as a data URL of a PNG."""
    buffer = BytesIO()
    FigureCanvasAgg(figure).print_figure(buffer, dpi=DPI, format="png")
    return f"data:image/png;base64,{b64encode(buffer.getvalue()).decode('ascii')}"
