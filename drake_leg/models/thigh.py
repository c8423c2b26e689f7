"""The thigh subsystem: one link as a model of its own, with the frames by which it is connected.

Report B's figure 5 shows it: a connection frame at the link's base, one at its centre of gravity
and one at its end, a Rigid Transform from each to the next, and the solid with its reference frame
at the centre of gravity: four frames for each solid. Three of them, and a joint between every
``end`` and the next ``base``, make the leg::

    base frame -- hip -- [coxa] -- knee -- [femur] -- ankle -- [tibia] -- foot
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from drake_leg.errors import InvalidValueError
from drake_leg.robot import Brick, Robot, Row, Segment, Solid

FRAMES = ("base", "cog", "end", "solid")  # of every thigh: three to connect, one of the solid
ENDS_TOGETHER = 1e-12  # [m], how far a link's end may be from the next row's beginning

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class RigidTransform:
    """The fixed place of one frame of a thigh against another: offset, then both turns."""

    base: str
    follower: str
    offset: Vector  # [m], in the base's axes
    turn_x: float = 0.0  # [rad], about x
    turn_z: float = 0.0  # [rad], then about z


@dataclass(frozen=True, kw_only=True)
class ThighSubsystem:
    """A link with its four frames, as drawn in report B's figure 5."""

    name: str  # of the link: coxa, femur, tibia
    solid: Solid  # a brick
    transforms: tuple[RigidTransform, ...]  # base to cog, cog to end, cog to solid

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the four frames."""
        return FRAMES


def thighs(robot: Robot) -> tuple[ThighSubsystem, ...]:
    """Take a robot's moving links as thigh subsystems, from base to tip.

    Raises
    ------
    InvalidValueError
        If a link is not a brick, or does not end where the next row begins.
    """
    nexts = [*(segment.row for segment in robot.segments[1:]), None]
    return tuple(
        _thigh(robot, segment, following)
        for segment, following in zip(robot.segments, nexts, strict=True)
        if segment.row.joint != "fixed"
    )


def _thigh(robot: Robot, segment: Segment, following: Row | None) -> ThighSubsystem:
    link = segment.link
    if link is None or link.solid is None or not isinstance(link.solid.shape, Brick):
        name = link.name if link else segment.joint
        raise InvalidValueError(
            f"the link {name!r} of {robot.name!r} is not a brick; only a leg of bricks is made "
            "of thighs"
        )
    row = following or Row(joint="fixed", d=link.end[0])
    cos, sin = math.cos(row.alpha), math.sin(row.alpha)
    start = (row.d, -row.r * sin, row.r * cos)
    if math.dist(start, link.end) > ENDS_TOGETHER:
        raise InvalidValueError(
            f"the link {link.name!r} of {robot.name!r} ends at {link.end} m and the next row "
            f"begins at {start} m in its frame; a thigh must end where the next one begins"
        )
    cog, centre = link.centre_of_mass, link.solid.centre
    return ThighSubsystem(
        name=link.name,
        solid=link.solid,
        transforms=(
            RigidTransform(base="base", follower="cog", offset=cog),
            RigidTransform(
                base="cog",
                follower="end",
                offset=_between(cog, link.end),
                turn_x=row.alpha,
                turn_z=row.theta,
            ),
            RigidTransform(base="cog", follower="solid", offset=_between(cog, centre)),
        ),
    )


def _between(start: Vector, end: Vector) -> Vector:
    return (end[0] - start[0], end[1] - start[1], end[2] - start[2])
