"""What a planned walk asks of a robot at given times: joints, support, distances between legs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array, base_transforms
from drake_leg.kinematics.walking.clearance import capsules_of, gaps_between_legs, lowest
from drake_leg.kinematics.walking.gaits import Motion
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.margins import on_ground, support_margin, zero_moment_point
from drake_leg.kinematics.walking.weights import (
    centres_of_mass,
    inertia_wrench,
    link_motions,
    total_mass,
)
from drake_leg.robot.robot import Robot
from drake_leg.units import STANDARD_GRAVITY

DOWNWARDS = (0.0, 0.0, -STANDARD_GRAVITY)  # [m/s^2], on level ground


class Paths(Protocol):
    """Paths of body and feet at times (rows,) [s], as a ``Walk`` has them."""

    @property
    def period(self) -> float:
        """Of the gait [s]."""
        ...

    @property
    def begins(self) -> float:
        """When the gait begins [s]."""
        ...

    def body(self, time: Array) -> Motion:
        """Pose X_GB, (rows, 4, 4) [-, m]."""
        ...

    def feet(self, time: Array) -> Motion:
        """Feet p_BF, (rows, n, 3) [m]."""
        ...

    def feet_in_world(self, time: Array) -> Motion:
        """Feet p_GF, (rows, n, 3) [m]."""
        ...

    def down(self, time: Array) -> NDArray[np.bool_]:
        """Whether each foot stands, (rows, n)."""
        ...

    def firmness(self, time: Array, fading: float) -> Array:
        """How firmly each foot stands, (rows, n), 0 to 1."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class PlannedWalk:
    """A robot that follows a walk exactly, at times; G is the frame of the ground.

    What depends on a joint is NaN where its foot is out of reach.
    """

    robot: Robot
    legs: Legs
    walk: Paths
    times: Array  # (rows,) [s]
    gravity: tuple[float, float, float] = DOWNWARDS  # [m/s^2], in G
    outwards: float = 0.0  # of its load, that a standing foot presses outwards from its hip [-]

    @cached_property
    def body(self) -> Motion:
        """Pose X_GB, (rows, 4, 4) [-, m], with derivatives."""
        return self.walk.body(self.times)

    @cached_property
    def feet(self) -> Motion:
        """Feet p_BF, (rows, n, 3) [m], with derivatives."""
        return self.walk.feet(self.times)

    @cached_property
    def feet_on_ground(self) -> Array:
        """The same feet in the frame of the ground, p_GF (rows, n, 3) [m]."""
        return self.walk.feet_in_world(self.times).value

    @cached_property
    def angles(self) -> Array:
        """Joint angles, (rows, n, 3) [rad]."""
        return self.legs.joints(self.feet.value)

    @cached_property
    def joints(self) -> Motion:
        """The same angles, with derivatives."""
        return self.legs.motion(self.feet)

    @cached_property
    def down(self) -> NDArray[np.bool_]:
        """Whether each foot stands, (rows, n)."""
        return self.walk.down(self.times)

    @cached_property
    def poses(self) -> Array:
        """Poses X_GL of the base and of all rows, (rows, m + 1, 4, 4)."""
        q = self.angles.reshape(len(self.times), 3 * self.legs.count)
        reached = np.asarray(np.isfinite(q).all(axis=-1))
        X_B = base_transforms(self.robot.rows, np.where(reached[:, np.newaxis], q, 0.0))
        X_B[~reached] = np.nan
        X_GB = self.body.value[:, np.newaxis]
        return np.concatenate([X_GB, X_GB @ X_B], axis=1)

    @cached_property
    def links(self) -> Motion:
        """The same poses, with derivatives."""
        positions, rates, bends = (
            part.reshape(len(self.times), 3 * self.legs.count) for part in self.joints
        )
        return link_motions(self.robot, self.body, Motion(positions, rates, bends))

    @cached_property
    def support_heights(self) -> Array:
        """Mean height of the standing feet in G, (rows,) [m]; 0 where none stands."""
        heights = self.feet_on_ground[..., 2]
        total = np.where(self.down, heights, 0.0).sum(axis=-1)
        return np.asarray(total / np.maximum(self.down.sum(axis=-1), 1))

    @cached_property
    def centres(self) -> Array:
        """Center of mass of the whole robot in G, (rows, 3) [m]."""
        return centres_of_mass(self.robot, self.poses)

    @cached_property
    def body_clearance(self) -> Array:
        """Height of the body's lowest point over the ground, (rows,) [m]; of its solid, if any."""
        body = self.robot.base_link
        X_GB = self.body.value
        low = X_GB[:, 2, 3] if body is None or body.solid is None else lowest(body.solid, X_GB)
        return np.asarray(low - self.support_heights)

    @cached_property
    def ground_points(self) -> Array:
        """Center of mass, projected onto the ground along gravity, (rows, 2) [m]."""
        return on_ground(self.centres, np.array(self.gravity), self.support_heights)

    @cached_property
    def rates_of_momentum(self) -> tuple[Array, Array]:
        """Rates of angular momentum about G's origin and of momentum, (rows, 3) [N*m, N]."""
        return inertia_wrench(self.robot, self.links)

    @cached_property
    def zero_moment_points(self) -> Array:
        """Where the ground's force must act for the planned motion, (rows, 2) [m]."""
        turning, moving = self.rates_of_momentum
        weight = total_mass(self.robot) * np.array(self.gravity)
        moment = np.cross(self.centres, weight) - turning
        return zero_moment_point(moment, weight - moving, self.support_heights)

    @cached_property
    def static_margins(self) -> Array:
        """Distance of the ground points from the edge of support, (rows,) [m]; outside negative."""
        return self._margins(self.ground_points)

    @cached_property
    def dynamic_margins(self) -> Array:
        """The same of the zero-moment points."""
        return self._margins(self.zero_moment_points)

    @cached_property
    def sigma_mins(self) -> Array:
        """Smallest singular value of every leg's Jacobian, (rows, n) [m/rad]."""
        return self.legs.sigma_mins(self.angles)

    @cached_property
    def gaps(self) -> Array:
        """Distances between the links of neighboring legs, (rows, pairs) [m]."""
        return gaps_between_legs(capsules_of(self.robot), self.poses[:, 1:])

    def _margins(self, points: Array) -> Array:
        return support_margin(self.feet_on_ground[..., :2], points, self.down)
