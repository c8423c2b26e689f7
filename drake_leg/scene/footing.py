"""Where a walking robot stands: its feet, the ground's forces on them, and its support."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from drake_leg.kinematics.khalil import Array, base_transforms
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.margins import support_margin, supporting
from drake_leg.kinematics.walking.weights import centres_of_mass, placed, total_mass
from drake_leg.robot.ground import Ground
from drake_leg.robot.robot import Robot
from drake_leg.units import STANDARD_GRAVITY

DOWN = np.array([0.0, 0.0, -1.0])  # along gravity, in the world


@dataclass(frozen=True, kw_only=True, eq=False)
class Footing:
    """The feet of a walking robot over time, in the world W; G is the frame of the ground.

    The ground is G's plane z = 0, apart from steps and blocks.
    """

    time: Array  # (rows,) [s], rising
    feet: Array  # (rows, n, 3) p_WF [m]
    forces: Array  # (rows, n, 3), of the ground on the feet [N]
    stands: NDArray[np.bool_]  # (rows, n), whether a foot carries load
    body: Array  # (rows, 3) p_WB [m]
    centre: Array  # (rows, 3), center of mass [m]
    weight: float  # [N]
    ground: Ground

    @classmethod
    def of(
        cls,
        robot: Robot,
        time: Array,
        body: Array,
        q: Array,
        forces: Array,
        ground: Ground,
    ) -> Self:
        """Make it from the body's quaternion and place in W (rows, 7), and joints (rows, 3 n).

        The forces (rows, n, 3) [N] are in W.
        """
        X_WB = pose_of(body)
        feet = _legs(robot).feet(q.reshape(len(q), -1, 3))
        links = base_transforms(robot.rows, q)
        links = np.concatenate([np.tile(np.eye(4), (len(q), 1, 1, 1)), links], axis=1)
        centre = centres_of_mass(robot, links)[:, np.newaxis]
        weight = total_mass(robot) * STANDARD_GRAVITY
        pressing = forces @ np.array(ground.X_WG)[:3, 2]
        return cls(
            time=time,
            feet=placed(X_WB, feet),
            forces=forces,
            stands=supporting(time, pressing, weight),
            body=body[:, 4:],
            centre=placed(X_WB, centre)[:, 0],
            weight=weight,
            ground=ground,
        )

    @cached_property
    def X_WG(self) -> Array:
        """Pose of the ground's frame, (4, 4)."""
        return np.array(self.ground.X_WG)

    def at(self, time: Array) -> Self:
        """Interpolate linearly at other times, (k,) [s]."""

        def between(values: Array) -> Array:
            columns = values.reshape(len(self.time), -1).T
            rows = np.column_stack([np.interp(time, self.time, column) for column in columns])
            return rows.reshape(len(time), *values.shape[1:])

        middles = (self.time[1:] + self.time[:-1]) / 2.0
        return replace(
            self,
            time=time,
            feet=between(self.feet),
            forces=between(self.forces),
            stands=self.stands[np.searchsorted(middles, time)],
            body=between(self.body),
            centre=between(self.centre),
        )

    @cached_property
    def origin(self) -> Array:
        """Where pictures go with the body: the ground under it, (rows, 3) [m]."""
        return self.under(self.body)

    @cached_property
    def below(self) -> Array:
        """Center of mass, projected along gravity to the height of the standing feet, (rows, 3)."""
        normal = self.X_WG[:3, 2]
        heights = np.where(self.stands, (self.feet - self.X_WG[:3, 3]) @ normal, 0.0)
        mean = heights.sum(axis=1) / np.maximum(self.stands.sum(axis=1), 1)
        over = (self.centre - self.X_WG[:3, 3]) @ normal - mean
        return np.asarray(self.centre - (over / (DOWN @ normal))[:, np.newaxis] * DOWN)

    @cached_property
    def margins(self) -> Array:
        """Distance of ``below`` from the edge of the support, (rows,) [m]; outside negative."""
        feet, point = (
            (points - self.X_WG[:3, 3]) @ self.X_WG[:3, :2] for points in (self.feet, self.below)
        )
        return support_margin(feet, point, self.stands)

    def support(self, row: int) -> list[int]:
        """Feet at the corners of the support in a row, one after the other around it."""
        loaded = np.flatnonzero(self.stands[row])
        in_ground = (self.feet[row, loaded] - self.X_WG[:3, 3]) @ self.X_WG[:3, :2]
        if len(loaded) < 3:
            return [int(foot) for foot in loaded]
        try:
            corners = ConvexHull(in_ground).vertices
        except QhullError:  # all on a line
            return []
        return [int(foot) for foot in loaded[corners]]

    def under(self, place: Array) -> Array:
        """Point of the ground's plane under or over a place (..., 3) of the world [m]."""
        normal = self.X_WG[:3, 2]
        over = (place - self.X_WG[:3, 3]) @ normal
        return np.asarray(place - (over / (DOWN @ normal))[..., np.newaxis] * DOWN)


@lru_cache(maxsize=8)
def _legs(robot: Robot) -> Legs:
    return Legs.of(robot)


def pose_of(body: Array) -> Array:
    """Pose (rows, 4, 4) of a body, from its quaternion and place, (rows, 7)."""
    X = np.tile(np.eye(4), (len(body), 1, 1))
    X[:, :3, :3] = Rotation.from_quat(body[:, :4], scalar_first=True).as_matrix()
    X[:, :3, 3] = body[:, 4:]
    return X
