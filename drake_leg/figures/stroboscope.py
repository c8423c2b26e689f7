"""A robot at instants of its first stroke, one over the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from drake_leg.colours import BLUE, GREEN, VERMILLION
from drake_leg.figures.style import LEGEND_BELOW, PLOT_WIDTH, new_figure
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.recording import Recording
from drake_leg.robot import Robot

GHOSTS = 9  # postures


def stroboscope(robot: Robot, recording: Recording, title: str) -> Figure:
    """Draw the links at instants of the first stroke, from the side and from the top (B 6, 7).

    The recording has joint positions and x, y, z.
    """
    tip = recording.stack("x", "y", "z")
    distance = np.linalg.norm(tip - tip[0], axis=1)
    last = int(np.argmax(distance))
    instants = np.searchsorted(distance[: last + 1], np.linspace(0.0, distance[last], GHOSTS))
    rows = np.unique(np.minimum(instants, last))
    q = recording.stack(*(f"q{i + 1}" for i in range(len(robot.moving))))
    X_B = base_transforms(robot.rows, q[rows])
    joints = np.concatenate([np.zeros((len(rows), 1, 3)), X_B[:, :, :3, 3]], axis=1)

    figure, (side, top) = new_figure(title, columns=2, width=PLOT_WIDTH, height=3.8)
    for axes, (across, up) in ((side, (0, 2)), (top, (0, 1))):
        for shade, points in zip(np.linspace(0.2, 1.0, len(rows)), joints, strict=True):
            x, y = points[:, across], points[:, up]
            axes.plot(x, y, "-", color=BLUE, alpha=float(shade), linewidth=2.0)
            axes.plot(x, y, "o", color=BLUE, alpha=float(shade), markersize=3.5)
        axes.plot(
            tip[:, across], tip[:, up], color=VERMILLION, linewidth=2.4, label="path of the tip"
        )
        axes.plot(tip[0, across], tip[0, up], "s", color=GREEN, markersize=6, label="start")
        axes.set(xlabel="xyz"[across] + " [m]", ylabel="xyz"[up] + " [m]")
        axes.set_aspect("equal", adjustable="datalim")
    top.plot([], [], "-", color=BLUE, alpha=0.5, linewidth=2.0, label="the links, palest first")
    side.set_xlabel("x [m]   (seen from the side)")
    top.set_xlabel("x [m]   (seen from the top)")
    figure.legend(*top.get_legend_handles_labels(), ncols=3, **LEGEND_BELOW)
    _equal_ticks(figure, (side, top))
    return figure


def _equal_ticks(figure: Figure, panels: Sequence[Axes]) -> None:
    """Put ticks at the same steps on all axes, whose units are equally long on paper."""
    figure.draw_without_rendering()
    widest = max(max(np.ptp(a.get_xlim()), np.ptp(a.get_ylim())) for a in panels)
    low, high = MaxNLocator(7, steps=[1, 2, 5, 10]).tick_values(0.0, float(widest))[:2]
    for axes in panels:
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MultipleLocator(high - low))
