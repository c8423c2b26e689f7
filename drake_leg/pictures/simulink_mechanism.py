"""Reads the mechanism of a Simulink model as a picture, from the world outwards."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from pydrake.math import RigidTransform, RotationMatrix

from drake_leg.arguments import printable
from drake_leg.errors import InvalidValueError, UnknownValueError
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
from drake_leg.robot.solids import Brick, Cylinder, Shape, Sphere
from drake_leg.simulink.listing import block_paths
from drake_leg.simulink.mechanism import (
    SOLIDS,
    Frame,
    PhysicalNetwork,
    SolidProperties,
    Walk,
    WalkStep,
    read_solid,
    rigid_transform,
)
from drake_leg.simulink.model import Block, Model, number, split_port, vector

_LONGEST = 24  # characters of a line
_MOST_LINES = 3
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


def body_block(block: Block, *, name: str, turned: bool, senses: bool) -> DrawnBlock:
    """Draw a mechanical block: its name, its kind where nothing else tells it, its parameters.

    ``turned`` tells whether its follower is on the left, towards the world; ``senses`` whether
    signals leave or reach it.

    Raises
    ------
    InvalidValueError
        If the numbers of a transform or a solid make no sense; the text of one that is not known is
        shown.
    """
    if block.kind in ("Connection Port", "PMIOPort"):
        return replace(connection_of(cut(block.name)), name=name)
    try:
        return _told(block, name=name, turned=turned, senses=senses)
    except UnknownValueError as error:
        caption = (*name_lines(block.name, CAPTION_WIDTH), cut(error.text))
        if block.kind in _GLYPHS:
            return DrawnBlock(name=name, caption=caption, glyph=_GLYPHS[block.kind])
        return DrawnBlock(name=name, caption=caption, text=wrapped(block.kind, CAPTION_WIDTH))


def _told(block: Block, *, name: str, turned: bool, senses: bool) -> DrawnBlock:
    """Draw a block whose values are known."""
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
    network: PhysicalNetwork, names: Mapping[str, str], *, title: str
) -> Picture:
    """Draw the mechanical blocks of a model, breadth-first from its World Frames.

    What is attached to no World Frame follows, from an open end if there is one. A block that
    closes a loop has two connections on its left side, and so has a joint that only senses, which
    comes last. A model without a mechanism has a picture without blocks.
    """
    return _Drawing(network, names).picture(title)


class _Drawing:
    """Attaches the blocks of a walk over the frames, breadth-first, sensors last."""

    def __init__(self, network: PhysicalNetwork, names: Mapping[str, str]) -> None:
        self._network, self._names = network, names
        self._frames: dict[Frame, Output] = {}  # of those that are reached
        self._walk = Walk(network, lambda block, _: (_only_senses(block, network),))
        self._chain = Chain()

    def picture(self, title: str) -> Picture:
        blocks = self._network.blocks
        mechanical = [block for sid, block in blocks.items() if sid in self._network.mechanical]
        worlds = [block for block in mechanical if block.kind == "World Frame"]
        others = sorted(mechanical, key=self._unlikely_start)
        for starts in (worlds, *([block] for block in others)):
            for block in starts:
                if block.sid not in self._walk.taken:
                    self._attach(self._walk.take(block))
            for step in self._walk:
                self._attach(step)
        return self._chain.picture(title)

    def _unlikely_start(self, block: Block) -> int:
        """Rank what a chain without a world may start from: references, open ends, the rest."""
        if "Reference" in block.kind or block.kind in ("Connection Port", "PMIOPort"):
            return 0
        ports = self._network.ports.get(block.sid, ())
        return 1 if len(ports) == 1 and not block.kind.endswith(_LEAVES) else 2

    def _attach(self, step: WalkStep) -> None:
        """Draw a block at its frames that were reached before; its others lead on from it."""
        index, network = len(self._chain.blocks), self._network
        near, far = (
            [port for port in ports if port in network.frames] for ports in (step.near, step.far)
        )
        self._frames |= {network.frame(port): (index, place) for place, port in enumerate(far)}
        drawn = body_block(
            step.block,
            name=self._names[step.block.sid],
            turned=[split_port(port)[1:] for port in near] == [("rconn", 1)] and bool(far),
            senses=step.block.sid in network.sensed,
        )
        self._chain.add(drawn, *(self._frames[network.frame(port)] for port in near))


def _only_senses(block: Block, network: PhysicalNetwork) -> bool:
    return block.kind in _SENSORS and block.sid in network.sensed
