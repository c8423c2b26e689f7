"""Figures of the pendulum (report A, figures 5-8)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from drake_leg.figures.style import BLUE, GREY, ORANGE, legend_above, new_figure
from drake_leg.figures.time_plots import TIME, add_degrees, time_plot, widen_flat_axis
from drake_leg.recording import Recording


def angle(recording: Recording, title: str, rest: float | None = None) -> Figure:
    """Draw the angle against time, with the rest angle where there is one.

    Parameters
    ----------
    recording : Recording
        Of a pendulum.
    title : str
        Of the figure.
    rest : float, optional
        Rest angle [rad].

    Returns
    -------
    Figure
    """
    figure = time_plot(
        recording, {"q": "q"}, title=title, ylabel="joint angle q [rad]", degrees=True
    )
    if rest is not None:
        axes = figure.axes[0]
        low, high = axes.get_ylim()
        margin = 0.05 * max(high, rest) - 0.05 * min(low, rest)
        axes.set_ylim(min(low, rest - margin), max(high, rest + margin))
        axes.axhline(rest, color=GREY, linestyle=":", linewidth=1.2)
        axes.annotate(
            f"rest at {rest:.4f} rad = {np.degrees(rest):.2f} deg",
            (0.98, rest),
            xycoords=("axes fraction", "data"),
            xytext=(0, 6),
            textcoords="offset points",
            ha="right",
            color=GREY,
        )
    return figure


def angle_and_rate(recording: Recording, title: str) -> Figure:
    """Draw the angle and the rate, one above the other; the vertical is marked.

    Parameters
    ----------
    recording : Recording
        Of a pendulum.
    title : str
        Of the figure.

    Returns
    -------
    Figure
    """
    figure, (top, bottom) = new_figure(title, rows=2, height=5.0)
    time = recording["time"]
    top.plot(time, recording["q"], color=BLUE)
    top.axhline(np.pi / 2, color=GREY, linestyle=":", linewidth=1.2, label="link vertical")
    top.set(ylabel="angle q [rad]")
    add_degrees(top)
    legend_above(top)
    bottom.plot(time, recording["qdot"], color=ORANGE)
    bottom.set(xlabel=TIME, ylabel="rate of q [rad/s]")
    return figure


def energy(recording: Recording, title: str, scale: float) -> Figure:
    """Draw the mechanical energy against time, on the scale of what the swing exchanges.

    Parameters
    ----------
    recording : Recording
        Of a pendulum.
    title : str
        Of the figure.
    scale : float
        m g L / 2 [J].

    Returns
    -------
    Figure
    """
    figure = time_plot(
        recording, {"energy": "energy"}, title=title, ylabel="kinetic + potential energy [J]"
    )
    widen_flat_axis(figure.axes[0], scale)
    return figure
