"""Sketches of mechanisms: links, joints, frames, dimensions, forces, labels."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle, FancyArrowPatch
from numpy.typing import NDArray

from drake_leg.colours import BLUE, GREEN, PURPLE, VERMILLION
from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.plots.style import BODY, GREY, INK

Point = tuple[float, float]
Line = tuple[Point, Point, float]

TURNS = 24  # directions in which a place is searched
ANGLES = 2.0 * math.pi * np.arange(TURNS) / TURNS  # [rad]
RINGS = (0.0, 6.0, 14.0, 24.0, 36.0, 50.0, 70.0, 95.0)  # [pt] from what is named to its label
LED = 20.0  # [pt], farther than which a thin line leads to a label
SPARE = 2.0  # [px] around a label
SPACING = 5.0  # [px] of the points that stand for a line
THIN = 4.0  # [pt], up to which a line has no sides
AXES = ("x", "y", "z")
COLOURS = (VERMILLION, GREEN, BLUE)  # of the axes x, y, z
FACING = 0.98  # cosine from which on an axis is seen end on


class Labels:
    """Places labels on axes whose limits and layout are fixed.

    They avoid ``lines``: (start, end, width), places in the axes' data, and points.
    """

    def __init__(self, axes: Axes, lines: Sequence[Line]) -> None:
        self._axes = axes
        self._drawn: Array = np.concatenate([self._points(*line) for line in lines])
        self._boxes: list[tuple[float, float, float, float]] = []

    def place(
        self,
        at: Point,
        text: str,
        colour: str = INK,
        *,
        away: Point = (0.0, 0.0),
        size: float = 10.0,
    ) -> None:
        """Write a label near a point of the data, in the direction ``away`` if there is room."""
        figure = self._axes.figure
        pixels = figure.dpi / 72.0
        label = self._axes.text(
            *at, text, color=colour, fontsize=size, ha="center", va="center", zorder=5
        )
        label.set_in_layout(False)
        extent = label.get_window_extent()
        half = np.array([extent.width, extent.height]) / 2.0 + SPARE
        anchor = self._axes.transData.transform(at)
        rings = np.array(RINGS)[:, np.newaxis]
        out = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
        far = pixels * rings + np.abs(out) @ half
        centres = (anchor + far[..., np.newaxis] * out).reshape(-1, 2)
        price = 0.06 * rings - 0.5 * (out @ _unit(away))
        best = centres[(self._costs(centres, half) + price.reshape(-1)).argmin()]
        self._boxes.append((*(best - half), *(best + half)))
        x, y = self._axes.transData.inverted().transform(best).tolist()
        label.set_position((x, y))
        nearest = np.clip(anchor, best - half, best + half)
        if np.linalg.norm(nearest - anchor) > LED * pixels:
            end = self._axes.transData.inverted().transform(nearest)
            self._axes.plot(*zip(at, end, strict=True), color=GREY, linewidth=0.5, zorder=4)

    def _points(self, start: Point, end: Point, width: float) -> Array:
        """Pixels along a line, on both of its sides if it is thick."""
        a, b = self._axes.transData.transform([start, end])
        count = 2 + int(np.linalg.norm(b - a) / SPACING)
        along: Array = a + np.linspace(0.0, 1.0, count)[:, np.newaxis] * (b - a)
        if width <= THIN:
            return along
        dx, dy = _unit((b - a).tolist())
        aside = 0.5 * width * self._axes.figure.dpi / 72.0 * np.array([-dy, dx])
        return np.concatenate([along - aside, along, along + aside])

    def _costs(self, centres: Array, half: Array) -> Array:
        """Count what a label at each place (k, 2) would hide, and whether it would leave, (k,)."""
        low, high = centres - half, centres + half
        box = self._axes.bbox
        outside = (low < box.min).any(axis=1) | (high > box.max).any(axis=1)
        boxes = np.array(self._boxes).reshape(-1, 4)
        hidden = _overlap(low, high, boxes[:, :2], boxes[:, 2:]).sum(axis=1)
        crossed = _overlap(low, high, self._drawn, self._drawn).sum(axis=1)
        found: Array = 100.0 * (hidden + outside) + 0.8 * crossed
        return found


def _overlap(low: Array, high: Array, start: Array, end: Array) -> NDArray[np.bool_]:
    """Whether boxes (k, 2) share points with others (n, 2), (k, n); corners are low and high."""
    x = (high[:, :1] > start[:, 0]) & (low[:, :1] < end[:, 0])
    y = (high[:, 1:] > start[:, 1]) & (low[:, 1:] < end[:, 1])
    found: NDArray[np.bool_] = x & y
    return found


def _unit(vector: Point) -> Array:
    length = math.hypot(*vector)
    return np.array(vector) / length if length > 0.0 else np.zeros(2)


class Sketch:
    """A view of a mechanism along one direction; lengths in mm.

    ``right`` and ``up`` (3,) are the base frame's directions to the right and upwards on paper:
    unit vectors, at a right angle. ``unit`` is the length of a frame's axes [mm]; everything
    else is drawn in proportion.
    """

    def __init__(
        self, axes: Axes, right: Sequence[float], up: Sequence[float], unit: float
    ) -> None:
        self.axes, self.unit = axes, unit
        self.view = np.array([right, up, np.cross(right, up)])
        axes.set_aspect("equal")
        axes.axis("off")
        axes.margins(0.06)

    def at(self, p_B: Array) -> Point:
        """Project a point of the base frame [m] onto the paper [mm]."""
        x, y, _ = 1e3 * (self.view @ p_B)
        return float(x), float(y)

    def text(self, at: Point, label: str, colour: str = INK, size: float = 10.0) -> None:
        """Write a label, centered."""
        self.axes.text(*at, label, color=colour, fontsize=size, ha="center", va="center", zorder=5)
        half = 0.25 * self.unit
        self.axes.update_datalim([(at[0] - half, at[1] - half), (at[0] + half, at[1] + half)])

    def link(self, start: Point, end: Point, width: float = 9.0) -> None:
        """Draw a body from joint to joint; its width is in points."""
        for colour, points, order in ((GREY, width + 1.6, 1.0), (BODY, width, 1.1)):
            self.axes.plot(
                *zip(start, end, strict=True),
                color=colour,
                linewidth=points,
                solid_capstyle="round",
                zorder=order,
            )

    def joint(self, at: Point) -> None:
        """Draw a revolute joint whose axis is seen end on."""
        radius = 0.13 * self.unit
        self.axes.add_patch(Circle(at, radius, facecolor="white", edgecolor=INK, zorder=2))

    def hinge(self, at: Point, along: Point) -> None:
        """Draw a revolute joint whose axis lies in the paper."""
        (x, y), (dx, dy) = at, along
        half = 0.28 * self.unit
        ends = [(x - half * dx, y - half * dy), (x + half * dx, y + half * dy)]
        for colour, points, order in ((INK, 11.0, 2.0), ("white", 8.5, 2.1)):
            self.axes.plot(
                *zip(*ends, strict=True),
                color=colour,
                linewidth=points,
                solid_capstyle="butt",
                zorder=order,
            )

    def slider(self, at: Point, along: Point) -> None:
        """Draw a prismatic joint: a block on its axis, which lies in the paper."""
        (x, y), (dx, dy) = at, along
        for half, colour, points, order in (
            (0.6, INK, 1.2, 1.9),
            (0.28, INK, 13.0, 2.0),
            (0.25, BODY, 10.5, 2.1),
        ):
            ends = [
                (x + side * half * self.unit * dx, y + side * half * self.unit * dy)
                for side in (-1, 1)
            ]
            self.axes.plot(
                *zip(*ends, strict=True),
                color=colour,
                linewidth=points,
                solid_capstyle="butt",
                zorder=order,
            )

    def ground(self, at: Point, half: float) -> None:
        """Draw what does not move: a hatched line."""
        x, y = at
        self.axes.plot([x - half, x + half], [y, y], color=INK, linewidth=1.4, zorder=0.5)
        count = max(2, round(2 * half / (0.35 * self.unit)))
        step = 2 * half / count
        for k in range(1, count + 1):
            start = x - half + k * step
            self.axes.plot([start, start - step], [y, y - step], color=GREY, linewidth=0.8)

    def frame(
        self,
        X_B: Array,
        index: int,
        names: str = "xyz",
        *,
        scale: float = 1.0,
        moved: Mapping[str, Point] = MappingProxyType({}),
    ) -> None:
        """Draw a frame: axes in the paper as arrows, those end on as a dot or a cross.

        ``X_B`` (4, 4) is the frame's pose in the base [-, m], ``names`` are the axes to be drawn,
        ``scale`` is their length in units. ``moved`` places an axis's label from the arrow's tip
        or, for an axis end on, from the origin, in units; others are beside x, beyond y and z,
        and opposite to both arrows.
        """
        origin = self.at(X_B[:3, 3])
        seen = self.view @ X_B[:3, :3]
        for column, (name, colour) in enumerate(zip(AXES, COLOURS, strict=True)):
            if name not in names:
                continue
            x, y, towards = seen[:, column]
            if abs(towards) > FACING:
                self._end_on(origin, towards > 0.0, colour)
                tip = origin
                away = -seen[:2].sum(axis=1)
                place = 0.3 * away
            else:
                tip = (origin[0] + scale * self.unit * x, origin[1] + scale * self.unit * y)
                self.arrow(origin, tip, colour, width=1.8)
                place = 0.3 * np.array([y, -x] if name == "x" else [x, y])
            dx, dy = moved.get(name, place)
            self.text(
                (tip[0] + dx * self.unit, tip[1] + dy * self.unit), f"${name}_{index}$", colour
            )

    def _end_on(self, at: Point, towards: bool, colour: str) -> None:
        radius = 0.13 * self.unit
        self.axes.add_patch(
            Circle(at, radius, facecolor="white", edgecolor=colour, linewidth=1.5, zorder=4)
        )
        if towards:
            self.axes.add_patch(Circle(at, radius / 3, color=colour, zorder=4.1))
            return
        part = radius / math.sqrt(2)
        for sign in (1, -1):
            xs, ys = (at[0] - part, at[0] + part), (at[1] - sign * part, at[1] + sign * part)
            self.axes.plot(xs, ys, color=colour, linewidth=1.5, zorder=4.1)

    def arrow(self, start: Point, end: Point, colour: str = INK, width: float = 1.2) -> None:
        """Draw an arrow."""
        self.axes.update_datalim([start, end])
        self._arrow(start, end, colour, "-|>", width)

    def _arrow(self, start: Point, end: Point, colour: str, style: str, width: float) -> None:
        self.axes.add_patch(
            FancyArrowPatch(
                start,
                end,
                arrowstyle=style,
                mutation_scale=9.0,
                shrinkA=0.0,
                shrinkB=0.0,
                color=colour,
                linewidth=width,
                zorder=3,
            )
        )

    def force(self, at: Point, towards: Point, label: str, place: Point) -> None:
        """Draw a force that acts at a point; ``towards`` and ``place`` are in units."""
        tip = (at[0] + towards[0] * self.unit, at[1] + towards[1] * self.unit)
        self.arrow(at, tip, PURPLE, width=2.0)
        self.text((tip[0] + place[0] * self.unit, tip[1] + place[1] * self.unit), label, PURPLE)

    def dimension(self, start: Point, end: Point, label: str, off: float) -> None:
        """Draw a length between two points [mm], ``off`` units to the left of their direction."""
        dx, dy = end[0] - start[0], end[1] - start[1]
        size = math.hypot(dx, dy)
        nx, ny = -dy / size * off * self.unit, dx / size * off * self.unit
        a, b = (start[0] + nx, start[1] + ny), (end[0] + nx, end[1] + ny)
        for point, moved in ((start, a), (end, b)):
            self.axes.plot(*zip(point, moved, strict=True), color=GREY, linewidth=0.7, zorder=0.6)
        self._arrow(a, b, GREY, "<|-|>", 0.9)
        self.axes.text(
            (a[0] + b[0]) / 2,
            (a[1] + b[1]) / 2,
            label,
            color=INK,
            fontsize=10.0,
            ha="center",
            va="center",
            zorder=5,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )

    def angle(
        self,
        at: Point,
        first: float,
        second: float,
        label: str,
        size: float,
        *,
        colour: str = INK,
    ) -> None:
        """Draw the arc from one direction to another [deg], with an arrow at its end.

        Directions are counted counter-clockwise from the right; ``size`` is the radius in units.
        """
        radius = size * self.unit
        low, high = sorted((first, second))
        self.axes.add_patch(
            Arc(at, 2 * radius, 2 * radius, theta1=low, theta2=high, color=colour, linewidth=1.1)
        )
        sense = math.copysign(min(10.0, abs(second - first) / 2), second - first)
        ends = [polar(at, angle, radius) for angle in (second - sense, second)]
        self._arrow(ends[0], ends[1], colour, "-|>", 1.1)
        self.text(polar(at, (first + second) / 2, radius + 0.28 * self.unit), label, colour)

    def torque(self, at: Point, first: float, second: float, label: str, size: float) -> None:
        """Draw a torque about an axis seen end on, as ``angle`` draws an angle."""
        self.angle(at, first, second, label, size, colour=PURPLE)

    def dashed(self, start: Point, end: Point) -> None:
        """Draw a line from which an angle is counted."""
        self.axes.plot(
            *zip(start, end, strict=True),
            color=GREY,
            linewidth=0.9,
            linestyle=(0, (4, 3)),
            zorder=0.7,
        )

    def gravity(self, at: Point) -> None:
        """Draw the direction of gravity."""
        self.arrow(at, (at[0], at[1] - 0.9 * self.unit), GREY, width=1.6)
        self.text((at[0] + 0.25 * self.unit, at[1] - 0.45 * self.unit), "$g$", GREY)

    def heading(self, text: str) -> None:
        """Say from where it is seen; to be called when all is drawn."""
        self.axes.set_title(text, fontsize=10.0, color=GREY, loc="left")
        self.axes.autoscale_view()


def polar(at: Point, angle: float, length: float) -> Point:
    """Return the point at a distance from another, in a direction [deg]."""
    return (
        at[0] + length * math.cos(math.radians(angle)),
        at[1] + length * math.sin(math.radians(angle)),
    )


def direction(sketch: Sketch, X_B: Array, axis: int = 0) -> float:
    """Direction of a frame's axis on paper [deg], in -180 ... 180."""
    x, y, _ = sketch.view @ X_B[:3, axis]
    return math.degrees(math.atan2(y, x))
