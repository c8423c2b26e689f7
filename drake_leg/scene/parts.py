"""The solids that pictures show, each fixed on a frame, and their sizes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from pydrake.geometry import CalcObb, Cylinder, Shape, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from drake_leg.colours import Colour
from drake_leg.kinematics.khalil import Array

LEAST_SIZE = 1e-3  # [m], of a scene
SOLID_OPACITY = 0.45  # so that the frames inside can be seen


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
        """Where the axes of that box end, (6, 3) [m]; of a ball its center, (1, 3)."""
        ends = np.concatenate([np.eye(3), -np.eye(3)])
        return self._on_box(np.zeros((1, 3)) if isinstance(self.shape, Sphere) else ends)

    def holds(self, point: Array, near: float) -> bool:
        """Tell whether a point of its frame is in the box around it, or near it [m]."""
        corners = self.corners()
        low, high = corners.min(axis=0) - near, corners.max(axis=0) + near
        return bool(((low <= point) & (point <= high)).all())

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


def rod(start: Array, end: Array, radius: float) -> tuple[Cylinder, Array]:
    """Make a cylinder from one point of a frame F to another; return it and its pose X_FC."""
    way = end - start
    length = float(np.linalg.norm(way))
    X_FC = RigidTransform(RotationMatrix.MakeFromOneVector(way, 2), (start + end) / 2.0)
    return Cylinder(radius, length), X_FC.GetAsMatrix4()
