"""Signals over time, as the scopes of a model show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle

import numpy as np
from matplotlib.figure import Figure

from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.plots.style import (
    LINES,
    PLOT_WIDTH,
    TIME,
    legend_above,
    new_figure,
    whole_ticks,
    widen_flat_axis,
)

FIRST, MORE = 3.4, 1.9  # [inch]: height of a figure with one axes, and of each more
MOST_AXES, MOST_NAMED = 12, 12  # axes of a figure, and lines of axes that are named
LONGEST = 48  # letters of a label


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A line of a scope."""

    label: str
    values: Array  # (rows,)


def scope_plot(title: str, time: Array, axes: Sequence[Sequence[Curve]]) -> Figure:
    """Plot curves over time [s], as many axes as a scope has ports."""
    shown = axes[:MOST_AXES]
    height = FIRST + MORE * (len(shown) - 1)
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


def xy_plot(title: str, x: Sequence[Curve], y: Sequence[Curve]) -> Figure:
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


def _short(curve: Curve) -> str:
    """Write a label without signs that would be read as a formula, or as no label."""
    label = curve.label.replace("$", r"\$").lstrip("_") or "signal"
    return label if len(label) <= LONGEST else f"{label[: LONGEST - 1]}…"
