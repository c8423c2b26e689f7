"""Contact by Simscape's smooth spring and damper, with smooth stick-slip friction.

At a depth d that grows at the rate v, the force is ``s(d / width) max(0, k d + c v)``, where s
rises smoothly from 0 to 1. Simscape states neither the smooth function nor whether the force may
pull; the one here is the polynomial of least degree that fits its description. The coefficient of
friction rises from 0 at rest to the static one at the critical velocity, and falls to the dynamic
one at half as much more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from drake_leg.simulink.dynamics.joints import smooth
from drake_leg.simulink.dynamics.moment import Moment, Place, cross
from drake_leg.simulink.dynamics.shapes import Box, Corners, Hull, Plane, Points, Surface
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.multibody.mass import Array

SLIDING = 1.5  # times the critical velocity, from which on friction is dynamic


@dataclass(frozen=True, kw_only=True)
class ContactLaw:
    """What two surfaces do to each other."""

    stiffness: float  # [N/m]
    damping: float  # [N*s/m]
    width: float  # of the transition region [m]
    static: float = 0.0  # coefficients of friction
    dynamic: float = 0.0
    critical: float = 1e-3  # velocity [m/s]
    pulls: bool = False  # whether the damper may pull the two together

    def normal(self, depth: float, rate: float) -> float:
        """Return the force that pushes two surfaces apart [N]."""
        if depth <= 0.0:
            return 0.0
        force = self.stiffness * depth + self.damping * rate
        if not self.pulls:
            force = max(0.0, force)
        return smooth(depth / self.width) * force

    def friction(self, speed: float) -> float:
        """Return the coefficient of friction at a tangential speed [m/s]."""
        s = speed / self.critical
        if s <= 1.0:
            return self.static * s * (3.0 - s * s) / 2.0
        share = smooth((s - 1.0) / (SLIDING - 1.0))
        return self.static + share * (self.dynamic - self.static)


@dataclass(frozen=True, eq=False, kw_only=True)
class Side:
    """A geometry that touches, on a body."""

    place: Place
    surface: Surface | None  # that points of the other side may be in
    corners: Corners | None  # that may be in the other side

    @cached_property
    def reach(self) -> float:
        """Return the radius of a ball around its origin that holds all of it [m]."""
        return self.corners.reach if self.corners else math.inf


@dataclass(frozen=True, eq=False, kw_only=True)
class Touch:
    """A point at which two surfaces are in each other, or the nearest one."""

    index: int  # of the corner that touches
    point: Array  # in the world [m]
    normal: Array  # outward from the base, in the world
    separation: float  # [m]
    push: float = 0.0  # [N], along the normal, on the follower
    friction: float = 0.0  # [N], its magnitude
    approach: float = 0.0  # [m/s], of the follower along the normal
    slip: Array = field(default_factory=lambda: np.zeros(3))  # of the follower [m/s], in the world
    speed: float = 0.0  # of the slip [m/s]


NOWHERE = np.zeros((0, 3))
Spot = tuple[int, Array, Array, float]  # the corner, the point, the normal, and how deep it is


def contact_axes(normal: Array) -> Array:
    """Return the rotation R_WC of a contact's frame C, whose z is the normal."""
    least = np.eye(3)[np.abs(normal).argmin()]
    x = np.cross(least, normal)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(normal, x), normal])


class Contact:
    """The forces between two geometries."""

    def __init__(
        self, base: Side, follower: Side, law: ContactLaw, *, measures: bool = False
    ) -> None:
        self.base, self.follower, self._law, self._measures = base, follower, law, measures
        pairs = [(base, follower, 1.0), (follower, base, -1.0)]
        pairs = [each for each in pairs if each[0].surface and each[1].corners]
        round_ones = [each for each in pairs if each[1].corners and each[1].corners.radius]
        self.pairs = round_ones[:1] or pairs

    @property
    def points(self) -> int:
        """Return how many points a cloud has that touches; 0 where none does."""
        corners = (side.corners for side in (self.base, self.follower) if side.surface is None)
        return max((len(each.points) for each in corners if isinstance(each, Points)), default=0)

    def touches(self, moment: Moment) -> list[Touch]:
        """Return where the two are in each other; where it measures, the nearest point else."""
        found = moment.memo.get(self)
        if not isinstance(found, list):
            found = []
            if self._measures or not self._is_far(moment):
                found = self.find(moment)
            moment.memo[self] = found
        return found

    def find(self, moment: Moment) -> list[Touch]:
        """List the points at which the two touch; where it measures, the nearest one else."""
        spots = moment.placed_memo.get(self)
        if not isinstance(spots, list):
            spots = [spot for pair in self.pairs for spot in self._between(moment, *pair)]
            moment.placed_memo[self] = spots
        return [self._touch(moment, *spot) for spot in spots]

    def _is_far(self, moment: Moment) -> bool:
        """Tell quickly that the two cannot touch."""
        on, of, _ = self.pairs[0]
        (R_WS, p_WS), (_, p_WC) = moment.pose(on.place), moment.pose(of.place)
        apart = p_WC - p_WS
        if isinstance(on.surface, Plane):
            return float(apart @ R_WS[:, 2]) > of.reach
        return math.sqrt(float(apart @ apart)) > on.reach + of.reach

    def separations(self, moment: Moment) -> Array:
        """Return the distances of all points of a cloud [m]."""
        on, of, _ = self.pairs[0]
        assert on.surface is not None
        return on.surface.signed(self._seen(moment, on, of))[0]

    def act(self, moment: Moment, wrenches: Wrenches) -> None:
        """Add the forces on both bodies."""
        for touch in self.touches(moment):
            if touch.push:
                force = touch.push * touch.normal
                if touch.speed > 0.0:
                    force = force - touch.friction / touch.speed * touch.slip
                self.push(moment, wrenches, touch, force)

    def push(self, moment: Moment, wrenches: Wrenches, touch: Touch, force: Array) -> None:
        """Add a force on the follower where the two touch, and its opposite on the base."""
        wrenches.add(moment, self.follower.place.body, touch.point, force)
        wrenches.add(moment, self.base.place.body, touch.point, -force)

    def _velocity(self, moment: Moment, point: Array) -> Array:
        """Return the velocity of the follower's point in the base's body, in the world."""
        v = np.zeros(3)
        for side, sign in ((self.follower, 1.0), (self.base, -1.0)):
            body = side.place.body
            if body:
                V = moment.body_twist(body)
                arm = point - moment.body_pose(body)[:, 3]
                v += sign * (V[3:] + cross(V[:3], arm))
        return v

    def _seen(self, moment: Moment, on: Side, of: Side) -> Array:
        """Return corners (n, 3) of one side in the frame of the other one's surface."""
        assert on.surface is not None
        assert of.corners is not None
        (R_WS, p_WS), (R_WC, p_WC) = moment.pose(on.place), moment.pose(of.place)
        R_CS, p_SC = R_WC.T @ R_WS, (p_WC - p_WS) @ R_WS
        hubs = of.corners.hubs
        if hubs is None:
            points = of.corners.toward(NOWHERE)
        elif on.surface.is_ground:
            points = of.corners.toward(np.broadcast_to(-R_CS[:, 2], hubs.shape))
        else:
            points = of.corners.toward(-on.surface.signed(hubs @ R_CS + p_SC)[1] @ R_CS.T)
        seen: Array = points @ R_CS + p_SC
        return seen

    def _between(self, moment: Moment, on: Side, of: Side, sign: float) -> list[Spot]:
        """List corners of one side that are in the other one's surface, or the nearest one."""
        surface, corners = on.surface, of.corners
        assert surface is not None
        assert corners is not None
        if corners.center is not None and isinstance(surface, Plane | Box):
            return self._of_center(moment, on, of, sign)
        points = self._seen(moment, on, of)
        radius = corners.radius
        places = np.arange(len(points))
        if isinstance(surface, Hull):  # each distance from one takes long
            places = surface.candidates(points, radius)
            points = points[places]
        distances, normals = surface.signed(points)
        R_WS, p_WS = moment.pose(on.place)
        inside = np.flatnonzero(distances < radius).tolist()
        found = []
        nearest = [int(distances.argmin())] if self._measures else []
        for k in inside or nearest:
            depth = radius - float(distances[k])
            at = points[k] - (float(distances[k]) + radius) / 2.0 * normals[k]
            point, normal = R_WS @ at + p_WS, sign * (R_WS @ normals[k])
            found.append((int(places[k]), point, normal, depth))
        return found

    def _of_center(self, moment: Moment, on: Side, of: Side, sign: float) -> list[Spot]:
        """Do so for one ball or point on a flat surface, in plain numbers, which is faster."""
        surface, corners = on.surface, of.corners
        assert isinstance(surface, Plane | Box)
        assert corners is not None
        assert corners.center is not None
        (R_WS, p_WS), (R_WC, p_WC) = moment.pose(on.place), moment.pose(of.place)
        seen = (R_WC @ corners.center + p_WC - p_WS) @ R_WS
        distance, outward = surface.nearest(seen.tolist())
        if distance >= corners.radius and not self._measures:
            return []
        normal = R_WS @ np.array(outward)
        middle = R_WS @ seen + p_WS - (distance + corners.radius) / 2.0 * normal
        return [(0, middle, sign * normal, corners.radius - distance)]

    def _touch(
        self, moment: Moment, index: int, point: Array, normal: Array, depth: float
    ) -> Touch:
        if depth <= 0.0:
            return Touch(index=index, point=point, normal=normal, separation=-depth)
        v = self._velocity(moment, point)
        rate = float(v @ normal)
        slip = v - rate * normal
        speed = math.sqrt(float(slip @ slip))
        push = self._law.normal(depth, -rate)
        return Touch(
            index=index,
            point=point,
            normal=normal,
            separation=-depth,
            push=push,
            friction=self._law.friction(speed) * abs(push),
            approach=rate,
            slip=slip,
            speed=speed,
        )
