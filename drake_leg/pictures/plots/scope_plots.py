"""Signals over time, as the scopes of a model show them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import cycle
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.plots.style import (
    LINES,
    PLOT_WIDTH,
    TIME,
    legend_above,
    legend_columns,
    new_figure,
    whole_ticks,
    widen_flat_axis,
)
from drake_leg.simulink.running.columns import Column, SinkFigure

FIRST, MORE = 3.4, 1.9  # [inch]: height of a figure with one axes, and of each more
NAMED_LINE = 0.19  # [inch]: height of a line of a legend
MOST_AXES, MOST_NAMED = 12, 12  # axes of a figure, and lines of axes that are named
LONGEST = 48  # letters of a label
LINE = 64  # letters of a title on one line


def figure_of(name: str, time: Array, sink: SinkFigure) -> Figure:
    """Plot what a sink of a model shows over time [s]; an XY Graph, one signal over the other."""
    title = fill(f"{name}: {sink.title}", LINE, break_on_hyphens=False)  # paths may be long
    return _xy_plot(title, *sink.axes) if sink.is_xy else _scope_plot(title, time, sink.axes)


def _scope_plot(title: str, time: Array, axes: Sequence[Sequence[Column]]) -> Figure:
    """Plot curves over time, as many axes as a scope has ports."""
    shown = axes[:MOST_AXES]
    height = FIRST + MORE * (len(shown) - 1) + sum(map(_legend_height, shown))
    figure, places = new_figure(title, rows=len(shown), width=PLOT_WIDTH, height=height)
    for place, curves in zip(places, shown, strict=True):
        for curve, (colour, style) in zip(curves, cycle(LINES), strict=False):
            place.plot(
                time, _finite(curve.values), linestyle=style, color=colour, label=_short(curve)
            )
        if len(curves) == 1:
            place.set_ylabel(_short(curves[0]))
        elif len(curves) <= MOST_NAMED:
            legend_above(place)
        whole_ticks(place)
        widen_flat_axis(place)
    places[-1].set_xlabel(TIME)
    return figure


def _legend_height(curves: Sequence[Column]) -> float:
    """Height of the lines of a legend above axes, beyond the first [inch]."""
    if not 1 < len(curves) <= MOST_NAMED:
        return 0.0
    columns = legend_columns([_short(curve) for curve in curves])
    return NAMED_LINE * (math.ceil(len(curves) / columns) - 1)


def _xy_plot(title: str, x: Sequence[Column], y: Sequence[Column]) -> Figure:
    """Plot the curves of one port over those of another, pair by pair."""
    figure, (place,) = new_figure(title, width=PLOT_WIDTH, height=PLOT_WIDTH * 0.8)
    for across, up, (colour, style) in zip(x, y, LINES, strict=False):
        place.plot(
            _finite(across.values),
            _finite(up.values),
            linestyle=style,
            color=colour,
            label=_short(up),
        )
    place.set(xlabel=_short(x[0]), ylabel=_short(y[0]))
    if len(y) > 1:
        legend_above(place)
    return figure


def _finite(values: Array) -> Array:
    return np.where(np.isfinite(values), values, np.nan)


def _short(curve: Column) -> str:
    """Write a label without signs that would be read as a formula, or as no label."""
    label = curve.label.name.replace("$", r"\$").lstrip("_") or "signal"
    return label if len(label) <= LONGEST else f"{label[: LONGEST - 1]}…"
