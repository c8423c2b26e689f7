"""What a scene has besides the plant: axes, traces and a floor."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from pydrake.geometry import Box
from pydrake.math import RigidTransform

from drake_leg.colours import PURPLE, rgb
from drake_leg.kinematics.khalil import Array
from drake_leg.scene.parts import Part, rod, size_of

RED, GREEN, BLUE = (0.83, 0.15, 0.15), (0.10, 0.60, 0.18), (0.12, 0.33, 0.85)
LINE = (0.66, 0.67, 0.70)
TRACE = rgb(PURPLE)

# Of the scene's size:
TRIAD_LENGTH, TRIAD_RADIUS = 0.14, 0.006
TRACE_RADIUS, TRACE_SPACING = 0.011, 1.0 / 60.0
FLOOR_LINE, FLOOR_SQUARES, FLOOR_GAP = 0.003, 5.0, 0.03
DASH = 3  # pieces of a trace from one dash to the next; the last of them is the gap
MOST_PIECES = 5000  # of a trace before those that lie on others are left out
SLACK = 1e-9  # of a square of the floor: a point on its edge needs no other square
WORLD_TRIAD = 1.5  # of the others: length of the world's axes


def triad_lengths(frames: int, size: float) -> list[float]:
    """Lengths of the axes of each frame [m]; those of the first, the world's, are longer."""
    return [WORLD_TRIAD * TRIAD_LENGTH * size] + [TRIAD_LENGTH * size] * (frames - 1)


def triad_parts(frames: int, size: float) -> tuple[Part, ...]:
    """Draw the axes of the first frames, three parts each: x red, y green, z blue."""
    parts = []
    for index, length in enumerate(triad_lengths(frames, size)):
        radius = (0.8 if index == 0 else 1.0) * TRIAD_RADIUS * size
        for axis, (letter, colour) in enumerate(zip("xyz", (RED, GREEN, BLUE), strict=True)):
            shape, pose = rod(np.zeros(3), length * np.eye(3)[axis], radius)
            parts.append(
                Part(path=f"triad/{letter}", frame=index, shape=shape, X_FP=pose, colour=colour)
            )
    return tuple(parts)


def triad_tips(X_WF: Array, size: float) -> Array:
    """Tips of the axes of frames, p_WT (..., n, 3, 3) [m], from their poses (..., n, 4, 4).

    The last axis but one counts x, y, z.
    """
    lengths = np.array(triad_lengths(X_WF.shape[-3], size))[:, np.newaxis, np.newaxis]
    axes = np.swapaxes(X_WF[..., :3, :3], -1, -2)
    return np.asarray(X_WF[..., np.newaxis, :3, 3] + lengths * axes)


def trace_parts(
    paths: Sequence[Array], size: float, radius: float = TRACE_RADIUS, dash: int = DASH
) -> tuple[Part, ...]:
    """Draw dashes along paths, (rows, 3) each [m]; what lies on earlier pieces is left out.

    They are thicker than the axes of frames: an axis that lies along a path is seen in the gaps.
    The radius is in sizes of the scene; a path without gaps has a ``dash`` of 0.
    """
    radius, parts = radius * size, list[Part]()
    for path in paths:
        for number, (start, end) in enumerate(_pieces(path, TRACE_SPACING * size)):
            if not dash or number % dash < dash - 1:
                shape, pose = rod(start, end, radius)
                parts.append(
                    Part(path=f"trace/{len(parts)}", frame=0, shape=shape, X_FP=pose, colour=TRACE)
                )
    return tuple(parts)


def floor_parts(corners: Array, square: float, line: float) -> tuple[Part, ...]:
    """Draw a grid between corners, as ``floor_corners`` finds them, of lines of a thickness [m]."""
    height = float(corners[0, 2])
    low, high = np.round(corners[:, :2] / square)
    middle, length = (low + high) * square / 2.0, (high - low) * square + line
    parts = []
    for axis in (0, 1):
        bar = Box(length[0], line, line) if axis == 0 else Box(line, length[1], line)
        for number, multiple in enumerate(np.arange(low[1 - axis], high[1 - axis] + 1.0)):
            x, y = (middle[0], multiple * square) if axis == 0 else (multiple * square, middle[1])
            pose = RigidTransform([x, y, height]).GetAsMatrix4()
            path = f"floor/{'xy'[axis]}{number}"
            parts.append(Part(path=path, frame=0, shape=bar, X_FP=pose, colour=LINE))
    return tuple(parts)


def floor_corners(points: Array, square: float) -> Array:
    """Opposite corners of the floor under points, (2, 3) [m]: least x and y, greatest x and y."""
    height = float(points[:, 2].min()) - FLOOR_GAP * size_of(points)
    low = square * np.floor(points[:, :2].min(axis=0) / square + SLACK)
    high = square * np.ceil(points[:, :2].max(axis=0) / square - SLACK)
    return np.array([[*low, height], [*high, height]])


def floor_square(size: float) -> float:
    """Edge of the floor's squares under a scene of a size [m]: 1, 2 or 5 times a power of ten."""
    wanted = size / FLOOR_SQUARES
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1.0 + 1e-9))


def _pieces(path: Array, spacing: float) -> Iterator[tuple[Array, Array]]:
    """Cut a path into pieces of equal length, without those on top of earlier ones."""
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
            yield points[index], points[index + 1]
