"""A Simulink model's mechanism as a graph, and which block became what of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.compare.graph import (
    WORLD,
    Graph,
    GraphJoint,
    Parameter,
    Passed,
    Place,
    Role,
    Sensor,
    SolidFacts,
)
from drake_leg.simulink.mechanism import BASE, FOLLOWER, Frame, about, inverse
from drake_leg.simulink.model import Block, Model, invalid_parameter, is_on, vector
from drake_leg.simulink.multibody.bodies import Joint, Mechanism, read_mechanism
from drake_leg.simulink.multibody.connections import WORLD as WORLD_FRAME
from drake_leg.simulink.multibody.connections import Rigid
from drake_leg.simulink.multibody.joints import SINGLE
from drake_leg.simulink.multibody.solids import (
    Brick,
    Cylinder,
    Ellipsoid,
    Extrusion,
    Revolution,
    Solid,
)

SENSING_JOINTS = ("6-DOF Joint", "Bushing Joint")  # joints that constrain nothing
SENSORS = (*SENSING_JOINTS, "Transform Sensor")
FLIP = about("x", math.pi)  # turns the axis of a joint whose follower is towards the world


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelGraph:
    """A model's mechanism, and where its blocks are."""

    graph: Graph
    body_of: dict[str, int]  # SID of what is rigid -> its body
    frames: dict[Frame, tuple[int, Array]]  # frame -> body, and pose in that body's frame M


@dataclass(frozen=True, eq=False, kw_only=True)
class _Found:
    """Where a frame is: its body, its pose in that body's frame M, and the way to it."""

    body: int
    X_M: Array
    way: Passed | None


def read_graph(model: Model, flat: Model) -> ModelGraph:
    """Read the mechanism of a model; ``flat`` is the same model without its subsystems.

    Raises
    ------
    InvalidValueError
        That lists all that is missing for a mechanism.
    """
    mechanism = read_mechanism(model, apart=False)
    sensors = _mistaken(mechanism)
    if sensors:
        mechanism = read_mechanism(model, sensors, apart=False)
    return _Reading(mechanism, flat).graph()


def _mistaken(mechanism: Mechanism) -> frozenset[str]:
    """Find sensors on which a chain seems to hang, since nothing else holds it.

    They are free joints from the world to the last link of a chain, whose other joints all lead to
    that link from its base.
    """
    ends: dict[int, list[Joint]] = {}
    for joint in mechanism.joints:
        for body in (joint.base, joint.follower):
            ends.setdefault(body, []).append(joint)

    def seems(joint: Joint) -> bool:
        others = [other for other in ends[joint.follower] if other is not joint]
        inward = bool(others) and all(other.follower == joint.follower for other in others)
        return joint.base == WORLD and inward and _only_senses(joint.block)

    return frozenset(joint.block.sid for joint in mechanism.joints if seems(joint))


def _only_senses(block: Block) -> bool:
    senses = any("Sense" in name and value == "on" for name, value in _switches(block))
    return block.kind in SENSING_JOINTS and senses


def _switches(block: Block) -> Iterable[tuple[str, object]]:
    return ((name, block.parameters.get(name)) for name in block.parameters if "Sense" in name)


class _Reading:
    """Places everything in its body, with the way there."""

    def __init__(self, mechanism: Mechanism, flat: Model) -> None:
        self._mechanism = mechanism
        self._blocks = flat.blocks
        self._node_of = {port: index for index, node in enumerate(flat.nodes) for port in node}
        self._near: dict[Frame, list[tuple[Frame, Rigid, bool]]] = {}
        for rigid in mechanism.connections.rigid:
            self._near.setdefault(rigid.base, []).append((rigid.follower, rigid, False))
            self._near.setdefault(rigid.follower, []).append((rigid.base, rigid, True))
        self._found: dict[Frame, _Found] = {}
        self._bodies: list[list[Place]] = [[] for _ in mechanism.bodies]
        self._body_of: dict[str, int] = {}
        inbound = {_child(joint): joint for joint in mechanism.joints}
        for number, body in enumerate(mechanism.bodies):
            self._walk(number, *_origin(number, inbound.get(number), body.frames))

    def graph(self) -> ModelGraph:
        """Put all places together."""
        joints = [self._joint(n, one) for n, one in enumerate(self._mechanism.joints, start=1)]
        for body in self._mechanism.bodies:
            for solid, _ in body.solids:
                self._solid(solid)
        cut = (*self._mechanism.loops, *self._mechanism.sensors)
        loops = [joint for joint in cut if joint.block.kind not in SENSING_JOINTS]
        graph = Graph(
            joints=tuple(joints),
            floating=self._mechanism.floating,
            loops=tuple(self._loop(number, joint) for number, joint in enumerate(loops)),
            sensors=tuple(self._sensors([joint.block for joint in cut])),
            bodies=tuple(map(tuple, self._bodies)),
        )
        frames = {frame: (at.body, at.X_M) for frame, at in self._found.items()}
        return ModelGraph(graph=graph, body_of=self._body_of, frames=frames)

    def _walk(self, body: int, root: Frame, X_M: Array) -> None:
        """Find all frames of a body, from the frame at which it is entered."""
        self._found[root] = _Found(body=body, X_M=X_M, way=None)
        line = [root]
        for here in line:
            at = self._found[here]
            for there, rigid, back in self._near.get(here, ()):
                if there not in self._found:
                    self._found[there] = _passed(rigid, at, back=back)
                    line.append(there)
                if rigid.block is not None:
                    self._body_of.setdefault(rigid.block.sid, body)

    def _add(self, role: Role, block: Block, at: _Found, **more: object) -> None:
        given = {"role": role, "name": block.name, "sid": block.sid, "X_M": at.X_M, "way": at.way}
        self._bodies[at.body].append(Place(**{**given, **more}))  # type: ignore[arg-type]

    def _joint(self, number: int, joint: Joint) -> GraphJoint:
        connects = joint.connects
        at = self._found[connects.follower if joint.reversed else connects.base]
        X_M = at.X_M @ FLIP if joint.reversed else at.X_M
        self._add("joint", joint.block, at, X_M=X_M, number=number)
        read = _graph_joint(number, joint)
        return replace(read, parent=at.body, child=_child(joint), turned=joint.reversed)

    def _loop(self, number: int, joint: Joint) -> GraphJoint:
        ends = self._found[joint.connects.base], self._found[joint.connects.follower]
        self._add("loop base", joint.block, ends[0], number=number)
        self._add("loop follower", joint.block, ends[1], number=number)
        return _graph_joint(number, joint)

    def _solid(self, solid: Solid) -> None:
        """Place a solid at its center of mass, in its own axes."""
        if solid.block.kind == "Graphic":
            return
        at = self._found[f"{solid.block.sid}#R"]
        X_RC = np.eye(4)
        X_RC[:3, 3] = solid.properties.center
        self._body_of.setdefault(solid.block.sid, at.body)
        self._add("solid", solid.block, at, X_M=at.X_M @ X_RC, solid=_facts(solid))

    def _sensors(self, cut: Iterable[Block]) -> list[Sensor]:
        """Find the sensors whose two frames are on bodies."""
        sids = {block.sid for block in cut if block.kind in SENSING_JOINTS}
        found: list[Sensor] = []
        for block in self._blocks:
            if block.kind == "Transform Sensor" or block.sid in sids:
                ports = (f"{block.sid}#{end}" for end in (BASE, FOLLOWER))
                base, foot = (self._found.get(self._node_of.get(port, port)) for port in ports)
                if base is not None and foot is not None:
                    number = len(found)
                    self._add("sensor", block, base, number=number)
                    self._add("foot", block, foot, number=number)
                    found.append(
                        Sensor(
                            number=number,
                            name=block.name,
                            sid=block.sid,
                            base=base.body,
                            foot=foot.body,
                        )
                    )
        return found


def _child(joint: Joint) -> int:
    return joint.base if joint.reversed else joint.follower


def _origin(number: int, joint: Joint | None, frames: Mapping[Frame, Array]) -> tuple[Frame, Array]:
    """Return the frame at which a body is entered, and its pose in M."""
    if number == WORLD:
        return WORLD_FRAME, np.eye(4)
    if joint is None:
        return next(iter(frames)), np.eye(4)
    if joint.reversed:
        return joint.connects.base, inverse(FLIP)
    return joint.connects.follower, np.eye(4)


def _passed(rigid: Rigid, at: _Found, *, back: bool) -> _Found:
    """Go from base to follower or back, through a block if one states the pose."""
    X_M = at.X_M @ (inverse(rigid.X_BF) if back else rigid.X_BF)
    block = rigid.block
    if block is None:
        return _Found(body=at.body, X_M=X_M, way=at.way)
    passed = Passed(
        sid=block.sid,
        name=block.name,
        back=back,
        X_before=at.X_M,
        X_BF=rigid.X_BF,
        method=str(block.parameters.get("TranslationMethod", "")),
        after=at.way,
        depth=at.way.depth + 1 if at.way else 1,
    )
    return _Found(body=at.body, X_M=X_M, way=passed)


# --- joints ----------------------------------------------------------------------------------


def _graph_joint(number: int, joint: Joint) -> GraphJoint:
    """Read what a joint is, and what acts at it, under the file's names, in SI."""
    block = joint.block
    prefixes = [""] if block.kind in SINGLE else [each.name for each in joint.primitives]
    parameters = _common(block)
    for prefix in prefixes:
        parameters |= _of_primitive(block, prefix)
    priorities = [f"{p}{name}TargetPriority" for p in prefixes for name in ("Position", "Velocity")]
    return GraphJoint(
        number=number,
        name=block.name,
        sid=block.sid,
        type=block.kind.removesuffix(" Joint").lower().replace("dof", "DOF"),
        parent=joint.base,
        child=joint.follower,
        parameters=parameters,
        priorities={name: str(block.parameters.get(name, "High")) for name in priorities},
    )


def _common(block: Block) -> dict[str, Parameter]:
    mode = str(block.parameters.get("JointMode", "Normal"))
    return {} if mode == "Normal" else {"JointMode": mode}


def _of_primitive(block: Block, prefix: str) -> dict[str, Parameter]:
    """Collect what acts at one of a joint's degrees of freedom."""
    get = block.parameters.get
    found: dict[str, Parameter] = {
        f"{prefix}MotionActuationMode": str(get(f"{prefix}MotionActuationMode", "ComputedMotion")),
        f"{prefix}TorqueActuationMode": _actuation(block, prefix),
        f"{prefix}SpringStiffness": _scalar(block, f"{prefix}SpringStiffness"),
        f"{prefix}DampingCoefficient": _scalar(block, f"{prefix}DampingCoefficient"),
    }
    if found[f"{prefix}SpringStiffness"] and f"{prefix}EquilibriumPosition" in block.parameters:
        found[f"{prefix}EquilibriumPosition"] = _scalar(block, f"{prefix}EquilibriumPosition")
    for side in (f"{prefix}Lower", f"{prefix}Upper"):
        if is_on(block, f"{side}LimitSpecify"):
            for what in ("Bound", "Stiffness", "Damping", "TransitionRegionWidth"):
                if f"{side}Limit{what}" in block.parameters:
                    found[f"{side}Limit{what}"] = _scalar(block, f"{side}Limit{what}")
    for what in (f"{prefix}Position", f"{prefix}Velocity"):
        if is_on(block, f"{what}TargetSpecify"):
            found[f"{what}TargetValue"] = _numbers(block, f"{what}TargetValue")
    return found


def _scalar(block: Block, name: str) -> float:
    numbers = vector(block.parameters.get(name, 0.0))
    if len(numbers) != 1:
        raise invalid_parameter(block, name, "it must be one number")
    return numbers[0]


def _numbers(block: Block, name: str) -> Parameter:
    """Read a target: one number, or several of a ball."""
    numbers = vector(block.parameters.get(name, 0.0))
    return numbers if len(numbers) > 1 else _scalar(block, name)


def _actuation(block: Block, prefix: str) -> str:
    """Return how a degree of freedom is actuated, in a turning joint's words."""
    modes = [
        str(block.parameters.get(f"{prefix}{what}ActuationMode", "")).replace("Force", "Torque")
        for what in ("Torque", "Force")
    ]
    return next((mode for mode in modes if mode not in ("", "NoTorque")), "NoTorque")


# --- solids ----------------------------------------------------------------------------------


def _facts(solid: Solid) -> SolidFacts:
    block = solid.block
    default = "PointMass" if block.kind == "Inertia" else "CalculateFromGeometry"
    homogeneous = block.parameters.get("InertiaType", default) == "CalculateFromGeometry"
    by_density = homogeneous and block.parameters.get("BasedOnType", "Density") == "Density"
    shape, size = _shape(solid)
    return SolidFacts(
        shape=shape,
        size=size,
        mass=solid.properties.mass,
        inertia=solid.properties.inertia,
        density=vector(block.parameters.get("Density"))[0] if by_density else None,
        homogeneous=homogeneous,
        colour=vector(block.parameters.get("GraphicDiffuseColor"))[:3],
    )


def _shape(solid: Solid) -> tuple[str, tuple[float, ...]]:
    """Name a solid's shape, with its dimensions [m]; "other" where they say nothing of it."""
    try:
        shape = solid.shape
    except InvalidValueError:
        return "other", ()
    if isinstance(shape, Brick):
        return "brick", shape.edges
    if isinstance(shape, Cylinder):
        return "cylinder", (shape.radius, shape.length)
    if isinstance(shape, Ellipsoid):
        ball = len(set(shape.radii)) == 1
        return ("sphere", shape.radii[:1]) if ball else ("ellipsoid", shape.radii)
    if isinstance(shape, Extrusion):
        return "extrusion", (*np.ravel(shape.section).tolist(), shape.length)
    if isinstance(shape, Revolution):
        turned = f"revolution of {math.degrees(shape.angle):.9g} deg"
        return turned, tuple(np.ravel(shape.section).tolist())
    return "other", ()
