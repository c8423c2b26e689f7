"""Plots of the pendulum (report A, figures 5-8)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drake_leg.colours import BLUE, VERMILLION
from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.plots.style import (
    GREY,
    PLOT_WIDTH,
    TIME,
    add_degrees,
    claim,
    inset,
    legend_above,
    new_figure,
    time_plot,
    whole_ticks,
    widen_flat_axis,
)
from drake_leg.simulation.recording import Recording

Span = tuple[float, float]

VERTICAL = np.pi / 2  # [rad], where the link hangs
NEAR_REST = np.radians(1.0)
SAME = 1e-6  # [rad], by which the extremes of a constant amplitude may differ
SLOW = 0.05  # of the greatest rate, and of the greatest swing: what is less is not marked
EARLY = 0.4  # of a run: motion that ends before is magnified
# Of the axes' height: a margin, a line of text, the ticks under an inset, the least inset.
EDGE, LINE, TICKS, LEAST_GAP = 0.05, 0.08, 0.1, 0.25
MOST = 24  # marks of a kind that can be told apart


def angle(
    recording: Recording,
    title: str,
    rest: float | None = None,
    *,
    equilibrium: float | None = None,
    span: Span | None = None,
) -> Figure:
    """Draw the angle against time (A 5, 6): its swing, or where it comes to rest.

    ``rest`` is the rest angle, ``equilibrium`` that of a spring at the joint [rad]; the axis
    shows at least the angles ``span``, so that figures can be compared.
    """
    figure = time_plot(
        recording, {"q": "q"}, title=title, ylabel="joint angle q [rad]", degrees=True
    )
    axes = figure.axes[0]
    _show(axes, span or ())
    if rest is None:
        _mark_amplitude(axes, recording)
    else:
        _mark_rest(axes, recording, rest, equilibrium)
    if equilibrium is not None:
        _mark_equilibrium(axes, equilibrium)
    until = _end_of_motion(recording)
    if until is not None:
        levels = [level for level in (rest, equilibrium) if level is not None]
        levels = levels or [recording["q"][-1]]
        _magnified(axes, recording, "q", until, levels=levels, texts=_texts(rest, equilibrium))
    return figure


def angle_and_rate(
    recording: Recording,
    title: str,
    *,
    span: Span | None = None,
    rates: Span | None = None,
) -> Figure:
    """Draw the angle and the rate, one above the other (A 7, 8).

    Where the link is vertical, and where it turns back, is marked in both. The axes show at
    least the angles ``span`` [rad] and the rates ``rates`` [rad/s].
    """
    figure, (top, bottom) = new_figure(title, rows=2, width=PLOT_WIDTH, height=5.6)
    _curve(top, recording, "q")
    _curve(bottom, recording, "qdot")
    top.set(ylabel="angle q [rad]")
    bottom.set(xlabel=TIME, ylabel="rate of q [rad/s]")
    whole_ticks(bottom)
    _show(top, span or ())
    _show(bottom, rates or ())
    add_degrees(top)
    until = _end_of_motion(recording)
    if until is not None:
        marked = [
            _magnified(axes, recording, column, until, levels=[recording[column][-1]])
            for axes, column in ((top, "q"), (bottom, "qdot"))
        ]
    else:
        marked = [top, bottom]
    _mark_passages_and_turns(recording, *marked)
    if marked[0].get_legend_handles_labels()[0]:
        legend_above(top, *(axes for axes in marked[:1] if axes is not top))
    return figure


def energy(recording: Recording, title: str, scale: float) -> Figure:
    """Draw the mechanical energy against time, on the scale m g L / 2 of the swing [J]."""
    figure = time_plot(
        recording, {"energy": "energy"}, title=title, ylabel="kinetic + potential energy [J]"
    )
    widen_flat_axis(figure.axes[0], scale)
    return figure


def _curve(axes: Axes, recording: Recording, column: str) -> None:
    axes.plot(recording["time"], recording[column], color=BLUE if column == "q" else VERMILLION)


def _mark_passages_and_turns(recording: Recording, angles: Axes, rates: Axes) -> None:
    """Mark where the link is vertical, and where it turns back, if they can be told apart."""
    time, q, rate = (recording[name] for name in ("time", "q", "qdot"))
    passages = _crossings(time, q - VERTICAL, q, rate)
    passages = passages[np.abs(passages[:, 2]) > SLOW * np.abs(rate).max()]
    turns = _crossings(time, rate, q, rate)
    swings = np.abs(np.diff(turns[:, 1], prepend=q[0]))
    turns = turns[swings > SLOW * np.ptp(q)]
    for places, marker, label in ((passages, "o", "link vertical"), (turns, "s", "turns back")):
        if 0 < len(places) <= MOST:
            style: dict[str, Any] = {
                "color": GREY,
                "linestyle": "none",
                "markersize": 4.5,
                "markerfacecolor": "w",
            }
            angles.plot(places[:, 0], places[:, 1], marker, label=label, **style)
            rates.plot(places[:, 0], places[:, 2], marker, **style)


def _end_of_motion(recording: Recording) -> float | None:
    """Find the time from which the angle stays near its final value [s], if that is early."""
    time, q = recording["time"], recording["q"]
    away = np.flatnonzero(np.abs(q - q[-1]) > NEAR_REST)
    if len(away) == 0 or not 0.0 < time[away[-1]] <= EARLY * time[-1]:
        return None
    return float(time[away[-1]])


def _magnified(
    axes: Axes,
    recording: Recording,
    column: str,
    until: float,
    *,
    levels: Sequence[float],
    texts: tuple[int, int] = (0, 0),
) -> Axes:
    """Magnify the beginning of a curve in an inset, above or below all levels.

    ``texts`` counts the lines of text above and below the levels. Where neither gap has room the
    axes are returned as they are.
    """
    low, high = axes.get_ylim()
    shares = [(level - low) / (high - low) for level in levels]
    above = max(shares) + EDGE + LINE * texts[0] + TICKS, 1.0
    below = TICKS, min(shares) - EDGE - LINE * texts[1]
    bottom, top = max(above, below, key=lambda gap: gap[1] - gap[0])
    if top - bottom < LEAST_GAP:
        return axes
    inner = inset(axes, (0.36, bottom, 0.62, top - bottom))
    inner.margins(y=0.2)
    _curve(inner, recording, column)
    inner.set_xlim(0.0, 1.15 * until)
    whole_ticks(inner)
    upper = recording[column].max() - levels[0] <= levels[0] - recording[column].min()
    inner.annotate(
        "the beginning, magnified",
        (0.99, 0.97 if upper else 0.03),
        xycoords="axes fraction",
        ha="right",
        va="top" if upper else "bottom",
        fontsize=8.5,
        color=GREY,
    )
    return inner


def _texts(rest: float | None, equilibrium: float | None) -> tuple[int, int]:
    """Count the lines that ``_mark_rest`` writes above and below the levels."""
    if rest is None:
        return 0, 0
    if equilibrium is None:
        return 1, 1
    return (2, 0) if equilibrium <= rest else (0, 2)


def _show(axes: Axes, values: Span | tuple[()]) -> None:
    """Widen the y axis until it shows these values, with room around them."""
    if values:
        low, high = axes.get_ylim()
        room = 0.05 * (max(values) - min(values))
        axes.set_ylim(min(low, min(values) - room), max(high, max(values) + room))


def _mark_rest(axes: Axes, recording: Recording, rest: float, equilibrium: float | None) -> None:
    low, high = axes.get_ylim()
    margin = 0.05 * max(high, rest) - 0.05 * min(low, rest)
    axes.set_ylim(min(low, rest - margin), max(high, rest + margin))
    axes.axhline(rest, color=GREY, linestyle=":", linewidth=1.2)
    offsets = (6, -14)
    if equilibrium is not None:
        offsets = (20, 6) if equilibrium <= rest else (-14, -28)
    for text, offset in zip(_of_rest(recording, rest), offsets, strict=True):
        axes.annotate(
            text,
            (0.98, rest),
            xycoords=("axes fraction", "data"),
            xytext=(0, offset),
            textcoords="offset points",
            ha="right",
            fontsize=9.5,
            color=GREY,
        )


def _of_rest(recording: Recording, rest: float) -> tuple[str, str]:
    """Describe where the pendulum rests, and from what time it stays near there, if it does."""
    time, off = recording["time"], np.abs(recording["q"] - rest)
    where = f"at rest at {rest:.4f} rad = {np.degrees(rest):.2f} deg"
    away = np.flatnonzero(off > NEAR_REST)
    if len(away) and away[-1] == len(off) - 1:
        return where, f"still {np.degrees(off[-1]):.1f} deg away from it at {time[-1]:.1f} s"
    since = time[away[-1]] if len(away) else time[0]
    return where, f"within 1 deg of it from {since:.1f} s on"


def _mark_equilibrium(axes: Axes, equilibrium: float) -> None:
    _show(axes, (equilibrium, equilibrium))
    axes.axhline(equilibrium, color=VERMILLION, linestyle="--", linewidth=1.2)
    claim(axes, f"dashed: the spring's equilibrium, {_degrees(equilibrium)} deg")


def _mark_amplitude(axes: Axes, recording: Recording) -> None:
    """Where the amplitude is constant, say so, and mark the extremes and the period."""
    turns = _crossings(*(recording[name] for name in ("time", "qdot", "q", "qdot")))
    highest, lowest = (turns[kind::2] for kind in (0, 1))
    if len(highest) < 2 or len(lowest) < 1:
        return
    if max(np.ptp(highest[:, 1]), np.ptp(lowest[:, 1])) > SAME:
        return
    low, high = sorted((highest[0, 1], lowest[0, 1]))
    for extreme in (low, high):
        axes.axhline(extreme, color=GREY, linestyle=":", linewidth=1.2)
    period = highest[1, 0] - highest[0, 0]
    claim(
        axes,
        f"constant amplitude: every swing from {_degrees(low)} to {_degrees(high)} deg, "
        f"period {period:.4f} s",
    )


def _degrees(angle: float) -> str:
    return f"{round(np.degrees(angle), 2) + 0.0:g}".replace("-", "\N{MINUS SIGN}")


def _crossings(time: Array, zero: Array, q: Array, rate: Array) -> Array:
    """Interpolate time, angle and rate to where a signal changes sign, (n, 3)."""
    i = np.flatnonzero(zero[:-1] * zero[1:] < 0.0)
    share = zero[i] / (zero[i] - zero[i + 1])
    step = share * (time[i + 1] - time[i])
    there = rate[i] + share * (rate[i + 1] - rate[i])
    return np.stack([time[i] + step, q[i] + step * (rate[i] + there) / 2.0, there], axis=-1)
