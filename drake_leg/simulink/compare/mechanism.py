"""A chain of bodies and joints in a form that both sides are brought to.

Poses inside a body are in the frame M of the joint that carries it (of the world for the first
body), at the joint's zero.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from drake_leg.kinematics.batches import Array
from drake_leg.simulink.bodies import SolidProperties

Parameter = float | str


@dataclass(frozen=True, kw_only=True)
class PassedTransform:
    """A Rigid Transform on the way from a body's frame M to a place, from B to F or back."""

    sid: str
    name: str
    back: bool
    X_before: Array  # pose in M of the frame before the transform
    X_BF: Array  # as the block states it
    method: str  # how it states the translation


@dataclass(frozen=True, kw_only=True)
class Place:
    """Something at a pose in a body: a solid, the next joint's base, the sensed foot."""

    role: str  # "solid", "joint", "foot"
    name: str
    X_M: Array  # (4, 4)
    sid: str = ""
    way: tuple[PassedTransform, ...] = ()
    solid: SolidProperties | None = None
    number: int = 0  # of the joint, counted from 1


@dataclass(frozen=True, kw_only=True)
class ChainJoint:
    """A joint of the chain."""

    number: int  # counted from 1, from the world outwards
    name: str
    type: str  # "revolute", "prismatic"
    sid: str = ""
    parameters: dict[str, Parameter] = field(default_factory=dict)  # SI
    priorities: dict[str, str] = field(default_factory=dict)  # of the state targets


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """A serial chain."""

    joints: tuple[ChainJoint, ...]
    bodies: tuple[tuple[Place, ...], ...]  # one more than joints: the world's places come first
