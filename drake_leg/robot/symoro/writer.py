"""Writes a robot as a ``.par`` file of SYMORO, in numbers, which are read back exactly.

A link's inertia is about the origin of its frame there. Names, shapes, springs, limits and state
targets have no place in such a file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import BASE, Link, Robot, Segment, require_robot
from drake_leg.robot.solids import Inertial, mass_properties
from drake_leg.robot.symoro.arithmetic import evaluate, parse_arithmetic
from drake_leg.robot.symoro.as_robot import (
    AT_ROBOTS_JOINT,
    JOINTS,
    central_inertial,
    robot_name,
)
from drake_leg.robot.symoro.positions import position_key
from drake_leg.robot.symoro.reader import FIXED, in_parts_of_pi
from drake_leg.robot.symoro.text import (
    FORCE,
    GEOMETRY,
    INERTIAL,
    MOMENT,
    OF_BASE,
    OF_JOINTS,
    POSE,
)
from drake_leg.robot.toml.reader import ORIGIN
from drake_leg.units import STANDARD_GRAVITY

_LONGEST = 300  # digits of an exact decimal
_IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def robot_par(robot: Robot) -> str:
    """Write a robot as a ``.par`` file.

    Rows at which loops are cut, and the frames on their other sides, come last, as in SYMORO.

    Raises
    ------
    InvalidValueError
        If its mass properties are too far apart to be written as decimals.
    """
    require_robot(robot)
    rows = _Rows(robot)
    links = range(0 if robot.floating else 1, rows.links + 1)
    lines = [
        f"(* Robotname = '{_title(robot)}' *)",
        f"NL = {rows.links}",
        f"NJ = {rows.joints}",
        f"NF = {len(rows.order)}",
        f"Type = {2 if robot.loops else 0 if robot.is_serial else 1}",
        f"is_floating = {robot.floating}",
        "is_mobile = False",
        "",
        "(* Geometric parameters: lengths in m, angles in rad *)",
        _list("ant", rows.antecedents()),
        _list("sigma", rows.sigmas()),
        _list("mu", rows.actuated()),
        *(_list(key, rows.column(key)) for key in GEOMETRY),
        "",
        "(* Dynamic parameters: inertias about the origins of the links' frames *)",
        *_bodies([rows.body(link) for link in links]),
        *(_list(key, [rows.at_joint(link, key) for link in links]) for key in ("IA", "FV", "FS")),
        *(_list(key, ["0" for _ in links]) for key in (*FORCE, *MOMENT)),
        "",
        "(* Joint parameters *)",
        *_joint_lines(rows.joints),
        "",
        "(* Velocity and acceleration of the base, gravity, both in frame 0 *)",
        *(_list(key, ["0"] * 3) for key in OF_BASE if key != "G"),
        _list("G", _gravity(robot)),
        "",
        "(* Pose of frame 0 in the world, whose z is up *)",
        _list(POSE, [_decimal(part) for row in robot.base_pose or _IDENTITY for part in row]),
        "",
        "(* End of definition *)",
    ]
    return "\n".join(lines) + "\n"


def not_in_par(robot: Robot) -> tuple[str, ...]:
    """List what a robot has and its ``.par`` file has not: ``springs``, ``limits``."""
    plain = JointMechanics()
    segments = [segment for segment in robot.segments if segment.link is not None]
    links = [segment.link for segment in segments if segment.link is not None]
    links += [] if robot.base_link is None else [robot.base_link]
    mechanics = [segment.mechanics for segment in robot.segments]
    default = {f"link_{number}" for number in range(1, len(robot.segments) + 1)} | {BASE}
    found = {
        "names of links and joints": any(link.name not in default for link in links),
        "shapes of links": any(link.solid is not None for link in links),
        "ends of links": any(link.end != ORIGIN for link in links),
        "the body of a base that does not float": robot.base_link is not None
        and not robot.floating,
        "springs": any(one.spring_stiffness for one in mechanics),
        "limits": any(
            (one.bounds, one.velocity, one.effort) != (plain.bounds, None, None)
            for one in mechanics
        ),
        "state targets": any(
            one.position_target != plain.position_target
            or one.velocity_target != plain.velocity_target
            for one in mechanics
        ),
    }
    return tuple(what for what, has in found.items() if has)


class _Rows:
    """The rows of a robot in SYMORO's order: links, cut joints, the other frames of the cuts."""

    def __init__(self, robot: Robot) -> None:
        cuts, ends = ([getattr(loop, side) for loop in robot.loops] for side in ("cut", "end"))
        others = [*cuts, *ends]
        own = [row for row in range(1, len(robot.segments) + 1) if row not in others]
        self._robot = robot
        self.order = [*own, *others]
        self.links, self.joints = len(own), len(own) + len(cuts)
        self._place = {0: 0, **{row: number for number, row in enumerate(self.order, start=1)}}

    def segments(self) -> Iterator[Segment]:
        """Yield the segments in that order."""
        for row in self.order:
            yield self._robot.segments[row - 1]

    def antecedents(self) -> list[str]:
        """Numbers of the antecedents."""
        return [str(self._place[self._robot.antecedents[row - 1]]) for row in self.order]

    def sigmas(self) -> list[str]:
        """Types of the joints."""
        return [str(JOINTS.index(segment.row.joint)) for segment in self.segments()]

    def actuated(self) -> list[str]:
        """Write 1 for actuated joints."""
        return [
            str(int(s.link is not None and s.row.joint != "fixed" and s.mechanics.actuated))
            for s in self.segments()
        ]

    def column(self, key: str) -> list[str]:
        """Write a geometric parameter, with the joint's position where it is added."""
        found = []
        for number, segment in enumerate(self.segments(), start=1):
            text = _number(getattr(segment.row, key), is_angle=key not in ("b", "d", "r"))
            sigma = JOINTS.index(segment.row.joint)
            if sigma != FIXED and position_key(sigma) == key:
                text = _added(f"{'th' if key == 'theta' else 'r'}{number}", text)
            found.append(text)
        return found

    def body(self, link: int) -> tuple[str, Inertial | None]:
        """Mass properties of a link, and how an error calls it."""
        if link == 0:
            return "the base", _inertial(self._robot.base_link)
        return f"link {link}", _inertial(self._robot.segments[self.order[link - 1] - 1].link)

    def at_joint(self, link: int, key: str) -> str:
        """Rotor's inertia or friction of a link's joint."""
        if link == 0:
            return "0"
        mechanics = self._robot.segments[self.order[link - 1] - 1].mechanics
        return _decimal(getattr(mechanics, AT_ROBOTS_JOINT[key]))


def _inertial(link: Link | None) -> Inertial | None:
    if link is None or link.inertial is not None or link.solid is None:
        return None if link is None else link.inertial
    body = mass_properties(link.solid)
    return Inertial(mass=body.mass, centre=link.solid.centre, moments=body.moments)


def _title(robot: Robot) -> str:
    """Choose what is read back as the robot's name: its title, or else the name."""
    title = " ".join(robot.title.split())
    return title if robot_name(title) == robot.name and title.isascii() else robot.name


def _list(key: str, values: Iterable[object]) -> str:
    return f"{key} = {{{','.join(map(str, values))}}}"


def _joint_lines(joints: int) -> Iterator[str]:
    for key in OF_JOINTS:
        values = ["0" if key in ("eta", "k") else f"{key}{joint + 1}" for joint in range(joints)]
        yield _list(key, values)


def _gravity(robot: Robot) -> list[str]:
    """Gravity in frame 0: that of the world is along -z."""
    third = (robot.base_pose or _IDENTITY)[2]
    return [_decimal(-STANDARD_GRAVITY * part) for part in third[:3]]


# --- numbers ---------------------------------------------------------------------------------


def _decimal(value: float) -> str:
    return repr(0.0 if value == 0.0 else float(value)).removesuffix(".0")


def _number(value: float, *, is_angle: bool) -> str:
    """Write a number so that it is read back exactly, as a part of pi where it is one."""
    if not is_angle or value == 0.0:
        return _decimal(value)
    as_fraction = "/".join(map(str, Fraction(repr(value)).as_integer_ratio()))
    spellings = (*_parts_of_pi(value), _decimal(value), as_fraction)
    return next(text for text in spellings if _read_back(text) == value)


def _read_back(text: str) -> float:
    return float(evaluate(in_parts_of_pi(parse_arithmetic(text))))


def _parts_of_pi(value: float) -> Iterator[str]:
    part = Fraction(value / math.pi).limit_denominator(360)
    if part:
        above = "Pi" if abs(part.numerator) == 1 else f"{abs(part.numerator)}*Pi"
        below = "" if part.denominator == 1 else f"/{part.denominator}"
        yield f"{'-' * (part < 0)}{above}{below}"


def _added(position: str, text: str) -> str:
    if text == "0":
        return position
    return f"{position} - {text[1:]}" if text.startswith("-") else f"{position} + {text}"


def _bodies(bodies: Sequence[tuple[str, Inertial | None]]) -> Iterator[str]:
    """Write the lines of the inertial parameters of all links."""
    columns = [_parameters(what, body) for what, body in bodies]
    for index, key in enumerate(INERTIAL):
        yield _list(key, [column[index] for column in columns])


def _parameters(what: str, body: Inertial | None) -> list[str]:
    """Write Khalil's ten parameters with as few digits as give the same body."""
    if body is None:
        return ["0"] * len(INERTIAL)
    exact = _about_origin(body)
    for digits in (6, 9, 12, 15, 16, 17):
        rounded = [_rounded(number, digits) for number in exact]
        try:
            same = central_inertial(dict(zip(INERTIAL, map(Fraction, rounded), strict=True)))
        except InvalidValueError:
            continue
        if same == body:
            return rounded
    texts = [_rounded(number, _LONGEST) for number in exact]
    if list(map(Fraction, texts)) != exact:
        raise InvalidValueError(
            f"the mass properties of {what} are too far apart to be written about its frame's "
            "origin: choose a frame nearer to the center of mass"
        )
    return texts


def _about_origin(body: Inertial) -> list[Fraction]:
    """Khalil's parameters, exactly: ``J = I + m (c.c 1 - c c')``."""
    mass = Fraction(repr(body.mass))
    x, y, z = (Fraction(repr(float(part))) for part in body.centre)
    xx, yy, zz = (Fraction(repr(float(part))) for part in body.moments)
    xy, xz, yz = (Fraction(repr(float(part))) for part in body.products)
    return [
        xx + mass * (y * y + z * z),
        xy - mass * x * y,
        xz - mass * x * z,
        yy + mass * (x * x + z * z),
        yz - mass * y * z,
        zz + mass * (x * x + y * y),
        mass * x,
        mass * y,
        mass * z,
        mass,
    ]


def _rounded(number: Fraction, digits: int) -> str:
    with localcontext(prec=digits):
        decimal = (Decimal(number.numerator) / Decimal(number.denominator)).normalize()
    text = f"{decimal:f}"
    return text if len(text) <= 24 else str(decimal)
