"""Shapes that touch: how deep points are in one, and which points of another one may be.

All are in the frame of their geometry. The distance of a point from a surface is negative inside;
the normal points outward.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.meshes import FileMeshes, Meshes, mesh
from drake_leg.simulink.multibody.solids import (
    Brick,
    Cylinder,
    Ellipsoid,
    Extrusion,
    Revolution,
    Shape,
)

UP = np.array([0.0, 0.0, 1.0])
NEAR = 1.0  # times the size of a hull, up to which the distance from it is exact
PAIRS = 50_000  # of points and faces, at once
FAR = 1e9  # [m], the distance of what cannot touch


class Surface(Protocol):
    """A surface that points can be in."""

    @property
    def is_ground(self) -> bool:
        """Whether its inside is all that is below."""
        ...

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return the distances (n,) of points (n, 3) and the normals (n, 3) near them."""
        ...


class Corners(Protocol):
    """Points of a shape that may be in another one."""

    @property
    def radius(self) -> float:
        """Return the radius of the balls around the points [m]."""
        ...

    @property
    def center(self) -> Array | None:
        """Return the only point (3,), if there is but one."""
        ...

    @property
    def reach(self) -> float:
        """Return the radius of a ball around the origin that holds all of the shape [m]."""
        ...

    @property
    def hubs(self) -> Array | None:
        """Return the middles (k, 3) of its round parts, if it has any [m]."""
        ...

    def toward(self, directions: Array) -> Array:
        """Return points (n, 3); ``directions`` (k, 3) are those of the other's inside at hubs."""
        ...


@dataclass(frozen=True, eq=False, kw_only=True)
class Plane:
    """The half-space below x, y."""

    is_ground: bool = True

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return distances and normals."""
        return points[:, 2], np.broadcast_to(UP, points.shape)

    def nearest(self, point: Sequence[float]) -> tuple[float, Sequence[float]]:
        """Return the distance of one point, and the normal near it."""
        return point[2], (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Points:
    """Fixed points, or the center of a ball."""

    points: Array  # (n, 3) [m]
    radius: float = 0.0  # [m]
    hubs: Array | None = None  # it has no round parts

    @cached_property
    def center(self) -> Array | None:
        """Return the only point, if there is but one."""
        return self.points[0] if len(self.points) == 1 else None

    @property
    def reach(self) -> float:
        """Return the greatest distance from the origin [m]."""
        return float(np.linalg.norm(self.points, axis=1).max()) + self.radius

    def toward(self, _: Array) -> Array:
        """Return all of them."""
        return self.points


@dataclass(frozen=True, eq=False, kw_only=True)
class Box:
    """A brick around the origin."""

    half: Array  # (3,) [m]
    is_ground: bool = False

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return distances and normals."""
        beyond = np.abs(points) - self.half
        return _from_beyond(beyond, np.where(points < 0.0, -1.0, 1.0))

    def nearest(self, point: Sequence[float]) -> tuple[float, Sequence[float]]:
        """Return the distance of one point, and the normal near it."""
        beyond = [abs(x) - half for x, half in zip(point, self._half, strict=True)]
        signs = [-1.0 if x < 0.0 else 1.0 for x in point]
        outside = [max(each, 0.0) for each in beyond]
        apart = math.sqrt(sum(each * each for each in outside))
        if apart > 0.0:
            return apart, [each / apart * sign for each, sign in zip(outside, signs, strict=True)]
        nearest = beyond.index(max(beyond))
        return beyond[nearest], [sign * (k == nearest) for k, sign in enumerate(signs)]

    @cached_property
    def _half(self) -> list[float]:
        return [float(each) for each in self.half]

    @cached_property
    def corners(self) -> Points:
        """Return its eight corners."""
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return Points(points=signs * self.half)


def _from_beyond(beyond: Array, signs: Array) -> tuple[Array, Array]:
    """Return distances and normals of a box, by how far points are beyond its faces."""
    outside = np.maximum(beyond, 0.0)
    apart = np.sqrt((outside**2).sum(axis=1))
    out = apart > 0.0
    nearest = beyond.argmax(axis=1)
    rows = np.arange(len(beyond))
    distances = np.where(out, apart, beyond[rows, nearest])
    normals = np.zeros_like(beyond)
    normals[rows, nearest] = 1.0
    normals[out] = outside[out] / apart[out, None]
    return distances, normals * signs


@dataclass(frozen=True, eq=False, kw_only=True)
class Ball:
    """An ellipsoid; the distance from one that is no sphere is exact to first order."""

    radii: Array  # (3,) [m]
    is_ground: bool = False

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return distances and normals."""
        scaled = points / self.radii
        length = np.linalg.norm(scaled, axis=1)
        slope = scaled / self.radii
        steep = np.maximum(np.linalg.norm(slope, axis=1), np.finfo(float).tiny)
        return (length - 1.0) * length / steep, slope / steep[:, None]

    @cached_property
    def radius(self) -> float:
        """Return the radius of a sphere, whose center is its only corner."""
        return float(self.radii[0]) if self._is_sphere else 0.0

    @cached_property
    def center(self) -> Array | None:
        """Return the center of a sphere."""
        return np.zeros(3) if self._is_sphere else None

    @property
    def reach(self) -> float:
        """Return the greatest radius [m]."""
        return float(self.radii.max())

    @cached_property
    def _is_sphere(self) -> bool:
        return bool((self.radii == self.radii[0]).all())

    @cached_property
    def hubs(self) -> Array | None:
        """Return the center of what is no sphere."""
        return None if self._is_sphere else np.zeros((1, 3))

    def toward(self, directions: Array) -> Array:
        """Return the center of a sphere, or the point that is farthest in a direction."""
        if self._is_sphere:
            return np.zeros((1, 3))
        scaled = self.radii * directions[0]
        farthest: Array = self.radii * scaled / np.linalg.norm(scaled)
        return farthest[np.newaxis]


@dataclass(frozen=True, eq=False, kw_only=True)
class Barrel:
    """A cylinder around z."""

    rim: float  # radius [m]
    half: float  # of its length [m]
    radius: float = 0.0  # of its corners
    center: Array | None = None  # it has several points
    is_ground: bool = False

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return distances and normals."""
        reach = np.hypot(points[:, 0], points[:, 1])
        beyond = np.column_stack([reach - self.rim, np.abs(points[:, 2]) - self.half])
        signs = np.column_stack([np.ones_like(reach), np.where(points[:, 2] < 0.0, -1.0, 1.0)])
        distances, across = _from_beyond(beyond, signs)
        radial = np.where(
            reach[:, None] > 0.0, points[:, :2] / np.maximum(reach, 1e-300)[:, None], [1.0, 0.0]
        )
        return distances, np.column_stack([across[:, :1] * radial, across[:, 1]])

    @property
    def reach(self) -> float:
        """Return the distance of a rim from the center [m]."""
        return math.hypot(self.rim, self.half)

    @cached_property
    def hubs(self) -> Array:
        """Return the middles of its ends."""
        return np.array([[0.0, 0.0, -self.half], [0.0, 0.0, self.half]])

    def toward(self, directions: Array) -> Array:
        """Return four points of each rim."""
        ends = zip(self.hubs, directions, strict=True)
        return np.vstack([_ring(self.rim, direction) + hub for hub, direction in ends])


def _ring(radius: float, direction: Array) -> Array:
    """Return the point of a circle in x, y that is farthest in a direction, and a cross with it."""
    x, y = direction[:2].tolist()
    length = math.hypot(x, y)
    x, y = (x / length, y / length) if length > 1e-9 else (1.0, 0.0)
    ring: Array = radius * np.array([[x, y, 0.0], [-y, x, 0.0], [-x, -y, 0.0], [y, -x, 0.0]])
    return ring


@dataclass(frozen=True, eq=False, kw_only=True)
class Rim:
    """The edge of a disk in x, y."""

    rim: float  # radius [m]
    radius: float = 0.0  # of its corners
    center: Array | None = None  # it has several points

    @property
    def reach(self) -> float:
        """Return the radius [m]."""
        return self.rim

    @cached_property
    def hubs(self) -> Array:
        """Return its center."""
        return np.zeros((1, 3))

    def toward(self, directions: Array) -> Array:
        """Return four points of it."""
        return _ring(self.rim, directions[0])


class Hull:
    """The convex hull of points (n, 3).

    Far outside, the distance is that from the plane of a face.
    """

    is_ground = False

    def __init__(self, points: Array) -> None:
        try:
            hull = ConvexHull(points)
        except (QhullError, ValueError) as error:
            raise InvalidValueError("its points span no volume: give it a thickness") from error
        self._faces, self._offsets = hull.equations[:, :3], hull.equations[:, 3]
        self._triangles = hull.points[hull.simplices]
        self.corners = Points(points=hull.points[hull.vertices])
        self._size = float(np.ptp(hull.points, axis=0).max())

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return distances and normals."""
        beyond = points @ self._faces.T + self._offsets
        nearest = beyond.argmax(axis=1)
        distances = beyond[np.arange(len(points)), nearest]
        normals = self._faces[nearest]
        near = np.flatnonzero((distances > 0.0) & (distances < NEAR * self._size))
        if near.size:
            across = points[near] - nearest_of(self._triangles, points[near])
            lengths = np.linalg.norm(across, axis=1)
            off = lengths > 0.0
            distances[near[off]] = lengths[off]
            normals[near[off]] = across[off] / lengths[off, None]
        return distances, normals

    def candidates(self, points: Array, radius: float) -> NDArray[np.intp]:
        """Return the places of points that may be nearest to it, and of those within a radius.

        No point is nearer than the planes of the faces say.
        """
        bounds = _in_blocks(
            lambda block: (block @ self._faces.T + self._offsets).max(axis=1),
            points,
            len(self._faces),
        )
        least = bounds.argmin()
        most = max(float(self.signed(points[[least]])[0][0]), float(bounds[least]), radius)
        return np.flatnonzero(~(bounds > most))  # all, where nothing is known


def nearest_of(triangles: Array, points: Array) -> Array:
    """Return the points of triangles (n, 3, 3) that are nearest to points (k, 3)."""
    return _in_blocks(lambda block: _nearest_of(triangles, block), points, len(triangles))


def _in_blocks(of: Callable[[Array], Array], points: Array, faces: int) -> Array:
    """Compute something of points and faces, a bounded number of pairs at a time."""
    count = max(1, PAIRS // faces)
    return np.concatenate([of(points[k : k + count]) for k in range(0, len(points), count)])


def _nearest_of(triangles: Array, points: Array) -> Array:
    a, b, c = triangles.transpose(1, 0, 2)
    point = points[:, np.newaxis]
    across = np.cross(b - a, c - a)
    square = np.maximum((across**2).sum(axis=-1), np.finfo(float).tiny)
    plumb = point - (((point - a) * across).sum(axis=-1) / square)[..., np.newaxis] * across
    outside = np.zeros(plumb.shape[:2], dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        outside |= (np.cross(q - p, plumb - p) * across).sum(axis=-1) < 0.0
    edges = [_on_edge(p, q, point) for p, q in ((a, b), (b, c), (c, a))]
    candidates = np.concatenate([*edges, plumb], axis=1)
    squares = ((candidates - point) ** 2).sum(axis=-1)
    squares[:, 3 * len(a) :][outside] = np.inf
    nearest: Array = candidates[np.arange(len(points)), squares.argmin(axis=1)]
    return nearest


def _on_edge(p: Array, q: Array, point: Array) -> Array:
    edge = q - p
    square = np.maximum((edge**2).sum(axis=-1), np.finfo(float).tiny)
    share = np.clip(((point - p) * edge).sum(axis=-1) / square, 0.0, 1.0)
    on: Array = p + share[..., np.newaxis] * edge
    return on


class Ground:
    """Heights over a grid in x, y, with planes twisted between four neighbors."""

    is_ground = True

    def __init__(self, x: Array, y: Array, heights: Array) -> None:
        if heights.shape != (len(x), len(y)) or min(len(x), len(y)) < 2:
            raise InvalidValueError(
                f"it has heights of size {heights.shape} for a grid of {len(x)} by {len(y)}: give "
                "one for each point of the grid"
            )
        self._x, self._y, self._heights = x, y, heights

    def signed(self, points: Array) -> tuple[Array, Array]:
        """Return distances and normals; beside the grid is nothing."""
        x, y, z = points.T
        i = np.clip(np.searchsorted(self._x, x) - 1, 0, len(self._x) - 2)
        j = np.clip(np.searchsorted(self._y, y) - 1, 0, len(self._y) - 2)
        dx, dy = self._x[i + 1] - self._x[i], self._y[j + 1] - self._y[j]
        s, t = (x - self._x[i]) / dx, (y - self._y[j]) / dy
        h = self._heights
        a, b, c, d = h[i, j], h[i + 1, j], h[i, j + 1], h[i + 1, j + 1]
        height = a * (1 - s) * (1 - t) + b * s * (1 - t) + c * (1 - s) * t + d * s * t
        slope_x = ((b - a) * (1 - t) + (d - c) * t) / dx
        slope_y = ((c - a) * (1 - s) + (d - b) * s) / dy
        normals = np.column_stack([-slope_x, -slope_y, np.ones_like(x)])
        length = np.linalg.norm(normals, axis=1)
        beside = (s < 0.0) | (s > 1.0) | (t < 0.0) | (t > 1.0)
        return np.where(beside, FAR, (z - height) / length), normals / length[:, None]


def surface_of(shape: Shape, files: FileMeshes) -> Surface | None:
    """Return the surface of a solid, or of its convex hull; None where its file is not read."""
    if isinstance(shape, Brick):
        return Box(half=np.array(shape.edges) / 2.0)
    if isinstance(shape, Cylinder):
        return Barrel(rim=shape.radius, half=shape.length / 2.0)
    if isinstance(shape, Ellipsoid):
        return Ball(radii=np.array(shape.radii))
    if isinstance(shape, Extrusion | Revolution):
        return Hull(mesh(shape)[0])
    read = files.mesh(shape, Meshes())
    return Hull(read[0]) if read else None


def corners_of(surface: Surface) -> Corners:
    """Return the points of a solid that may be in another one."""
    if isinstance(surface, Box | Hull):
        return surface.corners
    assert isinstance(surface, Ball | Barrel)
    return surface
