"""Plots of a sweep: a field over one or two varied values, and what is best in two fields."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from drake_leg.colours import BLUE, VERMILLION
from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.plots.style import (
    GREY,
    GRID,
    LINES,
    PLOT_WIDTH,
    claim,
    legend_above,
    new_figure,
)

MOST_LEVELS = 8  # of contours
SMALLEST_CONTOURED = 4  # rows or columns of a map that has contours
FEW_POINTS = 60  # of a curve whose points are marked
SMALL, MANY = 2.0, 2000  # a point of a cloud of many [pt]
BEST = 1e-6  # of a field's range: a smaller gain is none


class Axis(NamedTuple):
    """A column that is plotted: its label with its unit, and its values."""

    label: str
    values: NDArray[Any]  # (rows,), numbers or texts

    @property
    def is_text(self) -> bool:
        """Whether the values are no numbers."""
        return self.values.dtype.kind not in "fiu"


def curve(x: Axis, field: Axis, *, title: str, others: Sequence[str] = ()) -> Figure:
    """Plot a field over one varied value; where ``others`` vary, too, their mean and range."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    places, names = _places(x)
    known = np.isfinite(field.values)
    values = field.values[known]
    at, of, mean = _means(places[known], values)
    marked = "o" if len(at) <= FEW_POINTS else ""
    line = "" if names else "-"
    if others and len(values) > len(at):
        low, high = np.full(len(at), np.inf), np.full(len(at), -np.inf)
        np.minimum.at(low, of, values)
        np.maximum.at(high, of, values)
        axes.fill_between(at, low, high, color=BLUE, alpha=0.2, linewidth=0.0)
        claim(axes, f"mean and range over {' and '.join(others)}")
    elif len(known) > known.sum():
        claim(axes, f"{len(known) - known.sum()} of {len(known)} runs have no value")
    axes.plot(at, mean, f"{marked}{line}" or "o", color=BLUE, markersize=4)
    axes.set(xlabel=x.label, ylabel=field.label)
    _name_ticks(axes.xaxis, names)
    return figure


def curves(x: Axis, by: Axis, field: Axis, *, title: str, others: Sequence[str] = ()) -> Figure:
    """Plot a field over a varied number, a curve for each of the texts of another varied value."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    known = np.isfinite(field.values)
    which, names = _places(by)
    marked = "o" if len(np.unique(x.values)) <= FEW_POINTS else ""
    for number, (name, (colour, style)) in enumerate(zip(names, cycle(LINES), strict=False)):
        rows = known & (which == number)
        at, _, mean = _means(x.values[rows].astype(float), field.values[rows])
        axes.plot(at, mean, marked, linestyle=style, color=colour, markersize=4, label=name)
    missing, said = len(known) - int(known.sum()), []
    if others:
        said.append(f"mean over {' and '.join(others)}")
    if missing:
        said.append(f"{missing} of {len(known)} runs have no value")
    if said:
        claim(axes, "; ".join(said))
    axes.set(xlabel=x.label, ylabel=field.label)
    legend_above(axes)
    return figure


def field_map(x: Axis, y: Axis, field: Axis, *, title: str, others: Sequence[str] = ()) -> Figure:
    """Map a field over two varied values: a heat map with contours, or colored samples."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH, height=4.6)
    axes.grid(visible=False)
    (across, x_names), (up, y_names) = _places(x), _places(y)
    xs, of_x = np.unique(across, return_inverse=True)
    ys, of_y = np.unique(up, return_inverse=True)
    if len(xs) * len(ys) <= len(across):
        sums, counts = np.zeros((len(ys), len(xs))), np.zeros((len(ys), len(xs)))
        known = np.isfinite(field.values)
        np.add.at(sums, (of_y[known], of_x[known]), field.values[known])
        np.add.at(counts, (of_y[known], of_x[known]), 1)
        grid = np.ma.masked_invalid(np.where(counts > 0, sums / np.maximum(counts, 1), np.nan))
        drawn: Any = axes.pcolormesh(
            xs, ys, grid, cmap=_colours(), shading="nearest", rasterized=True
        )
        if min(grid.shape) >= SMALLEST_CONTOURED and not x_names and not y_names:
            _contours(axes, xs, ys, grid)
        missing, cells = int((counts == 0).sum()), counts.size
        said = f"mean over {' and '.join(others)}" if others else ""
    else:
        known = np.isfinite(field.values)
        size = SMALL if len(across) > MANY else 5 * SMALL
        axes.scatter(across[~known], up[~known], s=size, c=GRID, marker="s", linewidths=0)
        drawn = axes.scatter(
            across[known], up[known], s=size, c=field.values[known], cmap=_colours(), linewidths=0
        )
        missing, cells, said = int((~known).sum()), len(known), ""
    if missing:
        lacking = f"gray: no value, {missing} of {cells}"
        said = f"{said}; {lacking}" if said else lacking
    if said:
        claim(axes, said)
    axes.set_facecolor(GRID)
    figure.colorbar(drawn, ax=axes, label=field.label)
    axes.set(xlabel=x.label, ylabel=y.label)
    _name_ticks(axes.xaxis, x_names)
    _name_ticks(axes.yaxis, y_names)
    return figure


def pareto_plot(
    first: Axis, second: Axis, front: NDArray[np.int_], *, title: str, wanted: tuple[str, str]
) -> Figure:
    """Plot two fields against each other, and the runs that are best in them.

    ``front`` has the places of these, in order; ``wanted`` says of each field whether the greatest
    or the least is best.
    """
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH, height=4.2)
    x, y = first.values, second.values
    size = SMALL if len(x) > MANY else 5 * SMALL
    axes.scatter(x, y, s=size, c=GREY, linewidths=0, label="runs", rasterized=len(x) > MANY)
    axes.plot(x[front], y[front], "o-", color=VERMILLION, markersize=4, label="none better in both")
    claim(axes, f"best: {wanted[0]} x, {wanted[1]} y")
    axes.set(xlabel=first.label, ylabel=second.label)
    legend_above(axes)
    return figure


def pareto_front(first: Array, second: Array) -> NDArray[np.int_]:
    """Places of the points (n,) than which none is smaller in both, in order of the first."""
    known = np.flatnonzero(np.isfinite(first) & np.isfinite(second))
    if not len(known):
        return known
    x, y = _in_steps(first[known]), _in_steps(second[known])
    order = np.lexsort((y, x))
    least = np.minimum.accumulate(y[order])
    better = np.concatenate([[True], y[order][1:] < least[:-1]])
    front: NDArray[np.int_] = known[order[better]]
    return front


def _in_steps(values: Array) -> Array:
    """Round to what a gain must at least be, so that rounding errors are none."""
    step = BEST * float(np.ptp(values)) or 1.0
    steps: Array = np.round((values - values.min()) / step)
    return steps


def _means(places: Array, values: Array) -> tuple[Array, NDArray[np.int_], Array]:
    """Different places, which of them each value is at, and the mean value at each."""
    at, of = np.unique(places, return_inverse=True)
    counts = np.maximum(np.bincount(of, minlength=len(at)), 1)
    return at, of, np.asarray(np.bincount(of, values, len(at)) / counts)


def _places(axis: Axis) -> tuple[Array, list[str]]:
    """Where values are on an axis: numbers themselves, texts in the order of their appearance."""
    if not axis.is_text:
        return axis.values.astype(float), []
    names = list(dict.fromkeys(map(str, axis.values)))
    return np.array([names.index(str(value)) for value in axis.values], dtype=float), names


def _name_ticks(axis: Any, names: Sequence[str]) -> None:  # noqa: ANN401 - of matplotlib
    if names:
        axis.set_ticks(range(len(names)), names)


def _contours(axes: Axes, x: Array, y: Array, grid: np.ma.MaskedArray[Any, Any]) -> None:
    if not grid.count() or not float(np.ptp(grid.compressed())) > 0.0:
        return
    lines = axes.contour(x, y, grid, levels=MOST_LEVELS, colors="black", linewidths=0.6)
    axes.clabel(lines, fontsize=8.0)


def _colours() -> ListedColormap:
    """Light to dark blue, so that black contours can be read on all of it."""
    from matplotlib import colormaps

    return ListedColormap(colormaps["cividis"](np.linspace(0.25, 1.0, 256)), name="sweep")
