"""Opens the loops of a mechanism: a body where a loop closes is split in two, which are welded.

All joints are then joints of a tree, each with its own positions, springs, and inputs. The two
parts have equal shares of the body's mass, so that every body of the tree has mass; the weld is a
constraint between them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.mechanism import inverse
from drake_leg.simulink.multibody.bodies import Body, Joint, Mechanism
from drake_leg.simulink.multibody.mass import Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Weld:
    """A frame of a body and a part of that body, which stay together."""

    body: int
    X_BE: Array  # (4, 4), where the loop closes [m]
    part: int  # the body with its origin there


def with_acting(mechanism: Mechanism) -> Mechanism:
    """Count the 6-DOF joints between connected bodies that act on them among the loops."""
    acting = [joint for joint in mechanism.sensors if _acts(joint)]
    return replace(
        mechanism,
        loops=(*mechanism.loops, *acting),
        sensors=tuple(joint for joint in mechanism.sensors if joint not in acting),
    )


def _acts(joint: Joint) -> bool:
    return any(
        each.driven
        or each.stiffness
        or each.damping
        or each.lower is not None
        or each.upper is not None
        for each in joint.primitives
    )


def opened(mechanism: Mechanism) -> tuple[Mechanism, tuple[Weld, ...]]:
    """Return a mechanism without loops, and the welds that close them.

    Bodies and joints of the tree keep their numbers; the parts and the joints of loops come after.

    Raises
    ------
    InvalidValueError
        If a loop closes between bodies without mass.
    """
    ends = [_split_end(mechanism, joint) for joint in mechanism.loops]
    counts = Counter(ends)
    bodies = [
        replace(body, share=body.share / (1 + counts[number]))
        for number, body in enumerate(mechanism.bodies)
    ]
    joints, welds = list(mechanism.joints), []
    for joint, end in zip(mechanism.loops, ends, strict=True):
        at_follower = end == joint.follower
        X_BE = joint.X_CF if at_follower else joint.X_PB
        part = len(bodies)
        bodies.append(_part(bodies[end], X_BE, f"{bodies[end].name}_at_{joint.name}"))
        welds.append(Weld(body=end, X_BE=X_BE, part=part))
        joints.append(
            replace(joint, follower=part, X_CF=np.eye(4), reversed=False)
            if at_follower
            else replace(joint, base=part, X_PB=np.eye(4), reversed=True)
        )
    tree = replace(mechanism, bodies=tuple(bodies), joints=tuple(joints), loops=())
    return tree, tuple(welds)


def _split_end(mechanism: Mechanism, joint: Joint) -> int:
    """Choose the body to split: one that moves and has mass, the follower before the base."""
    for number in (joint.follower, joint.base):
        if number and mechanism.bodies[number].properties.mass > 0.0:
            return number
    raise InvalidValueError(
        f"the joint {joint.block.name!r} (SID {joint.block.sid}) closes a loop between bodies "
        "without mass: give one of them a mass"
    )


def _part(body: Body, X_BE: Array, name: str) -> Body:
    X_EB = inverse(X_BE)
    return Body(
        name=name,
        solids=tuple((solid, X_EB @ X_BR) for solid, X_BR in body.solids),
        frames={},
        share=body.share,
    )
