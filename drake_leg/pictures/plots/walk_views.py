"""Views of a robot that walks: the paths of its feet, and what carries it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from drake_leg.colours import BLUE, GREEN, VERMILLION
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.pictures.plots.style import BODY, GREY, LEGEND_BELOW, PLOT_WIDTH, new_figure
from drake_leg.pictures.plots.walk_plots import (
    PANEL_TITLE,
    legs_of,
    planned_and_real,
    planned_down,
)
from drake_leg.robot.robot import Robot
from drake_leg.robot.solids import Brick
from drake_leg.simulation.recording import Recording

MM = 1e3  # [1/m]
INSTANTS = 6  # of a period, in two rows
BORDER = 0.03  # [m], around what is drawn
MOVES = 1e-9  # [m or rad], from a row to the next: a body that moves less stands


@dataclass(frozen=True, kw_only=True, eq=False)
class _Walk:
    """A recording as arrays; G is the frame of the ground, B that of the body, n legs."""

    time: Array
    R_GB: Rotation  # (rows,)
    place: Array  # (rows, 3) [m], p_GB
    feet: Array  # (rows, n, 3) [m], p_GF
    legs: Array  # (rows, n, 4, 3) [m], hip, knee, ankle and foot in B

    @property
    def feet_in_body(self) -> Array:
        """p_BF, (rows, n, 3) [m]."""
        R = self.R_GB.as_matrix()
        return np.asarray(np.einsum("tji,tnj->tni", R, self.feet - self.place[:, np.newaxis]))


def foot_paths(
    robot: Robot, recording: Recording, title: str, summary: Mapping[str, Any]
) -> Figure:
    """Draw the paths of the feet as one sees them from the body: from the side and from above."""
    walk, legs = _walk_of(robot, recording), legs_of(recording)
    rows = walk.time >= summary["settled_at_s"]
    figure, panels = new_figure(title, rows=2, width=5.4, height=7.2)
    p_BF = walk.feet_in_body
    for axes, across, up in ((panels[0], 0, 2), (panels[1], 0, 1)):
        _draw_body(axes, robot, walk.legs[0], across, up)
        for number, leg in enumerate(legs):
            down = planned_down(recording, leg)
            for flags, colour, width, label in (
                (rows & down, BLUE, 3.2, "stance"),
                (rows & ~down, VERMILLION, 1.1, "swing"),
            ):
                path = MM * np.where(flags[:, np.newaxis], p_BF[:, number], np.nan)
                axes.plot(
                    path[:, across],
                    path[:, up],
                    color=colour,
                    linewidth=width,
                    label=label if number == 0 else None,
                )
        axes.set_ylabel("xyz"[up] + " [mm]")
        axes.set_aspect("equal")
    panels[0].set_title("from the right side", **PANEL_TITLE)
    panels[1].set_title("from above", **PANEL_TITLE)
    panels[1].set_xlabel("x, forward [mm]")
    heights = [np.ptp(axes.get_ylim()) for axes in panels]
    grid = figure.add_gridspec(2, 1, height_ratios=heights)
    for row, axes in enumerate(panels):
        axes.set_subplotspec(grid[row])
    figure.legend(*panels[1].get_legend_handles_labels(), ncols=4, **LEGEND_BELOW)
    return figure


def support(robot: Robot, recording: Recording, title: str, summary: Mapping[str, Any]) -> Figure:
    """Draw the polygon of the loaded feet and the center of mass at instants of a period."""
    walk, legs = _walk_of(robot, recording), legs_of(recording)
    loaded = recording.stack(*(f"{leg}_loaded" for leg in legs)) > 0.5
    centre = recording.stack("under_com_x", "under_com_y")
    zero_moment = recording.stack("zmp_x", "zmp_y")
    rows = _instants(walk, recording, summary["period_s"])
    seen = walk.feet[rows, :, :2] - walk.place[rows, np.newaxis, :2]
    low, high = seen.min(axis=(0, 1)) - BORDER, seen.max(axis=(0, 1)) + BORDER
    figure, panels = new_figure(title, rows=2, columns=3, width=PLOT_WIDTH, height=5.0)
    for axes, row in zip(panels, rows, strict=True):
        origin = walk.place[row, :2]
        turned = walk.R_GB[row].as_matrix()[:2]
        _draw_body(axes, robot, walk.legs[row], 0, 1, turned)
        feet = MM * (walk.feet[row, :, :2] - origin)
        stand = loaded[row]
        corners = _hull(feet[stand])
        axes.fill(*corners.T, facecolor=BLUE, alpha=0.15, edgecolor="none")
        axes.plot(*_closed(corners).T, color=BLUE, linewidth=1.2)
        axes.plot(*feet[stand].T, "o", color=BLUE, markersize=5.0, label="loaded foot")
        axes.plot(
            *feet[~stand].T, "o", color=GREY, markerfacecolor="none", markersize=5.0,
            label="foot in the air",
        )  # fmt: skip
        for point, marker, colour, size, label in (
            (centre[row], "o", VERMILLION, 8.0, "center of mass"),
            (zero_moment[row], "+", GREEN, 6.0, "zero-moment point"),
        ):
            axes.plot(
                *MM * (point - origin), marker, color=colour, markerfacecolor="none",
                markersize=size, label=label,
            )  # fmt: skip
        margin = MM * recording["static_margin"][row]
        said = f"{margin:.0f} mm" if np.isfinite(margin) else "no feet"
        axes.set_title(f"{walk.time[row]:.2f} s, {said}", **PANEL_TITLE)
        axes.set_aspect("equal")
        axes.set(xlim=MM * np.array([low[0], high[0]]), ylim=MM * np.array([low[1], high[1]]))
    for axes in panels:
        axes.tick_params(labelleft=axes in panels[::3])
    for axes in panels[::3]:
        axes.set_ylabel("y, left [mm]")
    for axes in panels[3:]:
        axes.set_xlabel("x [mm]")
    figure.legend(*panels[0].get_legend_handles_labels(), ncols=4, **LEGEND_BELOW)
    return figure


def _walk_of(robot: Robot, recording: Recording) -> _Walk:
    names, legs = legs_of(recording), Legs.of(robot)
    count = 3 * len(names)
    q = recording.stack(*(f"q{number}" for number in range(1, count + 1)))
    return _Walk(
        time=recording["time"],
        R_GB=planned_and_real(recording)[1],
        place=recording.stack("x", "y", "z"),
        feet=np.stack([recording.stack(*(f"{leg}_{at}" for at in "xyz")) for leg in names], axis=1),
        legs=legs.joints_and_feet(q.reshape(len(q), -1, 3)),
    )


def _draw_body(
    axes: Axes, robot: Robot, legs: Array, across: int, up: int, R: Array | None = None
) -> None:
    """Draw the body and its legs (n, 4, 3) in a posture, turned by the first rows of a rotation."""
    turned = np.eye(3)[[across, up]] if R is None else R
    outline = MM * _hull(_outline(robot, legs[:, 0]) @ turned.T)
    axes.fill(*outline.T, facecolor=BODY, edgecolor=GREY, linewidth=0.8)
    for line in MM * legs @ turned.T:
        axes.plot(*line.T, "-", color=GREY, linewidth=1.0, alpha=0.7)


def _outline(robot: Robot, hips: Array) -> Array:
    """Corners of the body, (k, 3) [m], in its frame: of its brick, or else its hips."""
    solid = robot.base_link.solid if robot.base_link else None
    if solid is None or not isinstance(solid.shape, Brick):
        return hips
    sides = np.array([solid.shape.length, solid.shape.width, solid.shape.height])
    signs = np.stack(np.meshgrid(*3 * ([-0.5, 0.5],)), axis=-1).reshape(-1, 3)
    return np.asarray(solid.centre + signs * sides)


def _instants(walk: _Walk, recording: Recording, period: float) -> list[int]:
    """Rows over a period of the gait, in the middle of the time in which the body moves."""
    places = recording.stack(
        *(f"planned_{each}" for each in ("x", "y", "z", "qw", "qx", "qy", "qz"))
    )
    moving = np.flatnonzero((np.abs(np.diff(places, axis=0)) > MOVES).any(axis=1))
    first, last = (moving[0], moving[-1]) if len(moving) else (0, len(places) - 1)
    lasts = min(period, walk.time[-1] - walk.time[0])
    middle = (walk.time[first] + walk.time[last]) / 2.0
    begins = np.clip(middle - lasts / 2.0, walk.time[0], walk.time[-1] - lasts)
    times = begins + lasts * (np.arange(INSTANTS) + 0.5) / INSTANTS
    rows: list[int] = np.searchsorted(walk.time, times).tolist()
    return rows


def _hull(points: Array) -> Array:
    """Corners of the convex hull of points (k, 2), in order; all points where there is none."""
    if len(points) < 3:
        return points
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:  # all on a line
        return points


def _closed(corners: Array) -> Array:
    return np.concatenate([corners, corners[:1]])
