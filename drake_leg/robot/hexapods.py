"""The whole hexabot: a body with six of report B's legs, one Khalil table.

The reports have the leg only. Body, hips and masses are chosen here: each leg has a servo of
57.2 g (XL430-W250, the vendor's manual) at its hip, carried by the body, one at its knee, carried
by the coxa, and one at its ankle, carried by the femur; the rest is printed plastic, a battery and
a computer.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from drake_leg.arguments import require_kind
from drake_leg.colours import Colour
from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robot import NO_MECHANICS, Link, Robot, Row, Segment, link_colour
from drake_leg.robot.robots import GREY, HEXABOT_LENGTHS
from drake_leg.robot.solids import Brick, Solid, Sphere, volume
from drake_leg.units import require_finite, require_positive, require_three

SERVO = 0.0572  # [kg], XL430-W250
COXA = FEMUR = SERVO + 0.020  # [kg], with a printed bracket
TIBIA, FOOT = 0.030, 0.002  # [kg], printed, and a rubber tip
BODY = 6 * SERVO + 0.190 + 0.100 + 0.410  # [kg], with battery, computer, and printed plates
BODY_SIZE = (0.240, 0.150, 0.040)  # [m]
HEIGHT, REACH = 0.085, 0.130  # [m], of the hips above the feet, and from a hip to its foot
_SECTION = (0.024, 0.030)  # [m], width and height of a link, those of a servo
_FOOT_RADIUS = 0.006  # [m]


class Hip(NamedTuple):
    """Where a leg's hip is on the body, and where the leg points at 0."""

    x: float  # [m], forward
    y: float  # [m], to the left
    yaw: float  # [rad], from x towards y


HIPS = {
    "left_front": Hip(0.100, 0.060, math.radians(45.0)),
    "left_middle": Hip(0.000, 0.080, math.radians(90.0)),
    "left_rear": Hip(-0.100, 0.060, math.radians(135.0)),
    "right_front": Hip(0.100, -0.060, math.radians(-45.0)),
    "right_middle": Hip(0.000, -0.080, math.radians(-90.0)),
    "right_rear": Hip(-0.100, -0.060, math.radians(-135.0)),
}


def hexapod(
    *,
    name: str = "hexabot",
    title: str = "Hexabot",
    source: str = "Report B, table 2.2, six times; body and masses are chosen",
    lengths: tuple[float, float, float] = HEXABOT_LENGTHS,
    hips: Mapping[str, Hip] = HIPS,
    body_size: tuple[float, float, float] = BODY_SIZE,
    body_mass: float = BODY,
    height: float = HEIGHT,
    reach: float = REACH,
    mechanics: JointMechanics = NO_MECHANICS,
) -> Robot:
    """Make a floating body that carries legs of three joints and stands on them at the start.

    Frame 0 is at the body's center, x forward, z up. At 0 the legs are stretched horizontally,
    along their yaw; positive angles of knee and ankle lift the foot.

    Parameters
    ----------
    lengths : (3,) tuple of float
        Of coxa, femur and tibia [m].
    hips : mapping of str to Hip
        One leg for each, by its name.
    body_size : (3,) tuple of float
        Length, width and height of the body, a brick [m].
    body_mass : float
        [kg], with all that it carries but the legs.
    height : float
        Of the hips above the feet, at the start [m].
    reach : float
        From a hip to its foot, along the ground, at the start [m].
    mechanics : JointMechanics
        Of every joint; its position target is replaced.

    Raises
    ------
    InvalidValueError
        If a length or the mass is not positive, a hip is not finite, there is no leg, or the feet
        cannot be that far.
    """
    require_three("the lengths of coxa, femur and tibia", lengths)
    require_three("the size of the body", body_size)
    for what, length in zip(("coxa", "femur", "tibia"), lengths, strict=True):
        require_positive(f"the length of the {what}", length, "m")
    for what, value, unit in (
        ("the body's mass", body_mass, "kg"),
        ("the height", height, "m"),
        ("the reach", reach, "m"),
    ):
        require_positive(what, value, unit)
    require_kind("the mechanics of a joint", mechanics, JointMechanics)
    require_kind("the hips", hips, Mapping)
    if not hips:
        raise InvalidValueError("there is no hip; a walking robot has at least one leg")
    standing = (0.0, *_standing(lengths, height, reach))
    brick = Brick(**dict(zip(("length", "width", "height"), body_size, strict=True)))
    legs = [
        segment
        for number, (leg, hip) in enumerate(hips.items(), start=1)
        for segment in _leg(leg, hip, lengths, mechanics, standing, link_colour(number))
    ]
    return Robot(
        name=name,
        title=title,
        source=source,
        segments=tuple(legs),
        floating=True,
        base_pose=((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, height), (0, 0, 0, 1)),
        base_link=_weighing(
            body_mass, "body", Solid(shape=brick, density=1.0, centre=(0.0, 0.0, 0.0), colour=GREY)
        ),
    )


def _leg(
    name: str,
    hip: Hip,
    lengths: tuple[float, float, float],
    mechanics: JointMechanics,
    standing: tuple[float, ...],
    colour: Colour,
) -> tuple[Segment, ...]:
    """One leg, its hip on frame 0; its foot is a ball whose center is the last frame."""
    require_kind(f"the hip {name}", hip, Hip)
    for what, value in zip(("x", "y", "yaw"), hip, strict=True):
        require_finite(f"{what} of the hip {name}", value)
    coxa, femur, tibia = lengths
    towards = math.atan2(hip.y, hip.x)

    def moving(joint: str, link: str, length: float, mass: float, row: Row) -> Segment:
        return Segment(
            row=row,
            joint=f"{name}_{joint}",
            link=_bar(f"{name}_{link}", length, mass, colour),
            mechanics=replace(
                mechanics,
                position_target=StateTarget(
                    value=standing[("hip", "knee", "ankle").index(joint)], priority="low"
                ),
            ),
        )

    ball = Solid(
        shape=Sphere(radius=_FOOT_RADIUS), density=1.0, centre=(0.0, 0.0, 0.0), colour=GREY
    )
    return (
        moving(
            "hip",
            "coxa",
            coxa,
            COXA,
            Row(
                joint="revolute",
                antecedent=0,
                gamma=towards,
                d=math.hypot(hip.x, hip.y),
                theta=hip.yaw - towards,
            ),
        ),
        moving("knee", "femur", femur, FEMUR, Row(joint="revolute", d=coxa, alpha=math.pi / 2)),
        moving("ankle", "tibia", tibia, TIBIA, Row(joint="revolute", d=femur)),
        Segment(
            row=Row(joint="fixed", d=tibia),
            joint=f"{name}_foot_weld",
            link=_weighing(FOOT, f"{name}_foot", ball),
        ),
    )


def _standing(
    lengths: tuple[float, float, float], height: float, reach: float
) -> tuple[float, float]:
    """Angles of knee and ankle [rad] that put a foot below its hip, the knee bent upwards."""
    coxa, femur, tibia = lengths
    far = math.hypot(reach - coxa, height)
    if not abs(femur - tibia) < far < femur + tibia:
        raise InvalidValueError(
            f"a foot {height:g} m below its hip and {reach:g} m away is {far:.4g} m from the knee; "
            f"it must be between {abs(femur - tibia):.4g} and {femur + tibia:.4g} m"
        )
    at_knee = math.acos((femur**2 + far**2 - tibia**2) / (2.0 * femur * far))
    at_ankle = math.acos((femur**2 + tibia**2 - far**2) / (2.0 * femur * tibia))
    return at_knee - math.atan2(height, reach - coxa), at_ankle - math.pi


def _bar(name: str, length: float, mass: float, colour: Colour) -> Link:
    brick = Brick(length=length, width=_SECTION[0], height=_SECTION[1])
    solid = Solid(shape=brick, density=1.0, centre=(length / 2, 0.0, 0.0), colour=colour)
    return _weighing(mass, name, solid, end=(length, 0.0, 0.0))


def _weighing(
    mass: float, name: str, solid: Solid, end: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Link:
    """Make a homogeneous link of a mass [kg]."""
    return Link(name=name, solid=replace(solid, density=mass / volume(solid.shape)), end=end)


HEXABOT = hexapod()
