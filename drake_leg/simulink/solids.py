"""What a solid of Simscape Multibody is: its shape, its size, its mass, its colour."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drake_leg.simulink.model import Block
from drake_leg.simulink.values import number, vector

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
)


@dataclass(frozen=True, kw_only=True)
class SolidProperties:
    """A solid, homogeneous or with its mass said outright."""

    shape: str  # "brick", "cylinder", "sphere", "other"
    size: tuple[float, ...]  # [m]: three edges; radius and length; radius
    density: float | None  # [kg/m^3]; None where the mass is said outright
    mass: float  # [kg]; 0 where it follows from a shape that is not known
    moments: tuple[float, ...] = ()  # [kg*m^2], said outright or of a plant's body
    offsets: tuple[float, ...] = ()  # centre of mass [m] and products [kg*m^2]; none means zero
    colour: tuple[float, ...] = ()  # red, green, blue in 0...1


def read_solid(block: Block) -> SolidProperties:
    """Read a solid.

    Parameters
    ----------
    block : Block
        Of a kind in ``SOLIDS``, its parameters in SI.

    Returns
    -------
    SolidProperties
        As the block has it: sizes may be zero or less, and the edges of a brick are as many
        numbers as its ``BrickDimensions``.
    """
    get = block.parameters.get
    shape = _shape(block)
    size = _size(block, shape)
    unsaid = "PointMass" if block.kind == "Inertia" else "CalculateFromGeometry"
    outright = get("InertiaType", unsaid) != "CalculateFromGeometry"
    weighed = outright or get("BasedOnType") == "Mass"
    density = None if weighed else number(get("Density"))
    moments, offsets = _inertia(block) if outright else ((), ())
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
    """Volume of a shape.

    Parameters
    ----------
    size : tuple of float
        As of ``SolidProperties`` [m].

    Returns
    -------
    float
        [m^3]; 0 of another shape, infinite where a square or a cube is beyond all numbers.
    """
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
    """Read moments and offsets that are said outright; a point mass has no moments."""
    get = block.parameters.get
    centre = vector(get("CenterOfMass"))
    if get("InertiaType") != "Custom":
        return (0.0, 0.0, 0.0), centre
    return vector(get("MomentsOfInertia")), centre + vector(get("ProductsOfInertia"))
