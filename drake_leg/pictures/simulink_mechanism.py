"""Reads the mechanism of a Simulink model as a picture, from the world outwards."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from pydrake.math import RigidTransform, RotationMatrix

from drake_leg.errors import InvalidValueError
from drake_leg.pictures.mechanical import (
    CAPTION_WIDTH,
    Chain,
    Output,
    connection_of,
    damping_words,
    gravity_words,
    mass_words,
    number_text,
    solid_block,
    spring_words,
    transform_words,
)
from drake_leg.pictures.svg import DrawnBlock, Picture, wrapped
from drake_leg.robot.robot import Brick, Cylinder, Shape, Sphere
from drake_leg.simulink.listing import block_paths, printable
from drake_leg.simulink.mechanism import SOLIDS, SolidProperties, read_solid, rigid_transform
from drake_leg.simulink.model import Block, Model, number, split_port, vector

_LONGEST = 24  # characters of a line
_MOST_LINES = 3
TO_PHYSICAL, TO_SIGNAL = "Simulink-PS Converter", "PS-Simulink Converter"
_SIGNAL_KINDS = (TO_PHYSICAL, TO_SIGNAL, "Spectrum Analyzer", "Probe")
_LIBRARIES = ("sm_lib", "nesl_utility", "nesl_utility_internal", "fl_lib")
Node = tuple[str, ...]  # ports that one connection joins
JOINT_GLYPHS = {
    "6-DOF Joint": "six_dof",
    "Prismatic Joint": "prismatic",
    "Revolute Joint": "revolute",
}
_GLYPHS = JOINT_GLYPHS | {
    "Mechanism Configuration": "configuration",
    "Rigid Transform": "transform",
    "Solver Configuration": "configuration",
    "World Frame": "world",
}
_INSIDE = {"Mechanism Configuration": ("g ↓",), "Solver Configuration": ("f(x) = 0",)}
_SENSORS = ("6-DOF Joint", "Bushing Joint", "Transform Sensor")
_LEAVES = ("Solid", "Inertia", "Configuration", "Graphic")  # how names of what ends a chain end


def unique_names(model: Model) -> dict[str, str]:
    """Name every block, by its SID, after its path; with the SID if two paths are the same."""
    paths = block_paths(model)
    count = Counter(paths.values())
    return {sid: path if count[path] == 1 else f"{path} (SID {sid})" for sid, path in paths.items()}


def name_lines(name: str, width: float) -> tuple[str, ...]:
    """Write a block's own name in at most three lines; what does not fit is cut off."""
    lines = wrapped(printable(name), width)
    if len(lines) > _MOST_LINES:
        lines = (*lines[: _MOST_LINES - 1], f"{lines[_MOST_LINES - 1]} …")
    return tuple(map(cut, lines))


def cut(text: str) -> str:
    """Cut a line of text off after 24 characters, and leave out what cannot be printed."""
    text = printable(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


@dataclass(frozen=True, kw_only=True)
class Network:
    """The physical connections of a flattened model, and the blocks at them."""

    signals: tuple[Node, ...]  # the port that puts the signal out comes first
    frames: tuple[Node, ...]
    physical: frozenset[str]  # SIDs of all blocks that are drawn as Simscape's
    mechanical: frozenset[str]  # those of them that are more than signals
    sensed: frozenset[str]  # mechanical blocks that signals reach or leave


def network_of(model: Model) -> Network:
    """Sort the physical connections of a model.

    A connection carries a signal where one of its ends is a converter, a block of physical
    signals, or a port of a joint or a sensor beyond its two frames.
    """
    blocks = {block.sid: block for block in model.blocks}
    signals = [node for node in model.nodes if any(_has_signal(port, blocks) for port in node)]
    frames = [node for node in model.nodes if node not in signals]
    ends = {split_port(port)[0] for node in model.nodes for port in node}
    physical = {sid for sid, block in blocks.items() if _is_of_simscape(block)} | ends
    mechanical = {sid for sid in physical if not _is_signal(blocks[sid])}
    reached = {split_port(port)[0] for node in signals for port in node}
    return Network(
        signals=tuple(
            tuple(sorted(node, key=lambda port: not _puts_out(port, blocks))) for node in signals
        ),
        frames=tuple(frames),
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
    two_frames = block.kind.endswith("Joint") or block.kind == "Transform Sensor"
    return _is_signal(block) or (two_frames and number > 1)


def _puts_out(port: str, blocks: Mapping[str, Block]) -> bool:
    """Whether a signal comes out of a port: right ports do so, except a converter's."""
    sid, side, _ = split_port(port)
    kind = blocks[sid].kind
    return kind == TO_PHYSICAL or (side == "rconn" and kind != TO_SIGNAL)


def body_block(block: Block, *, name: str, turned: bool, senses: bool) -> DrawnBlock:
    """Draw a mechanical block: its name, its kind where nothing else tells it, its parameters.

    ``turned`` tells whether its follower is on the left, towards the world; ``senses`` whether
    signals leave or reach it.

    Raises
    ------
    InvalidValueError
        If the numbers of a transform or a solid make no sense.
    """
    if block.kind in ("Connection Port", "PMIOPort"):
        return replace(connection_of(cut(block.name)), name=name)
    caption = name_lines(block.name, CAPTION_WIDTH)
    if block.kind in SOLIDS and "Mass" in block.parameters:  # a shaft's Inertia has none
        solid = read_solid(block)
        return solid_block(name, (*caption, *_kind(block), *_size(block, solid)), solid.shape)
    if block.kind not in _GLYPHS:
        return DrawnBlock(name=name, caption=caption, text=wrapped(block.kind, CAPTION_WIDTH))
    details = _DETAILS.get(block.kind)
    notes = {"senses the motion": senses and block.kind == "6-DOF Joint", "drawn F to B": turned}
    return DrawnBlock(
        name=name,
        caption=(
            *caption,
            *_kind(block),
            *(details(block) if details else ()),
            *(note for note, holds in notes.items() if holds),
        ),
        glyph=_GLYPHS[block.kind],
        text=_INSIDE.get(block.kind, ()),
    )


def _kind(block: Block) -> tuple[str, ...]:
    """Name the kind of a block that is not called after it."""
    return () if block.kind.lower() in block.name.lower() else (block.kind,)


def _transform(block: Block) -> Iterator[str]:
    X_BF = rigid_transform(block)
    R_BF = RotationMatrix.ProjectToRotationMatrix(X_BF[:3, :3])
    yield from transform_words(RigidTransform(R_BF, X_BF[:3, 3]))


def _gravity(block: Block) -> Iterator[str]:
    gravity = vector(block.parameters.get("GravityVector"))
    if len(gravity) == 3 and block.parameters.get("UniformGravity") == "Constant":
        yield from gravity_words(gravity)


def _joint(block: Block) -> Iterator[str]:
    """Describe the actuation, damping and spring of a joint with one degree of freedom."""
    get, turning = block.parameters.get, block.kind == "Revolute Joint"
    for what in ("Motion", "Torque", "Force"):
        if str(get(f"{what}ActuationMode", "")).startswith("Input"):
            yield f"{what.lower()} by input"
    yield from damping_words(number(get("DampingCoefficient")), turning=turning)
    stiffness, rest = number(get("SpringStiffness")), number(get("EquilibriumPosition"))
    yield from spring_words(stiffness, rest, turning=turning)


_DETAILS: dict[str, Callable[[Block], Iterator[str]]] = {
    "Mechanism Configuration": _gravity,
    "Prismatic Joint": _joint,
    "Revolute Joint": _joint,
    "Rigid Transform": _transform,
}


def _size(block: Block, solid: SolidProperties) -> Iterator[str]:
    """Write a solid's dimensions and its mass, its density where the mass is not known."""
    try:
        shape = _shape(solid)
    except InvalidValueError as error:
        raise InvalidValueError(f"the block {block.name!r} (SID {block.sid}): {error}") from None
    if shape is not None:
        yield _dimensions(shape)
    if shape is None and solid.density is not None:
        yield f"{number_text(solid.density)} kg/m³"
    else:
        yield mass_words(solid.mass)


def _shape(solid: SolidProperties) -> Shape | None:
    """Make a shape of a solid's dimensions, which refuses those that no solid has."""
    if solid.shape == "brick":
        if len(solid.size) != 3:
            raise InvalidValueError(
                f"its BrickDimensions are {len(solid.size)} numbers; give three"
            )
        length, width, height = solid.size
        return Brick(length=length, width=width, height=height)
    if solid.shape == "cylinder":
        radius, length = solid.size
        return Cylinder(radius=radius, length=length)
    return Sphere(radius=solid.size[0]) if solid.shape == "sphere" else None


def _dimensions(shape: Shape) -> str:
    if isinstance(shape, Brick):
        sides = (shape.length, shape.width, shape.height)
        return f"{' × '.join(number_text(1e3 * side) for side in sides)} mm"
    radius = f"r {number_text(1e3 * shape.radius)}"
    if isinstance(shape, Cylinder):
        return f"{radius}, l {number_text(1e3 * shape.length)} mm"
    return f"{radius} mm"


def model_mechanism_picture(
    model: Model, network: Network, names: Mapping[str, str], *, title: str
) -> Picture:
    """Draw the mechanical blocks of a model, breadth-first from its World Frames.

    What is attached to no World Frame follows, from an open end if there is one. A block that
    closes a loop has two connections on its left side, and so has a joint that only senses, which
    comes last. A model without a mechanism has a picture without blocks.
    """
    return _Walk(model, network, names).picture(title)


class _Walk:
    """Traverses the frames breadth-first and attaches the connected blocks."""

    def __init__(self, model: Model, network: Network, names: Mapping[str, str]) -> None:
        self.network, self.names = network, names
        self.blocks = {b.sid: b for b in model.blocks if b.sid in network.mechanical}
        self.node = {port: index for index, node in enumerate(network.frames) for port in node}
        self.ports = ports_by_block(self.node)
        self.frame: dict[int, Output] = {}  # of the nodes that are reached
        self.met: deque[str] = deque()
        self.met_sensors: deque[str] = deque()
        self.placed: set[str] = set()
        self.chain = Chain()

    def picture(self, title: str) -> Picture:
        worlds = [sid for sid, block in self.blocks.items() if block.kind == "World Frame"]
        for world in worlds:
            self._place(world)
        self._spread()
        for sid in sorted(self.blocks, key=self._unlikely_start):
            if sid not in self.placed:
                self._place(sid)
                self._spread()
        return self.chain.picture(title)

    def _unlikely_start(self, sid: str) -> int:
        """Rank what a chain without a world may start from: references, open ends, the rest."""
        kind = self.blocks[sid].kind
        if "Reference" in kind or kind in ("Connection Port", "PMIOPort"):
            return 0
        return 1 if len(self.ports.get(sid, ())) == 1 and not kind.endswith(_LEAVES) else 2

    def _spread(self) -> None:
        while self.met or self.met_sensors:
            sid = (self.met or self.met_sensors).popleft()
            if sid not in self.placed:
                self._place(sid)

    def _place(self, sid: str) -> None:
        """Attach a block to the frames reached so far; its other frames are then reached, too."""
        self.placed.add(sid)
        index, opened = len(self.chain.blocks), 0
        attached = []
        for port in self.ports.get(sid, ()):
            node = self.node[port]
            if node in self.frame:
                attached.append(port)
                continue
            self.frame[node] = (index, opened)
            opened += 1
            self._meet(node)
        drawn = body_block(
            self.blocks[sid],
            name=self.names[sid],
            turned=[split_port(port)[1:] for port in attached] == [("rconn", 1)] and opened > 0,
            senses=sid in self.network.sensed,
        )
        self.chain.add(drawn, *(self.frame[self.node[port]] for port in attached))

    def _meet(self, node: int) -> None:
        for port in self.network.frames[node]:
            sid, _, _ = split_port(port)
            (self.met_sensors if self._only_senses(self.blocks[sid]) else self.met).append(sid)

    def _only_senses(self, block: Block) -> bool:
        return block.kind in _SENSORS and block.sid in self.network.sensed
