"""Plots of a robot that walks, over time and over joint speed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_leg.colours import BLUE, GREEN, VERMILLION
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.margins import LOADED
from drake_leg.pictures.plots.style import (
    BODY,
    GREY,
    LEGEND_BELOW,
    PLOT_WIDTH,
    TIME,
    claim,
    legend_above,
    new_figure,
    whole_ticks,
)
from drake_leg.simulation.recording import Recording, intervals

KINDS = ("hip", "knee", "ankle")  # of the joints of a leg
BOUNCE = 0.040  # [s]: a gap of the load that is not longer is a bounce
ROOM = 1.05  # times the greatest value: what an axis shows
PANEL_TITLE: dict[str, Any] = {"loc": "left", "fontsize": 10.0}

Flags = NDArray[np.bool_]


def legs_of(recording: Recording) -> tuple[str, ...]:
    """Names of the legs whose feet a recording has."""
    found = (re.fullmatch(r"(.+)_down", name) for name in recording.columns)
    return tuple(match[1] for match in found if match)


def gait(recording: Recording, title: str) -> Figure:
    """Draw a bar for each time that a foot is loaded, and a thin one where it is planned to be."""
    legs, time = legs_of(recording), recording["time"]
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    forces = np.stack([recording[f"{leg}_fz"] for leg in legs])
    loaded = forces > LOADED * forces.sum(axis=0).mean()
    for row, leg in enumerate(legs):
        for bars, centre, height, colour, label in (
            (bars_of(time, planned_down(recording, leg)), -0.3, 0.12, VERMILLION, "planned"),
            (bars_of(time, loaded[row], BOUNCE), 0.1, 0.5, BLUE, "loaded"),
        ):
            axes.broken_barh(
                bars,
                (row + centre - height / 2.0, height),
                facecolors=colour,
                label=label if row == 0 else None,
            )
    axes.set_yticks(range(len(legs)), [words(leg) for leg in legs])
    axes.set(xlabel=TIME, xlim=(time[0], time[-1]))
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    whole_ticks(axes)
    legend_above(axes)
    claim(axes, "feet on the ground")
    return figure


def contact_forces(recording: Recording, title: str, *, settled: float) -> Figure:
    """Plot the vertical force on each foot, gray where it is planned to stand.

    The axes have room for the forces after ``settled`` [s], when the robot stands on its feet.
    """
    legs, time = legs_of(recording), recording["time"]
    rows = (len(legs) + 1) // 2
    figure, panels = new_figure(
        title, rows=rows, columns=2, width=PLOT_WIDTH, height=1.3 + 1.15 * rows
    )
    columns = np.array(panels).reshape(rows, 2).T.ravel()  # one below the other, as in the table
    forces = {leg: recording[f"{leg}_fz"] for leg in legs}
    most = max(float(force[time >= settled].max()) for force in forces.values())
    for leg, axes in zip(legs, columns, strict=False):
        for first, length in bars_of(time, planned_down(recording, leg)):
            axes.axvspan(first, first + length, color=BODY, linewidth=0.0)
        axes.plot(time, forces[leg], color=BLUE, linewidth=1.1)
        axes.set_title(words(leg), **PANEL_TITLE)
        axes.set(xlim=(time[0], time[-1]), ylim=(-0.05 * most, ROOM * most))
    for axes in columns[len(legs) :]:
        axes.set_axis_off()
    for axes in columns[:rows]:
        axes.set_ylabel("force [N]")
    for axes in columns[[rows - 1, len(legs) - 1]]:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(TIME)
    panels[0].plot([], [], color=BLUE, label="vertical force of the ground")
    panels[0].fill_between([], [], color=BODY, label="planned to stand")
    figure.legend(*panels[0].get_legend_handles_labels(), ncols=2, **LEGEND_BELOW)
    return figure


def servo_limits(recording: Recording, title: str, summary: Mapping[str, Any]) -> Figure:
    """Plot torque over speed of all hips, knees and ankles, and the line that no servo passes.

    A torque along the motion is positive, one against it negative. The settled rows are drawn.
    """
    stall, no_load = summary["stall_torque_n_m"], summary["no_load_speed_rad_s"]
    rows = recording["time"] >= summary["settled_at_s"]
    figure, panels = new_figure(title, columns=3, width=PLOT_WIDTH, height=3.8)
    speeds = {kind: _of_kind(recording, "qdot", kind)[rows] for kind in KINDS}
    reach = ROOM * max(no_load, *(float(np.abs(speed).max()) for speed in speeds.values()))
    line = np.array([0.0, reach])
    for kind, axes in zip(KINDS, panels, strict=True):
        speed = np.abs(speeds[kind])
        torque = np.sign(speeds[kind]) * _of_kind(recording, "tau", kind)[rows]
        used = np.abs(torque + stall / no_load * speed).max() / stall
        axes.plot(
            speed.ravel(), torque.ravel(), ".", color=BLUE, markersize=1.5, rasterized=True,
            label="every joint, every row",
        )  # fmt: skip
        axes.plot(
            line, stall * (1.0 - line / no_load), color=VERMILLION, label="100 %: limit of a servo"
        )
        axes.plot(line, -stall * (1.0 + line / no_load), color=VERMILLION)
        axes.axhline(0.0, color=GREY, linewidth=0.8)
        axes.set_title(f"{kind}: ≤ {100.0 * used:.0f} %", **PANEL_TITLE)
        axes.set(xlim=(0.0, reach), ylim=(-ROOM * stall, ROOM * stall))
        axes.tick_params(labelleft=axes is panels[0])
        axes.set_xlabel("speed [rad/s]")
    panels[0].set_ylabel("torque along the motion [N m]")
    _marked(figure, panels[0])
    return figure


def body_errors(recording: Recording, title: str) -> Figure:
    """Plot how far the body is off its planned attitude, height and course."""
    turned, off = errors_of(recording)
    time = recording["time"]
    figure, (angles, course, height) = new_figure(title, rows=3, width=PLOT_WIDTH, height=6.0)
    for axes, values, labels in (
        (angles, np.degrees(turned), ("roll", "pitch", "heading")),
        (course, 1e3 * off[:, :2], ("forward", "to the left")),
        (height, 1e3 * off[:, 2:], ("up",)),
    ):
        for column, label, colour, style in zip(
            values.T, labels, (BLUE, VERMILLION, GREEN), ("-", "--", "-."), strict=False
        ):
            axes.plot(time, column, style, color=colour, label=label)
        axes.axhline(0.0, color=GREY, linewidth=0.8)
        axes.locator_params(axis="y", nbins=5)
    legend_above(angles)
    legend_above(course)
    angles.set_ylabel("angle [deg]")
    course.set_ylabel("course [mm]")
    height.set(ylabel="height [mm]", xlabel=TIME, xlim=(time[0], time[-1]))
    whole_ticks(height)
    return figure


def margins(recording: Recording, title: str) -> Figure:
    """Plot how far inside the loaded feet the center of mass and the zero-moment point are."""
    time = recording["time"]
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    for name, label, colour, width in (
        ("dynamic_margin", "dynamic, of the zero-moment point", VERMILLION, 1.0),
        ("static_margin", "static, of the center of mass", BLUE, 1.6),
    ):
        axes.plot(time, 1e3 * recording[name], color=colour, linewidth=width, label=label)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set(xlabel=TIME, ylabel="margin [mm]", xlim=(time[0], time[-1]))
    whole_ticks(axes)
    legend_above(axes)
    return figure


def words(leg: str) -> str:
    """Name of a leg as one writes it."""
    return leg.replace("_", " ")


def planned_down(recording: Recording, leg: str) -> Flags:
    """Whether a leg's foot is planned to stand, (rows,)."""
    return np.asarray(recording[f"{leg}_down"] > 0.5)


def planned_and_real(recording: Recording) -> tuple[Rotation, Rotation]:
    """Planned and real attitude of the body in the frame of the ground, (rows,) each."""
    planned, real = (
        Rotation.from_quat(
            recording.stack(*(f"{prefix}q{part}" for part in "wxyz")), scalar_first=True
        )
        for prefix in ("planned_", "")
    )
    return planned, real


def errors_of(recording: Recording) -> tuple[Array, Array]:
    """Rotation [rad] and displacement [m] of the body off its plan, along the planned body's axes.

    Both are (rows, 3).
    """
    planned, real = planned_and_real(recording)
    off = recording.stack("x", "y", "z") - recording.stack("planned_x", "planned_y", "planned_z")
    return (planned.inv() * real).as_rotvec(), planned.inv().apply(off)


def bars_of(time: Array, flags: Flags, gap: float = 0.0) -> list[tuple[float, float]]:
    """Beginnings and lengths of the times in which a flag is set; gaps up to ``gap`` [s] count."""
    last = len(time) - 1
    bars: list[tuple[float, float]] = []
    for first, end in intervals(flags):
        begins, ends = float(time[first]), float(time[min(end, last)])
        if bars and begins - sum(bars[-1]) <= gap:
            begins = bars.pop()[0]
        bars.append((begins, ends - begins))
    return bars


def _of_kind(recording: Recording, name: str, kind: str) -> Array:
    """Columns of all joints of a kind, (rows, legs); a leg's joints follow one another."""
    count = len(KINDS) * len(legs_of(recording))
    numbers = range(1 + KINDS.index(kind), 1 + count, len(KINDS))
    return recording.stack(*(f"{name}{number}" for number in numbers))


def _marked(figure: Figure, axes: Axes) -> None:
    """Name what is drawn below the figure, its points large enough to be seen."""
    figure.legend(*axes.get_legend_handles_labels(), ncols=2, markerscale=5.0, **LEGEND_BELOW)
