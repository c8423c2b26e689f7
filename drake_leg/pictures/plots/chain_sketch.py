"""Any chain with the frames of its table, its bodies and the forces on them, seen at an angle."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drake_leg.colours import PURPLE
from drake_leg.kinematics.khalil import Array, base_transforms, chain_length
from drake_leg.pictures.plots.sketch import AXES, COLOURS, Labels, Line, Sketch
from drake_leg.pictures.plots.style import GREY, INK, new_figure
from drake_leg.robot.robot import Robot, Segment

TRIED = 120  # postures, of which the one is drawn in which most is seen
WIDEST = math.radians(75.0)  # of a joint from the middle of its range
AZIMUTHS = (-65.0, -25.0, 25.0, 65.0)  # [deg], from where it is looked at
ELEVATION = 22.0  # [deg]
SAME = 1e-6  # of the robot's size: points that are no farther apart are one
WIDTH, HIGHEST, LOWEST = 6.8, 5.2, 1.6  # [inch] of a view, or of two
BESIDE = 0.8  # higher than this part of their width, views are side by side
LINE = 0.2  # [inch] of the table
COLUMNS = (("row", 0.0), ("σ", 0.08), ("d [mm]", 0.16), ("α [deg]", 0.31), ("r [mm]", 0.46),
           ("θ [deg]", 0.64), ("drawn at", 0.84))  # fmt: skip


class _Seen(NamedTuple):
    """A posture, and from where it is looked at."""

    q: Array  # [rad or m]
    X_B: Array  # (n + 1, 4, 4), of the base and every row
    right: Array
    up: Array

    def corners(self) -> Array:
        """Where each row's way bends, from x of the frame before to its own z, (n, 3) [m]."""
        start, end, x = self.X_B[:-1, :3, 3], self.X_B[1:, :3, 3], self.X_B[:-1, :3, 0]
        found: Array = start + x * ((end - start) * x).sum(axis=1, keepdims=True)
        return found

    def on_paper(self, p_B: Array) -> Array:
        """Project points [m] onto the paper [mm]."""
        flat: Array = 1e3 * p_B @ np.stack([self.right, self.up], axis=1)
        return flat


def chain(robot: Robot, title: str) -> Figure:
    """Draw a chain twice, with its frames and with its bodies, above its table.

    Posture and side are those, among many that are tried, in which most is seen.
    """
    seen = _best_seen(robot)
    unit = _unit_of(seen)
    low, high = _bounds(seen, 2.1 * unit)
    figure, (frames, bodies, table) = _panels(title, high - low, len(robot.rows))
    for axes in (frames, bodies):
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        axes.set_autoscale_on(False)
    views = [Sketch(axes, seen.right.tolist(), seen.up.tolist(), unit) for axes in (frames, bodies)]
    views[0].heading("frames: x and z of each")
    views[1].heading("bodies: forces on them")
    _table(table, robot, seen.q)
    figure.draw_without_rendering()  # from here on places on paper are known
    _frames(views[0], robot, seen)
    _bodies(views[1], robot, seen)
    return figure


def _panels(title: str, size: Array, rows: int) -> tuple[Figure, list[Axes]]:
    """Put two views side by side or one above the other, and a table below."""
    width, height = size
    beside = height > BESIDE * width
    scale = min((0.5 if beside else 1.0) * WIDTH / width, HIGHEST / height)
    lines = LINE * (rows + 2)
    view = max(height * scale, LOWEST)
    figure, (whole,) = new_figure(title, height=(1 if beside else 2) * view + lines + 1.0)
    whole.remove()
    shares = [view, lines] if beside else [view, view, lines]
    grid = figure.add_gridspec(len(shares), 2 if beside else 1, height_ratios=shares)
    places = [grid[0, 0], grid[0, 1]] if beside else [grid[0, 0], grid[1, 0]]
    return figure, [figure.add_subplot(place) for place in (*places, grid[-1, :])]


def _best_seen(robot: Robot) -> _Seen:
    """Try postures and sides, always the same ones, and take the clearest."""
    random = np.random.default_rng(1).uniform(-1.0, 1.0, (TRIED, len(robot.moving)))
    low, high = np.array([_range(robot, segment) for segment in robot.moving]).T
    postures = (low + high) / 2.0 + random * (high - low) / 2.0
    X_B = base_transforms(robot.rows, postures)
    base = np.broadcast_to(np.eye(4), (TRIED, 1, 4, 4))
    el = math.radians(ELEVATION)
    found = []
    for q, X in zip(postures, np.concatenate([base, X_B], axis=1), strict=True):
        for azimuth in AZIMUTHS:
            c, s = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
            right = np.array([-s, c, 0.0])
            up = np.array([-math.sin(el) * c, -math.sin(el) * s, math.cos(el)])
            found.append(_Seen(q, X, right, up))
    return max(found, key=lambda seen: _clearness(seen, chain_length(robot.rows)))


def _range(robot: Robot, segment: Segment) -> tuple[float, float]:
    """Range in which a joint may be drawn [rad or m]."""
    mechanics, size = segment.mechanics, chain_length(robot.rows)
    turns = segment.row.joint == "revolute"
    low, high = (-WIDEST, WIDEST) if turns else (0.2 * size, 0.5 * size)
    lower = low if mechanics.lower is None else mechanics.lower
    upper = high if mechanics.upper is None else mechanics.upper
    inside = max(low, lower), min(high, upper)
    if inside[0] < inside[1]:
        return inside
    if mechanics.upper is None:
        return lower, lower + high - low
    return (upper - high + low, upper) if mechanics.lower is None else (lower, upper)


def _clearness(seen: _Seen, size: float) -> float:
    """Rate how well places can be told apart, and how well axes are seen."""
    origins = seen.X_B[:, :3, 3]
    flat = seen.on_paper(origins)
    first, second = np.triu_indices(len(origins), 1)
    apart = np.linalg.norm(origins[first] - origins[second], axis=1) > SAME * size
    gaps = np.linalg.norm(flat[first] - flat[second], axis=1)[apart]
    extent = float(np.ptp(flat, axis=0).max()) or 1.0
    towards = np.abs(seen.X_B[1:, :3, 2] @ np.cross(seen.right, seen.up))
    spread = float(np.ptp(flat, axis=0).min()) / extent
    nearest = float(gaps.min()) / extent if len(gaps) else 1.0
    return 2.0 * nearest - float(towards.max()) + 0.7 * spread


def _unit_of(seen: _Seen) -> float:
    """Length of an axis on paper [mm]."""
    flat = seen.on_paper(np.concatenate([seen.X_B[:, :3, 3], seen.corners()]))
    extent = float(np.ptp(flat, axis=0).max()) or 100.0
    return extent / (7.0 + 0.25 * len(seen.X_B))


def _bounds(seen: _Seen, margin: float) -> tuple[Array, Array]:
    flat = seen.on_paper(np.concatenate([seen.X_B[:, :3, 3], seen.corners()]))
    low, high = flat.min(axis=0) - margin, flat.max(axis=0) + margin
    missing = np.maximum(np.array([0.0, 3.0 * margin]) - (high - low), 0.0) / 2.0
    return low - missing, high + missing


def _links(sketch: Sketch, seen: _Seen, width: float) -> list[Line]:
    """Draw every row's way: along x of the frame before, then along its own z."""
    drawn = []
    origins = seen.X_B[:, :3, 3]
    for start, corner, end in zip(origins[:-1], seen.corners(), origins[1:], strict=True):
        for a, b in ((start, corner), (corner, end)):
            pair = sketch.at(a), sketch.at(b)
            if math.dist(*pair) > 1e-3 * sketch.unit:
                sketch.link(*pair, width=width)
                drawn.append((*pair, width))
    return drawn


def _joints(sketch: Sketch, robot: Robot, seen: _Seen) -> list[Line]:
    drawn = []
    for segment, X in zip(robot.segments, seen.X_B[1:], strict=True):
        if segment.row.joint == "fixed":
            continue
        x, y, _ = sketch.view @ X[:3, 2]
        draw = sketch.hinge if segment.row.joint == "revolute" else sketch.slider
        along, at = (float(x), float(y)), sketch.at(X[:3, 3])
        draw(at, along)
        half = 0.28 * sketch.unit
        ends = [
            (at[0] + side * half * along[0], at[1] + side * half * along[1]) for side in (-1, 1)
        ]
        drawn.append((ends[0], ends[1], 11.0))
    return drawn


def _frames(sketch: Sketch, robot: Robot, seen: _Seen) -> None:
    lines = _links(sketch, seen, 5.0) + _joints(sketch, robot, seen)
    named = []
    origins = seen.X_B[:, :3, 3]
    for index, X in enumerate(seen.X_B):
        together = int((np.linalg.norm(origins[:index] - X[:3, 3], axis=1) < 1e-9).sum())
        length = sketch.unit * (1.0 + 0.4 * together)
        at = sketch.at(X[:3, 3])
        for axis in "xyz" if index == 0 else "xz":
            column = AXES.index(axis)
            dx, dy, _ = sketch.view @ X[:3, column]
            end = (at[0] + length * float(dx), at[1] + length * float(dy))
            sketch.arrow(at, end, COLOURS[column], width=1.6)
            lines.append((at, end, 2.0))
            named.append((end, f"${axis}_{{{index}}}$", COLOURS[column], (float(dx), float(dy))))
    labels = Labels(sketch.axes, lines)
    for end, text, colour, away in named:
        labels.place(end, text, colour, away=away)
    moving = [i for i, s in enumerate(robot.segments, 1) if s.row.joint != "fixed"]
    for number, index in enumerate(moving, start=1):
        labels.place(sketch.at(origins[index]), f"$q_{{{number}}}$")


def _bodies(sketch: Sketch, robot: Robot, seen: _Seen) -> None:
    lines = _links(sketch, seen, 9.0) + _joints(sketch, robot, seen)
    base = sketch.at(seen.X_B[0][:3, 3])
    pulls = [((base[0] - 0.7 * sketch.unit, base[1] + 1.4 * sketch.unit), "$R$")]
    starts = [base]
    for number, segment in enumerate(robot.segments, start=1):
        link = segment.link
        if link is not None and (link.solid or link.inertial):
            X = seen.X_B[number]
            at = sketch.at((X @ [*link.centre_of_mass, 1.0])[:3])
            starts.append(at)
            pulls.append(((at[0], at[1] - 1.3 * sketch.unit), f"$m_{{{number}}}\\,g$"))
    for start, (end, _) in zip(starts, pulls, strict=True):
        sketch.arrow(start, end, PURPLE, width=2.0)
        lines.append((start, end, 2.0))
    labels = Labels(sketch.axes, lines)
    for start, (end, text) in zip(starts, pulls, strict=True):
        labels.place(end, text, PURPLE, away=(0.0, end[1] - start[1]))
    for segment, X in zip(robot.segments, seen.X_B[1:], strict=True):
        if segment.row.joint != "fixed":
            labels.place(sketch.at(X[:3, 3]), str(segment.joint), GREY, size=9.0)
    labels.place(sketch.at(seen.X_B[-1][:3, 3]), "foot", GREY, size=9.0)


def _table(axes: Axes, robot: Robot, q: Array) -> None:
    """Write the Khalil table, and where the joints are drawn."""
    axes.axis("off")
    count = len(robot.rows) + 1
    axes.set(xlim=(0.0, 1.0), ylim=(-count, 0.5))
    for name, x in COLUMNS:
        axes.text(x, -0.3, name, fontsize=9.5, color=GREY)
    joint = 0
    for place, row in enumerate(robot.rows, start=1):
        joint += row.joint != "fixed"
        there = ""
        r, theta = _number(1e3 * row.r), _number(math.degrees(row.theta))
        if row.joint == "prismatic":
            r = _added(f"$q_{{{joint}}}$", row.r, r)
            there = f"{round(1e3 * q[joint - 1])} mm"
        elif row.joint == "revolute":
            theta = _added(f"$q_{{{joint}}}$", row.theta, theta)
            there = f"{_number(round(math.degrees(q[joint - 1])))}°"
        sigma = "~" if row.sigma is None else str(row.sigma)
        d, alpha = _number(1e3 * row.d), _number(math.degrees(row.alpha))
        for (_, x), text in zip(
            COLUMNS, (str(place), sigma, d, alpha, r, theta, there), strict=True
        ):
            axes.text(x, -0.3 - place, text, fontsize=9.5, color=INK)


def _number(value: float) -> str:
    return f"{round(value, 3) + 0.0:g}".replace("-", "\N{MINUS SIGN}")


def _added(joint: str, value: float, text: str) -> str:
    return (
        joint
        if value == 0.0
        else f"{joint} + {text}".replace("+ \N{MINUS SIGN}", "\N{MINUS SIGN} ")
    )
