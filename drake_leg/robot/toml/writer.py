"""Writes a robot as a readable TOML file, which is read back as exactly the same robot."""

from __future__ import annotations

import json
from collections.abc import Iterator

from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robot import Link, Robot, Segment
from drake_leg.robot.solids import Inertial, Solid
from drake_leg.robot.toml.reader import ORIGIN, SHAPES
from drake_leg.units import AngleUnit, JointUnits, exact_degrees, joint_units

COMMENT_COLUMN = 32
HEAD = (
    "# A robot of drake-leg: its Khalil (modified DH) table from base to tip, one [[row]] each.\n"
    "# Lengths are in m, masses in kg, angles in the unit below, speeds in that unit per second."
)

Entries = dict[str, tuple[object, str]]  # key to value and unit


def robot_toml(robot: Robot) -> str:
    """Write a robot as TOML.

    ``read_robot(robot_toml(robot), name) == robot``, to the last bit. Angles are in degrees if all
    of them are read back exactly, otherwise in radians.
    """
    angles: AngleUnit = "deg"
    if any(exact_degrees(angle) is None for angle in _angles(robot)):
        angles = "rad"
    lines = [
        HEAD,
        as_line("name", robot.name),
        as_line("title", robot.title),
        as_line("source", robot.source),
        as_line("convention", "khalil", '"khalil" (modified DH) or "classic" (standard DH)'),
        as_line("angles", angles, '"deg" or "rad"'),
    ]
    lines += _base_lines(robot)
    for segment in robot.segments:
        lines += ["", "[[row]]", *_row_lines(segment, angles)]
    for loop in robot.loops:
        lines += [
            "",
            "[[loop]]",
            as_line("joint", loop.joint, "at which the loop is cut"),
            as_line("cut", loop.cut, "its row"),
            as_line("end", loop.end, "row of the frame on the other side"),
        ]
    return "\n".join(lines) + "\n"


def _angles(robot: Robot) -> Iterator[float]:
    """Yield every number of a robot that is written in the file's unit of angles."""
    for segment in robot.segments:
        yield from (segment.row.alpha, segment.row.theta, segment.row.gamma)
        if segment.row.joint == "revolute":
            mechanics = segment.mechanics
            yield mechanics.equilibrium_position
            targets = (mechanics.position_target, mechanics.velocity_target)
            yield from (target.value for target in targets if target is not None)
            yield from (stop.transition_width for _, _, stop in mechanics.stops)
            limits = (mechanics.lower, mechanics.upper, mechanics.velocity)
            yield from (limit for limit in limits if limit is not None)


def _row_lines(segment: Segment, angles: AngleUnit) -> Iterator[str]:
    row, link = segment.row, segment.link
    sigma = "~" if row.sigma is None else row.sigma
    alpha, theta, gamma = (
        exact_degrees(angle) if angles == "deg" else angle
        for angle in (row.alpha, row.theta, row.gamma)
    )
    if row.antecedent is not None:
        yield as_line("antecedent", row.antecedent, "row that carries this one; 0 is the base")
    yield as_line("sigma", sigma, '0 revolute, 1 prismatic, "~" fixed')
    if gamma:
        yield as_line("gamma", gamma, f"[{angles}] about z of the antecedent's frame")
    if row.b:
        yield as_line("b", row.b, "[m] along z of the antecedent's frame")
    yield as_line("d", row.d, "[m] along x of the frame before")
    yield as_line("alpha", alpha, f"[{angles}] about x of the frame before")
    yield as_line("r", row.r, "[m] along z")
    yield as_line("theta", theta, f"[{angles}] about z")
    if link is None:
        yield from _joint_lines(segment.mechanics, joint_units(row.joint, angles))
        return
    yield as_line("joint", segment.joint)
    yield as_line("link", link.name)
    if link.end != ORIGIN:
        yield as_line("end", link.end, "[m] end of the link in its frame")
    yield from _body_lines(link)
    yield from _joint_lines(segment.mechanics, joint_units(row.joint, angles))


def _base_lines(robot: Robot) -> Iterator[str]:
    pose, link = robot.base_pose, robot.base_link
    if not robot.floating and pose is None and link is None:
        return
    yield from ("", "[base]")
    if robot.floating:
        yield as_line("floating", True, "it moves freely")
    if link is not None:
        yield as_line("link", link.name)
        if link.end != ORIGIN:
            yield as_line("end", link.end, "[m] end of the link in its frame")
    if pose is not None:
        yield as_line("position", tuple(row[3] for row in pose[:3]), "[m] of frame 0 in the world")
        yield as_line("rotation", tuple(row[:3] for row in pose[:3]), "its axes, as columns")
    if link is not None:
        yield from _body_lines(link, "base")


def _body_lines(link: Link, table: str = "row") -> Iterator[str]:
    if link.inertial is not None:
        yield from _inertial_lines(link.inertial, table)
    if link.solid is not None:
        yield from _solid_lines(link.solid, table)


def _inertial_lines(body: Inertial, table: str) -> Iterator[str]:
    yield f"[{table}.inertial]"
    yield as_line("mass", body.mass, "[kg]")
    yield as_line("centre", body.centre, "[m] center of mass in the link's frame")
    yield as_line("moments", body.moments, "[kg*m^2] Ixx, Iyy, Izz about the center of mass")
    yield as_line("products", body.products, "[kg*m^2] Ixy, Ixz, Iyz of the inertia matrix")


def _solid_lines(solid: Solid, table: str) -> Iterator[str]:
    kinds = {kind: (name, dimensions) for name, (kind, dimensions) in SHAPES.items()}
    name, dimensions = kinds[type(solid.shape)]
    yield f"[{table}.solid]"
    yield as_line("shape", name)
    for dimension in dimensions:
        yield as_line(dimension, getattr(solid.shape, dimension), "[m]")
    yield as_line("density", solid.density, "[kg/m^3]")
    yield as_line("centre", solid.centre, "[m] in the link's frame")
    yield as_line("colour", solid.colour, "red, green, blue, 0 to 1")


def _joint_lines(mechanics: JointMechanics, units: JointUnits) -> Iterator[str]:
    """Write the values that differ from the defaults."""
    for header, entries in (("[row.mechanics]", _acting), ("[row.limits]", _bounds)):
        nothing, all_entries = entries(JointMechanics(), units), entries(mechanics, units)
        keys = {key for key, entry in all_entries.items() if entry != nothing[key]}
        if "equilibrium_position" in keys:
            keys.add("spring_stiffness")  # the reader wants both
        if keys:
            yield header
        for key, (value, unit) in all_entries.items():
            if key in keys:
                yield as_line(key, value, unit and f"[{unit}]")


def _acting(mechanics: JointMechanics, units: JointUnits) -> Entries:
    position, velocity = mechanics.position_target, mechanics.velocity_target
    return {
        "damping": (mechanics.damping, next(iter(units.damping))),
        "dry_friction": (mechanics.dry_friction, units.effort),
        "rotor_inertia": (mechanics.rotor_inertia, units.rotor_inertia),
        "spring_stiffness": (mechanics.spring_stiffness, next(iter(units.stiffness))),
        "equilibrium_position": (_shown_in(units, mechanics.equilibrium_position), units.position),
        "actuated": (mechanics.actuated, ""),
        "position_target": (_target(position, units), units.position),
        "position_priority": (_low_priority(position), ""),
        "velocity_target": (_target(velocity, units), units.velocity),
        "velocity_priority": (_low_priority(velocity), ""),
    }


def _bounds(mechanics: JointMechanics, units: JointUnits) -> Entries:
    inside = f"{next(iter(units.stiffness))}, {next(iter(units.damping))}, {units.position}"
    return {
        "lower": (_shown_in(units, mechanics.lower), units.position),
        "upper": (_shown_in(units, mechanics.upper), units.position),
        "velocity": (_shown_in(units, mechanics.velocity), units.velocity),
        "effort": (mechanics.effort, units.effort),
        "lower_stop": (_stop(mechanics.lower_stop, units), inside),
        "upper_stop": (_stop(mechanics.upper_stop, units), inside),
    }


def _target(target: StateTarget | None, units: JointUnits) -> float | None:
    return None if target is None else _shown_in(units, target.value)


def _low_priority(target: StateTarget | None) -> str | None:
    return "low" if target is not None and target.priority == "low" else None


def _stop(stop: HardStop | None, units: JointUnits) -> dict[str, float | None] | None:
    if stop is None:
        return None
    return {
        "stiffness": stop.stiffness,
        "damping": stop.damping,
        "transition_width": _shown_in(units, stop.transition_width),
    }


def _shown_in(units: JointUnits, value: float | None) -> float | None:
    """Convert a position or speed in SI to the file's unit."""
    return value if value is None or units.position != "deg" else exact_degrees(value)


def as_line(key: str, value: object, comment: str = "") -> str:
    """Write a key with its value and, in a column of its own, a comment."""
    line = f"{key} = {_toml(value)}"
    return f"{line:<{COMMENT_COLUMN - 1}} # {comment}" if comment else line


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_toml(part)}' for key, part in value.items())} }}"
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, float | int):
        return repr(0.0 if value == 0.0 else float(value)).removesuffix(".0")
    return json.dumps(value, ensure_ascii=False)
