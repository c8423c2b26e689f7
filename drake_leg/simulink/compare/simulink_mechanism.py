"""The physical network of a Simulink model, read as a chain of bodies and joints."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.plant_mechanism import (
    ChainJoint,
    Mechanism,
    Parameter,
    PassedTransform,
    Place,
)
from drake_leg.simulink.mechanism import (
    SOLIDS,
    SolidProperties,
    about,
    inverse,
    read_solid,
    rigid_transform,
)
from drake_leg.simulink.model import Block, Model, invalid_parameter, is_on, vector

MOVING = {"Revolute Joint": "revolute", "Prismatic Joint": "prismatic"}
SENSORS = ("6-DOF Joint", "Transform Sensor")
RIGID = ("Rigid Transform", "Weld Joint")
BASE, FOLLOWER = "lconn:1", "rconn:1"


@dataclass(frozen=True, kw_only=True)
class Network:
    """A mechanism, and which block of the model became what of it."""

    mechanism: Mechanism
    joints: dict[str, int]  # SID -> number in the chain
    grounded: bool  # whether the World Frame carries the chain; if not, it is read from its base
    sensor: str | None  # SID of the block that senses the foot
    sensor_turned: bool  # whether it senses the world from the foot
    turned: tuple[int, ...]  # joints whose follower is towards the world
    exchanged: tuple[int, ...]  # those of them that are read as if they were not
    unplaced: dict[str, str]  # SID -> why this mechanical block has no place in a serial chain
    frames: dict[int, tuple[int, Array]]  # node -> body, and pose in that body's frame M


class Found(NamedTuple):
    """Where a node is: its body, its pose in that body's frame M, and the way to it."""

    body: int
    X_M: Array
    way: tuple[PassedTransform, ...]


def read_network(model: Model, *, taken_as_drawn: Sequence[int] = ()) -> Network:
    """Read the chain that a model's physical connections make.

    Joints with the numbers ``taken_as_drawn`` have base and follower exchanged by mistake: their
    frames are read as if they had not.
    """
    walk = _Walk(model)
    roots = [walk.node(block, FOLLOWER) for block in model.blocks if block.kind == "World Frame"]
    walk.spread(roots, np.eye(4), body=0)
    grounded = walk.next_joint() is not None
    if not grounded:
        walk.spread(walk.outermost_base(), np.eye(4), body=0)
    joints: list[ChainJoint] = []
    turned_joints: list[int] = []
    branches: dict[str, str] = {}
    places: list[list[Place]] = [[]]
    while (found := walk.next_joint()) is not None:
        block, near, far, turned = found
        number, at = len(joints) + 1, walk.found[near]
        joints.append(_joint(block, number))
        turned_joints += [number] * turned
        if at.body != number - 1:
            branches[block.sid] = "it branches off: only serial chains are compared"
        flip = about("x", math.pi) if turned and number not in taken_as_drawn else np.eye(4)
        joint_at = at._replace(X_M=at.X_M @ flip)
        places[at.body].append(_place("joint", block, joint_at, number=number))
        places.append([])
        walk.used.add(block.sid)
        walk.spread([far], inverse(flip), body=number)
    for body, place in walk.solids():
        places[body].append(place)
    sensor, sensor_turned = walk.sensor()
    for body, place in sensor:
        places[body].append(place)
    loose = [
        block.sid
        for block in model.blocks
        if block.kind in (*MOVING, *RIGID, *SOLIDS) and block.sid not in walk.used
    ]
    unconnected = "it is connected to nothing that leads to the World Frame"
    return Network(
        mechanism=Mechanism(joints=tuple(joints), bodies=tuple(map(tuple, places))),
        joints={joint.sid: joint.number for joint in joints},
        grounded=grounded,
        sensor=next((place.sid for _, place in sensor), None),
        sensor_turned=sensor_turned,
        turned=tuple(turned_joints),
        exchanged=tuple(taken_as_drawn),
        unplaced=dict.fromkeys(loose, unconnected) | branches,
        frames={node: (at.body, at.X_M) for node, at in walk.found.items()},
    )


class _Walk:
    """A walk from the world outwards, over the nodes ``found`` and the blocks ``used`` so far."""

    def __init__(self, model: Model) -> None:
        self._blocks = model.blocks
        self._rigid = [block for block in model.blocks if block.kind in RIGID]
        self._joints = [block for block in model.blocks if block.kind in MOVING]
        self._node_of = {port: index for index, node in enumerate(model.nodes) for port in node}
        self.found: dict[int, Found] = {}
        self.used: set[str] = set()

    def node(self, block: Block, port: str) -> int:
        """Node at a block's port; a port that is not connected is a node of its own."""
        return self._node_of.setdefault(f"{block.sid}#{port}", len(self._node_of) + 1_000_000)

    def ends(self, block: Block) -> tuple[int, int]:
        """Nodes at a block's base and follower."""
        return self.node(block, BASE), self.node(block, FOLLOWER)

    def outermost_base(self) -> list[int]:
        """Find the base of a joint that is no other joint's follower, without a world."""
        ends = [self.ends(block) for block in self._joints]
        inner = {follower for _, follower in ends}
        inner |= {node for block in self._rigid for node in self.ends(block)}
        bases = [base for base, _ in ends]
        return [base for base in bases if base not in inner][:1] or bases[:1]

    def spread(self, starts: list[int], X_M: Array, body: int) -> None:
        """Follow the rigid connections of one body from its first frames."""
        queue = deque(starts)
        for node in starts:
            self.found.setdefault(node, Found(body, X_M, ()))
        while queue:
            node = queue.popleft()
            at = self.found[node]
            for block in self._rigid:
                base, follower = self.ends(block)
                if node not in (base, follower) or block.sid in self.used:
                    continue
                self.used.add(block.sid)
                back = node == follower
                X_BF = rigid_transform(block) if block.kind == "Rigid Transform" else np.eye(4)
                passed = PassedTransform(
                    sid=block.sid,
                    name=block.name,
                    back=back,
                    X_before=at.X_M,
                    X_BF=X_BF,
                    method=str(block.parameters.get("TranslationMethod", "")),
                )
                other = base if back else follower
                if other not in self.found:
                    X_next = at.X_M @ (inverse(X_BF) if back else X_BF)
                    self.found[other] = Found(body, X_next, (*at.way, passed))
                    queue.append(other)

    def next_joint(self) -> tuple[Block, int, int, bool] | None:
        """Find the innermost joint with one end on what is known and the other beyond.

        Returns the joint, its near and far node, and whether its follower is the near one.
        """
        reached = [
            (self.found[near].body, block, near, far, turned)
            for block in self._joints
            if block.sid not in self.used
            for turned, (near, far) in enumerate((self.ends(block), self.ends(block)[::-1]))
            if near in self.found and far not in self.found
        ]
        if not reached:
            return None
        _, block, near, far, turned = min(reached, key=lambda one: one[0])
        return block, near, far, bool(turned)

    def solids(self) -> Iterator[tuple[int, Place]]:
        """List the solids, each with its body."""
        for block in self._blocks:
            if block.kind in SOLIDS:
                ports = (n for p, n in self._node_of.items() if p.startswith(f"{block.sid}#"))
                at = self.found.get(next(ports, -1))
                if at is not None:
                    self.used.add(block.sid)
                    yield at.body, _place("solid", block, at, _solid(block))

    def sensor(self) -> tuple[list[tuple[int, Place]], bool]:
        """Find the sensor between the world and the outermost body, and whether it is turned."""
        reached = [
            (self.found[far], block, bool(turned))
            for block in self._blocks
            if block.kind in SENSORS
            for turned, (near, far) in enumerate((self.ends(block), self.ends(block)[::-1]))
            if near in self.found and far in self.found and self.found[near].body == 0
        ]
        if not reached:
            return [], False
        at, block, turned = max(reached, key=lambda one: one[0].body)
        self.used.add(block.sid)
        return [(at.body, _place("foot", block, at))], turned


def _place(
    role: str, block: Block, at: Found, solid: SolidProperties | None = None, number: int = 0
) -> Place:
    return Place(
        role=role,
        name=block.name,
        sid=block.sid,
        X_M=at.X_M,
        way=at.way,
        solid=solid,
        number=number,
    )


def _joint(block: Block, number: int) -> ChainJoint:
    return ChainJoint(
        number=number,
        name=block.name,
        sid=block.sid,
        type=MOVING[block.kind],
        parameters=_joint_parameters(block),
        priorities={
            name: str(block.parameters.get(name, "High"))
            for name in ("PositionTargetPriority", "VelocityTargetPriority")
        },
    )


def _joint_parameters(block: Block) -> dict[str, Parameter]:
    """Collect what acts at a joint, under the file's names, in SI."""
    get = block.parameters.get
    mode = str(get("JointMode", "Normal"))
    found: dict[str, Parameter] = {} if mode == "Normal" else {"JointMode": mode}
    found |= {
        "MotionActuationMode": str(get("MotionActuationMode", "ComputedMotion")),
        "TorqueActuationMode": _actuation(block),
        "SpringStiffness": _scalar(block, "SpringStiffness"),
        "DampingCoefficient": _scalar(block, "DampingCoefficient"),
    }
    if found["SpringStiffness"]:
        found["EquilibriumPosition"] = _scalar(block, "EquilibriumPosition")
    for side in ("Lower", "Upper"):
        if is_on(block, f"{side}LimitSpecify"):
            for what in ("Bound", "Stiffness", "Damping", "TransitionRegionWidth"):
                if f"{side}Limit{what}" in block.parameters:
                    found[f"{side}Limit{what}"] = _scalar(block, f"{side}Limit{what}")
    for what in ("Position", "Velocity"):
        if is_on(block, f"{what}TargetSpecify"):
            found[f"{what}TargetValue"] = _scalar(block, f"{what}TargetValue")
    return found


def _scalar(block: Block, name: str) -> float:
    numbers = vector(block.parameters.get(name, 0.0))
    if len(numbers) != 1:
        raise invalid_parameter(block, name, "it must be one number")
    return numbers[0]


def _actuation(block: Block) -> str:
    """Return how a joint is actuated, in a turning joint's words."""
    modes = [
        str(block.parameters.get(f"{what}ActuationMode", "")).replace("Force", "Torque")
        for what in ("Torque", "Force")
    ]
    return next((mode for mode in modes if mode not in ("", "NoTorque")), "NoTorque")


def _solid(block: Block) -> SolidProperties:
    solid = read_solid(block)
    if solid.shape == "brick" and len(solid.size) != 3:
        raise invalid_parameter(block, "BrickDimensions", "it must be three numbers")
    return solid
