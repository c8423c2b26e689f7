"""Plots of a robot whose foot or tool follows a command."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from drake_leg.colours import BLUE, GREEN, VERMILLION
from drake_leg.kinematics.euler import rotation_matrices
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.leg import LegGeometry, foot_rotation_angles
from drake_leg.pictures.plots.style import (
    GREY,
    LEGEND_BELOW,
    PLOT_WIDTH,
    TIME,
    add_degrees,
    claim,
    curves_plot,
    lay_out,
    legend_above,
    new_figure,
    time_plot,
    whole_ticks,
    widen_flat_axis,
)
from drake_leg.robot.robot import Robot
from drake_leg.simulation.recording import Recording

LIKE_A_SINE = 0.02  # of the greatest value: deviation up to which a motion counts as a sine
NEAR_SINGULAR = (
    0.05  # of the greatest smallest singular value: where torques say nothing about a leg
)
FAR_HIGHER = 3.0  # times the torques elsewhere: what would hide them
ROOM = 1.3  # times the greatest torque away from a singularity: what an axis shows
STILL = 1e-6  # [m or m/s], a coordinate that changes less counts as constant
FEW = 4  # joints whose panels have room for their names beside them
SINGULARITY = {"det_j": "det J", "manipulability": "manipulability"}
INTERLEAVED = ((0.0, (5.0, 5.0)), (5.0, (5.0, 5.0)))  # dashes of one in the gaps of the other
GHOSTS = 9  # postures


def step_frequency(recording: Recording) -> float | None:
    """Find the frequency of a step that begins at rest; half a period ends where it turns.

    In rad/s; None if the run ends before that.
    """
    v, time = recording["vx"], recording["time"]
    turns = np.flatnonzero(v[1:-1] * v[2:] < 0.0) + 1
    if not len(turns):
        return None
    i = turns[0]
    return float(np.pi / (time[i] + (time[i + 1] - time[i]) * v[i] / (v[i] - v[i + 1])))


def sine_frequency(recording: Recording) -> float | None:
    """Find the frequency of a foot that moves as a sine, a quarter period behind its velocity.

    In rad/s; None if velocity or position is not such a sine: damped, limited, pushed, late.
    """
    frequency = step_frequency(recording)
    if frequency is None:
        return None
    time, x, v = (recording[name] for name in ("time", "x", "vx"))
    phase = frequency * time
    sine, way = np.sin(phase), 1.0 - np.cos(phase)
    speed = float(v @ sine / (sine @ sine))
    off_speed = np.abs(v - speed * sine).max() / abs(speed)
    off_way = np.abs(x - x[0] - speed / frequency * way).max() / abs(2.0 * speed / frequency)
    return frequency if max(off_speed, off_way) < LIKE_A_SINE else None


def torques_away(recording: Recording, columns: list[str]) -> tuple[float, float] | None:
    """Find the greatest torques away from a singularity and near it [N*m].

    None if one axis shows both well. The recording has sigma_min and these columns.
    """
    sigma = recording["sigma_min"]
    near = sigma < NEAR_SINGULAR * sigma.max()
    torques = np.abs(recording.stack(*columns)).max(axis=1)
    if not near.any() or near.all():
        return None
    away, there = float(torques[~near].max()), float(torques[near].max())
    return (away, there) if there > FAR_HIGHER * away else None


def position(recording: Recording, title: str, what: str = "foot") -> Figure:
    """Draw the position of the foot against time (A 11, B 8)."""
    figure = time_plot(
        recording,
        {"x": "x", "y": "y", "z": "z"},
        title=title,
        ylabel=f"{what} position in the base frame [m]",
    )
    spans = {name: float(np.ptp(recording[name])) for name in "xyz"}
    still = [name for name, span in spans.items() if span < STILL]
    if len(still) == 2:
        (moving,) = spans.keys() - still
        claim(
            figure.axes[0],
            f"{moving} swings through {1e3 * spans[moving]:.1f} mm; {still[0]} and {still[1]} "
            f"stay within {_power(max(spans[name] for name in still))} m",
        )
    return figure


def velocity(recording: Recording, title: str, what: str = "foot") -> Figure:
    """Draw the velocity of the foot against time (A 12, B 9)."""
    figure = time_plot(
        recording,
        {"vx": "$v_x$", "vy": "$v_y$", "vz": "$v_z$"},
        title=title,
        ylabel=f"{what} velocity in the base frame [m/s]",
    )
    fastest = {axis: float(np.abs(recording[f"v{axis}"]).max()) for axis in "xyz"}
    still = [axis for axis, speed in fastest.items() if speed < STILL]
    if len(still) == 2:
        for axis, dashes in zip(still, INTERLEAVED, strict=True):
            figure.axes[0].lines["xyz".index(axis)].set_linestyle(dashes)
        legend_above(figure.axes[0])
        claim(
            figure.axes[0],
            f"$v_{still[0]}$ and $v_{still[1]}$ stay within "
            f"{_power(max(fastest[axis] for axis in still))} m/s of zero",
        )
    return figure


def joint_angles(recording: Recording, title: str, joints: dict[int, str]) -> Figure:
    """Draw joint angles against time, one above the other on one scale (A 13, 14, 15).

    ``joints`` maps the number of a joint, from 1, to its name.
    """
    figure, panels = _joint_panels(recording, title, joints, "rad")
    for axes in panels:
        add_degrees(axes)
    return figure


def joint_strokes(recording: Recording, title: str, joints: dict[int, str]) -> Figure:
    """Draw the positions of sliding joints against time, as ``joint_angles`` draws angles."""
    return _joint_panels(recording, title, joints, "m")[0]


def _joint_panels(
    recording: Recording, title: str, joints: dict[int, str], unit: str
) -> tuple[Figure, list[Axes]]:
    """Put joint positions one above the other; many panels are lower, and named above."""
    few = len(joints) <= FEW
    figure, panels = new_figure(
        title, rows=len(joints), width=PLOT_WIDTH, height=1.2 + (1.55 if few else 1.2) * len(joints)
    )
    span = 1.15 * max([float(np.ptp(recording[f"q{number}"])) for number in joints] + [1e-6])
    for axes, (number, name) in zip(panels, joints.items(), strict=True):
        q, symbol = recording[f"q{number}"], f"$q_{{{number}}}$"
        axes.plot(recording["time"], q, color=BLUE, label=f"{symbol} ({name})")
        middle = (q.min() + q.max()) / 2.0
        axes.set_ylim(middle - span / 2.0, middle + span / 2.0)
        axes.set_ylabel(f"{name} {symbol} [{unit}]" if few else f"{symbol} [{unit}]")
        if not few:
            axes.set_title(name, loc="left", fontsize=9.0, pad=2.0)
    panels[-1].set_xlabel(TIME)
    whole_ticks(panels[-1])
    figure.align_ylabels(panels)
    return figure, panels


def rotation(robot: Robot, recording: Recording, title: str) -> Figure:
    """Draw the rotation of the foot about its axes, in the leg's own Z-X-Z angles (A 16)."""
    R_BF = rotation_matrices(recording.stack("qw", "qx", "qy", "qz"))
    angles = np.unwrap(foot_rotation_angles(LegGeometry.from_robot(robot), R_BF), axis=0)
    labels = ("about Z: $q_1$", "about X", "about Z: $q_2 + q_3$")
    return curves_plot(
        recording["time"],
        {label: angles[:, i] for i, label in enumerate(labels)},
        title=title,
        ylabel="Z-X-Z angle of the foot [rad]",
        degrees=True,
    )


def torques(recording: Recording, title: str, joints: dict[int, str]) -> Figure:
    """Draw the computed torques against time."""
    columns = {f"tau{number}": name for number, name in joints.items()}
    figure = time_plot(recording, columns, title=title, ylabel="computed torque [N m]")
    hidden = torques_away(recording, list(columns))
    if hidden is not None:
        away, near = hidden
        figure.axes[0].set_ylim(-ROOM * away, ROOM * away)
        claim(figure.axes[0], f"cut off: up to {near:.2g} N m near the singularity")
    return figure


def forces(recording: Recording, title: str, joints: dict[int, str]) -> Figure:
    """Draw the computed forces of sliding joints against time."""
    columns = {f"tau{number}": name for number, name in joints.items()}
    return time_plot(recording, columns, title=title, ylabel="computed force [N]")


def singularity(recording: Recording, title: str) -> Figure:
    """Draw the determinant and the smallest singular value of the Jacobian against time.

    A redundant robot has its manipulability in place of the determinant.
    """
    figure, (top, bottom) = new_figure(title, rows=2, width=PLOT_WIDTH, height=5.0)
    header = next(h for h in recording.columns if h.startswith(tuple(SINGULARITY)))
    name, _, unit = header.rstrip("]").partition("[")
    shown = f" [m$^{{{unit.removeprefix('m^')}}}$]" if unit else " [SI units]"
    top.plot(recording["time"], recording[name], color=BLUE)
    top.axhline(0.0, color=GREY, linewidth=1.0)
    top.set(ylabel=SINGULARITY[name] + shown)
    bottom.plot(recording["time"], recording["sigma_min"], color=VERMILLION)
    bottom.axhline(0.0, color=GREY, linewidth=1.0, label="singular")
    bottom.set(xlabel=TIME, ylabel=r"$\sigma_{\min}$ [m]")
    whole_ticks(bottom)
    return figure


def input_and_velocity(recording: Recording, title: str, gain: float) -> Figure:
    """Draw the sine's output and the foot's velocity after a gain (B 10)."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    time = recording["time"]
    axes.plot(time, recording["input"], color=GREY, linewidth=3.5, alpha=0.6, label="input (sine)")
    axes.plot(time, recording["vx"], color=BLUE, label="foot velocity $v_x$")
    axes.set(xlabel=TIME, ylabel="velocity [m/s]")
    if gain != 1.0:
        row = int(np.argmax(recording["vx"]))
        top, bottom = recording["vx"][row], recording["input"][row]
        axes.annotate(
            "",
            (time[row], top),
            xytext=(time[row], bottom),
            arrowprops={"arrowstyle": "->", "color": VERMILLION},
        )
        claim(axes, f"the velocity is {gain:g} times the input")
    whole_ticks(axes)
    widen_flat_axis(axes)
    legend_above(axes)
    return figure


def velocity_and_position(
    recording: Recording, title: str, *, frequency: float | None = None, with_input: bool = False
) -> Figure:
    """Draw velocity and position along x together (B 11; with the input, B 12).

    With the ``frequency`` of the sine [rad/s] the quarter period between the maxima is marked.
    """
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH, height=4.0)
    time = recording["time"]
    if with_input:
        axes.plot(
            time, recording["input"], color=GREY, linewidth=4.0, alpha=0.5, label="input (sine)"
        )
    axes.plot(time, recording["vx"], color=BLUE, label="velocity $v_x$ (left)")
    axes.set(xlabel=TIME, ylabel="velocity [m/s]")
    whole_ticks(axes)
    right = axes.twinx()
    right.plot(time, recording["x"], color=VERMILLION, linestyle="--", label="position x (right)")
    right.set_ylabel("position [m]")
    right.grid(visible=False)
    right.spines["right"].set_visible(True)
    if frequency is not None and time[-1] * frequency > np.pi:
        peaks = np.pi / 2 / frequency, np.pi / frequency
        for twin in (axes, right):
            low, high = twin.get_ylim()
            twin.set_ylim(low, high + 0.14 * (high - low))
        low, high = axes.get_ylim()
        level = high - 0.07 * (high - low)
        for peak in peaks:
            axes.axvline(peak, color=GREY, linestyle=":", linewidth=1.0)
        arrow = {"arrowstyle": "<->", "color": GREY, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (peaks[1], level), xytext=(peaks[0], level), arrowprops=arrow)
        axes.annotate(
            "velocity leads by a quarter period",
            (peaks[1], level),
            xytext=(6, 0),
            textcoords="offset points",
            va="center",
            fontsize=9.5,
            color=GREY,
        )
    legend_above(axes, right)
    return figure


def _power(value: float) -> str:
    """Write a size as a power of ten, rounded up."""
    if value == 0.0:
        return "0"
    return f"$10^{{{math.ceil(math.log10(value))}}}$"


def stroboscope(robot: Robot, recording: Recording, title: str) -> Figure:
    """Draw the links at several instants of the first stroke, from the side and the top (B 6, 7).

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
    lay_out(figure)
    widest = max(max(np.ptp(a.get_xlim()), np.ptp(a.get_ylim())) for a in panels)
    low, high = MaxNLocator(7, steps=[1, 2, 5, 10]).tick_values(0.0, float(widest))[:2]
    for axes in panels:
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MultipleLocator(high - low))
