"""A mechanism in one form, whatever it was read from: a tree of bodies, and what each carries.

Poses inside a body are in its frame M: the frame of the joint that leads to it, at the joint's
zero; of the world, the world frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from drake_leg.kinematics.khalil import Array

Parameter = float | str | tuple[float, ...]
Role = Literal["solid", "joint", "foot", "sensor", "loop base", "loop follower"]

WORLD = 0  # the body that stands still


@dataclass(frozen=True, eq=False, kw_only=True)
class Passed:
    """A block on the way from a body's frame M to a place, from base B to follower F or back."""

    sid: str
    name: str
    back: bool
    X_before: Array  # pose in M of the frame before the block
    X_BF: Array  # as the block states it
    method: str = ""  # how it states the translation
    after: Passed | None = None  # the block before it on the way
    depth: int = 1  # blocks on the way so far


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidFacts:
    """What is known of a solid."""

    shape: str  # "brick", "cylinder", "sphere", ...; "other" where it is not known
    size: tuple[float, ...]  # [m], in the order of the shape's dimensions
    mass: float  # [kg]
    inertia: Array  # (3, 3) about the center of mass, in the solid's axes [kg*m^2]
    density: float | None = None  # [kg/m^3]; None where the mass or the inertia is given
    homogeneous: bool = True  # whether the inertia follows from the shape
    colour: tuple[float, ...] = ()  # red, green, blue in 0...1


@dataclass(frozen=True, eq=False, kw_only=True)
class Place:
    """Something at a pose in a body: a solid's center of mass, a joint's base, a sensed frame."""

    role: Role
    name: str
    X_M: Array  # (4, 4) [m]
    sid: str = ""
    way: Passed | None = None  # the last block on the way there
    solid: SolidFacts | None = None
    number: int = 0  # of the joint, the sensor or the loop

    def passed(self) -> list[Passed]:
        """List the blocks on the way there, the first one first."""
        found = []
        here = self.way
        while here is not None:
            found.append(here)
            here = here.after
        return found[::-1]


@dataclass(frozen=True, eq=False, kw_only=True)
class GraphJoint:
    """A joint: of the tree, from its parent to its child, or one that closes a loop."""

    number: int  # counted from 1, from the world outwards
    name: str
    type: str  # "revolute", "prismatic", "universal", ...
    parent: int  # body
    child: int  # body
    sid: str = ""
    turned: bool = False  # whether its follower is towards the world
    parameters: Mapping[str, Parameter] = field(default_factory=dict)  # SI
    priorities: Mapping[str, str] = field(default_factory=dict)  # of the state targets


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensor:
    """What measures the motion of a frame, the foot, against another one, its base."""

    number: int
    name: str
    base: int  # body
    foot: int  # body
    sid: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Graph:
    """The bodies of a mechanism, and what connects them."""

    bodies: tuple[tuple[Place, ...], ...]  # the world's places first
    joints: tuple[GraphJoint, ...]  # of the tree; a parent's comes before its children's
    floating: tuple[int, ...] = ()  # bodies that begin a tree without the world
    loops: tuple[GraphJoint, ...] = ()
    sensors: tuple[Sensor, ...] = ()

    @cached_property
    def children(self) -> dict[int, list[GraphJoint]]:
        """List the joints that lead away from each body."""
        found: dict[int, list[GraphJoint]] = {body: [] for body in range(len(self.bodies))}
        for joint in self.joints:
            found[joint.parent].append(joint)
        return found

    @cached_property
    def inbound(self) -> dict[int, GraphJoint]:
        """Find the joint that leads to each body."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def place_of_joint(self) -> dict[int, Place]:
        """Find the place of each joint on its parent."""
        return {p.number: p for body in self.bodies for p in body if p.role == "joint"}

    def name_of(self, body: int) -> str:
        """Name a body by the joint that leads to it."""
        joint = self.inbound.get(body)
        return "the world" if joint is None else f"the link of joint {joint.name!r}"

    def scaled(self, factor: float) -> Graph:
        """Multiply all lengths; masses and densities stay."""
        if factor == 1.0:
            return self
        known: dict[int, Passed] = {}

        def scaled_way(way: Passed | None) -> Passed | None:
            new = []
            while way is not None and id(way) not in known:
                new.append(way)
                way = way.after
            after = None if way is None else known[id(way)]
            for one in reversed(new):
                X_before, X_BF = (scaled_pose(X, factor) for X in (one.X_before, one.X_BF))
                after = replace(one, X_before=X_before, X_BF=X_BF, after=after)
                known[id(one)] = after
            return after

        def scaled_place(place: Place) -> Place:
            solid = place.solid
            if solid is not None:
                solid = replace(solid, size=tuple(edge * factor for edge in solid.size))
            X_M = scaled_pose(place.X_M, factor)
            return replace(place, X_M=X_M, way=scaled_way(place.way), solid=solid)

        return replace(self, bodies=tuple(tuple(map(scaled_place, one)) for one in self.bodies))


def scaled_pose(X: Array, factor: float) -> Array:
    """Multiply the translation of a pose."""
    found = X.copy()
    found[:3, 3] *= factor
    return found
