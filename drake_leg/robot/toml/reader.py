"""Reads a robot from a TOML file."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from drake_leg.robot.joint_mechanics import PRIORITIES, HardStop, JointMechanics, StateTarget
from drake_leg.robot.robot import BASE, JointType, Link, Robot, Row, Segment, link_colour
from drake_leg.robot.solids import (
    Brick,
    Cylinder,
    Inertial,
    Shape,
    Solid,
    Sphere,
    mass_properties,
    volume,
)
from drake_leg.robot.toml.base import BASE_KEYS, INSTEAD_OF_BASE, read_base_pose, read_loops
from drake_leg.robot.toml.keys import Keys, parse_document
from drake_leg.units import AngleUnit, JointUnits, in_radians, joint_units

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
    "inertia": "inertia is moments and products, under [row.inertial], beside the solid",
    "type": "did you mean 'shape'?",
    "box": 'write shape = "brick", length, width, height',
    "size": "write length, width, height, or radius",
    "origin": "write centre, in the link's frame",
    "material": "write density",
}
_INSTEAD_OF_INERTIAL = {
    **dict.fromkeys(("com", "cog", "origin"), "write centre, of mass in the link's frame"),
    "inertia": "write moments = [Ixx, Iyy, Izz] and products = [Ixy, Ixz, Iyz]",
    **dict.fromkeys(("Ixx", "Iyy", "Izz", "ixx", "iyy", "izz"), "write moments = [Ixx, Iyy, Izz]"),
    **dict.fromkeys(("Ixy", "Ixz", "Iyz", "ixy", "ixz", "iyz"), "write products = [Ixy, Ixz, Iyz]"),
    "density": "mass, centre and moments are given here; a density goes under [row.solid]",
}

_MECHANICS_KEYS = (
    "damping",
    "damping_unit",
    "dry_friction",
    "rotor_inertia",
    "spring_stiffness",
    "spring_unit",
    "equilibrium_position",
    "actuated",
    "position_target",
    "position_priority",
    "velocity_target",
    "velocity_priority",
)
_LIMIT_KEYS = ("lower", "upper", "velocity", "effort", "lower_stop", "upper_stop")
_STOP_KEYS = ("stiffness", "spring_unit", "damping", "damping_unit", "transition_width")
_INSTEAD_OF_MECHANICS = {
    **dict.fromkeys(("limits", *_LIMIT_KEYS), "limits go under [row.limits]"),
    "stiffness": "did you mean 'spring_stiffness'?",
    "mimic": "joints do not follow one another here, each row that moves has a position of its own",
    "friction": "friction that grows with speed is damping, any other is dry_friction",
    **dict.fromkeys(("armature", "inertia", "ia", "IA"), "write rotor_inertia, seen at the joint"),
    **dict.fromkeys(("q0", "home", "initial_position"), "write position_target"),
}
_INSTEAD_OF_LIMITS = {
    "min": "write lower",
    "max": "write upper",
    **dict.fromkeys(("speed", "rate", "velocity_limit"), "write velocity, the greatest speed"),
    **dict.fromkeys(("torque", "force", "effort_limit"), "write effort, the greatest of the motor"),
    **dict.fromkeys(
        ("stiffness", "damping"),
        "a limit that pushes back has them: lower_stop = { stiffness = ..., damping = ... }",
    ),
}

ROBOT_KEYS = ("name", "title", "source", "convention", "angles", "base", "row", "loop")
TABLE_KEYS = {
    "khalil": ("sigma", "d", "alpha", "r", "theta"),
    "classic": ("sigma", "theta", "d", "a", "alpha"),
}
TREE_KEYS = ("antecedent", "gamma", "b")  # of a row of Khalil's table that is a branch
BODY_KEYS = ("joint", "link", "end", "solid", "inertial", "mechanics", "limits")
SIGMAS: dict[int | str, JointType] = {0: "revolute", 1: "prismatic", "~": "fixed"}

_INSTEAD_OF_ROBOT = {
    "lengths": "lengths are in m throughout",
    "rows": "every row is a table of its own, under [[row]]",
    "units": 'lengths are in m throughout, and angles = "deg" or "rad"',
    "dh": "the table's rows go under [[row]]",
    "joints": "a joint goes with its link in a row, under [[row]]",
    "links": "a link goes with its joint in a row, under [[row]]",
    "gravity": "gravity belongs to a run, as its option `gravity`",
    "q0": "where it starts belongs to a run, as its option `q0`, or to [row.mechanics], as "
    "position_target",
    "tool": 'a tool is a last [[row]] with sigma = "~"',
    "loops": "every loop is a table of its own, under [[loop]]",
    "floating": "it goes under [base]",
    "pose": "the base's position and rotation go under [base]",
}
_ANTECEDENT = (
    "write antecedent, the number of the row that carries this one, from 1, or 0 for the base"
)
_OFFSET = (
    "the joint's position adds to theta where it turns, to r (classic: d) where it slides: write "
    "the offset there"
)
_INSTEAD_OF_ROW = {
    "mimic": "joints do not follow one another here, each row that moves has a position of its own",
    **dict.fromkeys(("theta_offset", "offset", "theta_0", "theta0", "q_offset"), _OFFSET),
    **dict.fromkeys(("d_offset", "r_offset", "d_0", "d0", "r_0", "r0"), _OFFSET),
    "name": 'write joint = "..." and link = "...", each has a name',
    **dict.fromkeys(
        ("type", "joint_type"), 'write sigma = 0 (revolute), 1 (prismatic) or "~" (fixed)'
    ),
    **dict.fromkeys(("min", "lower"), "write lower, under [row.limits]"),
    **dict.fromkeys(("max", "upper"), "write upper, under [row.limits]"),
    "velocity": "the greatest speed goes under [row.limits]",
    "effort": "the greatest torque or force goes under [row.limits]",
    **dict.fromkeys(("q0", "home", "position"), "write position_target, under [row.mechanics]"),
    "inertia": "inertia is moments and products, with mass and centre, under [row.inertial]",
    **dict.fromkeys(
        ("length", "width", "height", "radius", "shape", "colour", "color"),
        "what a link looks like goes under [row.solid]",
    ),
    "friction": "what grows with speed is damping, any other dry_friction, under [row.mechanics]",
    **dict.fromkeys(
        ("stiffness", "spring_stiffness"), "write spring_stiffness, under [row.mechanics]"
    ),
    "axis": "every joint turns about or slides along its z; alpha turns that axis",
    **dict.fromkeys(("parent", "child", "children", "ant"), _ANTECEDENT),
    "a": 'it belongs to the classic convention: say convention = "classic", or give d and r',
    "mass": "a mass goes with centre and moments under [row.inertial]",
    "density": "a density goes under [row.solid]",
    "damping": "damping goes under [row.mechanics]",
    "r": 'it belongs to Khalil\'s convention: leave out convention = "classic", or give d and a',
}


def read_solid(table: object, where: str, inertial: Inertial | None, row: int) -> Solid:
    """Read the solid of a row, from the value of its key.

    ``where`` is the file and row, with which every error begins. With an ``inertial`` the density
    may be left out; the row's number, from 1, chooses a color if none is given.
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
        spelled = keys.spelled("colour")
        raise keys.error(f"{spelled} is {list(colour)}; red, green and blue go from 0 to 1")
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


def read_mechanics(
    mechanics: object, limits: object, where: str, units: JointUnits
) -> JointMechanics:
    """Read the joint mechanics of a row from the values of these two keys.

    ``where`` is the file and row, with which every error begins.
    """
    acting = Keys(mechanics, f"{where}, mechanics", _MECHANICS_KEYS, _INSTEAD_OF_MECHANICS)
    bounds = Keys(limits, f"{where}, limits", _LIMIT_KEYS, _INSTEAD_OF_LIMITS)
    lower, upper = (bounds.optional(key, units.position) for key in ("lower", "upper"))
    if lower is not None and upper is not None and lower >= upper:
        raise bounds.error(
            f"lower is {lower:.9g} {units.position} and upper is {upper:.9g} {units.position}; "
            'lower must be less, and a joint that cannot move is a fixed row (sigma = "~")'
        )
    velocity = bounds.optional("velocity", units.velocity, positive=True)
    equilibrium = acting.number("equilibrium_position", units.position, 0.0)
    if acting.has("equilibrium_position") and not acting.has("spring_stiffness"):
        raise acting.error(
            f"equilibrium_position is {equilibrium:.9g} {units.position}, but there is no "
            "spring_stiffness; give both"
        )
    actuated = acting.flag("actuated", True)
    effort = bounds.optional("effort", units.effort, positive=True)
    if effort is not None and not actuated:
        raise bounds.error(
            f"effort is {effort:.9g} {units.effort} at a joint with actuated = false; leave out "
            "one of the two"
        )
    rotor = acting.non_negative("rotor_inertia", units.rotor_inertia, 0.0)
    if rotor and not actuated:
        raise acting.error(
            f"rotor_inertia is {rotor:.9g} {units.rotor_inertia} at a joint with actuated = false; "
            "leave out one of the two"
        )
    return bounds.make(
        JointMechanics,
        damping=_in_si(acting, "damping", "damping_unit", units.damping, 0.0),
        dry_friction=acting.non_negative("dry_friction", units.effort, 0.0),
        rotor_inertia=rotor,
        spring_stiffness=_in_si(acting, "spring_stiffness", "spring_unit", units.stiffness, 0.0),
        equilibrium_position=units.si(equilibrium),
        actuated=actuated,
        lower=None if lower is None else units.si(lower),
        upper=None if upper is None else units.si(upper),
        velocity=None if velocity is None else units.si(velocity),
        effort=effort,
        lower_stop=_stop(bounds, "lower_stop", units),
        upper_stop=_stop(bounds, "upper_stop", units),
        position_target=_target(acting, "position", units.position, units),
        velocity_target=_target(acting, "velocity", units.velocity, units),
    )


def _in_si(keys: Keys, key: str, unit_key: str, units: dict[str, float], default: float) -> float:
    """Read a number that is not negative, and the unit that the file may choose for it."""
    unit = keys.choice(unit_key, tuple(units), next(iter(units)))
    if keys.has(key):
        return keys.non_negative(key, unit, 0.0) * units[unit]
    if keys.has(unit_key):
        raise keys.error(f"{unit_key} is {unit!r}, but there is no {key}; give both")
    return default


def _stop(bounds: Keys, key: str, units: JointUnits) -> HardStop | None:
    """Read a limit's spring and damper; missing values have Simscape's defaults."""
    if not bounds.has(key):
        return None
    keys = Keys(bounds.value(key), f"{bounds.where}, {key}", _STOP_KEYS)
    default = HardStop.translational() if units.position == "m" else HardStop.rotational()
    width = keys.optional("transition_width", units.position, positive=True)
    return keys.make(
        HardStop,
        stiffness=_in_si(keys, "stiffness", "spring_unit", units.stiffness, default.stiffness),
        damping=_in_si(keys, "damping", "damping_unit", units.damping, default.damping),
        transition_width=default.transition_width if width is None else units.si(width),
    )


def _target(acting: Keys, quantity: str, unit: str, units: JointUnits) -> StateTarget | None:
    """Read the initial position or velocity of a joint, if the file has one."""
    key, priority_key = f"{quantity}_target", f"{quantity}_priority"
    priority = acting.choice(priority_key, PRIORITIES, "high")
    value = acting.optional(key, unit)
    if value is not None:
        return acting.make(StateTarget, value=units.si(value), priority=priority)
    if acting.has(priority_key):
        raise acting.error(f"{priority_key} is {priority!r}, but there is no {key}; give both")
    return None


@dataclass(frozen=True, kw_only=True)
class ClassicRow:
    """One row of a classic table; the joint's position adds to ``theta`` or to ``d``."""

    joint: JointType
    theta: float  # [rad], about z of the frame before
    d: float  # [m], along z of the frame before
    a: float  # [m], along x of this frame
    alpha: float  # [rad], about x of this frame


def khalil_rows(rows: Sequence[ClassicRow]) -> tuple[Row, ...]:
    """Convert a classic table of n rows to a Khalil table of n + 1 rows with the same last frame.

    The last row is fixed and carries the last ``a`` and ``alpha``. Frame i of the result lies on
    the axis of joint i, where the classic frame i - 1 has its z axis (Craig, *Introduction to
    Robotics*, 3rd ed., section 3.4, names both conventions).
    """
    before = [(0.0, 0.0), *((row.a, row.alpha) for row in rows)]
    moved = [
        Row(joint=row.joint, d=a, alpha=alpha, r=row.d, theta=row.theta)
        for row, (a, alpha) in zip(rows, before, strict=False)
    ]
    a, alpha = before[-1]
    return (*moved, Row(joint="fixed", d=a, alpha=alpha))


def read_robot(text: str, where: str) -> Robot:
    """Read a robot from TOML; errors begin with the file's name."""
    keys = Keys(parse_document(text, where), where, ROBOT_KEYS, _INSTEAD_OF_ROBOT)
    name = keys.text("name")
    convention = keys.choice("convention", tuple(TABLE_KEYS), "khalil")
    angles: AngleUnit = keys.choice("angles", ("deg", "rad"))
    tables = keys.value("row", remedy="every row of the table goes under [[row]]")
    if not isinstance(tables, list) or not tables:
        raise keys.error(
            "row is not a list of tables; every row goes under [[row]], with two brackets"
        )
    tree = TREE_KEYS if convention == "khalil" else ()
    known = (*TABLE_KEYS[convention], *tree, *BODY_KEYS)
    rows = [
        Keys(table, f"{where}: row {index}", known, _INSTEAD_OF_ROW)
        for index, table in enumerate(tables, start=1)
    ]
    loops = read_loops(keys)
    return keys.make(
        Robot,
        name=name,
        title=keys.text("title", name),
        source=keys.text("source", Path(where).name),
        segments=_segments(rows, convention, angles, {loop.cut for loop in loops}),
        loops=loops,
        **_base(keys, angles),
    )


def _base(keys: Keys, angles: AngleUnit) -> dict[str, object]:
    """Read what a robot has of a base, as arguments of ``Robot``."""
    if not keys.has("base"):
        return {}
    base = Keys(keys.value("base"), f"{keys.where}: base", BASE_KEYS, INSTEAD_OF_BASE)
    has_link = any(base.has(key) for key in ("link", "end", "solid", "inertial"))
    return {
        "floating": base.flag("floating", False),
        "base_link": _link(base, base.text("link", BASE), 0) if has_link else None,
        "base_pose": read_base_pose(base, angles),
    }


def _segments(
    rows: list[Keys], convention: str, angles: AngleUnit, cuts: Collection[int]
) -> tuple[Segment, ...]:
    tools: list[Row] = []
    if convention == "classic":
        *table, tool = khalil_rows([_classic_row(keys, angles) for keys in rows])
        tools.append(tool)
    else:
        table = [_khalil_row(keys, angles) for keys in rows]
    numbered = enumerate(zip(rows, table, strict=True), start=1)
    carried = [
        _cut(keys, row, angles) if index in cuts else _segment(keys, row, index, angles)
        for index, (keys, row) in numbered
    ]
    return (*carried, *(Segment(row=row) for row in tools))


def _joint_type(keys: Keys) -> JointType:
    return SIGMAS[keys.choice("sigma", tuple(SIGMAS))]


def _khalil_row(keys: Keys, angles: AngleUnit) -> Row:
    return keys.make(
        Row,
        joint=_joint_type(keys),
        d=keys.number("d", "m"),
        alpha=in_radians(keys.number("alpha", angles), angles),
        r=keys.number("r", "m"),
        theta=in_radians(keys.number("theta", angles), angles),
        gamma=in_radians(keys.number("gamma", angles, 0.0), angles),
        b=keys.number("b", "m", 0.0),
        antecedent=keys.whole("antecedent") if keys.has("antecedent") else None,
    )


def _classic_row(keys: Keys, angles: AngleUnit) -> ClassicRow:
    return ClassicRow(
        joint=_joint_type(keys),
        theta=in_radians(keys.number("theta", angles), angles),
        d=keys.number("d", "m"),
        a=keys.number("a", "m"),
        alpha=in_radians(keys.number("alpha", angles), angles),
    )


def _segment(keys: Keys, row: Row, index: int, angles: AngleUnit) -> Segment:
    acting = [key for key in ("mechanics", "limits") if keys.has(key)]
    if row.joint == "fixed" and acting:
        raise keys.error(f'{acting[0]} is given at a fixed row (sigma = "~"), which cannot move')
    if row.joint == "fixed" and not any(keys.has(key) for key in BODY_KEYS):
        return Segment(row=row)
    link = keys.text("link", f"link_{index}")
    joint = keys.text("joint", f"{link}_weld" if row.joint == "fixed" else f"joint_{index}")
    return keys.make(
        Segment,
        row=row,
        joint=joint,
        link=_link(keys, link, index),
        mechanics=_mechanics(keys, row, angles),
    )


def _cut(keys: Keys, row: Row, angles: AngleUnit) -> Segment:
    """Read the row of a cut joint, which carries no link."""
    given = [key for key in ("joint", "link", "end", "solid", "inertial") if keys.has(key)]
    if given:
        raise keys.error(
            f"{given[0]} is given at a row where a loop is cut, which has no link; its joint has "
            "its name under [[loop]]"
        )
    mechanics = JointMechanics()
    if row.joint != "fixed":
        mechanics = _mechanics(keys, row, angles)
    return keys.make(Segment, row=row, mechanics=mechanics)


def _mechanics(keys: Keys, row: Row, angles: AngleUnit) -> JointMechanics:
    return read_mechanics(
        keys.value("mechanics", {}),
        keys.value("limits", {}),
        keys.where,
        joint_units(row.joint, angles),
    )


def _link(keys: Keys, name: str, index: int) -> Link:
    inertial = solid = None
    if keys.has("inertial"):
        inertial = read_inertial(keys.value("inertial"), f"{keys.where}, inertial")
    if keys.has("solid"):
        solid = read_solid(keys.value("solid"), f"{keys.where}, solid", inertial, index)
    return Link(name=name, solid=solid, inertial=inertial, end=keys.three("end", "m", ORIGIN))
