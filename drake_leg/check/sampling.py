"""Random configurations of a robot within its limits, and its size."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot, Row, Segment


def table_length(rows: Sequence[Row]) -> float:
    """Length of a chain's table, all d and r together.

    Returns
    -------
    float
        [m]; 1 m for a chain without lengths.
    """
    return sum(abs(row.d) + abs(row.r) for row in rows) or 1.0


def ranges(robot: Robot) -> list[tuple[float, float]]:
    """Range of every joint: its limits, or a full turn, or twice the table's length.

    Parameters
    ----------
    robot : Robot
        Of which m rows move.

    Returns
    -------
    list of (float, float)
        Least and greatest position of the m joints [rad or m].
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
    """Draw configurations, uniform within every joint's range.

    Parameters
    ----------
    robot : Robot
        Of which m rows move.

    Returns
    -------
    (count, m) ndarray
        [rad or m].
    """
    lower, upper = np.transpose(ranges(robot))
    return rng.uniform(lower, upper, (count, len(lower)))


def chain_size(robot: Robot) -> float:
    """How far the foot can be from the base at most.

    Returns
    -------
    float
        Length of the table and of the sliding joints' greatest positions [m].
    """
    strokes = (
        max(map(abs, bounds))
        for bounds, segment in zip(ranges(robot), robot.moving, strict=True)
        if segment.row.joint == "prismatic"
    )
    return table_length(robot.rows) + sum(strokes)
