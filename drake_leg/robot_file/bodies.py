"""What a link weighs and looks like: the tables ``solid`` and ``inertial`` of a row."""

from __future__ import annotations

from collections.abc import Callable

from drake_leg.models.solids import mass_properties, volume
from drake_leg.robot import Brick, Cylinder, Inertial, Shape, Solid, Sphere, link_colour
from drake_leg.robot_file.keys import Keys

# Of each shape: its class, and its dimensions in the order in which they are written.
SHAPES: dict[str, tuple[Callable[..., Shape], tuple[str, ...]]] = {
    "brick": (Brick, ("length", "width", "height")),
    "cylinder": (Cylinder, ("radius", "length")),
    "sphere": (Sphere, ("radius",)),
}
ORIGIN = (0.0, 0.0, 0.0)

_SOLID_KEYS = ("density", "centre", "colour")
_INERTIAL_KEYS = ("mass", "centre", "moments", "products")
_INSTEAD_OF_SOLID = {
    "mass": "a mass goes with centre and moments under [row.inertial], beside the solid",
    "color": "did you mean 'colour'?",
    "center": "did you mean 'centre'?",
    "inertia": "inertia is moments and products, under [row.inertial], beside the solid",
    "type": "did you mean 'shape'?",
    "box": 'write shape = "brick", length, width, height',
    "size": "write length, width, height, or radius",
    "origin": "write centre, in the link's frame",
    "material": "write density",
}
_INSTEAD_OF_INERTIAL = {
    "center": "did you mean 'centre'?",
    **dict.fromkeys(("com", "cog", "origin"), "write centre, of mass in the link's frame"),
    "inertia": "write moments = [Ixx, Iyy, Izz] and products = [Ixy, Ixz, Iyz]",
    **dict.fromkeys(("Ixx", "Iyy", "Izz", "ixx", "iyy", "izz"), "write moments = [Ixx, Iyy, Izz]"),
    **dict.fromkeys(("Ixy", "Ixz", "Iyz", "ixy", "ixz", "iyz"), "write products = [Ixy, Ixz, Iyz]"),
    "density": "mass, centre and moments are given here; a density goes under [row.solid]",
}


def read_solid(table: object, where: str, inertial: Inertial | None, row: int) -> Solid:
    """Read the solid of a row, from the value of its key.

    ``where`` is the file and row, with which every error begins. With an ``inertial`` the density
    may be left out; the row's number, from 1, chooses a colour if none is given.
    """
    every = {key for _, names in SHAPES.values() for key in names}
    shape_keys = Keys(table, where, ("shape", *sorted(every), *_SOLID_KEYS), _INSTEAD_OF_SOLID)
    kind = shape_keys.choice("shape", tuple(SHAPES))
    make, names = SHAPES[kind]
    keys = Keys(table, f"{where} ({kind})", ("shape", *names, *_SOLID_KEYS))
    shape = keys.make(make, **{name: keys.positive(name, "m") for name in names})
    of_mass = {} if inertial is None else {"default": inertial.mass / volume(shape)}
    colour = keys.three("colour", "0 to 1", link_colour(row))
    if not all(0.0 <= part <= 1.0 for part in colour):
        raise keys.error(f"colour is {list(colour)}; red, green and blue go from 0 to 1")
    solid = keys.make(
        Solid,
        shape=shape,
        density=keys.positive("density", "kg/m^3", **of_mass),
        centre=keys.three("centre", "m", ORIGIN),
        colour=colour,
    )
    keys.make(mass_properties, solid=solid)
    return solid


def read_inertial(table: object, where: str) -> Inertial:
    """Read the explicit mass properties of a row, from the value of its key."""
    keys = Keys(table, where, _INERTIAL_KEYS, _INSTEAD_OF_INERTIAL)
    return keys.make(
        Inertial,
        mass=keys.positive("mass", "kg"),
        centre=keys.three("centre", "m"),
        moments=keys.three("moments", "kg*m^2"),
        products=keys.three("products", "kg*m^2", ORIGIN),
    )
