"""Random configurations of a robot within its limits, and how far its foot can be."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.robot.robot import Robot, Row, Segment


def table_length(rows: Sequence[Row]) -> float:
    """Sum of all d and r of a table [m]; 1 m if there are none."""
    return sum(abs(row.d) + abs(row.r) for row in rows) or 1.0


def ranges(robot: Robot) -> list[tuple[float, float]]:
    """Least and greatest position of every joint [rad or m].

    Its limits; without them a full turn, or twice the table's length.
    """
    length = table_length(robot.rows)
    return [_range(segment, length) for segment in robot.moving]


def _range(segment: Segment, length: float) -> tuple[float, float]:
    lower, upper = segment.mechanics.lower, segment.mechanics.upper
    span = 2.0 * (length if segment.row.joint == "prismatic" else math.pi)
    if lower is None:
        lower = -span / 2.0 if upper is None else upper - span
    return lower, lower + span if upper is None else upper


def random_configurations(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    """Draw configurations of m joints, (count, m) [rad or m], uniform within every range."""
    lower, upper = np.transpose(ranges(robot))
    return rng.uniform(lower, upper, (count, len(lower)))


def greatest_reach(robot: Robot) -> float:
    """How far the foot can be from the base at most [m]: the table's lengths and the strokes."""
    strokes = (
        max(map(abs, bounds))
        for bounds, segment in zip(ranges(robot), robot.moving, strict=True)
        if segment.row.joint == "prismatic"
    )
    return table_length(robot.rows) + sum(strokes)
