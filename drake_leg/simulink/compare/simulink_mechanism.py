"""The physical network of a Simulink model, read as a chain of bodies and joints."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.simulink.compare.mechanism import (
    ChainJoint,
    Mechanism,
    Parameter,
    PassedTransform,
    Place,
)
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.poses import about, inverse, rigid_transform
from drake_leg.simulink.solids import SOLIDS, SolidProperties, read_solid
from drake_leg.simulink.values import is_on, senseless, vector

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
    sensor: str | None  # SID of the 6-DOF joint that senses the foot
    sensor_turned: bool  # whether it senses the world from the foot
    turned: tuple[int, ...]  # joints whose follower is towards the world
    exchanged: tuple[int, ...]  # those of them that are read as if they were not
    loose: tuple[str, ...]  # SIDs of mechanical blocks that hang on nothing
    unknown: dict[str, str]  # SID -> why this mechanical block has no place in a serial chain
    frames: dict[int, tuple[int, Array]]  # node -> body, and pose in that body's frame M


@dataclass
class _Walk:
    """What is found on the way from the world outwards."""

    blocks: dict[str, Block]
    node_of: dict[str, int]  # physical port -> node
    found: dict[int, tuple[int, Array, tuple[PassedTransform, ...]]] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)

    def end(self, block: Block, port: str) -> int:
        """Node at a block's port; a port that hangs in the air is a node of its own."""
        name = f"{block.sid}#{port}"
        return self.node_of.setdefault(name, len(self.node_of) + 1_000_000)


def read_network(model: Model, *, taken_as_drawn: Sequence[int] = ()) -> Network:
    """Read the chain that a model's physical connections make.

    Joints with the numbers ``taken_as_drawn`` have base and follower exchanged by mistake: their
    frames are read as if they had not.

    Raises
    ------
    InvalidValueError
        If a Rigid Transform, a joint or a solid cannot be read.
    """
    blocks = {block.sid: block for block in model.blocks}
    node_of = {port: index for index, node in enumerate(model.nodes) for port in node}
    walk = _Walk(blocks, node_of)
    sensors = [block for block in model.blocks if block.kind in SENSORS]
    joints: list[ChainJoint] = []
    turned_joints: list[int] = []
    bases: dict[int, tuple[int, Array, tuple[PassedTransform, ...], ChainJoint]] = {}

    roots = [walk.end(block, FOLLOWER) for block in model.blocks if block.kind == "World Frame"]
    _spread(walk, [(root, np.eye(4)) for root in roots], body=0)
    grounded = _next_joint(walk) is not None
    if not grounded:
        _spread(walk, [(base, np.eye(4)) for base in _outermost_base(walk)], body=0)
    while True:
        found = _next_joint(walk)
        if found is None:
            break
        block, near, far, turned = found
        number = len(joints) + 1
        body, X, way = walk.found[near]
        joint = ChainJoint(
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
        joints.append(joint)
        if turned:
            turned_joints.append(number)
        flip = about("x", math.pi) if turned and number not in taken_as_drawn else np.eye(4)
        bases[number] = (body, X @ flip, way, joint)
        walk.used.add(block.sid)
        _spread(walk, [(far, inverse(flip))], body=number)

    places: list[list[Place]] = [[] for _ in range(len(joints) + 1)]
    for number, (body, X, way, joint) in bases.items():
        places[body].append(
            Place(role="joint", name=joint.name, sid=joint.sid, X_M=X, way=way, number=number)
        )
    _add_solids(walk, places)
    sensor, sensor_turned = _add_sensor(walk, sensors, places)
    mechanism = Mechanism(
        joints=tuple(joints),
        bodies=tuple(tuple(body) for body in places),
    )
    return Network(
        mechanism=mechanism,
        joints={joint.sid: joint.number for joint in joints},
        grounded=grounded,
        sensor=sensor,
        sensor_turned=sensor_turned,
        turned=tuple(turned_joints),
        exchanged=tuple(taken_as_drawn),
        loose=tuple(
            block.sid
            for block in model.blocks
            if block.kind in (*MOVING, *RIGID, *SOLIDS) and block.sid not in walk.used
        ),
        unknown={
            joint.sid: "it branches off: only serial chains are compared"
            for number, (body, _, _, joint) in bases.items()
            if body != number - 1
        },
        frames={node: (body, X) for node, (body, X, _) in walk.found.items()},
    )


def _outermost_base(walk: _Walk) -> list[int]:
    """Find the base of a joint that is no other joint's follower, in a model without a world."""
    joints = [block for block in walk.blocks.values() if block.kind in MOVING]
    followers = {walk.end(block, FOLLOWER) for block in joints}
    bases = [walk.end(block, BASE) for block in joints]
    rigid = {
        walk.end(block, port)
        for block in walk.blocks.values()
        if block.kind in RIGID
        for port in (BASE, FOLLOWER)
    }
    return [base for base in bases if base not in followers | rigid][:1] or bases[:1]


def _spread(walk: _Walk, starts: list[tuple[int, Array]], body: int) -> None:
    """Follow the rigid connections of one body from its first frames."""
    queue = deque(starts)
    for node, X in starts:
        walk.found.setdefault(node, (body, X, ()))
    rigid = [block for block in walk.blocks.values() if block.kind in RIGID]
    while queue:
        node, _ = queue.popleft()
        _, X, way = walk.found[node]
        for block in rigid:
            base, follower = walk.end(block, BASE), walk.end(block, FOLLOWER)
            if node not in (base, follower) or block.sid in walk.used:
                continue
            walk.used.add(block.sid)
            back = node == follower
            X_BF = rigid_transform(block) if block.kind == "Rigid Transform" else np.eye(4)
            X_next = X @ (inverse(X_BF) if back else X_BF)
            other = base if back else follower
            passed = PassedTransform(
                sid=block.sid,
                name=block.name,
                back=back,
                X_before=X,
                X_BF=X_BF,
                method=str(block.parameters.get("TranslationMethod", "")),
            )
            if other not in walk.found:
                walk.found[other] = (body, X_next, (*way, passed))
                queue.append((other, X_next))


def _next_joint(walk: _Walk) -> tuple[Block, int, int, bool] | None:
    """Find a joint with one end on what is known and the other beyond."""
    for body in range(len(walk.used) + 1):
        for block in walk.blocks.values():
            if block.kind not in MOVING or block.sid in walk.used:
                continue
            base, follower = walk.end(block, BASE), walk.end(block, FOLLOWER)
            for near, far, turned in ((base, follower, False), (follower, base, True)):
                if near in walk.found and walk.found[near][0] == body and far not in walk.found:
                    return block, near, far, turned
    return None


def _add_solids(walk: _Walk, places: list[list[Place]]) -> None:
    for block in walk.blocks.values():
        if block.kind not in SOLIDS:
            continue
        node = next((n for p, n in walk.node_of.items() if p.startswith(f"{block.sid}#")), None)
        if node not in walk.found:
            continue
        body, X, way = walk.found[node]
        walk.used.add(block.sid)
        places[body].append(
            Place(role="solid", name=block.name, sid=block.sid, X_M=X, way=way, solid=_solid(block))
        )


def _add_sensor(
    walk: _Walk, sensors: list[Block], places: list[list[Place]]
) -> tuple[str | None, bool]:
    """Find the sensor between the world and the outermost body that one reaches, and its sense."""
    best: tuple[int, bool, Block, int] | None = None
    for block in sensors:
        ends = (walk.end(block, BASE), walk.end(block, FOLLOWER))
        for (base, follower), turned in ((ends, False), (ends[::-1], True)):
            if base not in walk.found or follower not in walk.found or walk.found[base][0] != 0:
                continue
            body = walk.found[follower][0]
            if best is None or body > best[0]:
                best = (body, turned, block, follower)
    if best is None:
        return None, False
    body, turned, block, follower = best
    _, X, way = walk.found[follower]
    walk.used.add(block.sid)
    places[body].append(Place(role="foot", name=block.name, sid=block.sid, X_M=X, way=way))
    return block.sid, turned


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
        raise senseless(block, name, "it must be one number")
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
        raise senseless(block, "BrickDimensions", "it must be three numbers")
    return solid
