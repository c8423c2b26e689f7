"""What a planned walk asks of a robot at given times: joints, support, distances between legs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.clearance import Gaps, capsules_of, gaps_between_legs
from drake_leg.kinematics.walking.gaits import Motion, Walk
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


@dataclass(frozen=True, kw_only=True, eq=False)
class PlannedWalk:
    """A robot that follows a walk exactly, at times; G is the frame of the ground.

    What depends on a joint is NaN where its foot is out of reach.
    """

    robot: Robot
    legs: Legs
    walk: Walk
    times: Array  # (rows,) [s]
    gravity: tuple[float, float, float] = DOWNWARDS  # [m/s^2], in G

    @cached_property
    def body(self) -> Motion:
        """Pose X_GB, (rows, 4, 4) [-, m], with derivatives."""
        return self.walk.body(self.times)

    @cached_property
    def feet(self) -> Motion:
        """Feet p_BF, (rows, n, 3) [m], with derivatives."""
        return self.walk.feet(self.times)

    @cached_property
    def joints(self) -> Motion:
        """Joint angles, (rows, n, 3) [rad], with derivatives."""
        return self.legs.motion(self.feet)

    @cached_property
    def down(self) -> NDArray[np.bool_]:
        """Whether each foot stands, (rows, n)."""
        return self.walk.down(self.times)

    @cached_property
    def links(self) -> Motion:
        """Poses X_GL of the base and of all rows, (rows, m + 1, 4, 4), with derivatives."""
        positions, rates, bends = (
            part.reshape(len(self.times), 3 * self.legs.count) for part in self.joints
        )
        return link_motions(self.robot, self.body, Motion(positions, rates, bends))

    @cached_property
    def support_heights(self) -> Array:
        """Mean height of the standing feet in G, (rows,) [m]; 0 where none stands."""
        heights = self.walk.feet_in_world(self.times).value[..., 2]
        total = np.where(self.down, heights, 0.0).sum(axis=-1)
        return np.asarray(total / np.maximum(self.down.sum(axis=-1), 1))

    @cached_property
    def centres(self) -> Array:
        """Center of mass of the whole robot in G, (rows, 3) [m]."""
        return centres_of_mass(self.robot, self.links.value)

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
        return self.legs.sigma_mins(self.joints.value)

    @cached_property
    def gaps(self) -> Gaps:
        """Distances between the links of different legs, (rows, pairs) [m]."""
        return gaps_between_legs(capsules_of(self.robot), self.links.value[..., 1:, :, :])

    def _margins(self, points: Array) -> Array:
        feet = self.walk.feet_in_world(self.times).value[..., :2]
        return support_margin(feet, points, self.down)
