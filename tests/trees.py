"""Robots with branches and closed loops, for the tests of several rooms."""

import math

from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.solids import Brick, Solid, Sphere
from drake_leg.robot.tree import Loop

COLOUR = (0.2, 0.4, 0.6)
LENGTHS = (0.05, 0.1, 0.1)  # [m]


def bar(name, length):
    shape = Brick(length=length, width=0.02, height=0.01)
    solid = Solid(shape=shape, density=1200.0, centre=(length / 2, 0.0, 0.0), colour=COLOUR)
    return Link(name=name, solid=solid, end=(length, 0.0, 0.0))


def ball(name):
    return Link(
        name=name,
        solid=Solid(shape=Sphere(radius=0.01), density=1000.0, centre=(0, 0, 0), colour=COLOUR),
    )


def turning(joint, link, **row):
    return Segment(row=Row(joint="revolute", **row), joint=joint, link=link)


def two_fingers():
    """A wrist that carries two fingers, one of them beside the common normal."""
    return Robot(
        name="hand",
        title="Two fingers",
        source="a test",
        segments=(
            turning("wrist", bar("palm", 0.1), alpha=0.4, r=0.2),
            turning("left", bar("left_finger", 0.08), d=0.1, alpha=1.1, gamma=0.5, b=0.03),
            Segment(row=Row(joint="fixed", d=0.08), joint="left_weld", link=ball("left_tip")),
            turning(
                "right", bar("right_finger", 0.07), d=0.09, alpha=-0.7, gamma=-0.8, antecedent=1
            ),
            Segment(row=Row(joint="fixed", d=0.07), joint="right_weld", link=ball("right_tip")),
        ),
    )


def leg(number, yaw, radius=0.1):
    """One leg of a hexapod: hip, knee, ankle and foot, its hip on a circle [m] at a yaw [rad]."""
    coxa, femur, tibia = LENGTHS
    return (
        turning(f"hip_{number}", bar(f"coxa_{number}", coxa), d=radius, gamma=yaw, antecedent=0),
        turning(f"knee_{number}", bar(f"femur_{number}", femur), d=coxa, alpha=math.pi / 2),
        turning(f"ankle_{number}", bar(f"tibia_{number}", tibia), d=femur),
        Segment(
            row=Row(joint="fixed", d=tibia), joint=f"weld_{number}", link=ball(f"foot_{number}")
        ),
    )


def hexapod():
    """A floating body with six legs."""
    body = Solid(
        shape=Brick(length=0.2, width=0.2, height=0.04),
        density=600.0,
        centre=(0.0, 0.0, 0.01),
        colour=COLOUR,
    )
    legs = [leg(number, (number - 1) * math.pi / 3) for number in range(1, 7)]
    segments = [segment for one in legs for segment in one]
    return Robot(
        name="hexapod",
        title="Six legs",
        source="a test",
        segments=tuple(segments),
        floating=True,
        base_link=Link(name="body", solid=body),
        base_pose=((1, 0, 0, 0.1), (0, 0.6, -0.8, 0.2), (0, 0.8, 0.6, 0.3), (0, 0, 0, 1)),
    )


def parallelogram():
    """Two cranks of 0.2 m and a coupler of 0.3 m, cut where the coupler meets the second."""
    return Robot(
        name="parallelogram",
        title="A parallelogram",
        source="a test",
        segments=(
            turning("crank", bar("driver", 0.2)),
            turning("pin", bar("coupler", 0.3), d=0.2),
            turning("pivot", bar("follower", 0.2), d=0.3, antecedent=0),
            Segment(row=Row(joint="revolute", d=0.2)),
            Segment(row=Row(joint="fixed", d=0.3, antecedent=2)),
        ),
        loops=(Loop(joint="cut", cut=4, end=5),),
    )
