"""The robots of the two reports, and the only place where their dimensions are written.

Report A is "Modeling of a Simple Pendulum and a Hexabot Leg using MATLAB/Simulink"
(Olanrewaju, Jabeen); report B is "Geometric, Kinematic and Dynamical modeling of Robotic
systems" (Deowan, Hossain). Cross sections, foot radius and the SCARA's solids are in neither:
they are chosen here so that the links are visible.
"""

from __future__ import annotations

import math
from typing import Literal

from drake_leg.colours import Colour
from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import LINK_COLOURS, Link, Robot, Row, Segment
from drake_leg.robot.solids import Brick, Cylinder, Solid, Sphere
from drake_leg.units import require_positive

LegVariant = Literal["A", "B"]

WATER = 1000.0  # [kg/m^3], Simscape's default, and the public Simulink model's density
ALUMINIUM = 2700.0  # [kg/m^3]

BLUE, ORANGE, GREEN = LINK_COLOURS[:3]
GREY = (0.35, 0.35, 0.35)

HEXABOT_LENGTHS = (0.050, 0.100, 0.100)  # [m], report B, section 2.2
SCARA_LENGTHS = (0.220, 0.240)  # [m], report B, table 1.2

# Where the reports' motions start, hip to ankle or shoulder to wrist [deg]; the feet of both legs
# are in the same place.
LEG_A_POSTURE = (90.0, 50.0, 90.0)
LEG_B_POSTURE = (90.0, -50.0, -90.0)
SCARA_POSTURE = (30.0, 90.0, -120.0)
SCARA_HEIGHT = 0.4524  # [m], report B, table 1.2
SCARA_LOWEST = 0.340  # [m], height of the tool at R = 0, report B, table 1.2
PENDULUM_SIZE = (0.40, 0.01, 0.01)  # [m], the assignment that report A answers

_LEG_SECTION = (0.008, 0.005)  # [m], width and height of the bricks
_FOOT_RADIUS = 0.006  # [m]
_SCARA_SECTION = (0.040, 0.030)  # [m], width and height of the arms
_TOOL_RADIUS = 0.010  # [m]


def _bar(
    name: str,
    length: float,
    section: tuple[float, float],
    density: float,
    colour: Colour,
) -> Link:
    """Make a link that is one brick along its x axis, from joint to joint."""
    brick = Brick(length=length, width=section[0], height=section[1])
    solid = Solid(shape=brick, density=density, centre=(length / 2, 0.0, 0.0), colour=colour)
    return Link(name=name, solid=solid, end=(length, 0.0, 0.0))


def pendulum(
    *,
    size: tuple[float, float, float] = PENDULUM_SIZE,
    density: float = WATER,
    mechanics: JointMechanics | None = None,
) -> Robot:
    """Make report A's pendulum: one brick that turns about the base's horizontal y axis.

    At q = 0 the link is horizontal; positive q turns it downwards. The brick has a length, width
    and height [m] and a density [kg/m^3]; by default its joint has neither damping nor spring
    (report A, section 1.2, figures 1 and 2).
    """
    length, width, height = size
    require_positive("the pendulum's length", length, "m")
    mechanics = mechanics or JointMechanics(actuated=False)
    return Robot(
        name="pendulum",
        title="Simple pendulum",
        source="Report A, section 1.2",
        segments=(
            Segment(
                row=Row(joint="revolute", alpha=-math.pi / 2),
                joint="pivot",
                link=_bar("link", length, (width, height), density, BLUE),
                mechanics=mechanics,
            ),
            Segment(row=Row(joint="fixed", d=length / 2)),
        ),
    )


def hexabot_leg(
    variant: LegVariant,
    *,
    l1: float = HEXABOT_LENGTHS[0],
    l2: float = HEXABOT_LENGTHS[1],
    l3: float = HEXABOT_LENGTHS[2],
    density: float = WATER,
    damping: float = 0.0,
) -> Robot:
    """Make the three-joint leg of the hexabot, named ``leg_a`` or ``leg_b``.

    Report A turns the knee axis by -90 degrees, report B by +90. Coxa, femur and tibia have lengths
    l1, l2, l3 [m], all solids one density [kg/m^3] and all joints one damping [N*m*s/rad] (report
    A, table 1; report B, table 2.2, printed shifted by a column).
    """
    if variant not in ("A", "B"):
        raise InvalidValueError(f"the leg's variant is {variant!r}; it must be 'A' or 'B'")
    for name, length in (("l1", l1), ("l2", l2), ("l3", l3)):
        require_positive(f"the length {name}", length, "m")
    mechanics = JointMechanics(damping=damping)
    knee_twist = -math.pi / 2 if variant == "A" else math.pi / 2
    foot = Solid(
        shape=Sphere(radius=_FOOT_RADIUS), density=density, centre=(0.0, 0.0, 0.0), colour=GREY
    )
    return Robot(
        name=f"leg_{variant.lower()}",
        title=f"Hexabot leg {variant}",
        source={"A": "Report A, table 1", "B": "Report B, table 2.2"}[variant],
        segments=(
            Segment(
                row=Row(joint="revolute"),
                joint="hip",
                link=_bar("coxa", l1, _LEG_SECTION, density, BLUE),
                mechanics=mechanics,
            ),
            Segment(
                row=Row(joint="revolute", d=l1, alpha=knee_twist),
                joint="knee",
                link=_bar("femur", l2, _LEG_SECTION, density, ORANGE),
                mechanics=mechanics,
            ),
            Segment(
                row=Row(joint="revolute", d=l2),
                joint="ankle",
                link=_bar("tibia", l3, _LEG_SECTION, density, GREEN),
                mechanics=mechanics,
            ),
            Segment(
                row=Row(joint="fixed", d=l3),
                joint="foot_weld",
                link=Link(name="foot", solid=foot),
            ),
        ),
    )


def scara(
    *,
    l1: float = SCARA_LENGTHS[0],
    l2: float = SCARA_LENGTHS[1],
    density: float = ALUMINIUM,
    damping: float = 0.0,
) -> Robot:
    """Make report B's SCARA arm; its tool's z axis points down.

    The fourth joint position is q4 = 452.4 mm - 340 mm - R, with R the height of the tool above
    its lowest position. The two arms have lengths l1, l2 [m], all solids one density [kg/m^3] and
    all joints one damping [N*m*s/rad, N*s/m] (report B, table 1.2).
    """
    for name, length in (("l1", l1), ("l2", l2)):
        require_positive(f"the length {name}", length, "m")
    mechanics = JointMechanics(damping=damping)
    stroke = SCARA_HEIGHT - SCARA_LOWEST
    tool = Solid(
        shape=Cylinder(radius=_TOOL_RADIUS, length=stroke),
        density=density,
        centre=(0.0, 0.0, -stroke / 2),
        colour=GREY,
    )
    return Robot(
        name="scara",
        title="SCARA arm",
        source="Report B, table 1.2",
        segments=(
            Segment(
                row=Row(joint="revolute", r=SCARA_HEIGHT),
                joint="shoulder",
                link=_bar("arm_1", l1, _SCARA_SECTION, density, BLUE),
                mechanics=mechanics,
            ),
            Segment(
                row=Row(joint="revolute", d=l1),
                joint="elbow",
                link=_bar("arm_2", l2, _SCARA_SECTION, density, ORANGE),
                mechanics=mechanics,
            ),
            Segment(
                row=Row(joint="revolute", d=l2),
                joint="wrist",
                link=Link(name="quill"),
                mechanics=mechanics,
            ),
            Segment(
                row=Row(joint="prismatic", alpha=math.pi),
                joint="lift",
                link=Link(name="tool", solid=tool),
                mechanics=mechanics,
            ),
        ),
    )


PENDULUM = pendulum()
LEG_A = hexabot_leg("A")
LEG_B = hexabot_leg("B")
SCARA = scara()
ROBOTS = (PENDULUM, LEG_A, LEG_B, SCARA)
