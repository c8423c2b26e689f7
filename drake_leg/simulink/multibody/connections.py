"""How the blocks of a Simulink model connect frames: rigidly, or by joints.

All that is missing for a mechanism is collected, and raised at once.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from scipy.cluster.hierarchy import DisjointSet

from drake_leg.arguments import with_article
from drake_leg.errors import (
    InvalidValueError,
    MissingThingsError,
    UnknownValueError,
    UnplacedFeatureError,
)
from drake_leg.simulink.catalogue import JOINTS
from drake_leg.simulink.lacks import lacks_of_block
from drake_leg.simulink.mechanism import SOLIDS as OF_MASS
from drake_leg.simulink.mechanism import Frame, PhysicalNetwork, network_of, rigid_transform
from drake_leg.simulink.model import Block, Model, is_on, vector
from drake_leg.simulink.multibody.joints import Primitive, primitives_of
from drake_leg.simulink.multibody.mass import Array, MassProperties
from drake_leg.simulink.multibody.solids import GEOMETRIES, NO_MASS, REFERENCE, Solid
from drake_leg.simulink.multibody.unplaced import Unplaced
from drake_leg.simulink.multibody.variable import constant_inputs
from drake_leg.simulink.wiring import physical_part

T = TypeVar("T")

WORLD = "world"
SOLIDS = (*OF_MASS, "Graphic")
PLACES = (
    "Reference Frame", "World Frame", "Mechanism Configuration", "Transform Sensor",
    "Infinite Plane", "Point Cloud", "Spline", "Grid Surface", "Point", "Disk", "Convex Hull",
    "Line Segment", "Connection Frame", "Joint Mode Configuration", "Inertia Sensor",
    "Rigid Transform",
)  # fmt: skip
FORCES = (
    "Spatial Contact Force", "External Force and Torque", "Internal Force",
    "Inverse Square Law Force", "Gravitational Field", "Spring and Damper Force",
    "Magic Formula Tire Force and Torque", "Planar Contact Force", "Sphere to Plane Force",
    "Sphere to Sphere Force", "Sphere in Sphere Force",
)  # fmt: skip
CONSTRAINTS = (
    "Point on Curve Constraint", "Angle Constraint", "Distance Constraint",
    "Point on Surface Constraint", "Rack and Pinion Constraint", "Common Gear Constraint",
    "Bevel Gear Constraint", "Worm and Gear Constraint", "Pulley", "Belt-Cable End",
    "Belt-Cable Spool", "Belt-Cable Properties",
)  # fmt: skip
KNOWN = frozenset((*SOLIDS, *PLACES, *FORCES, *CONSTRAINTS, *JOINTS))
STANDARD_GRAVITY: tuple[float, ...] = (0.0, 0.0, -9.80665)  # [m/s^2]


@dataclass(frozen=True, eq=False, kw_only=True)
class Rigid:
    """Two frames that do not move with respect to each other."""

    base: Frame
    follower: Frame
    X_BF: Array  # (4, 4) [m]
    block: Block | None = None  # that states the pose; None where they are one frame


@dataclass(frozen=True, eq=False, kw_only=True)
class Jointed:
    """Two frames that a joint connects."""

    block: Block
    primitives: tuple[Primitive, ...]  # from base to follower
    base: Frame
    follower: Frame


@dataclass(frozen=True, eq=False, kw_only=True)
class Connections:
    """All that connects the frames of a model."""

    rigid: tuple[Rigid, ...]
    joints: tuple[Jointed, ...]
    solids: tuple[tuple[Frame, Solid], ...]  # with their reference frames
    gravity: tuple[float, ...]  # [m/s^2]
    left_out: Mapping[str, tuple[str, ...]]  # forces and constraints: kind of block -> names
    only: Mapping[str, Array] = field(default_factory=dict)  # features found as the only ones


def connections_of(model: Model, *, apart: bool = True) -> Connections:
    """Read what connects the frames of a model.

    A weld that senses what it carries is a joint, where nothing else holds its frames together;
    all welds are rigid where it is not ``apart``.

    Raises
    ------
    InvalidValueError
        That lists all that is missing: values, kinds of blocks.
    """
    reading = _Reading(model)
    connections = reading.connections()
    refuse(reading.problems)
    return _with_welds_apart(connections, reading.sensed) if apart else connections


def refuse(problems: Sequence[str], goal: str = "a mechanism") -> None:
    """Raise all problems in one error, if there are any."""
    if problems:
        raise MissingThingsError(problems, goal)


def _with_welds_apart(connections: Connections, sensed: Container[str]) -> Connections:
    """Make joints of welds that sense, each where it alone holds its frames together."""
    joints: dict[Rigid, Jointed] = {}
    for edge in connections.rigid:
        block = edge.block
        if block and block.sid in sensed and _senses(block) and _alone(edge, connections.rigid):
            joints[edge] = Jointed(
                block=block, primitives=(), base=edge.base, follower=edge.follower
            )
    return replace(
        connections,
        rigid=tuple(edge for edge in connections.rigid if edge not in joints),
        joints=(*connections.joints, *joints.values()),
    )


def _senses(block: Block) -> bool:
    return block.kind == "Weld Joint" and any(
        is_on(block, name) for name in block.parameters if name.startswith("Sense")
    )


def _alone(weld: Rigid, edges: Iterable[Rigid]) -> bool:
    """Tell whether nothing else holds the frames of a weld together."""
    groups: DisjointSet[Frame] = DisjointSet()
    for frame in (weld.base, weld.follower):
        groups.add(frame)
    for edge in edges:
        if edge is not weld:
            groups.add(edge.base)
            groups.add(edge.follower)
            groups.merge(edge.base, edge.follower)
    return not groups.connected(weld.base, weld.follower)


class _Reading:
    def __init__(self, model: Model) -> None:
        flat = physical_part(model)
        self._blocks = flat.blocks
        self._find = model.variables.workspace.folders.geometry if model.variables else None
        self._network: PhysicalNetwork = network_of(flat)
        self._placed, self._inputs = model.features, constant_inputs(model)
        self._problems: dict[str, None] = {}
        self._is_lacking = False  # whether the block that is read lacks a value
        self._only: dict[str, Array] = {}
        self._unplaced = Unplaced()
        self._mechanical = self._at_frames()

    @property
    def sensed(self) -> frozenset[str]:
        """The blocks that signals reach or leave, by SID."""
        return self._network.sensed

    @property
    def problems(self) -> tuple[str, ...]:
        """What is wrong, each once."""
        return (*self._problems, *self._unplaced.sentences())

    def connections(self) -> Connections:
        """Read all blocks; what is wrong is collected."""
        rigid: list[Rigid] = []
        joints: list[Jointed] = []
        solids: list[tuple[Frame, Solid]] = []
        for block in self._mechanical:
            self._attempt(None, self._read, block, rigid, joints, solids)
            if self._is_lacking:
                self._problems |= dict.fromkeys(lack.reason for lack in lacks_of_block(block))
                self._is_lacking = False
        return Connections(
            rigid=tuple(rigid),
            joints=tuple(joints),
            solids=tuple(solids),
            gravity=self._gravity(),
            left_out=self._left_out(),
            only=self._only,
        )

    def _read(
        self,
        block: Block,
        rigid: list[Rigid],
        joints: list[Jointed],
        solids: list[tuple[Frame, Solid]],
    ) -> None:
        self._notice_unknown(block)
        if block.kind == "World Frame":
            rigid += self._at_world(block)
        elif block.kind in ("Rigid Transform", "Weld Joint"):
            rigid.append(self._rigid(block))
        elif block.kind in JOINTS:
            joints.append(self._joint(block))
        elif block.kind in SOLIDS:
            solid = Solid(block=block, find=self._find, placed=self._placed, inputs=self._inputs)
            self._attempt(NO_MASS, _properties, solid)
            solids.append((_own(block), solid))
            rigid += self._at_solid(solid)

    def _at_frames(self) -> list[Block]:
        """List the blocks of Simscape Multibody at frames, and unknown blocks that meet them."""
        ports, frame = self._network.ports, self._network.frame
        ours = [block for block in self._blocks if block.sid in ports and is_multibody(block)]
        frames = {frame(port) for block in ours for port in ports[block.sid]}
        others = [
            block
            for block in self._blocks
            if block.unknown and any(frame(port) in frames for port in ports.get(block.sid, ()))
        ]
        return [*ours, *others]

    def _attempt(self, otherwise: T, work: Callable[..., T], *arguments: object) -> T:
        """Do a piece of work; collect its complaint."""
        try:
            return work(*arguments)
        except InvalidValueError as error:
            self._problems[str(error)] = None
            self._is_lacking |= isinstance(error, UnknownValueError)
            return otherwise

    def _notice_unknown(self, block: Block) -> None:
        if block.unknown:
            self._problems[block.unknown] = None
        elif block.kind not in KNOWN:
            self._problems[
                f"the block {block.name!r} (SID {block.sid}) is {with_article(block.kind)}, "
                "which is not built: replace it by blocks that are"
            ] = None

    def _at_world(self, block: Block) -> list[Rigid]:
        ports = self._network.ports[block.sid]
        frames = (self._network.frame(port) for port in ports)
        return [Rigid(base=WORLD, follower=frame, X_BF=np.eye(4)) for frame in frames]

    def _rigid(self, block: Block) -> Rigid:
        base, follower = self._network.ends(block)
        X_BF = np.eye(4)
        if block.kind == "Rigid Transform":
            X_BF = self._attempt(X_BF, rigid_transform, block)
        else:
            self._primitives(block)
        return Rigid(base=base, follower=follower, X_BF=X_BF, block=block)

    def _joint(self, block: Block) -> Jointed:
        base, follower = self._network.ends(block)
        primitives = self._primitives(block)
        return Jointed(block=block, primitives=primitives, base=base, follower=follower)

    def _primitives(self, block: Block) -> tuple[Primitive, ...]:
        none: tuple[Primitive, ...] = ()
        return self._attempt(none, primitives_of, block)

    def _at_solid(self, solid: Solid) -> list[Rigid]:
        """Connect the frames at a solid's ports with its reference frame."""
        block, found = solid.block, []
        ports = self._network.ports[block.sid]
        for port in ports:
            place = port.removeprefix(f"{block.sid}#")
            # A solid whose only line is at R may be drawn with R on the other side.
            name = solid.ports.get(place, REFERENCE if len(ports) == 1 else None)
            if name is None:
                self._problems[
                    f"the block {block.name!r} (SID {block.sid}) has a line at its port {place}, "
                    "where it has no frame: save the model again in Simulink"
                ] = None
            elif name not in GEOMETRIES:
                X_RF = np.eye(4)
                if not self._note_unplaced(solid, name):
                    X_RF = self._attempt(X_RF, solid.frame, name)
                found.append(
                    Rigid(
                        base=_own(block),
                        follower=self._network.frame(port),
                        X_BF=X_RF,
                        block=None if name == REFERENCE else block,
                    )
                )
        return found

    def _note_unplaced(self, solid: Solid, frame: str) -> bool:
        """Note the features under a frame that nobody has placed; tell whether there are any."""
        none: tuple[UnplacedFeatureError, ...] = ()
        errors = self._attempt(none, solid.unplaced, frame)
        for error in errors:
            self._unplaced.note(solid, error)
        if not errors:
            self._only |= solid.only_ones(frame)
        return bool(errors)

    def _gravity(self) -> tuple[float, ...]:
        """Return the gravity of the first configuration that is connected; none without one."""
        for block in self._mechanical:
            if block.kind == "Mechanism Configuration":
                if block.parameters.get("UniformGravity", "Constant") != "Constant":
                    break
                given = self._attempt(STANDARD_GRAVITY, _gravity_vector, block)
                return given if len(given) == 3 else STANDARD_GRAVITY
        return (0.0, 0.0, 0.0)

    def _left_out(self) -> dict[str, tuple[str, ...]]:
        found: dict[str, list[str]] = {}
        for block in self._blocks:
            if acts(block):
                found.setdefault(block.kind, []).append(block.name)
        return {kind: tuple(names) for kind, names in found.items()}


def is_multibody(block: Block) -> bool:
    """Tell whether a block is of Simscape Multibody, or of a library that stands on it."""
    return block.source.startswith(("sm_lib/", "Contact_Forces_Lib/"))


def acts(block: Block) -> bool:
    """Tell whether a block of Simscape Multibody is a force or a constraint, and no joint."""
    return block.kind in (*FORCES, *CONSTRAINTS) and is_multibody(block)


def _own(block: Block) -> Frame:
    """Name the reference frame of a solid, whether it has a port there or not."""
    return f"{block.sid}#{REFERENCE}"


def _properties(solid: Solid) -> MassProperties:
    return solid.properties


def _gravity_vector(block: Block) -> tuple[float, ...]:
    return vector(block.parameters.get("GravityVector"))
