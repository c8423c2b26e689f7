"""How one mechanical block of a Simulink model looks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from drake_leg.drawings.captions import (
    CAPTION_WIDTH,
    damping_words,
    gravity_words,
    mass_words,
    number_text,
    spring_words,
    transform_words,
)
from drake_leg.drawings.chain import SHAPES, connection_of, solid_block
from drake_leg.drawings.picture import Block as Drawn
from drake_leg.drawings.simulink_names import cut, name_lines
from drake_leg.drawings.text import wrapped
from drake_leg.errors import InvalidValueError
from drake_leg.models.solids import volume
from drake_leg.robot import Brick, Cylinder, Shape, Sphere
from drake_leg.simulink.model import Block
from drake_leg.simulink.poses import rigid_transform

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
_SHAPES = {kind: shape for shape, kind in SHAPES.items()}
_SOLIDS = (
    *_SHAPES,
    "Solid",
    "Ellipsoidal Solid",
    "Extruded Solid",
    "File Solid",
    "Inertia",
    "Revolved Solid",
)


def body_block(block: Block, *, name: str, turned: bool, senses: bool) -> Drawn:
    """Draw a mechanical block.

    Parameters
    ----------
    block : Block
        Of the model.
    name : str
        Unique in its picture.
    turned : bool
        Whether its follower is on the left, towards the world.
    senses : bool
        Whether signals leave or reach it.

    Returns
    -------
    Block
        With its name, its kind where nothing else tells it, and its parameters.

    Raises
    ------
    InvalidValueError
        If the numbers of a transform or a solid make no sense.
    """
    if block.kind in ("Connection Port", "PMIOPort"):
        return replace(connection_of(cut(block.name)), name=name)
    caption = name_lines(block.name, CAPTION_WIDTH)
    if block.kind in _SOLIDS and "Mass" in block.parameters:
        shape = _shape_of(block)
        return solid_block(name, (*caption, *_kind(block), *_size(block, shape)), shape)
    if block.kind not in _GLYPHS:
        return Drawn(name=name, caption=caption, text=wrapped(block.kind, CAPTION_WIDTH))
    details = _DETAILS.get(block.kind)
    notes = {"senses the motion": senses and block.kind == "6-DOF Joint", "drawn F to B": turned}
    return Drawn(
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


def _numbers(block: Block, parameter: str) -> tuple[float, ...]:
    """Read a parameter as numbers, none where it is text."""
    value = block.parameters.get(parameter, ())
    return () if isinstance(value, str) else tuple(np.ravel(np.array(value, dtype=float)).tolist())


def _number(block: Block, parameter: str) -> float:
    numbers = _numbers(block, parameter)
    return numbers[0] if len(numbers) == 1 else 0.0


def _transform(block: Block) -> Iterator[str]:
    X_BF = rigid_transform(block)
    R_BF = RotationMatrix.ProjectToRotationMatrix(X_BF[:3, :3])
    yield from transform_words(RigidTransform(R_BF, X_BF[:3, 3]))


def _gravity(block: Block) -> Iterator[str]:
    gravity = _numbers(block, "GravityVector")
    if len(gravity) == 3 and block.parameters.get("UniformGravity") == "Constant":
        yield from gravity_words(gravity)


def _joint(block: Block) -> Iterator[str]:
    """Say what drives a joint with one degree of freedom, and what acts in it."""
    turning = block.kind == "Revolute Joint"
    for what in ("Motion", "Torque", "Force"):
        if str(block.parameters.get(f"{what}ActuationMode", "")).startswith("Input"):
            yield f"{what.lower()} by input"
    yield from damping_words(_number(block, "DampingCoefficient"), turning=turning)
    stiffness, rest = _number(block, "SpringStiffness"), _number(block, "EquilibriumPosition")
    yield from spring_words(stiffness, rest, turning=turning)


_DETAILS: dict[str, Callable[[Block], Iterator[str]]] = {
    "Mechanism Configuration": _gravity,
    "Prismatic Joint": _joint,
    "Revolute Joint": _joint,
    "Rigid Transform": _transform,
}


def _shape_of(block: Block) -> str:
    """Name the shape of a solid; files of about R2016 have one kind of block for all shapes."""
    if block.kind == "Solid":
        return str(block.parameters.get("GeometryShape")).lower()
    return _SHAPES.get(block.kind, "")


def _size(block: Block, shape: str) -> Iterator[str]:
    """Write a solid's dimensions and its mass, its density where the mass is not known."""
    try:
        drawn = _shape(block, shape)
    except InvalidValueError as error:
        raise InvalidValueError(f"the block {block.name!r} (SID {block.sid}): {error}") from None
    if drawn is not None:
        yield _dimensions(drawn)
    geometric = block.parameters.get("InertiaType") == "CalculateFromGeometry"
    if not geometric or block.parameters.get("BasedOnType") == "Mass":
        yield mass_words(_number(block, "Mass"))
    elif drawn is not None:
        yield mass_words(_number(block, "Density") * volume(drawn))
    else:
        yield f"{number_text(_number(block, 'Density'))} kg/m³"


def _shape(block: Block, shape: str) -> Shape | None:
    if shape == "brick":
        sides = _numbers(block, "BrickDimensions")
        if len(sides) != 3:
            raise InvalidValueError(f"its BrickDimensions are {len(sides)} numbers; give three")
        return Brick(length=sides[0], width=sides[1], height=sides[2])
    if shape == "cylinder":
        radius, length = _number(block, "CylinderRadius"), _number(block, "CylinderLength")
        return Cylinder(radius=radius, length=length)
    return Sphere(radius=_number(block, "SphereRadius")) if shape == "sphere" else None


def _dimensions(shape: Shape) -> str:
    if isinstance(shape, Brick):
        sides = (shape.length, shape.width, shape.height)
        return f"{' × '.join(number_text(1e3 * side) for side in sides)} mm"
    radius = f"r {number_text(1e3 * shape.radius)}"
    if isinstance(shape, Cylinder):
        return f"{radius}, l {number_text(1e3 * shape.length)} mm"
    return f"{radius} mm"
