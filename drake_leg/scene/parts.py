"""The solids that a scene consists of: links, axes, traces and a floor, on the frames of a plant.

Every way of showing a plant, in a browser, by VTK or by matplotlib, shows these parts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from pydrake.geometry import Box, CalcObb, Cylinder, Shape, Sphere

from drake_leg.colours import PURPLE, Colour, rgb
from drake_leg.kinematics.khalil import Array

RED, GREEN, BLUE = (0.83, 0.15, 0.15), (0.10, 0.60, 0.18), (0.12, 0.33, 0.85)
LINE = (0.66, 0.67, 0.70)
TRACE = rgb(PURPLE)

LEAST_SIZE = 1e-3  # [m], of a scene

# Of the scene's size:
TRIAD_LENGTH, TRIAD_RADIUS = 0.14, 0.006
TRACE_RADIUS, TRACE_SPACING = 0.011, 1.0 / 60.0
FLOOR_LINE, FLOOR_SQUARES, FLOOR_GAP = 0.003, 5.0, 0.03

SLACK = 1e-9  # of a square of the floor: a point on its edge needs no other square

WORLD_TRIAD = 1.5  # of the others: length of the world's axes
DASH = 3  # pieces of a trace from one dash to the next; the last of them is the gap
MOST_PIECES = 5000  # of a trace before those that lie on others are left out


@dataclass(frozen=True, kw_only=True)
class Part:
    """One solid, fixed on one of the shown frames."""

    path: str  # "solid", "triad/x": unique among the frame's parts
    frame: int  # 0: the world
    shape: Shape
    X_FP: Array = field(default_factory=lambda: np.eye(4))  # (4, 4) pose on the frame [-, m]
    colour: Colour
    opacity: float = 1.0

    def corners(self) -> Array:
        """Corners of the box around it, on its frame, (8, 3) [m]; none of a half-space."""
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        return self._on_box(signs)

    def ends(self) -> Array:
        """Where the axes of that box end, (6, 3) [m]; of a ball its centre, (1, 3)."""
        ends = np.concatenate([np.eye(3), -np.eye(3)])
        return self._on_box(np.zeros((1, 3)) if isinstance(self.shape, Sphere) else ends)

    def _on_box(self, shares: Array) -> Array:
        """Points of the box around it, -1 ... 1 along each of its axes, on its frame [m]."""
        box = CalcObb(self.shape)
        if box is None:
            return np.zeros((0, 3))
        X_FB = self.X_FP @ box.pose().GetAsMatrix4()
        return np.asarray(shares * box.half_width() @ X_FB[:3, :3].T + X_FB[:3, 3])


def size_of(points: Array) -> float:
    """Greatest edge of the box around points (n, 3), at least ``LEAST_SIZE`` [m]."""
    return max(float(np.ptp(points, axis=0).max()), LEAST_SIZE)


def placed(x: float, y: float, z: float) -> Array:
    """Make a pure translation, (4, 4)."""
    X = np.eye(4)
    X[:3, 3] = x, y, z
    return X


def rod(start: Array, end: Array, radius: float) -> tuple[Cylinder, Array]:
    """Make a cylinder from one point of a frame F to another; return it and its pose X_FC."""
    way = end - start
    length = float(np.linalg.norm(way))
    z = way / length
    x = np.cross(np.eye(3)[int(np.abs(z).argmin())], z)
    x /= np.linalg.norm(x)
    X = np.eye(4)
    X[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    X[:3, 3] = (start + end) / 2.0
    return Cylinder(radius, length), X


def triad_lengths(frames: int, size: float) -> list[float]:
    """Lengths of the axes of each frame [m]; the world's are longer."""
    return [WORLD_TRIAD * TRIAD_LENGTH * size] + [TRIAD_LENGTH * size] * (frames - 1)


def triad_parts(frames: int, size: float) -> tuple[Part, ...]:
    """Draw the axes of all frames, three parts each: x red, y green, z blue."""
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


def trace_parts(paths: Sequence[Array], size: float) -> tuple[Part, ...]:
    """Draw dashes along paths, (rows, 3) each [m]; what lies on earlier pieces is left out.

    They are thicker than the axes of frames: an axis that lies along a path is seen in the gaps.
    """
    radius, parts = TRACE_RADIUS * size, list[Part]()
    for path in paths:
        for number, (start, end) in enumerate(_pieces(path, TRACE_SPACING * size)):
            if number % DASH < DASH - 1:
                shape, pose = rod(start, end, radius)
                parts.append(
                    Part(path=f"trace/{len(parts)}", frame=0, shape=shape, X_FP=pose, colour=TRACE)
                )
    return tuple(parts)


def floor_parts(points: Array, square: float | None = None) -> tuple[Part, ...]:
    """Draw a grid just under points; its squares measure 1, 2 or 5 times a power of ten.

    Parameters
    ----------
    square : float, optional
        Edge of its squares; by default as ``floor_square`` has it [m].
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
        bar = Box(length[0], line, line) if axis == 0 else Box(line, length[1], line)
        for number, multiple in enumerate(np.arange(low[1 - axis], high[1 - axis] + 1.0)):
            x, y = (middle[0], multiple * square) if axis == 0 else (multiple * square, middle[1])
            pose, path = placed(x, y, height), f"floor/{'xy'[axis]}{number}"
            parts.append(Part(path=path, frame=0, shape=bar, X_FP=pose, colour=LINE))
    return tuple(parts)


def floor_corners(points: Array, square: float | None = None) -> Array:
    """Opposite corners of the floor under points, (2, 3) [m]: least x and y, greatest x and y."""
    size = size_of(points)
    square = floor_square(size) if square is None else square
    height = float(points[:, 2].min()) - FLOOR_GAP * size
    low = square * np.floor(points[:, :2].min(axis=0) / square + SLACK)
    high = square * np.ceil(points[:, :2].max(axis=0) / square - SLACK)
    return np.array([[*low, height], [*high, height]])


def floor_square(size: float) -> float:
    """Edge of the floor's squares under a scene of a size [m]."""
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
