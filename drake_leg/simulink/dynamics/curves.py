"""Curves through points, as a Spline block has them: cubic, with the chords as parameter."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, invalid_parameter
from drake_leg.simulink.multibody.mass import Array

CLOSED, OPEN = ("Closed", "Periodic"), ("Open", "Natural")  # ends, as files write them
SAMPLES = 40  # of each piece, of which the nearest one begins Newton's search
STEPS = 8


class Curve:
    """A cubic spline through points (n, 3) [m]; its parameter is the length of the chords."""

    def __init__(self, points: Array, *, closed: bool) -> None:
        from scipy.interpolate import CubicSpline  # takes a while to load, and few models need it

        if closed and not np.allclose(points[0], points[-1], rtol=0.0, atol=1e-12):
            points = np.vstack([points, points[:1]])
        elif closed:
            points = np.vstack([points[:-1], points[:1]])
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        if len(points) < 2 + closed or not chords.min(initial=np.inf) > 0.0:
            raise InvalidValueError(
                "it has too few points, or two equal ones after each other: give at least "
                f"{2 + closed} different points"
            )
        knots = np.concatenate([[0.0], np.cumsum(chords)])
        spline = CubicSpline(knots, points, bc_type="periodic" if closed else "natural")
        self._knots, self._pieces = knots.tolist(), [*spline.c.transpose(1, 0, 2)]
        self._closed, self.length = closed, float(knots[-1])
        self._at = np.linspace(0.0, self.length, SAMPLES * (len(points) - 1) + 1)
        self._samples = spline(self._at)

    def at(self, s: float) -> tuple[Array, Array, Array]:
        """Return the point at a parameter [m], and its two derivatives by the parameter."""
        place = min(max(bisect_right(self._knots, s) - 1, 0), len(self._pieces) - 1)
        a, b, c, d = self._pieces[place]
        h = s - self._knots[place]
        return ((a * h + b) * h + c) * h + d, (3.0 * a * h + 2.0 * b) * h + c, 6.0 * a * h + 2.0 * b

    def nearest(self, point: Array) -> float:
        """Return the parameter of the point of the curve that is nearest to a point (3,)."""
        apart = self._samples - point
        s = float(self._at[(apart * apart).sum(axis=1).argmin()])
        for _ in range(STEPS):
            on, first, second = self.at(s)
            off = on - point
            slope = float(first @ first)
            bend = slope + float(off @ second)
            step = -float(off @ first) / (bend if bend > 0.0 else slope)
            s = (s + step) % self.length if self._closed else min(max(s + step, 0.0), self.length)
            if abs(step) < 1e-13 * self.length:
                break
        return s


def curve_of(block: Block) -> Curve:
    """Read a Spline block.

    Raises
    ------
    InvalidValueError
        If its points are no curve, or its ends are of no kind that is known.
    """
    points = np.array(block.parameters.get("DataPoints", ()), dtype=float)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise invalid_parameter(block, "DataPoints", "it must be points, n x 2 or n x 3")
    ends = block.parameters.get("EndConditionType")
    if ends not in (*CLOSED, *OPEN):
        raise invalid_parameter(block, "EndConditionType", f"it must be {CLOSED[0]} or {OPEN[0]}")
    in_space = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    try:
        return Curve(in_space, closed=ends in CLOSED)
    except InvalidValueError as error:
        raise InvalidValueError(f"the block {block.name!r} (SID {block.sid}): {error}") from None
