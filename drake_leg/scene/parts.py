"""What is to be seen of a robot, as simple solids on the frames of its table.

Every way of showing a robot, in a browser, by VTK or by matplotlib, shows these parts.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Brick, Cylinder, Robot, Shape, Sphere
from drake_leg.scene.paper import Colour

PALE = (0.72, 0.73, 0.76)

BASE_SIZE = 0.07  # of the scene's size
LEAST_SIZE = 1e-3  # [m], of a scene
SOLID_OPACITY = 0.45  # so that the frames inside can be seen


@dataclass(frozen=True, kw_only=True)
class Part:
    """One solid, fixed on a frame of the robot's table."""

    path: str  # "solid", "triad/x": where it stands among the frame's parts
    frame: int  # 0: the base
    shape: Shape
    X_FP: Array = field(default_factory=lambda: np.eye(4))  # (4, 4) pose on the frame [-, m]
    colour: Colour
    opacity: float = 1.0


def size_of(points: Array) -> float:
    """Greatest edge of the box around points, at least ``LEAST_SIZE``.

    Parameters
    ----------
    points : (n, 3) ndarray
        [m].

    Returns
    -------
    float
        [m].
    """
    return max(float(np.ptp(points, axis=0).max()), LEAST_SIZE)


def solid_parts(robot: Robot, size: float) -> tuple[Part, ...]:
    """Solids of the links, a block where the base is, and a post under a raised first joint.

    Parameters
    ----------
    robot : Robot
        Any.
    size : float
        Of the scene [m].

    Returns
    -------
    tuple of Part
    """
    edge = BASE_SIZE * size
    block = Brick(length=edge, width=edge, height=edge / 2.0)
    parts = [Part(path="block", frame=0, shape=block, colour=PALE, opacity=SOLID_OPACITY)]
    rise = robot.rows[0].r
    if rise > edge:
        post = Cylinder(radius=edge / 4.0, length=rise)
        middle = placed(0.0, 0.0, rise / 2.0)
        parts.append(
            Part(
                path="post",
                frame=0,
                shape=post,
                X_FP=middle,
                colour=PALE,
                opacity=SOLID_OPACITY,
            )
        )
    for index, segment in enumerate(robot.segments, start=1):
        if segment.link is not None and segment.link.solid is not None:
            solid = segment.link.solid
            ball = isinstance(solid.shape, Sphere)
            parts.append(
                Part(
                    path="solid",
                    frame=index,
                    shape=solid.shape,
                    X_FP=placed(*solid.centre),
                    colour=solid.colour,
                    opacity=1.0 if ball else SOLID_OPACITY,
                )
            )
    return tuple(parts)


def outline(robot: Robot, X_BF: Array) -> Array:
    """Points that a picture of a robot must hold: origins of its frames, corners of its solids.

    Parameters
    ----------
    robot : Robot
        n rows.
    X_BF : (rows, n + 1, 4, 4) ndarray
        Poses of its frames, as ``Motion.poses``.

    Returns
    -------
    (k, 3) ndarray
        In the base frame [m].
    """
    points = [X_BF[:, :, :3, 3].reshape(-1, 3)]
    for index in range(1, len(robot.rows) + 1):
        R, p = X_BF[:, index, :3, :3], X_BF[:, index, :3, 3]
        points.extend(p + R @ corner for corner in corners(robot, index))
    return np.concatenate(points)


def corners(robot: Robot, index: int) -> Array:
    """Points of a link that a picture must hold: its end, and the corners of its solid.

    Parameters
    ----------
    robot : Robot
        Any.
    index : int
        Of the link's frame in the table, from 1 on.

    Returns
    -------
    (k, 3) ndarray
        In the link's frame [m]; none where the frame has no link.
    """
    link = robot.segments[index - 1].link
    if link is None:
        return np.zeros((0, 3))
    points = np.array([link.end], dtype=np.float64)
    if link.solid is None:
        return points
    return np.concatenate([points, _corners(link.solid.shape) + np.array(link.solid.centre)])


def _corners(shape: Shape) -> Array:
    if isinstance(shape, Brick):
        half = np.array([shape.length, shape.width, shape.height]) / 2.0
    elif isinstance(shape, Cylinder):
        half = np.array([shape.radius, shape.radius, shape.length / 2.0])
    else:
        half = np.full(3, shape.radius)
    signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    return np.asarray(signs * half)


def placed(x: float, y: float, z: float) -> Array:
    """Make a pose that only displaces.

    Parameters
    ----------
    x, y, z : float
        [m].

    Returns
    -------
    (4, 4) ndarray
        A homogeneous transform [-, m].
    """
    X = np.eye(4)
    X[:3, 3] = x, y, z
    return X
