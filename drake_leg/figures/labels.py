"""Labels beside what they name, each where it hides nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from drake_leg.figures.style import GREY, INK
from drake_leg.kinematics.batches import Array

Point = tuple[float, float]
Line = tuple[Point, Point, float]

TURNS = 24  # directions in which a place is looked for
RINGS = (0.0, 6.0, 14.0, 24.0, 36.0, 50.0, 70.0, 95.0)  # [pt] from what is named to its label
LED = 20.0  # [pt], farther than which a thin line leads to a label
SPARE = 2.0  # [px] around a label
SPACING = 5.0  # [px] of the points that stand for a line
THIN = 4.0  # [pt], up to which a line has no sides


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
        best, lowest = anchor, math.inf
        for ring in RINGS:
            for turn in range(TURNS):
                angle = 2.0 * math.pi * turn / TURNS
                out = np.array([math.cos(angle), math.sin(angle)])
                centre = anchor + (pixels * ring + half @ np.abs(out)) * out
                cost = self._cost(centre, half) + 0.06 * ring - 0.5 * float(out @ _unit(away))
                if cost < lowest:
                    best, lowest = centre, cost
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

    def _cost(self, centre: Array, half: Array) -> float:
        """Count what a label would hide, and whether it would leave the axes."""
        low, high = centre - half, centre + half
        box = self._axes.bbox
        outside = low[0] < box.x0 or low[1] < box.y0 or high[0] > box.x1 or high[1] > box.y1
        hidden = sum(
            min(high[0], x1) > max(low[0], x0) and min(high[1], y1) > max(low[1], y0)
            for x0, y0, x1, y1 in self._boxes
        )
        crossed = ((self._drawn > low) & (self._drawn < high)).all(axis=1).sum()
        return float(100.0 * (hidden + outside) + 0.8 * crossed)


def _unit(vector: Point) -> Array:
    length = math.hypot(*vector)
    return np.array(vector) / length if length > 0.0 else np.zeros(2)
