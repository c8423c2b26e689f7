"""Columns of a recording against time: what a Simulink scope shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import Locator, MaxNLocator

from drake_leg.figures.style import LINES, PLOT_WIDTH, legend_above, new_figure, whole_ticks
from drake_leg.kinematics.batches import Array
from drake_leg.recording import Recording

TIME = "time t [s]"
DEGREE_STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0)
MOST_TICKS = 5


def time_plot(
    recording: Recording, columns: dict[str, str], *, title: str, ylabel: str, degrees: bool = False
) -> Figure:
    """Plot columns (name to label) of one unit against time; ``degrees`` adds an axis of them."""
    return curves_plot(
        recording["time"],
        {label: recording[name] for name, label in columns.items()},
        title=title,
        ylabel=ylabel,
        degrees=degrees,
    )


def curves_plot(
    time: Array, curves: dict[str, Array], *, title: str, ylabel: str, degrees: bool = False
) -> Figure:
    """Plot curves (label to values) of one unit against time [s]."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    for (label, values), (colour, style) in zip(curves.items(), cycle(LINES), strict=False):
        axes.plot(time, values, linestyle=style, color=colour, label=label)
    axes.set(xlabel=TIME, ylabel=ylabel)
    whole_ticks(axes)
    widen_flat_axis(axes)
    if degrees:
        add_degrees(axes)
    if len(curves) > 1:
        legend_above(axes)
    return figure


def add_degrees(axes: Axes) -> None:
    """Add an axis in degrees to the right of a y axis in rad."""
    right = axes.secondary_yaxis("right", functions=(np.degrees, np.radians))
    right.set_ylabel("[deg]")
    right.yaxis.set_major_locator(_DegreeLocator())
    right.spines["right"].set_visible(True)


class _DegreeLocator(Locator):
    """Ticks at the steps in which angles are counted."""

    def __call__(self) -> Sequence[float]:
        return self.tick_values(*self.axis.get_view_interval()) if self.axis else []

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        low, high = sorted((vmin, vmax))
        step = next((step for step in DEGREE_STEPS if high - low < MOST_TICKS * step), None)
        if step is None or high - low < DEGREE_STEPS[0]:
            return MaxNLocator(MOST_TICKS).tick_values(low, high)
        return [step * n for n in range(math.ceil(low / step), math.floor(high / step) + 1)]


def widen_flat_axis(axes: Axes, least: float = 1e-6) -> None:
    """Keep rounding noise from filling the height of a constant curve's axis.

    ``least`` is the least range, in the unit of the y axis.
    """
    low, high = axes.get_ylim()
    if high - low < least:
        middle = (low + high) / 2.0
        axes.set_ylim(middle - least, middle + least)
