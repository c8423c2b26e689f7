"""What helps to read a scene: axes of frames, the trace of the tip, a floor."""

from __future__ import annotations

import math

import numpy as np

from drake_leg.colours import PURPLE, rgb
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Brick, Robot
from drake_leg.scene.parts import Part, placed, rod, size_of

RED, GREEN, BLUE = (0.83, 0.15, 0.15), (0.10, 0.60, 0.18), (0.12, 0.33, 0.85)
LINE = (0.66, 0.67, 0.70)
TRACE = rgb(PURPLE)

# Of the scene's size:
TRIAD_LENGTH, TRIAD_RADIUS = 0.14, 0.006
TRACE_RADIUS, TRACE_SPACING = 0.011, 1.0 / 60.0
FLOOR_LINE, FLOOR_SQUARES, FLOOR_GAP = 0.003, 5.0, 0.03

SLACK = 1e-9  # of a square of the floor: what stands on its edge needs no other square

BASE_TRIAD = 1.5  # of the others: length of the base's axes
DASH = 3  # pieces of a trace from one dash to the next; the last of them is the gap
MOST_PIECES = 5000  # of a trace before those that lie on others are left out


def triad_parts(robot: Robot, size: float) -> tuple[Part, ...]:
    """Axes of all frames of the table: x red, y green, z blue; those of the base are longer.

    Parameters
    ----------
    size : float
        Of the scene [m].

    Returns
    -------
    tuple of Part
        Three a frame, from the base to the tip.
    """
    parts = []
    for index, length in enumerate(triad_lengths(robot, size)):
        radius = (0.8 if index == 0 else 1.0) * TRIAD_RADIUS * size
        for axis, (letter, colour) in enumerate(zip("xyz", (RED, GREEN, BLUE), strict=True)):
            shape, pose = rod(np.zeros(3), length * np.eye(3)[axis], radius)
            parts.append(
                Part(path=f"triad/{letter}", frame=index, shape=shape, X_FP=pose, colour=colour)
            )
    return tuple(parts)


def triad_tips(robot: Robot, X_BF: Array, size: float) -> Array:
    """Where the axes of all frames end.

    Parameters
    ----------
    X_BF : (..., n + 1, 4, 4) ndarray
        Poses of its frames.
    size : float
        Of the scene [m].

    Returns
    -------
    p_BT : (..., n + 1, 3, 3) ndarray
        The last axis but one counts x, y, z [m].
    """
    lengths = np.array(triad_lengths(robot, size))[:, np.newaxis, np.newaxis]
    axes = np.swapaxes(X_BF[..., :3, :3], -1, -2)
    return np.asarray(X_BF[..., np.newaxis, :3, 3] + lengths * axes)


def triad_lengths(robot: Robot, size: float) -> list[float]:
    """How long the axes of each frame are.

    Parameters
    ----------
    size : float
        Of the scene [m].

    Returns
    -------
    (n + 1,) list of float
        From the base to the tip [m].
    """
    return [BASE_TRIAD * TRIAD_LENGTH * size] + [TRIAD_LENGTH * size] * len(robot.rows)


def trace_parts(path: Array, size: float) -> tuple[Part, ...]:
    """Dashes along the way of the tip; what lies on earlier pieces is left out.

    They are thicker than the axes of frames: an axis that lies along the way is seen in the gaps.

    Parameters
    ----------
    path : (rows, 3) ndarray
        In the base frame [m].
    size : float
        Of the scene [m].

    Returns
    -------
    tuple of Part
        Empty where the tip does not move.
    """
    pieces = _pieces(path, TRACE_SPACING * size)
    return tuple(
        trace_piece(number, start, end, size)
        for number, (start, end) in enumerate(pieces)
        if number % DASH < DASH - 1
    )


def trace_piece(number: int, start: Array, end: Array, size: float) -> Part:
    """One piece of a trace.

    Parameters
    ----------
    number : int
        Tells it from the others.
    start, end : (3,) ndarray
        In the base frame, apart from each other [m].
    size : float
        Of the scene [m].
    """
    shape, pose = rod(start, end, TRACE_RADIUS * size)
    return Part(path=f"trace/{number}", frame=0, shape=shape, X_FP=pose, colour=TRACE)


def floor_parts(points: Array, square: float | None = None) -> tuple[Part, ...]:
    """A grid just under the scene; its squares measure 1, 2 or 5 times a power of ten.

    Parameters
    ----------
    points : (n, 3) ndarray
        What stands on it [m].
    square : float, optional
        Edge of its squares; by default as ``floor_square`` has it [m].

    Returns
    -------
    tuple of Part
        Lines along x and along y.
    """
    size = size_of(points)
    square = floor_square(size) if square is None else square
    line = FLOOR_LINE * size
    corners = floor_corners(points, square)
    height = float(corners[0, 2])
    low, high = np.round(corners[:, :2] / square)
    middle, length = (low + high) * square / 2.0, (high - low) * square + line
    parts = []
    for axis in (0, 1):
        sides = (length[0], line) if axis == 0 else (line, length[1])
        bar = Brick(length=sides[0], width=sides[1], height=line)
        for number, multiple in enumerate(np.arange(low[1 - axis], high[1 - axis] + 1.0)):
            x, y = (middle[0], multiple * square) if axis == 0 else (multiple * square, middle[1])
            parts.append(
                Part(
                    path=f"floor/{'xy'[axis]}{number}",
                    frame=0,
                    shape=bar,
                    X_FP=placed(x, y, height),
                    colour=LINE,
                )
            )
    return tuple(parts)


def floor_corners(points: Array, square: float | None = None) -> Array:
    """Opposite corners of the floor.

    Parameters
    ----------
    points : (n, 3) ndarray
        What stands on it [m].
    square : float, optional
        Edge of its squares; by default as ``floor_square`` has it [m].

    Returns
    -------
    (2, 3) ndarray
        Least x and y, greatest x and y, in one height [m].
    """
    size = size_of(points)
    square = floor_square(size) if square is None else square
    height = float(points[:, 2].min()) - FLOOR_GAP * size
    low = square * np.floor(points[:, :2].min(axis=0) / square + SLACK)
    high = square * np.ceil(points[:, :2].max(axis=0) / square - SLACK)
    return np.array([[*low, height], [*high, height]])


def floor_square(size: float) -> float:
    """Edge of the floor's squares.

    Parameters
    ----------
    size : float
        Of the scene [m].

    Returns
    -------
    float
        [m].
    """
    wanted = size / FLOOR_SQUARES
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1.0 + 1e-9))


def _pieces(path: Array, spacing: float) -> list[tuple[Array, Array]]:
    """Cut a way into pieces of equal length, without those on top of earlier ones."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(lengths)])
    count = min(math.ceil(way[-1] / spacing - 1e-9), MOST_PIECES)
    marks = np.linspace(0.0, way[-1], count + 1)
    points = np.column_stack([np.interp(marks, way, column) for column in path.T])
    middles = (points[1:] + points[:-1]) / 2.0
    kept: list[int] = []
    for index, middle in enumerate(middles):
        apart = np.linalg.norm(middles[kept] - middle, axis=1)
        if not kept or apart.min() > 0.6 * spacing:
            kept.append(index)
    return [(points[index], points[index + 1]) for index in kept]
