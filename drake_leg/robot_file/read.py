"""From a TOML file to a robot."""

from __future__ import annotations

from pathlib import Path

from drake_leg.files import read_text
from drake_leg.robot import JointType, Link, Robot, Row, Segment
from drake_leg.robot_file.bodies import ORIGIN, read_inertial, read_solid
from drake_leg.robot_file.classic import ClassicRow, khalil_rows
from drake_leg.robot_file.document import parse_document
from drake_leg.robot_file.joints import read_mechanics
from drake_leg.robot_file.keys import Keys
from drake_leg.units import AngleUnit, in_radians, joint_units

ROBOT_KEYS = ("name", "title", "source", "convention", "angles", "row")
TABLE_KEYS = {
    "khalil": ("sigma", "d", "alpha", "r", "theta"),
    "classic": ("sigma", "theta", "d", "a", "alpha"),
}
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
    "base": 'what raises or turns the base is a first [[row]] with sigma = "~"',
}
_NO_PARENTS = "a robot is one chain, and every row's parent is the row before it"
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
    "friction": "what grows with speed is damping, under [row.mechanics]; there is no other",
    **dict.fromkeys(
        ("stiffness", "spring_stiffness"), "write spring_stiffness, under [row.mechanics]"
    ),
    "axis": "every joint turns about or slides along its z; alpha turns that axis",
    "parent": _NO_PARENTS,
    "child": _NO_PARENTS,
    "children": _NO_PARENTS,
    "a": 'it belongs to the classic convention: say convention = "classic", or give d and r',
    "mass": "a mass goes with centre and moments under [row.inertial]",
    "density": "a density goes under [row.solid]",
    "damping": "damping goes under [row.mechanics]",
    "r": 'it belongs to Khalil\'s convention: leave out convention = "classic", or give d and a',
}


def load_robot(path: Path | str) -> Robot:
    """Read a robot from a TOML file.

    Parameters
    ----------
    path : Path or str
        ``drake-leg sdf leg-b --toml`` prints one to start from.

    Returns
    -------
    Robot
        In Khalil's convention, whatever the file has.

    Raises
    ------
    InvalidValueError
        With file, key and value, if something makes no sense.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from drake_leg import LEG_B, load_robot
    >>> from drake_leg.robot_file.write import robot_toml
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "leg_b.toml"
    ...     _ = path.write_text(robot_toml(LEG_B))
    ...     load_robot(path) == LEG_B
    True
    """
    return read_robot(read_text(Path(path)), str(path))


def read_robot(text: str, where: str) -> Robot:
    """Read a robot from TOML, as ``load_robot`` does; errors begin with the file's name."""
    keys = Keys(parse_document(text, where), where, ROBOT_KEYS, _INSTEAD_OF_ROBOT)
    name = keys.text("name")
    convention = keys.choice("convention", tuple(TABLE_KEYS), "khalil")
    angles: AngleUnit = keys.choice("angles", ("deg", "rad"))
    tables = keys.value("row", remedy="every row of the table goes under [[row]]")
    if not isinstance(tables, list) or not tables:
        raise keys.error(
            "row is not a list of tables; every row goes under [[row]], with two brackets"
        )
    rows = [
        Keys(table, f"{where}: row {index}", (*TABLE_KEYS[convention], *BODY_KEYS), _INSTEAD_OF_ROW)
        for index, table in enumerate(tables, start=1)
    ]
    title, source = keys.text("title", name), keys.text("source", Path(where).name)
    segments = _segments(rows, convention, angles)
    return keys.make(Robot, name=name, title=title, source=source, segments=segments)


def _segments(rows: list[Keys], convention: str, angles: AngleUnit) -> tuple[Segment, ...]:
    tools: list[Row] = []
    if convention == "classic":
        *table, tool = khalil_rows([_classic_row(keys, angles) for keys in rows])
        tools.append(tool)
    else:
        table = [_khalil_row(keys, angles) for keys in rows]
    numbered = enumerate(zip(rows, table, strict=True), start=1)
    carried = [_segment(keys, row, index, angles) for index, (keys, row) in numbered]
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
        mechanics=read_mechanics(
            keys.value("mechanics", {}),
            keys.value("limits", {}),
            keys.where,
            joint_units(row.joint, angles),
        ),
    )


def _link(keys: Keys, name: str, index: int) -> Link:
    inertial = solid = None
    if keys.has("inertial"):
        inertial = read_inertial(keys.value("inertial"), f"{keys.where}, inertial")
    if keys.has("solid"):
        solid = read_solid(keys.value("solid"), f"{keys.where}, solid", inertial, index)
    return Link(name=name, solid=solid, inertial=inertial, end=keys.three("end", "m", ORIGIN))
