"""The mechanism of a Simulink model: what its blocks are, and a walk over its physical network."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import count

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, Model, invalid_parameter, number, split_port, vector
from drake_leg.simulink.networks.ports import layout_of

Array = NDArray[np.float64]

AXES = {
    sign + name: factor * np.eye(3)[index]
    for sign, factor in (("+", 1.0), ("-", -1.0))
    for index, name in enumerate("XYZ")
}
ROUNDING = 1e-12  # of the entries of a rotation matrix


def pose(R: Array | None = None, p: Sequence[float] | Array | None = None) -> Array:
    """Put a pose together of a rotation and a translation [m]."""
    X = np.eye(4)
    if R is not None:
        X[:3, :3] = R
    if p is not None:
        X[:3, 3] = p
    return X


def inverse(X: Array) -> Array:
    """Invert a pose."""
    R = X[:3, :3].T
    return pose(R, -R @ X[:3, 3])


def about(axis: str, angle: float) -> Array:
    """Make the pose of a rotation about ``x``, ``y`` or ``z`` [rad]."""
    return pose(Rotation.from_euler(axis, angle).as_matrix())


def rigid_transform(block: Block) -> Array:
    """Pose X_BF of the follower frame F in the base frame B of a Rigid Transform block in SI."""
    return pose(rotation_of(block), _translation(block))


def rotation_text(R: Array) -> str:
    """Write a rotation as an angle about an axis: ``90 deg about +x``."""
    vector = Rotation.from_matrix(R).as_rotvec(degrees=True)
    angle = float(np.linalg.norm(vector))
    if angle < 1e-9:
        return "no rotation"
    axis = vector / angle
    for name, unit in AXES.items():
        if np.allclose(axis, unit, atol=1e-9):
            return f"{angle:.9g} deg about {name.lower()}"
    return f"{angle:.9g} deg about ({', '.join(f'{value:.6g}' for value in axis)})"


def _translation(block: Block) -> Array:
    method = block.parameters.get("TranslationMethod", "None")
    if method == "None":
        return np.zeros(3)
    if method == "StandardAxis":
        return _number(block, "TranslationStandardOffset") * _axis(block, "TranslationStandardAxis")
    if method == "Cartesian":
        return _vector(block, "TranslationCartesianOffset", 3)
    if method == "Cylindrical":
        radius = _number(block, "TranslationCylindricalRadius")
        theta = _number(block, "TranslationCylindricalTheta")
        height = _number(block, "TranslationCylindricalZOffset")
        return np.array([radius * math.cos(theta), radius * math.sin(theta), height])
    raise _unknown(block, "TranslationMethod", method)


def rotation_of(block: Block, prefix: str = "") -> Array:
    """Rotation R_BF by a block's parameters ``RotationMethod`` and so on, after a prefix."""
    method = block.parameters.get(prefix + "RotationMethod", "None")
    if method == "None":
        return np.eye(3)
    if method == "StandardAxis":
        return _about(
            _axis(block, prefix + "RotationStandardAxis"), _number(block, prefix + "RotationAngle")
        )
    if method == "ArbitraryAxis":
        axis = _vector(block, prefix + "RotationArbitraryAxis", 3)
        angle, length = _number(block, prefix + "RotationAngle"), np.linalg.norm(axis)
        if angle == 0.0:  # as CAD programs export a transform without rotation, without an axis
            return np.eye(3)
        if length == 0.0:
            raise invalid_parameter(block, prefix + "RotationArbitraryAxis", "it must not be zero")
        return _about(axis / length, angle)
    if method == "AlignedAxes":
        return _aligned(block, prefix)
    if method == "RotationSequence":
        sequence = str(block.parameters.get(prefix + "RotationSequence", "XYZ"))
        if block.parameters.get(prefix + "RotationSequenceAxes", "FollowerAxes") == "BaseAxes":
            sequence = sequence.lower()
        angles = _vector(block, prefix + "RotationSequenceAngles", 3)
        try:
            return _clean(Rotation.from_euler(sequence, angles).as_matrix())
        except ValueError:
            raise _unknown(block, prefix + "RotationSequence", sequence) from None
    if method == "RotationMatrix":
        return _proper(block, prefix)
    if method == "Quaternion":
        quaternion = _vector(block, prefix + "RotationQuaternion", 4)
        if not np.any(quaternion):
            raise invalid_parameter(block, prefix + "RotationQuaternion", "it must not be zero")
        return _clean(Rotation.from_quat(np.roll(quaternion, -1)).as_matrix())
    raise _unknown(block, prefix + "RotationMethod", method)


def _aligned(block: Block, prefix: str) -> Array:
    """Two axes of the follower along two axes of the base; the third follows."""
    pairs = [
        (
            _axis(block, f"{prefix}FollAlignAxis{letter}"),
            _axis(block, f"{prefix}BaseAlignAxis{letter}"),
        )
        for letter in "AB"
    ]
    (f1, b1), (f2, b2) = pairs
    if abs(f1 @ f2) > 0.5 or abs(b1 @ b2) > 0.5:
        raise invalid_parameter(
            block, prefix + "BaseAlignAxisB", "the two axes must be at a right angle"
        )
    base = np.column_stack([b1, b2, np.cross(b1, b2)])
    follower = np.column_stack([f1, f2, np.cross(f1, f2)])
    R: Array = base @ follower.T
    return R


def _proper(block: Block, prefix: str) -> Array:
    rows = block.parameters.get(prefix + "RotationMatrix")
    R = np.array(rows, dtype=float) if isinstance(rows, tuple) else np.zeros(0)
    if R.shape != (3, 3) or not np.allclose(R @ R.T, np.eye(3), atol=1e-6) or np.linalg.det(R) < 0:
        raise invalid_parameter(
            block, prefix + "RotationMatrix", "it must be a proper rotation, 3 x 3"
        )
    return R


def _about(axis: Array, angle: float) -> Array:
    return _clean(Rotation.from_rotvec(angle * axis).as_matrix())


def _clean(R: Array) -> Array:
    """Make right angles exact."""
    nearest = np.round(R)
    cleaned: Array = np.where(np.abs(R - nearest) < ROUNDING, nearest, R)
    return cleaned


def _axis(block: Block, name: str) -> Array:
    text = str(block.parameters.get(name, "")).upper()
    if text not in AXES:
        raise _unknown(block, name, text)
    axis: Array = AXES[text]
    return axis


def _number(block: Block, name: str) -> float:
    value = block.parameters.get(name, 0.0)
    if not isinstance(value, float | int):
        raise _unknown(block, name, value)
    return float(value)


def _vector(block: Block, name: str, size: int) -> Array:
    value = block.parameters.get(name)
    if not isinstance(value, tuple) or np.shape(value) != (size,):
        raise invalid_parameter(block, name, f"it must be {size} numbers")
    return np.array(value, dtype=float)


def _unknown(block: Block, name: str, value: object) -> InvalidValueError:
    return InvalidValueError(
        f"the block {block.name!r} (SID {block.sid}) has {name} {value!r}, which is not "
        "supported: choose another setting that means the same"
    )


# --- solids ----------------------------------------------------------------------------------

SHAPES = {"Brick Solid": "brick", "Cylindrical Solid": "cylinder", "Spherical Solid": "sphere"}
DIMENSIONS = {
    "brick": ("BrickDimensions",),
    "cylinder": ("CylinderRadius", "CylinderLength"),
    "sphere": ("SphereRadius",),
}
OTHER = "other"
SOLIDS = (
    *SHAPES,
    "Solid",
    "Ellipsoidal Solid",
    "Extruded Solid",
    "File Solid",
    "Inertia",
    "Revolved Solid",
    "Variable Cylindrical Solid",
    "Variable Spherical Solid",
)


@dataclass(frozen=True, kw_only=True)
class SolidProperties:
    """A solid, homogeneous or with its mass given."""

    shape: str  # "brick", "cylinder", "sphere", "other"
    size: tuple[float, ...]  # [m]: three edges; radius and length; radius
    density: float | None  # [kg/m^3]; None where the mass is given
    mass: float  # [kg]; 0 where it follows from a shape that is not known
    moments: tuple[float, ...] = ()  # [kg*m^2], given, or of a plant's body
    offsets: tuple[float, ...] = ()  # center of mass [m] and products [kg*m^2]; none means zero
    colour: tuple[float, ...] = ()  # red, green, blue in 0...1


def read_solid(block: Block) -> SolidProperties:
    """Read a block of a kind in ``SOLIDS`` as it is: sizes may be zero or less, or too few."""
    get = block.parameters.get
    shape = _shape(block)
    size = _size(block, shape)
    default = "PointMass" if block.kind == "Inertia" else "CalculateFromGeometry"
    has_inertia = get("InertiaType", default) != "CalculateFromGeometry"
    has_mass = has_inertia or get("BasedOnType") == "Mass"
    density = None if has_mass else number(get("Density"))
    moments, offsets = _inertia(block) if has_inertia else ((), ())
    return SolidProperties(
        shape=shape,
        size=size,
        density=density,
        mass=number(get("Mass")) if density is None else density * volume(shape, size),
        moments=moments,
        offsets=offsets,
        colour=vector(get("GraphicDiffuseColor"))[:3],
    )


def volume(shape: str, size: tuple[float, ...]) -> float:
    """Volume [m^3] of a shape; 0 of another one, infinite where it is beyond all numbers."""
    try:
        if shape == "brick":
            return math.prod(size)
        if shape == "cylinder":
            radius, length = size
            return math.pi * radius**2 * length
        if shape == "sphere":
            (radius,) = size
            return 4.0 / 3.0 * math.pi * radius**3
    except OverflowError:
        return math.inf
    return 0.0


def _shape(block: Block) -> str:
    """Name the shape of a solid; files of about R2016 have one kind of block for all shapes."""
    if block.kind != "Solid":
        return SHAPES.get(block.kind, OTHER)
    shape = str(block.parameters.get("GeometryShape")).lower()
    return shape if shape in DIMENSIONS else OTHER


def _size(block: Block, shape: str) -> tuple[float, ...]:
    if shape == "brick":
        return vector(block.parameters.get("BrickDimensions"))
    return tuple(number(block.parameters.get(name)) for name in DIMENSIONS.get(shape, ()))


def _inertia(block: Block) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Read moments and offsets that are given; a point mass has no moments."""
    get = block.parameters.get
    centre = vector(get("CenterOfMass"))
    if get("InertiaType") != "Custom":
        return (0.0, 0.0, 0.0), centre
    return vector(get("MomentsOfInertia")), centre + vector(get("ProductsOfInertia"))


# --- the physical network --------------------------------------------------------------------

BASE, FOLLOWER = "lconn:1", "rconn:1"
RIGID = ("Rigid Transform", "Weld Joint")
TO_PHYSICAL, TO_SIGNAL = "Simulink-PS Converter", "PS-Simulink Converter"
_SIGNAL_KINDS = (TO_PHYSICAL, TO_SIGNAL, "Spectrum Analyzer", "Probe")
_LIBRARIES = ("sm_lib", "nesl_utility", "nesl_utility_internal", "fl_lib", "fl_ps_legacy_lib")
Node = tuple[str, ...]  # ports that one connection joins
Frame = int | str  # the number of a node in the model, or a port that is not connected


@dataclass(frozen=True, kw_only=True)
class PhysicalNetwork:
    """The physical connections of a flattened model, and the blocks at them.

    A connection carries a signal where one of its ends is a converter, a block of physical
    signals, or a port of a joint or a sensor beyond its two frames, and a geometry at a contact.
    All others are frames.
    """

    blocks: Mapping[str, Block]  # all blocks of the model, by SID
    nodes: tuple[Node, ...]  # all connections, as in the model
    frames: Mapping[str, int]  # port at a frame -> number of its node
    ports: Mapping[str, tuple[str, ...]]  # SID -> the block's ports at frames, by side and number
    signals: tuple[Node, ...]  # the port that puts the signal out comes first
    geometries: tuple[Node, ...]  # shapes that touch
    physical: frozenset[str]  # SIDs of Simscape's blocks
    mechanical: frozenset[str]  # those of them that are more than signals
    sensed: frozenset[str]  # mechanical blocks that signals reach or leave

    def frame(self, port: str) -> Frame:
        """Return the frame at a port; one that is not connected is a frame of its own."""
        return self.frames.get(port, port)

    def ends(self, block: Block) -> tuple[Frame, Frame]:
        """Return the frames at a block's base and follower."""
        return self.frame(f"{block.sid}#{BASE}"), self.frame(f"{block.sid}#{FOLLOWER}")


def network_of(model: Model) -> PhysicalNetwork:
    """Sort the physical connections of a flattened model."""
    blocks = {block.sid: block for block in model.blocks}
    signals: list[Node] = []
    geometries: list[Node] = []
    frames: dict[str, int] = {}
    for index, node in enumerate(model.nodes):
        if any(_has_signal(port, blocks) for port in node):
            signals.append(node)
        elif any(_has_geometry(port, blocks) for port in node):
            geometries.append(node)
        else:
            frames |= dict.fromkeys(node, index)
    ends = {split_port(port)[0] for node in model.nodes for port in node}
    physical = {sid for sid, block in blocks.items() if _is_of_simscape(block)} | ends
    mechanical = {sid for sid in physical if not _is_signal(blocks[sid])}
    reached = {split_port(port)[0] for node in signals for port in node}
    return PhysicalNetwork(
        blocks=blocks,
        nodes=model.nodes,
        frames=frames,
        ports={sid: tuple(ports) for sid, ports in ports_by_block(frames).items()},
        signals=tuple(
            tuple(sorted(node, key=lambda port: not _puts_out(port, blocks))) for node in signals
        ),
        geometries=tuple(geometries),
        physical=frozenset(physical),
        mechanical=frozenset(mechanical),
        sensed=frozenset(mechanical & reached),
    )


def ports_by_block(ports: Iterable[str]) -> dict[str, list[str]]:
    """Group ports by the SIDs of their blocks, ordered by side and number."""
    found: dict[str, list[str]] = {}
    for port in sorted(ports, key=lambda port: split_port(port)[1:]):
        found.setdefault(split_port(port)[0], []).append(port)
    return found


def _is_of_simscape(block: Block) -> bool:
    return block.source.split("/", 1)[0] in _LIBRARIES or block.type == "PMIOPort"


def _is_signal(block: Block) -> bool:
    return block.kind in _SIGNAL_KINDS or block.kind.startswith("PS ")


def _has_signal(port: str, blocks: Mapping[str, Block]) -> bool:
    sid, _, number = split_port(port)
    block = blocks[sid]
    layout = layout_of(block)
    if layout is not None:
        return port.partition("#")[2] in layout.signals
    two_frames = block.kind.endswith("Joint") or block.kind in _SENSING
    return _is_signal(block) or (two_frames and number > (2 if block.kind == "Pulley" else 1))


_SENSING = ("Transform Sensor", "Planar Contact Force", "Pulley", "Belt-Cable End")


_CURVES_AND_SURFACES = (
    "Infinite Plane", "Point Cloud", "Spline", "Line Segment", "Grid Surface", "Point", "Disk",
    "Convex Hull",
)  # fmt: skip
AT_GEOMETRY = {  # kinds of blocks, and their ports at geometries and belts, which are no frames
    **dict.fromkeys(("Spatial Contact Force", "Planar Contact Force"), (BASE, FOLLOWER)),
    "Pulley": (FOLLOWER, "rconn:2"),  # of belts
    **dict.fromkeys(("Belt-Cable End", "Belt-Cable Spool"), (FOLLOWER,)),
    "Belt-Cable Properties": (BASE,),
    "Point on Curve Constraint": (BASE,),
    **dict.fromkeys(_CURVES_AND_SURFACES, (FOLLOWER,)),
}


def _has_geometry(port: str, blocks: Mapping[str, Block]) -> bool:
    sid, side, number = split_port(port)
    return f"{side}:{number}" in AT_GEOMETRY.get(blocks[sid].kind, ())


def _puts_out(port: str, blocks: Mapping[str, Block]) -> bool:
    """Whether a signal comes out of a port: right ports do so, except a converter's."""
    sid, side, _ = split_port(port)
    kind, layout = blocks[sid].kind, layout_of(blocks[sid])
    if layout is not None:
        return port.partition("#")[2] in layout.outputs.values()
    return kind == TO_PHYSICAL or (side == "rconn" and kind != TO_SIGNAL)


@dataclass(frozen=True, kw_only=True)
class WalkStep:
    """A block in a walk over the frames, and the rigid body from which it is entered."""

    block: Block
    near: tuple[str, ...]  # its ports at frames reached before; several where it closes a loop
    far: tuple[str, ...]  # its ports at frames that are reached through it
    body: int  # at its near side; 0 is the body in which the walk begins, the world
    beyond: int  # at its far side: a new body where the block is a joint and leads on


class Walk:
    """A walk over the frames of a network, block by block, that numbers the rigid bodies.

    Reach a frame or take a block to begin, then iterate for the blocks beyond; do so again for
    parts that are not connected with the first one. Blocks come in the order of
    ``rank(block, body)``, where ``body`` carries the frame at which the block is met, and those of
    equal rank in the order in which they are met. A block of rank None is not entered.
    """

    def __init__(
        self, network: PhysicalNetwork, rank: Callable[[Block, int], tuple[int, ...] | None]
    ) -> None:
        self._network, self._rank = network, rank
        self._met: list[tuple[tuple[int, ...], int, str]] = []  # a heap: rank, place in line, SID
        self._meetings = count()
        self._bodies = count(1)
        self.reached: dict[Frame, int] = {}  # frame -> the body that carries it
        self.taken: set[str] = set()  # SIDs

    def reach(self, frame: Frame, body: int = 0) -> None:
        """Meet the blocks at a frame of a body; a frame that was reached before stays as it is."""
        if frame in self.reached:
            return
        self.reached[frame] = body
        for port in self._network.nodes[frame] if isinstance(frame, int) else (frame,):
            sid, _, _ = split_port(port)
            rank = self._rank(self._network.blocks[sid], body)
            if rank is not None:
                heappush(self._met, (rank, next(self._meetings), sid))

    def take(self, block: Block) -> WalkStep:
        """Enter a block by the frames that are reached, and reach its others through it."""
        self.taken.add(block.sid)
        ports = _two_ports(block) or self._network.ports.get(block.sid, ())
        frames = [self._network.frame(port) for port in ports]
        bodies = [self.reached[frame] for frame in frames if frame in self.reached]
        at_world = block.kind == "World Frame"
        body = beyond = bodies[0] if bodies else 0 if at_world else next(self._bodies)
        if _moves(block) and len(bodies) < len(ports):
            beyond = next(self._bodies)
        near: list[str] = []
        far: list[str] = []
        for port, frame in zip(ports, frames, strict=True):
            (near if frame in self.reached else far).append(port)
            self.reach(frame, body if not bodies and far == [port] else beyond)
        return WalkStep(block=block, near=tuple(near), far=tuple(far), body=body, beyond=beyond)

    def __iter__(self) -> Iterator[WalkStep]:
        while self._met:
            *_, sid = heappop(self._met)
            if sid not in self.taken:
                yield self.take(self._network.blocks[sid])


def _two_ports(block: Block) -> tuple[str, ...]:
    """List the ports of a block that has a base and a follower, connected or not."""
    two = block.kind.endswith("Joint") or block.kind in ("Rigid Transform", "Transform Sensor")
    return (f"{block.sid}#{BASE}", f"{block.sid}#{FOLLOWER}") if two else ()


def _moves(block: Block) -> bool:
    return block.kind not in RIGID and bool(_two_ports(block))
