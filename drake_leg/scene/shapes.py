"""A robot's shapes as Drake's."""

from __future__ import annotations

from pydrake.geometry import Box, Cylinder, Sphere
from pydrake.geometry import Shape as DrakeShape

from drake_leg.robot import Brick, Shape
from drake_leg.robot import Cylinder as RobotCylinder


def drake_shape(shape: Shape) -> DrakeShape:
    """Return a robot's shape as Drake's.

    Parameters
    ----------
    shape : Brick, Cylinder or Sphere
        Of a robot or of a part.

    Returns
    -------
    pydrake.geometry.Shape
        With the same frame.
    """
    if isinstance(shape, Brick):
        return Box(shape.length, shape.width, shape.height)
    if isinstance(shape, RobotCylinder):
        return Cylinder(shape.radius, shape.length)
    return Sphere(shape.radius)
