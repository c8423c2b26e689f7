"""A table's branches, closed loops and base; and the same robot with one foot."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from drake_leg.arguments import counted, is_number, require_kind, shown
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.robot.joint_mechanics import JointMechanics, starting_posture

if TYPE_CHECKING:
    from drake_leg.robot.robot import Robot, Row, Segment

Pose = tuple[tuple[float, float, float, float], ...]  # rows of a (4, 4) matrix [-, m]

ORTHONORMAL = 1e-9  # how far the axes of a given pose may be from orthonormal


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A closed loop of links, cut at one of its joints.

    Both sides of the cut have a frame: that of the cut joint's row, on one side, and that of a
    fixed row, on the other. The loop is closed where both have one origin and one z axis (cut at a
    revolute joint), or one z axis and one orientation (at a prismatic one).
    """

    joint: str  # name of the cut joint
    cut: int  # the cut joint's row, from 1: it moves and has no link
    end: int  # row of the frame on the other side: fixed, without a link

    def __post_init__(self) -> None:
        require_kind("the cut joint of a loop", self.joint, str)
        require_kind("the cut of a loop", self.cut, int)
        require_kind("the end of a loop", self.end, int)


def antecedents(rows: Sequence[Row]) -> tuple[int, ...]:
    """Find the antecedent of every row, counted from 1; 0 is the base."""
    return tuple(
        before if row.antecedent is None else row.antecedent for before, row in enumerate(rows)
    )


def path_to(before: Sequence[int], row: int) -> tuple[int, ...]:
    """List the rows, from 1, from the base to a row, given the antecedent of each."""
    path = []
    while row:
        path.append(row)
        row = before[row - 1]
    return tuple(reversed(path))


def require_tree(robot: Robot) -> None:
    """Refuse an antecedent that is not an earlier row."""
    for index, segment in enumerate(robot.segments, start=1):
        before = segment.row.antecedent
        if before is not None and not 0 <= before < index:
            raise InvalidValueError(
                f"row {index} of {robot.name!r} has the antecedent {before}; it must be an earlier "
                "row, or 0 for the base"
            )


def require_base(robot: Robot) -> None:
    """Refuse a base that floats without mass; make its pose a tuple, and refuse what is none."""
    require_kind("`floating`", robot.floating, bool)
    body = robot.base_link
    if robot.floating and (body is None or not body.has_mass):
        raise InvalidValueError(
            f"the base of {robot.name!r} floats and has no mass",
            advice="give it a `base_link` with a solid or with mass properties",
        )
    if robot.base_pose is not None:
        object.__setattr__(robot, "base_pose", _pose(robot.base_pose))


def _pose(given: object) -> Pose:
    try:
        rows = tuple(tuple(map(float, row)) for row in given)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        rows = ()
    if [len(row) for row in rows] != [4] * 4 or not all(math.isfinite(x) for r in rows for x in r):
        raise InvalidValueError(
            f"the base's pose is {shown(given)}; it must be a matrix of 4 x 4 finite numbers"
        )
    x, y, z = (tuple(row[column] for row in rows[:3]) for column in range(3))
    lengths = (math.dist(axis, (0.0, 0.0, 0.0)) for axis in (x, y, z))
    if (
        any(abs(length - 1.0) > ORTHONORMAL for length in lengths)
        or math.dist(_cross(x, y), z) > ORTHONORMAL
        or rows[3] != (0.0, 0.0, 0.0, 1.0)
    ):
        raise InvalidValueError(
            "the base's pose is not one: its first three columns must be right-handed orthonormal "
            "axes, and its last row 0, 0, 0, 1"
        )
    first, second, third, last = rows
    return (first, second, third, last)  # type: ignore[return-value]


def _cross(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def require_loops(robot: Robot) -> None:
    """Refuse a loop whose rows are not a cut, and a moving row that is neither link nor cut."""
    used: set[int] = set()
    for loop in robot.loops:
        _require_frame(robot, loop, loop.cut, used, moves=True)
        _require_frame(robot, loop, loop.end, used, moves=False)
        carrier = _carrier(robot, loop.cut)
        if carrier == _carrier(robot, loop.end):
            raise InvalidValueError(
                f"the two frames of the loop {loop.joint!r}, rows {loop.cut} and {loop.end}, have "
                f"one antecedent, {carrier}; they must be on two links"
            )
    for index, segment in enumerate(robot.segments, start=1):
        if segment.row.joint != "fixed" and segment.link is None and index not in used:
            raise InvalidValueError(
                f"row {index} of {robot.name!r} is {segment.row.joint} and has no link; only a "
                "fixed row, or one at which a loop is cut, may have none"
            )


def _carrier(robot: Robot, row: int) -> int:
    """Row of the link that carries a row's frame; 0 is the base."""
    row = robot.antecedents[row - 1]
    while row and robot.segments[row - 1].link is None:
        row = robot.antecedents[row - 1]
    return row


def _require_frame(robot: Robot, loop: Loop, row: int, used: set[int], *, moves: bool) -> None:
    what = "cut" if moves else "end"
    if not 1 <= row <= len(robot.segments) or row in used:
        raise InvalidValueError(
            f"the loop {loop.joint!r} has row {row} as its {what}; it must be a row of the table, "
            f"1 to {len(robot.segments)}, and of one loop only"
        )
    segment = robot.segments[row - 1]
    if (segment.row.joint != "fixed") != moves or segment.link is not None:
        raise InvalidValueError(
            f"the loop {loop.joint!r} has row {row} as its {what}; it must be a row that "
            f"{'moves' if moves else 'is fixed'}, without a link"
        )
    if moves and row in robot.antecedents:
        raise InvalidValueError(
            f"the loop {loop.joint!r} has row {row} as its {what}, which carries another row; a "
            "loop is cut between links that the table has"
        )
    used.add(row)


def require_one_foot(robot: Robot) -> None:
    """Refuse a robot with several feet, a floating base or closed loops: its foot is not clear."""
    if robot.has_one_foot:
        return
    if robot.loops:
        raise InvalidValueError(f"{robot.name!r} has closed loops; this needs an open chain")
    names = list(robot.tips)
    has = f"{len(names)} tips: {', '.join(names)}" if len(names) > 1 else "a floating base"
    raise InvalidValueError(
        f"{robot.name!r} has {has}", advice=f"take one foot, `robot.at_tip({names[0]!r})`"
    )


def with_one_foot(robot: Robot, tip: str | None, q: Sequence[float] | None) -> Robot:
    """Fix the joints that do not move one tip, and put its row last; see ``Robot.at_tip``."""
    if robot.loops:
        raise InvalidValueError(
            f"{robot.name!r} has closed loops; its joints cannot be fixed one by one, as it takes "
            "to move one foot"
        )
    foot = _tip_row(robot, tip)
    path = set(robot.path(foot))
    order = [row for row in range(1, len(robot.segments) + 1) if row != foot] + [foot]
    place = {0: 0, **{row: number for number, row in enumerate(order, start=1)}}
    positions = _positions(robot, q)
    segments = []
    for row in order:
        segment = robot.segments[row - 1]
        if row not in path:
            segment = _held(segment, positions.get(row, 0.0))
        before = place[robot.antecedents[row - 1]]
        given = None if before == place[row] - 1 else before
        segments.append(replace(segment, row=replace(segment.row, antecedent=given)))
    return replace(robot, segments=tuple(segments), floating=False)


def _tip_row(robot: Robot, tip: str | None) -> int:
    names = ", ".join(robot.tips)
    if tip is None and len(robot.tips) == 1:
        return next(iter(robot.tips.values()))
    if tip is None:
        raise InvalidValueError(
            f"{robot.name!r} has {len(robot.tips)} tips: {names}", advice="choose one by `tip`"
        )
    if not isinstance(tip, str) or tip not in robot.tips:
        raise InvalidValueError(
            f"{robot.name!r} has no tip {shown(tip)}",
            advice=did_you_mean(tip, robot.tips, f"its tips are {names}"),
        )
    return robot.tips[tip]


def _positions(robot: Robot, q: Sequence[float] | None) -> dict[int, float]:
    """Joint positions by their rows, from 1 [rad or m]."""
    given = starting_posture(robot) if q is None else q
    posture = tuple(given) if isinstance(given, Iterable) else ()
    if not isinstance(given, Iterable) or not all(map(is_number, posture)):
        raise InvalidValueError(f"q is {shown(q)}; it must be joint positions")
    moving = [row for row, one in enumerate(robot.rows, start=1) if one.joint != "fixed"]
    if len(posture) != len(moving):
        raise InvalidValueError(
            f"q has {counted(len(posture), 'number')}; {robot.name} has "
            f"{counted(len(moving), 'joint position')}"
        )
    if not all(map(math.isfinite, posture)):
        raise InvalidValueError(f"q is {shown(posture)}; it must be finite numbers")
    return dict(zip(moving, posture, strict=True))


def _held(segment: Segment, position: float) -> Segment:
    """Fix a joint at a position [rad or m]; its link stays."""
    row = segment.row
    if row.joint == "revolute":
        row = replace(row, joint="fixed", theta=row.theta + position)
    elif row.joint == "prismatic":
        row = replace(row, joint="fixed", r=row.r + position)
    return replace(segment, row=row, mechanics=JointMechanics())
