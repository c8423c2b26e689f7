"""Bodies with six legs, each one Khalil table: the hexabot, and a product, the PhantomX MK-IV.

Of the hexabot, the reports have the leg only. Body, hips and masses are chosen here: each leg has
a servo of 57.2 g (XL430-W250, the vendor's manual) at its hip, carried by the body, one at its
knee, carried by the coxa, and one at its ankle, carried by the femur; the rest is printed plastic,
a battery and a computer.

Of the PhantomX, all is published, in the vendor's robot description ``pxmark4`` (BSD license,
github.com/Interbotix/interbotix_ros_crawlers). Its zeros and axes differ from the ones of this
table: there a positive angle of femur or tibia lowers the foot, and at 0 femur and tibia point
down. Both are converted here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from drake_leg.arguments import require_kind, shown
from drake_leg.colours import Colour
from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robot import NO_MECHANICS, Link, Robot, Row, Segment, link_colour
from drake_leg.robot.robots import GREY, HEXABOT_LENGTHS
from drake_leg.robot.solids import Axes, Brick, Inertial, Solid, Sphere, turned, volume, without
from drake_leg.units import beyond, require_finite, require_positive, require_three

SERVO = 0.0572  # [kg], XL430-W250
COXA = FEMUR = SERVO + 0.020  # [kg], with a printed bracket
TIBIA = 0.030  # [kg], printed
FOOT = 0.002  # [kg], a rubber tip
BODY = 6 * SERVO + 0.190 + 0.100 + 0.410  # [kg], with battery, computer, and printed plates
BODY_SIZE = (0.240, 0.150, 0.040)  # [m]
HEIGHT, REACH = 0.085, 0.130  # [m], of the hips above the feet, and from a hip to its foot
_SECTION = (0.024, 0.030)  # [m], width and height of a link, those of a servo
_FOOT_RADIUS = 0.006  # [m]
_BALL = Solid(
    shape=Sphere(radius=_FOOT_RADIUS), density=1.0, centre=(-_FOOT_RADIUS, 0.0, 0.0), colour=GREY
)


PARTS = ("coxa", "femur", "tibia")
_DRAWN = ("body", *PARTS)  # links whose mass properties may be given


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
    link_masses: tuple[float, float, float] = (COXA, FEMUR, TIBIA),
    foot_mass: float = FOOT,
    inertials: Mapping[str, Inertial] | None = None,
    height: float = HEIGHT,
    reach: float = REACH,
    mechanics: JointMechanics | Sequence[JointMechanics] = NO_MECHANICS,
) -> Robot:
    """Make a floating body that carries legs of three joints and stands on them at the start.

    Frame 0 is at the body's center, x forward, z up. At 0 the legs are stretched horizontally,
    along their yaw; positive angles of knee and ankle lift the foot. The last frame of a leg is
    the point with which it touches the ground: the ball of the foot ends there.

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
    link_masses : (3,) tuple of float
        Of coxa, femur and tibia, homogeneous bricks [kg].
    foot_mass : float
        Of the ball at the end of a tibia [kg].
    inertials : mapping of str to Inertial, optional
        Mass properties of ``body``, ``coxa``, ``femur`` or ``tibia`` that replace those of a
        homogeneous brick, in the link's frame.
    height : float
        Of the hips above the feet, at the start [m].
    reach : float
        From a hip to its foot, along the ground, at the start [m].
    mechanics : JointMechanics or (3,) sequence of JointMechanics
        Of every joint, or of every hip, knee and ankle; the position targets are replaced.

    Raises
    ------
    InvalidValueError
        If a length or a mass is not positive, a hip is not finite, there is no leg, or the feet
        cannot be that far within the joints' limits.
    """
    require_three("the lengths of coxa, femur and tibia", lengths)
    require_three("the masses of coxa, femur and tibia", link_masses)
    require_three("the size of the body", body_size)
    for what, length, mass in zip(PARTS, lengths, link_masses, strict=True):
        require_positive(f"the length of the {what}", length, "m")
        require_positive(f"the mass of the {what}", mass, "kg")
    for what, value, unit in (
        ("the body's mass", body_mass, "kg"),
        ("the foot's mass", foot_mass, "kg"),
        ("the height", height, "m"),
        ("the reach", reach, "m"),
    ):
        require_positive(what, value, unit)
    require_kind("the hips", hips, Mapping)
    if not hips:
        raise InvalidValueError("there is no hip; a walking robot has at least one leg")
    given = _given_inertials(inertials)
    joints = _with_targets(mechanics, (0.0, *_standing(lengths, height, reach)))
    brick = Brick(**dict(zip(("length", "width", "height"), body_size, strict=True)))
    body = Solid(shape=brick, density=1.0, centre=(0.0, 0.0, 0.0), colour=GREY)
    legs: list[Segment] = []
    for number, (leg, hip) in enumerate(hips.items(), start=1):
        bars = [
            _bar(f"{leg}_{part}", length, mass, link_colour(number), given.get(part))
            for part, length, mass in zip(PARTS, lengths, link_masses, strict=True)
        ]
        legs += _leg(leg, hip, bars, joints, foot_mass)
    return Robot(
        name=name,
        title=title,
        source=source,
        segments=tuple(legs),
        floating=True,
        base_pose=((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, height), (0, 0, 0, 1)),
        base_link=_weighing(body_mass, "body", body, given.get("body")),
    )


def _given_inertials(inertials: Mapping[str, Inertial] | None) -> Mapping[str, Inertial]:
    if inertials is None:
        return {}
    require_kind("the inertials", inertials, Mapping)
    for part, inertial in inertials.items():
        if part not in _DRAWN:
            raise InvalidValueError(
                f"there is an inertial of {shown(part)}; it must be one of {', '.join(_DRAWN)}"
            )
        require_kind(f"the inertial of {part}", inertial, Inertial)
    return inertials


def _with_targets(
    mechanics: JointMechanics | Sequence[JointMechanics], standing: tuple[float, ...]
) -> list[JointMechanics]:
    """Mechanics of hip, knee and ankle that start in the standing posture [rad]."""
    if isinstance(mechanics, JointMechanics):
        mechanics = (mechanics,) * 3
    require_kind("the mechanics of a leg", mechanics, tuple, list)
    if len(mechanics) != 3:
        raise InvalidValueError(
            f"the mechanics of a leg are {len(mechanics)}; there must be three: of hip, knee and "
            "ankle"
        )
    joints = []
    for joint, one, angle in zip(("hip", "knee", "ankle"), mechanics, standing, strict=True):
        require_kind(f"the mechanics of the {joint}", one, JointMechanics)
        low, high = one.bounds
        if beyond(angle, low, high):
            raise InvalidValueError(
                f"to stand, the {joint} turns to {math.degrees(angle):.6g} deg; its limits are "
                f"{math.degrees(low):.6g} and {math.degrees(high):.6g} deg"
            )
        joints.append(replace(one, position_target=StateTarget(value=angle, priority="low")))
    return joints


def _leg(
    name: str,
    hip: Hip,
    bars: Sequence[Link],
    mechanics: Sequence[JointMechanics],
    foot_mass: float,
) -> tuple[Segment, ...]:
    """One leg, its hip on frame 0."""
    require_kind(f"the hip {name}", hip, Hip)
    for what, value in zip(("x", "y", "yaw"), hip, strict=True):
        require_finite(f"{what} of the hip {name}", value)
    coxa, femur, tibia = (bar.end[0] for bar in bars)
    towards = math.atan2(hip.y, hip.x)
    rows = (
        Row(
            joint="revolute",
            antecedent=0,
            gamma=towards,
            d=math.hypot(hip.x, hip.y),
            theta=hip.yaw - towards,
        ),
        Row(joint="revolute", d=coxa, alpha=math.pi / 2),
        Row(joint="revolute", d=femur),
    )
    moving = (
        Segment(row=row, joint=f"{name}_{joint}", link=link, mechanics=mechanic)
        for joint, row, link, mechanic in zip(
            ("hip", "knee", "ankle"), rows, bars, mechanics, strict=True
        )
    )
    foot = Segment(
        row=Row(joint="fixed", d=tibia),
        joint=f"{name}_foot_weld",
        link=_weighing(foot_mass, f"{name}_foot", _BALL),
    )
    return (*moving, foot)


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


def _bar(name: str, length: float, mass: float, colour: Colour, inertial: Inertial | None) -> Link:
    brick = Brick(length=length, width=_SECTION[0], height=_SECTION[1])
    solid = Solid(shape=brick, density=1.0, centre=(length / 2, 0.0, 0.0), colour=colour)
    return _weighing(mass, name, solid, inertial, end=(length, 0.0, 0.0))


def _weighing(
    mass: float,
    name: str,
    solid: Solid,
    inertial: Inertial | None = None,
    end: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Link:
    """Make a homogeneous link of a mass [kg], unless its mass properties are given."""
    homogeneous = replace(solid, density=mass / volume(solid.shape))
    return Link(name=name, solid=homogeneous, inertial=inertial, end=end)


HEXABOT = hexapod()


# --- PhantomX MK-IV ---------------------------------------------------------------------------

# The published places of joints in the frame of the link before, x out and z up [m].
_PX_COXA = 0.052907539
_PX_FEMUR, _PX_TIBIA = (0.060, -0.015), (0.095, -0.090)  # x and z of ankle and foot
_PX_BOTTOM = 0.033  # of the body, below its hips

# The published home: the feet stay where they are when femur and tibia are at -90 and 90 degrees,
# and the bottom is raised to 50 mm.
PHANTOMX_HEIGHT = _PX_BOTTOM + 0.050
PHANTOMX_REACH = _PX_COXA - _PX_FEMUR[1] + _PX_TIBIA[0]

PHANTOMX_HIPS = {
    "left_front": Hip(0.125, 0.065, math.radians(45.0)),
    "left_middle": Hip(0.000, 0.100, math.radians(90.0)),
    "left_rear": Hip(-0.125, 0.065, math.radians(135.0)),
    "right_front": Hip(0.125, -0.065, math.radians(-45.0)),
    "right_middle": Hip(0.000, -0.100, math.radians(-90.0)),
    "right_rear": Hip(-0.125, -0.065, math.radians(-135.0)),
}
_PX_SIZE = (0.260, 0.190, 2 * _PX_BOTTOM)  # [m], chosen: a brick around the hips

# Published, about the hip's, femur's and tibia's axes, which lower the foot [deg].
_PX_LIMITS = ((-55.0, 55.0), (-98.0, 90.0), (-45.0, 125.0))

# Published, in each link's frame, x out and z up: with the servos, 3.216 kg in all.
_PX_INERTIALS = {
    "body": Inertial(
        mass=1.522054,
        centre=(0.001522, 0.000302, 0.015345),
        moments=(4.466e-3, 8.489e-3, 9.202e-3),
        products=(7.6888e-6, -1.245e-4, 5.0996e-6),
    ),
    "coxa": Inertial(
        mass=0.024710,
        centre=(0.019066, -0.000002, 0.006577),
        moments=(2.154e-5, 2.657e-5, 2.925e-5),
        products=(-1.22e-9, -1.92741e-6, -1e-11),
    ),
    "femur": Inertial(
        mass=0.085834,
        centre=(0.020226, -0.000290, -0.000630),
        moments=(2.887e-5, 7.502e-5, 8.672e-5),
        products=(2.419e-7, 4.8494e-6, 3e-10),
    ),
    "tibia": Inertial(
        mass=0.171825,
        centre=(0.036797, 0.000054, -0.011991),
        moments=(1.762e-4, 5.158e-4, 3.768e-4),
        products=(-1.4522e-6, 1.789e-4, 6.181e-7),
    ),
}


def _along(line: tuple[float, float]) -> Axes:
    """Axes of a row of this table, x along a line out and up, z to the right, when all is at 0."""
    length = math.hypot(*line)
    out, up = line[0] / length, line[1] / length
    return ((out, 0.0, up), (-up, 0.0, out), (0.0, -1.0, 0.0))


def _phantomx() -> Robot:
    """The published robot, in this table's axes; the ball of a foot is a part of its tibia."""
    femur, tibia = math.hypot(*_PX_FEMUR), math.hypot(*_PX_TIBIA)
    knee = math.degrees(math.atan2(*reversed(_PX_FEMUR)))
    ankle = math.degrees(math.atan2(*reversed(_PX_TIBIA))) - knee
    foot = replace(_BALL, density=FOOT / volume(_BALL.shape))
    end = (tibia - _FOOT_RADIUS, 0.0, 0.0)
    return hexapod(
        name="phantomx",
        title="PhantomX MK-IV",
        source="Interbotix's robot description pxmark4; the drawn solids are chosen",
        lengths=(_PX_COXA, femur, tibia),
        hips=PHANTOMX_HIPS,
        body_size=_PX_SIZE,
        inertials={
            "body": _PX_INERTIALS["body"],
            "coxa": _PX_INERTIALS["coxa"],
            "femur": turned(_PX_INERTIALS["femur"], _along(_PX_FEMUR)),
            "tibia": without(turned(_PX_INERTIALS["tibia"], _along(_PX_TIBIA)), foot, place=end),
        },
        height=PHANTOMX_HEIGHT,
        reach=PHANTOMX_REACH,
        mechanics=[
            JointMechanics(lower=math.radians(zero - upper), upper=math.radians(zero - lower))
            for zero, (lower, upper) in zip((0.0, knee, ankle), _PX_LIMITS, strict=True)
        ],
    )


PHANTOMX = _phantomx()
HEXAPODS = (HEXABOT, PHANTOMX)
