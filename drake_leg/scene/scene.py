"""A robot with all that is shown of it: solids, frames, floor, and the trace of its tip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot
from drake_leg.scene.marks import (
    floor_corners,
    floor_parts,
    floor_square,
    trace_parts,
    triad_parts,
    triad_tips,
)
from drake_leg.scene.motion import Motion
from drake_leg.scene.parts import Part, outline, size_of, solid_parts
from drake_leg.scene.views import Framing, View, frame

MOST_POSTURES = 400  # of a motion that are looked at to find out how much room it takes


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What is shown."""

    robot: Robot
    parts: tuple[Part, ...]
    points: Array  # (n, 3), what a picture of the robot must hold [m]
    floor: Array  # (2, 3), opposite corners of the floor [m]
    floor_square: float  # edge of the floor's squares [m]
    size: float  # greatest edge of the box around the robot [m]

    @property
    def held(self) -> Array:
        """Points that a picture must hold, with the floor's corners, (n + 4, 3) [m]."""
        (x, y, z), (u, v, _) = self.floor
        corners = np.array([[x, y, z], [u, y, z], [x, v, z], [u, v, z]])
        return np.concatenate([self.points, corners])

    def framing(self, view: View) -> Framing:
        """Find how a view sees the whole scene."""
        return frame(view, self.held)

    def hull(self) -> Array:
        """Corners of the least convex body that holds the whole scene.

        Returns
        -------
        (k, 3) ndarray
            [m].
        """
        points = self.held
        return np.asarray(points[ConvexHull(points, qhull_options="QJ").vertices])


def scene_of(motion: Motion, *, room: float = 0.0, around: Array | None = None) -> Scene:
    """Put a scene together that holds a whole motion.

    Parameters
    ----------
    motion : Motion
        Of one row or many.
    room : float
        How much larger than the motion the scene is on every side, of its size.
    around : (n, 3) ndarray, optional
        More points that the scene must hold, on the same floor [m].
    """
    few = np.unique(np.linspace(0, len(motion.time) - 1, MOST_POSTURES).astype(int))
    poses = motion.poses()[few]
    seen = outline(motion.robot, poses)
    size = size_of(seen)
    tips = triad_tips(motion.robot, poses, size).reshape(-1, 3)
    points = np.concatenate([seen, tips])
    low, high = points.min(axis=0) - room * size, points.max(axis=0) + room * size
    points = np.concatenate([points, [low, high]]) if room else points
    square = floor_square(size_of(points))
    points = points if around is None else np.concatenate([points, around])
    parts = (
        *solid_parts(motion.robot, size),
        *triad_parts(motion.robot, size),
        *trace_parts(motion.path(), size),
        *floor_parts(points, square),
    )
    return Scene(
        robot=motion.robot,
        parts=parts,
        points=points,
        floor=floor_corners(points, square),
        floor_square=square,
        size=size,
    )
