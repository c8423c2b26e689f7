"""The physical network of a Simulink model, read as a chain of bodies and joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.of_diagram import (
    ChainJoint,
    Mechanism,
    Parameter,
    PassedTransform,
    Place,
)
from drake_leg.simulink.mechanism import (
    FOLLOWER,
    RIGID,
    SOLIDS,
    Frame,
    PhysicalNetwork,
    SolidProperties,
    Walk,
    WalkStep,
    about,
    inverse,
    network_of,
    read_solid,
    rigid_transform,
)
from drake_leg.simulink.model import Block, Model, invalid_parameter, is_on, vector

MOVING = {"Revolute Joint": "revolute", "Prismatic Joint": "prismatic"}
SENSORS = ("6-DOF Joint", "Transform Sensor")


@dataclass(frozen=True, kw_only=True)
class ModelChain:
    """A mechanism, and which block of the model became what of it."""

    mechanism: Mechanism
    joints: dict[str, int]  # SID -> number in the chain
    grounded: bool  # whether the World Frame carries the chain; if not, it is read from its base
    sensor: str | None  # SID of the block that senses the foot
    sensor_turned: bool  # whether it senses the world from the foot
    turned: tuple[int, ...]  # joints whose follower is towards the world
    exchanged: tuple[int, ...]  # those of them that are read as if they were not
    unplaced: dict[str, str]  # SID -> why this mechanical block has no place in a serial chain
    frames: dict[Frame, tuple[int, Array]]  # frame -> body, and pose in that body's frame M


@dataclass(frozen=True, kw_only=True)
class Route:
    """The way from the world, or from the base of a chain without one, over a model's joints."""

    network: PhysicalNetwork
    starts: tuple[Frame, ...]
    steps: tuple[WalkStep, ...]  # over joints and what is rigid, one body after the other
    grounded: bool
    poses: dict[str, Array]  # SID of what is rigid -> X_BF


class Found(NamedTuple):
    """Where a frame is: its body, its pose in that body's frame M, and the way to it."""

    body: int
    X_M: Array
    way: tuple[PassedTransform, ...]


def find_route(model: Model) -> Route:
    """Walk over a model's physical network: a whole rigid body, then the innermost joint."""
    network = network_of(model)
    order = {block.sid: index for index, block in enumerate(model.blocks)}

    def rank(block: Block, body: int) -> tuple[int, ...] | None:
        if block.kind in MOVING:
            return (1, body, order[block.sid])
        return (0,) if block.kind in RIGID else None

    walk = Walk(network, rank)
    starts = [network.ends(block)[1] for block in model.blocks if block.kind == "World Frame"]
    for frame in starts:
        walk.reach(frame)
    steps = list(walk)
    grounded = any(step.beyond for step in steps)
    if not grounded:
        bases = _outermost_base(network)
        for frame in bases:
            walk.reach(frame)
        starts += bases
        steps += walk
    return Route(
        network=network,
        starts=tuple(starts),
        steps=tuple(steps),
        grounded=grounded,
        poses={
            step.block.sid: rigid_transform(step.block)
            if step.block.kind == "Rigid Transform"
            else np.eye(4)
            for step in steps
            if step.block.kind in RIGID
        },
    )


def _outermost_base(network: PhysicalNetwork) -> list[Frame]:
    """Find the base of a joint that is no other joint's follower, without a world."""
    blocks = network.blocks.values()
    ends = [network.ends(block) for block in blocks if block.kind in MOVING]
    inner = {follower for _, follower in ends}
    inner |= {end for block in blocks if block.kind in RIGID for end in network.ends(block)}
    bases = [base for base, _ in ends]
    return [base for base in bases if base not in inner][:1] or bases[:1]


def read_chain(route: Route, *, taken_as_drawn: Sequence[int] = ()) -> ModelChain:
    """Read the chain that a model's physical connections make.

    Joints with the numbers ``taken_as_drawn`` have base and follower exchanged by mistake: their
    frames are read as if they had not.
    """
    network = route.network
    found = {frame: Found(0, np.eye(4), ()) for frame in route.starts}
    joints: list[ChainJoint] = []
    turned: list[int] = []
    branches: dict[str, str] = {}
    used: set[str] = set()
    places: list[list[Place]] = [[]]
    for step in route.steps:
        block = step.block
        if block.kind in RIGID or step.far:
            used.add(block.sid)
        if not step.far:
            continue
        at, far = found[network.frame(step.near[0])], network.frame(step.far[0])
        back = step.near[0].endswith(FOLLOWER)
        if block.kind in RIGID:
            found[far] = _passed(block, at, route.poses[block.sid], back=back)
            continue
        number = len(joints) + 1
        joints.append(_joint(block, number))
        turned += [number] * back
        if at.body != number - 1:
            branches[block.sid] = "it branches off: only serial chains are compared"
        flip = about("x", math.pi) if back and number not in taken_as_drawn else np.eye(4)
        joint_at = at._replace(X_M=at.X_M @ flip)
        places[at.body].append(_place("joint", block, joint_at, number=number))
        places.append([])
        found[far] = Found(number, inverse(flip), ())
    for block in network.blocks.values():
        ports = network.ports.get(block.sid, ()) if block.kind in SOLIDS else ()
        frame = min((network.frames[port] for port in ports), default=-1)
        if frame in found:
            used.add(block.sid)
            places[found[frame].body].append(_place("solid", block, found[frame], _solid(block)))
    sensor, sensor_turned = _sensor(network, found)
    if sensor is not None:
        at, block = sensor
        used.add(block.sid)
        places[at.body].append(_place("foot", block, at))
    loose = [
        block.sid
        for block in network.blocks.values()
        if block.kind in (*MOVING, *RIGID, *SOLIDS) and block.sid not in used
    ]
    unconnected = "it is connected to nothing that leads to the World Frame"
    return ModelChain(
        mechanism=Mechanism(joints=tuple(joints), bodies=tuple(map(tuple, places))),
        joints={joint.sid: joint.number for joint in joints},
        grounded=route.grounded,
        sensor=sensor[1].sid if sensor else None,
        sensor_turned=sensor_turned,
        turned=tuple(turned),
        exchanged=tuple(taken_as_drawn),
        unplaced=dict.fromkeys(loose, unconnected) | branches,
        frames={frame: (at.body, at.X_M) for frame, at in found.items()},
    )


def _passed(block: Block, at: Found, X_BF: Array, *, back: bool) -> Found:
    """Go through a Rigid Transform, or a weld, from base to follower or back."""
    passed = PassedTransform(
        sid=block.sid,
        name=block.name,
        back=back,
        X_before=at.X_M,
        X_BF=X_BF,
        method=str(block.parameters.get("TranslationMethod", "")),
    )
    return Found(at.body, at.X_M @ (inverse(X_BF) if back else X_BF), (*at.way, passed))


def _sensor(
    network: PhysicalNetwork, found: dict[Frame, Found]
) -> tuple[tuple[Found, Block] | None, bool]:
    """Find the sensor between the world and the outermost body, and whether it is turned."""
    reached = [
        (found[far], block, bool(turned))
        for block in network.blocks.values()
        if block.kind in SENSORS
        for turned, (near, far) in enumerate((network.ends(block), network.ends(block)[::-1]))
        if near in found and far in found and found[near].body == 0
    ]
    if not reached:
        return None, False
    at, block, turned = max(reached, key=lambda one: one[0].body)
    return (at, block), turned


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
