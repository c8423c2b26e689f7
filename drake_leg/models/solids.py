"""Mass and inertia of homogeneous solids, from shape and density."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drake_leg.quantities import require_positive
from drake_leg.robot import Brick, Cylinder, Shape, Solid


@dataclass(frozen=True, kw_only=True)
class MassProperties:
    """Mass and principal moments about the solid's centre, along its own axes."""

    mass: float  # [kg]
    moments: tuple[float, float, float]  # [kg*m^2], about x, y, z


def volume(shape: Shape) -> float:
    """Volume of a shape [m^3]."""
    if isinstance(shape, Brick):
        return shape.length * shape.width * shape.height
    if isinstance(shape, Cylinder):
        return math.pi * shape.radius**2 * shape.length
    return 4.0 / 3.0 * math.pi * shape.radius**3


def bounding_radius(shape: Shape) -> float:
    """Distance of a shape's farthest point from its centre [m]."""
    if isinstance(shape, Brick):
        return math.hypot(shape.length, shape.width, shape.height) / 2
    if isinstance(shape, Cylinder):
        return math.hypot(shape.radius, shape.length / 2)
    return shape.radius


def mass_properties(solid: Solid) -> MassProperties:
    """Mass and principal moments of a homogeneous solid.

    A brick has ``Ixx = m (w^2 + h^2) / 12`` and so on, a cylinder ``Izz = m r^2 / 2`` and
    ``Ixx = m (3 r^2 + l^2) / 12``, a ball ``2/5 m r^2``. A solid that is too small or too large
    for its mass and moments to be numbers is refused.
    """
    shape = solid.shape
    mass = solid.density * volume(shape)
    if isinstance(shape, Brick):
        x2, y2, z2 = shape.length**2, shape.width**2, shape.height**2
        per_mass = ((y2 + z2) / 12, (x2 + z2) / 12, (x2 + y2) / 12)
    elif isinstance(shape, Cylinder):
        across = (3 * shape.radius**2 + shape.length**2) / 12
        per_mass = (across, across, shape.radius**2 / 2)
    else:
        about = 2 / 5 * shape.radius**2
        per_mass = (about, about, about)
    require_positive("the mass of a solid", mass, "kg")
    for moment in per_mass:
        require_positive("a moment of inertia of a solid", mass * moment, "kg*m^2")
    return MassProperties(
        mass=mass, moments=(mass * per_mass[0], mass * per_mass[1], mass * per_mass[2])
    )
