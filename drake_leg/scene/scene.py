"""The scene around a moving plant, and the views of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from pydrake.geometry import Box
from pydrake.math import RigidTransform
from scipy.spatial import ConvexHull

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.ground import Ground
from drake_leg.scene.footing import Footing
from drake_leg.scene.furniture import (
    FLOOR_LINE,
    TRIAD_LENGTH,
    floor_corners,
    floor_parts,
    floor_square,
    trace_parts,
    triad_parts,
    triad_tips,
)
from drake_leg.scene.motion import PlantMotion
from drake_leg.scene.parts import Part, size_of
from drake_leg.scene.shown_plant import ShownPlant
from drake_leg.scene.views import VIEWS, WALKING_VIEWS, Framing, View, frame

MOST_POSTURES = 400  # of a motion that determine the size of its scene
# Of a robot that walks, in sizes of it: lines on the ground, squares, traces of the feet.
GROUND_LINE, SQUARE_SHARE, FOOT_TRACE = 0.004, 1.5, 0.003
CLEAR = 0.6  # opacity of the body
GROUND_AROUND = 2  # squares of the ground beyond the walk
STONE, DEPTH = (0.80, 0.79, 0.76), 0.002  # of steps and blocks; how deep they go below the grid [m]
WALKING_TRIADS = 2  # of the world and the body


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What is shown: a plant, its traces, and the floor."""

    shown: ShownPlant
    parts: tuple[Part, ...]
    points: Array  # (n, 3), what a picture of the plant must hold [m]
    floor: Array  # (2, 3), opposite corners of the floor [m]
    floor_square: float  # edge of the floor's squares [m]
    size: float  # greatest edge of the box around the plant [m]
    triads: int  # how many of the first frames have axes
    triad_size: float  # the size that these axes are for [m]: less than size where links are small
    has_frames: bool = True  # whether the axes are seen; on a page, at first
    notes: tuple[str, ...] = ()  # what the picture shows instead of shapes, or leaves out
    footing: Footing | None = None  # of a robot that walks: pictures go with it, over its ground
    whole: Array | None = None  # (n, 3), its whole walk [m]

    @property
    def views(self) -> dict[str, View]:
        """The views that have names."""
        return WALKING_VIEWS if self.footing is not None or self.shown.walks else VIEWS

    def own(self, view: View) -> View:
        """Return the scene's own view of the same name; another one as it is."""
        return self.views[view.name] if view in VIEWS.values() else view

    @cached_property
    def held(self) -> Array:
        """Points that a picture must hold, with the floor's corners, (k, 3) [m]."""
        if self.footing is not None:
            return np.concatenate([self.points, self.footing.under(self.points)])
        (x, y, z), (u, v, _) = self.floor
        corners = np.array([[x, y, z], [u, y, z], [x, v, z], [u, v, z]])
        return np.concatenate([self.points, corners])

    def framing(self, view: View) -> Framing:
        """Find how a view sees the whole scene, or a robot that walks."""
        return self._framing(view)

    @cached_property
    def _framing(self) -> Callable[[View], Framing]:
        return cache(lambda view: frame(view, self.held))

    def hull(self) -> Array:
        """Corners of the smallest convex body that holds what is framed, (k, 3) [m]."""
        return hull_of(self.held)

    @property
    def drawn(self) -> tuple[Part, ...]:
        """What a picture shows of the parts."""
        if self.has_frames:
            return self.parts
        return tuple(part for part in self.parts if not part.path.startswith("triad/"))

    def followed(self, X_WF: Array) -> Array:
        """Poses in the picture, X_UF (..., n, 4, 4): a robot that walks is over the origin."""
        if self.footing is not None:
            return _followed(X_WF, self.footing)
        return np.asarray(self.shown.X_UW @ X_WF)

    def trace_points(self) -> Array:
        """Middles of the traces' dashes in the picture, (k, 3) [m]."""
        middles = [part.X_FP[:3, 3] for part in self.parts if part.path.startswith("trace/")]
        return np.array(middles).reshape(-1, 3) @ self.shown.X_UW[:3, :3].T


def hull_of(points: Array) -> Array:
    """Corners of the smallest convex body that holds points (n, 3), (k, 3) [m]."""
    return np.asarray(points[ConvexHull(points, qhull_options="QJ").vertices])


def _followed(X_WF: Array, footing: Footing) -> Array:
    found = X_WF.copy()
    found[..., :3, 3] -= footing.under(X_WF[..., 1:2, :3, 3])
    return found


def scene_of(
    motion: PlantMotion,
    *,
    room: float = 0.0,
    around: Array | None = None,
    frames: bool | None = None,
) -> Scene:
    """Make a scene that contains a whole motion, of one row or many.

    It is larger than the motion on every side by ``room``, of its size, and holds also the points
    ``around``, (n, 3) [m], on the same floor. Of a robot that walks it shows what is
    around it, and so many more squares of its ground. ``frames`` are seen or not; by default as
    the plant has it.
    """
    has_frames = motion.shown.shows_frames if frames is None else frames
    few = np.unique(np.linspace(0, len(motion.time) - 1, MOST_POSTURES).astype(int))
    plant, poses = motion.shown, motion.poses()
    if motion.footing is not None:
        scene = _walk_scene(plant, poses[few], motion.footing, room)
        return replace(scene, has_frames=has_frames)
    turned = plant.X_UW @ poses[few]
    points = plant.outline(turned, with_origin=has_frames)
    size = size_of(points)
    triad_size = min(size, plant.typical_part() / TRIAD_LENGTH / 2.0)
    if has_frames:
        points = np.concatenate([points, triad_tips(turned, triad_size).reshape(-1, 3)])
    low, high = points.min(axis=0) - room * size, points.max(axis=0) + room * size
    points = np.concatenate([points, [low, high]]) if room else points
    square = floor_square(size_of(points))
    points = points if around is None else np.concatenate([points, around])
    floor = floor_corners(points, square)
    parts = (
        *plant.parts(size),
        *triad_parts(len(plant.frames), triad_size),
        *trace_parts(list(np.moveaxis(plant.traced(poses), -2, 0)), size),
        *(
            replace(part, X_FP=plant.X_UW.T @ part.X_FP)  # level in the picture
            for part in floor_parts(floor, square, FLOOR_LINE * size_of(points))
        ),
    )
    return Scene(
        shown=plant,
        parts=parts,
        points=points,
        floor=floor,
        floor_square=square,
        size=size,
        triads=len(plant.frames),
        triad_size=triad_size,
        has_frames=has_frames,
        notes=(*plant.notes, *plant.left_out(size)),
    )


def _walk_scene(plant: ShownPlant, poses: Array, footing: Footing, room: float) -> Scene:
    """Make a scene of a robot that walks: on its ground, as large in the picture as it can be."""
    moving = _followed(poses, footing)
    moving[:, 0] = moving[:, 1]  # the world's origin stays behind
    near, whole = plant.outline(moving), plant.outline(poses)
    size, line = size_of(near), GROUND_LINE * size_of(near)
    square = floor_square(SQUARE_SHARE * size)
    in_ground = (footing.under(whole) - footing.X_WG[:3, 3]) @ footing.X_WG[:3, :3]
    low = np.floor(in_ground[:, :2].min(axis=0) / square) - GROUND_AROUND - room
    high = np.ceil(in_ground[:, :2].max(axis=0) / square) + GROUND_AROUND + room
    floor = np.column_stack([np.array([low, high]) * square, np.full(2, -line / 2.0)])
    grid = (
        replace(part, X_FP=footing.X_WG @ part.X_FP)
        for part in (*floor_parts(floor, square, line), *_stones(footing.ground, floor))
    )
    paths = list(np.moveaxis(footing.feet, 1, 0))
    return Scene(
        shown=plant,
        parts=(
            *(
                replace(part, opacity=1.0 if part.frame > 1 else CLEAR)
                for part in plant.parts(size)
            ),
            *triad_parts(WALKING_TRIADS, size),
            *trace_parts(paths, size, FOOT_TRACE, dash=0),
            *grid,
        ),
        points=near,
        floor=floor,
        floor_square=square,
        size=size,
        triads=WALKING_TRIADS,
        triad_size=size,
        notes=plant.notes,
        footing=footing,
        whole=hull_of(np.concatenate([whole, footing.under(whole)])),
    )


def _stones(ground: Ground, floor: Array) -> Iterator[Part]:
    """Draw steps and blocks between the corners of the floor, (2, 3) [m], in the ground's frame."""
    if ground.steps is None and ground.blocks is None:
        return
    for number, slab in enumerate(ground.slabs()):
        low, high = np.array(slab)
        low[:2], high[:2] = np.maximum(low[:2], floor[0, :2]), np.minimum(high[:2], floor[1, :2])
        low[2] = min(-DEPTH, high[2] - DEPTH)
        if (low < high).all() and high[2] != 0.0:
            X_GS = RigidTransform((low + high) / 2.0).GetAsMatrix4()
            box = Box(*(high - low))
            yield Part(path=f"floor/stone{number}", frame=0, shape=box, X_FP=X_GS, colour=STONE)
