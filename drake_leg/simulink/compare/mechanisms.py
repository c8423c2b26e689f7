"""The mechanism of a Simulink model beside another one, matched and aligned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.alignment import Alignment, align, scale_of
from drake_leg.simulink.compare.graph import WORLD, Graph, GraphJoint, Place, scaled_pose
from drake_leg.simulink.compare.matching import Matching, match
from drake_leg.simulink.compare.of_model import read_graph
from drake_leg.simulink.compare.simulink_signals import senses_rotation
from drake_leg.simulink.mechanism import Frame
from drake_leg.simulink.model import Block, Model


@dataclass(frozen=True, kw_only=True)
class Mechanisms:
    """A model's mechanism, ``ours``, and another one, ``theirs``."""

    blocks: Mapping[str, Block]  # of the model without its subsystems, by SID
    ours: Graph  # in their unit of length
    theirs: Graph
    other: str  # what the other side is called
    matching: Matching
    alignment: Alignment
    scale: float  # by which our lengths were divided
    body_of: Mapping[str, int]  # SID of what is rigid -> our body
    frames: Mapping[Frame, tuple[int, Array]]  # frame -> our body, and pose in its frame M

    def block(self, sid: str) -> Block:
        """Find a block of the model."""
        return self.blocks[sid]

    @cached_property
    def numbers(self) -> dict[str, int]:
        """SID of a joint -> number of its counterpart; the others have numbers beyond these."""
        beyond = len(self.theirs.joints) + len(self.ours.joints)
        return {
            joint.sid: self.matching.joints.get(joint.number, beyond + joint.number)
            for joint in self.ours.joints
        }

    @cached_property
    def branches(self) -> dict[int, GraphJoint]:
        """Find for each of our bodies without a counterpart the joint at which its branch begins.

        A tree of its own, without the world, begins with no joint.
        """
        found: dict[int, GraphJoint] = {}
        for joint in self.ours.joints:
            if joint.number not in self.matching.joints:
                at_root = joint.parent in self.matching.bodies or joint.parent == WORLD
                head = joint if at_root else found.get(joint.parent)
                if head is not None:
                    found[joint.child] = head
        return found

    def counterpart(self, joint: GraphJoint) -> GraphJoint | None:
        """Return the joint that stands for one of ours."""
        number = self.matching.joints.get(joint.number)
        return None if number is None else self.theirs.joints[number - 1]


def read_mechanisms(model: Model, flat: Model, theirs: Graph, other: str) -> Mechanisms:
    """Read a model's mechanism, and match and align it with another one.

    Raises
    ------
    InvalidValueError
        That lists all that is missing for a mechanism.
    """
    blocks = {block.sid: block for block in flat.blocks}
    read = read_graph(model, flat)
    matching = match(read.graph, theirs)
    scale = scale_of(read.graph, theirs, matching)
    ours = read.graph.scaled(1.0 / scale)

    def turns(place: Place) -> bool:
        """Tell whether it matters how a place is turned."""
        if place.role not in ("sensor", "foot"):
            return place.role != "solid"
        block = blocks[place.sid]
        in_base = block.parameters.get("MeasurementFrame", "Base") != "World"
        is_base = place.role == "sensor" and place.number not in matching.turned
        return senses_rotation(block) or (is_base and in_base)

    return Mechanisms(
        blocks=blocks,
        ours=ours,
        theirs=theirs,
        other=other,
        matching=matching,
        alignment=align(ours, theirs, matching, turns),
        scale=scale,
        body_of=read.body_of,
        frames={
            frame: (body, scaled_pose(X, 1.0 / scale)) for frame, (body, X) in read.frames.items()
        },
    )
