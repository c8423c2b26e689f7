"""How every figure looks, and how it is saved."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

FORMATS = ("png", "svg")

# Okabe and Ito's colours, told apart by colour-blind eyes, and different line styles too.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#9B4F96"
GREY = "#6B6B6B"
LINES = ((BLUE, "-"), (ORANGE, "--"), (GREEN, "-."), (PURPLE, ":"))

STYLE: dict[Any, Any] = {
    "font.size": 10.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "axes.xmargin": 0.01,
    "grid.color": "#D9D9D9",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "figure.facecolor": "white",
    "savefig.dpi": 150,
    "svg.fonttype": "path",
    "svg.hashsalt": "drake-leg",
}


def new_figure(
    title: str, *, rows: int = 1, columns: int = 1, height: float = 3.6
) -> tuple[Figure, list[Axes]]:
    """Make a figure with axes one above the other, or side by side.

    Parameters
    ----------
    title : str
        Above everything, left.
    rows, columns : int
        Of axes; those one above the other share their x axis.
    height : float
        Of the figure [inch]; it is 7.2 inch wide.

    Returns
    -------
    Figure, list of Axes
        Row by row.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, height), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns, sharex=rows > 1, squeeze=False).ravel()
    figure.suptitle(title, x=0.01, horizontalalignment="left", fontsize=11.0)
    return figure, list(axes)


def legend_above(axes: Axes, *others: Axes) -> None:
    """Put the legend in one line above the axes, right, where it hides nothing.

    Parameters
    ----------
    axes : Axes
        Whose legend it is.
    *others : Axes
        Twins whose lines it names, too.
    """
    handles, labels = axes.get_legend_handles_labels()
    for other in others:
        more_handles, more_labels = other.get_legend_handles_labels()
        handles, labels = handles + more_handles, labels + more_labels
    axes.legend(
        handles,
        labels,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=len(labels),
        borderaxespad=0.1,
        frameon=False,
        fontsize=9.5,
        columnspacing=1.0,
        handlelength=2.2,
    )


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write a figure as PNG and SVG, the same bytes every time.

    Parameters
    ----------
    figure : Figure
        To be written.
    folder : Path
        Where.
    name : str
        File name without ending.

    Returns
    -------
    list of Path
        The files written.
    """
    paths = []
    with mpl.rc_context(STYLE):
        for ending in FORMATS:
            path = folder / f"{name}.{ending}"
            metadata = {"Date": None} if ending == "svg" else None
            figure.savefig(path, metadata=metadata)
            paths.append(path)
    return paths
