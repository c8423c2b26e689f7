"""What is to be seen of a robot, as simple solids on the frames of its table.

Every way of showing a robot, in a browser, by VTK or by matplotlib, shows these parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from drake_leg.colours import Colour
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import row_transform
from drake_leg.robot import Brick, Cylinder, Robot, Row, Shape, Solid, Sphere, link_colour

PALE = (0.72, 0.73, 0.76)

BASE_SIZE, ROD_RADIUS = 0.07, 0.009  # of the scene's size
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
    """Solids of the links, thin rods where no solid leads on, and a block where the base is.

    Parameters
    ----------
    size : float
        Of the scene [m].
    """
    return (*_base_parts(robot, size), *_link_solids(robot), *_link_rods(robot, size))


def _base_parts(robot: Robot, size: float) -> Iterator[Part]:
    """Make the base's block, and a post from there to a first joint that is somewhere else."""
    edge = BASE_SIZE * size
    block = Brick(length=edge, width=edge, height=edge / 2.0)
    yield Part(path="block", frame=0, shape=block, colour=PALE, opacity=SOLID_OPACITY)
    joint = _origin(robot.rows[0])
    if np.linalg.norm(joint) > edge:
        post, pose = rod(np.zeros(3), joint, edge / 4.0)
        yield Part(path="post", frame=0, shape=post, X_FP=pose, colour=PALE, opacity=SOLID_OPACITY)


def _link_solids(robot: Robot) -> Iterator[Part]:
    for index, segment in enumerate(robot.segments, start=1):
        if segment.link is not None and segment.link.solid is not None:
            solid = segment.link.solid
            ball = isinstance(solid.shape, Sphere)
            yield Part(
                path="solid",
                frame=index,
                shape=solid.shape,
                X_FP=placed(*solid.centre),
                colour=solid.colour,
                opacity=1.0 if ball else SOLID_OPACITY,
            )


def _link_rods(robot: Robot, size: float) -> Iterator[Part]:
    radius = ROD_RADIUS * size
    for index, segment in enumerate(robot.segments, start=1):
        solid = segment.link.solid if segment.link is not None else None
        colour = link_colour(index) if solid is None else solid.colour
        for number, end in enumerate(_bare_ends(robot, index, radius)):
            shape, pose = rod(np.zeros(3), end, radius)
            yield Part(
                path=f"rod/{number}",
                frame=index,
                shape=shape,
                X_FP=pose,
                colour=colour,
                opacity=SOLID_OPACITY,
            )


def _bare_ends(robot: Robot, index: int, near: float) -> Iterator[Array]:
    """List where a frame's link goes without a solid: its end, and the origin of the next frame."""
    link = robot.segments[index - 1].link
    solid = link.solid if link is not None else None
    ends = [np.array(link.end)] if link is not None and solid is None else []
    ends += [_origin(row) for row in robot.rows[index : index + 1]]
    seen = [np.zeros(3)]
    for end in ends:
        held = solid is not None and _holds(solid, end, near)
        if not held and min(np.linalg.norm(end - other) for other in seen) > near:
            seen.append(end)
            yield end


def _holds(solid: Solid, point: Array, near: float) -> bool:
    """Tell whether a point of a link's frame lies in the box around its solid, or near it."""
    half = _corners(solid.shape).max(axis=0) + near
    return bool((np.abs(point - solid.centre) <= half).all())


def _origin(row: Row) -> Array:
    """Origin of a row's frame in the frame before, p_PC, where its joint stands at zero [m]."""
    return np.asarray(row_transform(row)[:3, 3])


def outline(robot: Robot, X_BF: Array) -> Array:
    """Points that a picture of a robot must hold: origins of its frames, corners of its solids.

    Parameters
    ----------
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


def rod(start: Array, end: Array, radius: float) -> tuple[Cylinder, Array]:
    """Make a cylinder from one point to another.

    Parameters
    ----------
    start, end : (3,) ndarray
        In a frame F, apart from each other [m].
    radius : float
        [m].

    Returns
    -------
    X_FC : (4, 4) ndarray
        Its pose [-, m].
    """
    way = end - start
    length = float(np.linalg.norm(way))
    z = way / length
    x = np.cross(np.eye(3)[int(np.abs(z).argmin())], z)
    x /= np.linalg.norm(x)
    X = np.eye(4)
    X[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    X[:3, 3] = (start + end) / 2.0
    return Cylinder(radius=radius, length=length), X
