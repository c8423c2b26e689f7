"""A robot as data: Khalil rows, links with their mass properties, names and joint mechanics."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from types import NoneType
from typing import Literal

from drake_leg.arguments import require_kind, shown
from drake_leg.colours import (
    BLUE,
    GREEN,
    ORANGE,
    REDDISH_PURPLE,
    SKY_BLUE,
    VERMILLION,
    YELLOW,
    Colour,
    rgb,
)
from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.solids import Inertial, Solid
from drake_leg.robot.tree import (
    Loop,
    Pose,
    antecedents,
    path_to,
    require_base,
    require_loops,
    require_tree,
    with_one_foot,
)
from drake_leg.units import require_finite, require_three

JointType = Literal["revolute", "prismatic", "fixed"]

NO_MECHANICS = JointMechanics()

# In the order of a chain's rows.
LINK_COLOURS = tuple(map(rgb, (BLUE, ORANGE, GREEN, SKY_BLUE, YELLOW, VERMILLION, REDDISH_PURPLE)))

BASE = "base"  # the link that is welded to the world
BASE_WELD = "base_weld"
PLACES = ("base", "cog", "end")  # of the frames on every link


@dataclass(frozen=True, kw_only=True)
class Row:
    """One row of a Khalil (modified DH) table.

    The transform of the row is ``Rot_z(gamma) Trans_z(b) Rot_x(alpha) Trans_x(d) Rot_z(theta)
    Trans_z(r)``, in the frame of its antecedent. A revolute joint adds its position to ``theta``, a
    prismatic one to ``r``; a fixed row (printed as ~ in the reports) has no joint position. Only
    where a link carries several joints, ``gamma`` and ``b`` are needed.
    """

    joint: JointType
    d: float = 0.0  # [m], along x of the antecedent's frame, after gamma and b
    alpha: float = 0.0  # [rad], about the same axis
    r: float = 0.0  # [m], along z of this frame
    theta: float = 0.0  # [rad], about z of this frame
    gamma: float = 0.0  # [rad], about z of the antecedent's frame
    b: float = 0.0  # [m], along the same axis
    antecedent: int | None = None  # row, from 1; 0 is the base; None: the row before

    def __post_init__(self) -> None:
        if self.joint not in ("revolute", "prismatic", "fixed"):
            raise InvalidValueError(
                f"a row's joint is {self.joint!r}; it must be revolute, prismatic or fixed"
            )
        for name in ("d", "alpha", "r", "theta", "gamma", "b"):
            require_finite(f"a row's {name}", getattr(self, name))
        if self.antecedent is not None and type(self.antecedent) is not int:
            raise InvalidValueError(
                f"a row's antecedent is {shown(self.antecedent)}; it must be the number of a row, "
                "0 for the base, or None"
            )

    @property
    def sigma(self) -> int | None:
        """The reports' joint type: 0 revolute, 1 prismatic, None fixed (~)."""
        return {"revolute": 0, "prismatic": 1, "fixed": None}[self.joint]


@dataclass(frozen=True, kw_only=True)
class Link:
    """A rigid body whose frame is the DH frame of its row.

    Its mass follows from ``solid``, unless there is an ``inertial``: then the solid is only drawn.
    With neither, it is a body without mass, which is allowed between two joints.
    """

    name: str
    solid: Solid | None = None
    inertial: Inertial | None = None
    end: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m], p_LE: end of the link in its frame

    def __post_init__(self) -> None:
        require_kind("the solid of a link", self.solid, Solid, NoneType)
        require_kind("the inertial of a link", self.inertial, Inertial, NoneType)
        require_three("the end of a link", self.end)

    @property
    def has_mass(self) -> bool:
        """Whether mass properties are given or follow from a solid."""
        return self.solid is not None or self.inertial is not None

    @property
    def centre_of_mass(self) -> tuple[float, float, float]:
        """Center of mass in the link's frame, p_LC [m]; the origin where there is no mass."""
        body = self.inertial or self.solid
        return body.centre if body else (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Segment:
    """A row of the table with its joint and link, or with only a frame."""

    row: Row
    joint: str | None = None  # name of the joint; None for a frame alone
    link: Link | None = None
    mechanics: JointMechanics = NO_MECHANICS

    def __post_init__(self) -> None:
        require_kind("the row of a segment", self.row, Row)
        require_kind("the link of a segment", self.link, Link, NoneType)
        require_kind("the mechanics of a segment", self.mechanics, JointMechanics)
        if (self.joint is None) != (self.link is None):
            raise InvalidValueError(
                f"a row has joint {self.joint!r} and link {self.link!r}; it must have both or none"
            )
        if self.row.joint == "fixed" and self.mechanics != NO_MECHANICS:
            raise InvalidValueError(
                "a fixed row has joint mechanics or limits; only a row that moves may"
            )


def link_colour(row: int) -> Colour:
    """Color of a link that has none of its own, by its row in the table, from 1.

    Colors repeat after ``len(LINK_COLOURS)`` rows.
    """
    return LINK_COLOURS[(row - 1) % len(LINK_COLOURS)]


@dataclass(frozen=True, kw_only=True)
class Robot:
    """A robot: a tree of links on a base, from its Khalil table; its loops are cut.

    A robot whose table has no branches is serial, and its end effector, the foot, is the last frame
    of the table. ``at_tip`` chooses one foot of several.

    Parameters
    ----------
    name : str
        As in file names: letters, digits and underscores.
    title : str
        As in headings.
    source : str
        Where its numbers come from.
    segments : tuple of Segment
        One for each row of the Khalil table, an antecedent before what it carries, with its joint
        and its link.
    floating : bool
        Whether the base moves freely, as that of a walking robot; else it is welded to the world.
    base_link : Link, optional
        The body of the base; its frame is frame 0. A floating base needs one with mass.
    base_pose : (4, 4) array_like, optional
        Pose of frame 0 in the world [-, m], at the beginning if the base floats.
    loops : tuple of Loop
        Where the closed loops of links are cut.

    Raises
    ------
    InvalidValueError
        If a name is unusable or used twice, no row moves, a row that moves has no link and is no
        loop's cut, an antecedent does not come before its row, or the base's pose is not one.

    Examples
    --------
    >>> from drake_leg import Robot
    >>> from drake_leg.robot.robot import Link, Row, Segment
    >>> from drake_leg.robot.solids import Brick, Solid
    >>> bar = Solid(
    ...     shape=Brick(length=0.2, width=0.02, height=0.01),  # [m]
    ...     density=2700.0,  # [kg/m^3]
    ...     centre=(0.1, 0.0, 0.0),
    ...     colour=(0.0, 0.45, 0.7),
    ... )
    >>> arm = Robot(
    ...     name="arm",
    ...     title="One bar",
    ...     source="typed here",
    ...     segments=(
    ...         Segment(
    ...             row=Row(joint="revolute"),
    ...             joint="turn",
    ...             link=Link(name="bar", solid=bar, end=(0.2, 0.0, 0.0)),
    ...         ),
    ...         Segment(row=Row(joint="fixed", d=0.2)),  # the foot: a frame only
    ...     ),
    ... )
    >>> len(arm.moving), len(arm.rows)
    (1, 2)
    """

    name: str  # as in file names: leg_b
    title: str  # as in headings: Hexabot leg B
    source: str  # report and table
    segments: tuple[Segment, ...]
    floating: bool = False
    base_link: Link | None = None
    base_pose: Pose | None = None  # X_W0 [-, m]
    loops: tuple[Loop, ...] = ()

    def __post_init__(self) -> None:
        require_name("the robot's name", self.name)
        require_line("the robot's title", self.title)
        require_line("the robot's source", self.source)
        require_kind("the segments of a robot", self.segments, tuple, list)
        object.__setattr__(self, "segments", tuple(self.segments))
        require_kind("the loops of a robot", self.loops, tuple, list)
        object.__setattr__(self, "loops", tuple(self.loops))
        for index, segment in enumerate(self.segments, start=1):
            require_kind(f"segment {index} of a robot", segment, Segment)
        for loop in self.loops:
            require_kind("a loop of a robot", loop, Loop)
            require_name("the cut joint of a loop", loop.joint)
        for index, segment in enumerate(self.segments, start=1):
            if segment.link is not None and segment.joint is not None:
                require_name(f"the link of row {index}", segment.link.name)
                require_name(f"the joint of row {index}", segment.joint)
        require_tree(self)
        require_base(self)
        require_loops(self)
        require_unique(self._names())
        if not self.moving:
            raise InvalidValueError(
                f"the robot {self.name!r} has no row that moves; at least one must be revolute "
                "or prismatic"
            )

    def _names(self) -> Iterator[tuple[str, str]]:
        """List the names of all links, joints and frames of the model, with descriptions."""
        yield self.base_name, "the base"
        yield BASE_WELD, "the base's weld"
        yield frame_name(0), "the base's frame"
        for index, segment in enumerate(self.segments, start=1):
            if segment.link is not None and segment.joint is not None:
                yield segment.link.name, f"the link of row {index}"
                yield segment.joint, f"the joint of row {index}"
            yield frame_name(index), f"the frame of row {index}"
        for index, segment in enumerate(self.segments, start=1):
            if segment.link is not None:
                for place in PLACES:
                    yield (
                        place_name(segment.link.name, place),
                        f"a frame on the link of row {index}",
                    )
        for loop in self.loops:
            yield loop.joint, f"the joint at which the loop of row {loop.cut} is cut"

    @property
    def base_name(self) -> str:
        """Name of the link that carries frame 0."""
        return BASE if self.base_link is None else self.base_link.name

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """The Khalil table; a row at which a loop is cut is fixed where its joint is at 0."""
        return tuple(
            replace(s.row, joint="fixed") if s.link is None and s.row.joint != "fixed" else s.row
            for s in self.segments
        )

    @property
    def moving(self) -> tuple[Segment, ...]:
        """The segments with a joint position, in the table's order; not those that are cut."""
        return tuple(s for s in self.segments if s.row.joint != "fixed" and s.link is not None)

    @property
    def is_actuated(self) -> bool:
        """Whether every joint has an actuator."""
        return all(segment.mechanics.actuated for segment in self.moving)

    @property
    def antecedents(self) -> tuple[int, ...]:
        """The antecedent of every row, counted from 1; 0 is the base."""
        return antecedents(self.rows)

    @property
    def is_serial(self) -> bool:
        """Whether every row's antecedent is the row before."""
        return self.antecedents == tuple(range(len(self.segments)))

    @property
    def is_plain(self) -> bool:
        """Whether the table is a chain on a base at rest in the world, without gamma and b."""
        branched = any(row.gamma or row.b for row in self.rows)
        placed = self.floating or self.base_pose is not None
        return self.is_serial and not (branched or placed or self.loops)

    @property
    def tips(self) -> dict[str, int]:
        """Rows, from 1, that carry no other row, by the names of their links or frames.

        The two frames of a loop are not tips.
        """
        carrying = {*self.antecedents, *(row for one in self.loops for row in (one.cut, one.end))}
        leaves = [index for index in range(1, len(self.segments) + 1) if index not in carrying]
        return {self._frame_owner(index): index for index in leaves}

    @property
    def leaves(self) -> dict[str, int]:
        """The tips, and the two frames of each loop: every row that carries no other row."""
        frames = sorted(row for one in self.loops for row in (one.cut, one.end))
        return {**self.tips, **{frame_name(row): row for row in frames}}

    def _frame_owner(self, index: int) -> str:
        link = self.segments[index - 1].link
        return frame_name(index) if link is None else link.name

    def path(self, row: int) -> tuple[int, ...]:
        """Rows, from 1, that one passes from the base to a row, that row last."""
        if type(row) is not int or not 0 <= row <= len(self.segments):
            raise InvalidValueError(
                f"{self.name!r} has no row {shown(row)}; its rows are 1 to {len(self.segments)}"
            )
        return path_to(self.antecedents, row)

    def at_tip(self, tip: str | None = None, q: Sequence[float] | None = None) -> Robot:
        """Return the robot with one foot: the joints that do not move it are fixed.

        The rows keep their order, but the tip's comes last, and a floating base is held.

        Parameters
        ----------
        tip : str, optional
            One of ``tips``; needed where there are several.
        q : (n,) sequence of float, optional
            Joint positions of all joints [rad or m], in which the others are fixed. By default
            their targets, or else as near to 0 as their limits allow.

        Raises
        ------
        InvalidValueError
            If there is no such tip, or there are several and none is chosen; or if the robot has
            closed loops, whose joints cannot be fixed one by one.
        """
        return self if tip is None and self.has_one_foot else with_one_foot(self, tip, q)

    @property
    def has_one_foot(self) -> bool:
        """Whether the last frame of the table is the only one that the joints lead to."""
        return not self.floating and not self.loops and self._one_foot

    @cached_property
    def _one_foot(self) -> bool:
        on_path = set(self.path(len(self.segments)))
        return all(
            index in on_path
            for index, segment in enumerate(self.segments, start=1)
            if segment.row.joint != "fixed"
        )

    def __repr__(self) -> str:
        tree = "" if self.is_serial else f", {len(self.tips)} tips"
        loops = f", {len(self.loops)} closed loop{'s' * (len(self.loops) > 1)}" * bool(self.loops)
        floats = ", floating" * self.floating
        return f"<Robot {self.name}: {self.title}, {len(self.segments)} rows{tree}{loops}{floats}>"

    def _repr_html_(self) -> str:
        tree = not self.is_serial
        headings = ["row", "σ", "d [m]", "α [rad]", "r [m]", "θ [rad]", "joint", "link"]
        if tree:
            headings[1:2] = ["antecedent", "σ", "γ [rad]", "b [m]"]
        rows = []
        variables = (f"q{number}" for number in itertools.count(1))
        for index, segment in enumerate(self.segments, start=1):
            row = segment.row
            r, theta = f"{row.r:g}", angle_text(row.theta)
            if row.joint == "revolute":
                theta = _sum(next(variables), row.theta, theta)
            elif row.joint == "prismatic":
                r = _sum(next(variables), row.r, r)
            sigma = "~" if row.sigma is None else row.sigma
            link = segment.link.name if segment.link else ""
            cells = [index, sigma, f"{row.d:g}", angle_text(row.alpha), r, theta]
            if tree:
                antecedent = self.antecedents[index - 1]
                cells[1:2] = [antecedent, sigma, angle_text(row.gamma), f"{row.b:g}"]
            rows.append((*cells, segment.joint or "", link))
        return html_table(headings, rows, title=f"{self.title} ({self.source})")


def angle_text(angle: float) -> str:
    """Write an angle [rad], as a multiple of π where it is one."""
    named = {0.0: "0", math.pi / 2: "π/2", -math.pi / 2: "−π/2", math.pi: "π"}
    return named.get(angle, f"{angle:.4g}")


def _sum(variable: str, offset: float, text: str) -> str:
    """Write a joint variable plus the table's constant offset, unless that is 0."""
    return f"{variable} + {text}" if offset else variable


def frame_name(index: int) -> str:
    """Name the frame of a row, counted from 1; 0 is the base."""
    return f"frame_{index}"


def place_name(link: str, place: str) -> str:
    """Name a frame on a link: its base, its center of gravity or its end."""
    return f"{link}_{place}"


def require_name(what: str, name: str) -> None:
    """Refuse a name that SDF reserves or that other programs cannot read.

    Allowed are letters, digits, _ and -, beginning with a letter or _.
    """
    require_kind(what, name, str)
    if not name:
        raise InvalidValueError(f"{what} is empty; it must be a name")
    if "::" in name:
        raise InvalidValueError(
            f"{what} is {name!r}; SDF keeps '::' for models inside of models: leave it out"
        )
    if name == "world" or re.fullmatch(r"__.*__", name):
        raise InvalidValueError(f"{what} is {name!r}, which SDF reserves; choose another name")
    if not re.fullmatch(r"[^\W\d][\w-]*", name):
        raise InvalidValueError(
            f"{what} is {name!r}; it must have letters, digits, _ and - only, and begin with a "
            "letter"
        )


def require_line(what: str, text: str) -> None:
    """Refuse text that is not printable on one line."""
    require_kind(what, text, str)
    if not text.isprintable():
        raise InvalidValueError(f"{what} is {text!r}; it must be printable text on one line")


def require_unique(names: Iterable[tuple[str, str]]) -> None:
    """Refuse a name that is used twice, given pairs of a name and a description of its owner."""
    owners: dict[str, str] = {}
    for name, what in names:
        if name in owners:
            raise InvalidValueError(
                f"the name {name!r} is given twice, to {owners[name]} and to {what}; every link, "
                "joint and frame must have its own"
            )
        owners[name] = what


def html_table(headings: Sequence[str], rows: Iterable[Sequence[object]], *, title: str) -> str:
    """HTML of a table with a title above it, for notebooks; all texts are escaped."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f"<p><b>{escape(title)}</b></p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def require_robot(robot: object) -> None:
    """Refuse what is not a Robot, such as the name of one."""
    if not isinstance(robot, Robot):
        raise InvalidValueError(
            f"{shown(robot)} is not a Robot",
            advice="take one from drake_leg, such as LEG_B, or load one with load_robot",
        )
