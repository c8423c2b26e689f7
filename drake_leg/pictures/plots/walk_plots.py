"""Plots of a robot that walks."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from drake_leg.colours import BLUE, VERMILLION
from drake_leg.pictures.plots.style import (
    GREY,
    PLOT_WIDTH,
    TIME,
    claim,
    lay_out,
    legend_above,
    new_figure,
)
from drake_leg.simulation.recording import Recording

LOADED = 0.02  # of the greatest force of all feet: less is no support


def legs_of(recording: Recording) -> tuple[str, ...]:
    """Names of the legs whose feet a recording has."""
    found = (re.fullmatch(r"(.+)_down", name) for name in recording.columns)
    return tuple(match[1] for match in found if match)


def gait(recording: Recording, title: str) -> Figure:
    """Draw a bar for each time that a foot is loaded, and a thin one where it is planned to be."""
    legs, time = legs_of(recording), recording["time"]
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    forces = np.stack([recording[f"{leg}_fz"] for leg in legs])
    loaded = forces > LOADED * forces.max()
    for row, leg in enumerate(legs):
        for flags, centre, height, colour, label in (
            (loaded[row], row + 0.1, 0.5, BLUE, "loaded"),
            (recording[f"{leg}_down"] > 0.5, row - 0.3, 0.12, VERMILLION, "planned"),
        ):
            bars = _bars(time, flags)
            axes.broken_barh(
                bars,
                (centre - height / 2.0, height),
                facecolors=colour,
                label=label if row == 0 else None,
            )
    axes.set_yticks(range(len(legs)), [leg.replace("_", " ") for leg in legs])
    axes.set(xlabel=TIME, xlim=(time[0], time[-1]))
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    legend_above(axes)
    claim(axes, "feet on the ground")
    lay_out(figure)
    return figure


def margin(recording: Recording, title: str) -> Figure:
    """Plot how far inside the loaded feet the center of mass is, seen along gravity."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    axes.plot(recording["time"], 1e3 * recording["static_margin"], color=BLUE)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set(xlabel=TIME, ylabel="margin in mm")
    lay_out(figure)
    return figure


def _bars(time: Sequence[float], flags: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """Beginnings and lengths of the times in which a flag is set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    last = len(time) - 1
    return [
        (float(time[first]), float(time[min(end, last)] - time[first]))
        for first, end in zip(edges[::2], edges[1::2], strict=True)
    ]
