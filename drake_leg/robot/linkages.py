"""Robots with closed loops: four-bar, slider-crank, five-bar, Bennett's linkage, an arm.

They stand in the vertical plane, where they are planar, and start in a closed posture.
"""

from __future__ import annotations

import math

from drake_leg.colours import Colour
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robot import Link, Robot, Row, Segment, link_colour
from drake_leg.robot.solids import Brick, Solid, Sphere
from drake_leg.robot.tree import Loop

QUARTER = math.pi / 2
DENSITY = 2700.0  # [kg/m^3]
WIDTH, HEIGHT = 0.02, 0.01  # [m], of a bar

CRANK, COUPLER, ROCKER, GROUND = 0.10, 0.25, 0.20, 0.30  # [m]
FIVE_BAR_CRANK, FIVE_BAR_ROD = 0.15, 0.25  # [m]
BENNETT_LONG, BENNETT_SHORT = 0.20, 0.15  # [m]
BENNETT_TWIST = math.radians(40.0)  # of the long links [rad]; that of the short ones follows
ARM_D2, ARM_D3, ARM_D4, ARM_D8, ARM_RL4 = 0.15, 0.55, 0.05, 0.20, 0.50  # [m]


def bar(name: str, length: float, colour: Colour) -> Link:
    """Make a bar along x, from the origin of its frame."""
    solid = Solid(
        shape=Brick(length=length, width=WIDTH, height=HEIGHT),
        density=DENSITY,
        centre=(length / 2.0, 0.0, 0.0),
        colour=colour,
    )
    return Link(name=name, solid=solid, end=(length, 0.0, 0.0))


def ball(name: str, radius: float, colour: Colour) -> Link:
    """Make a ball around the origin of its frame."""
    solid = Solid(
        shape=Sphere(radius=radius), density=DENSITY, centre=(0.0, 0.0, 0.0), colour=colour
    )
    return Link(name=name, solid=solid)


def _driven(degrees: float) -> JointMechanics:
    return JointMechanics(position_target=StateTarget(value=math.radians(degrees)))


def _following(position: float) -> JointMechanics:
    """Mechanics of a passive joint that starts near a position [rad or m]."""
    target = StateTarget(value=position, priority="low")
    return JointMechanics(actuated=False, position_target=target)


def _turning(name: str, link: Link, mechanics: JointMechanics, **row: float | int) -> Segment:
    given = Row(joint="revolute", **row)  # type: ignore[arg-type]
    return Segment(row=given, joint=name, link=link, mechanics=mechanics)


_CUT = JointMechanics(actuated=False)

FOUR_BAR = Robot(
    name="four_bar",
    title="Four-bar linkage",
    source="a crank and a rocker",
    segments=(
        _turning("crank", bar("crank_bar", CRANK, link_colour(1)), _driven(60.0), alpha=QUARTER),
        _turning("coupler", bar("coupler_bar", COUPLER, link_colour(2)), _following(-0.7), d=CRANK),
        _turning(
            "rocker",
            bar("rocker_bar", ROCKER, link_colour(3)),
            _following(1.7),
            alpha=QUARTER,
            d=GROUND,
            antecedent=0,
        ),
        Segment(row=Row(joint="revolute", d=ROCKER), mechanics=_CUT),
        Segment(row=Row(joint="fixed", d=COUPLER, antecedent=2)),
    ),
    loops=(Loop(joint="pin", cut=4, end=5),),
)

SLIDER_CRANK = Robot(
    name="slider_crank",
    title="Slider-crank",
    source="cut where the rod meets the slider",
    segments=(
        _turning("crank", bar("crank_bar", CRANK, link_colour(1)), _driven(60.0), alpha=QUARTER),
        _turning("rod", bar("rod_bar", COUPLER, link_colour(2)), _following(-1.4), d=CRANK),
        Segment(
            row=Row(joint="prismatic", gamma=QUARTER, alpha=QUARTER, antecedent=0),
            joint="slide",
            link=ball("slider", 0.02, link_colour(3)),
            mechanics=_following(0.28),
        ),
        Segment(row=Row(joint="revolute", gamma=-QUARTER, alpha=QUARTER), mechanics=_CUT),
        Segment(row=Row(joint="fixed", d=COUPLER, antecedent=2)),
    ),
    loops=(Loop(joint="pin", cut=4, end=5),),
)

SLIDER_CRANK_CUT_AT_SLIDE = Robot(
    name="slider_crank_cut_at_slide",
    title="Slider-crank",
    source="cut where the slider meets its rail",
    segments=(
        _turning("crank", bar("crank_bar", CRANK, link_colour(1)), _driven(60.0), alpha=QUARTER),
        _turning("rod", bar("rod_bar", COUPLER, link_colour(2)), _following(-1.4), d=CRANK),
        _turning("pin", ball("slider", 0.02, link_colour(3)), _following(0.35), d=COUPLER),
        Segment(
            row=Row(joint="prismatic", gamma=QUARTER, alpha=QUARTER, antecedent=0), mechanics=_CUT
        ),
        Segment(row=Row(joint="fixed", gamma=QUARTER, alpha=QUARTER, theta=-QUARTER, antecedent=3)),
    ),
    loops=(Loop(joint="slide", cut=4, end=5),),
)

FIVE_BAR = Robot(
    name="five_bar",
    title="Five-bar linkage",
    source="two cranks",
    segments=(
        _turning(
            "left", bar("left_crank", FIVE_BAR_CRANK, link_colour(1)), _driven(110.0), alpha=QUARTER
        ),
        _turning(
            "left_elbow",
            bar("left_rod", FIVE_BAR_ROD, link_colour(2)),
            _following(-1.2),
            d=FIVE_BAR_CRANK,
        ),
        _turning(
            "right",
            bar("right_crank", FIVE_BAR_CRANK, link_colour(3)),
            _driven(70.0),
            alpha=QUARTER,
            d=GROUND,
            antecedent=0,
        ),
        _turning(
            "right_elbow",
            bar("right_rod", FIVE_BAR_ROD, link_colour(4)),
            _following(1.2),
            d=FIVE_BAR_CRANK,
        ),
        Segment(row=Row(joint="revolute", d=FIVE_BAR_ROD), mechanics=_CUT),
        Segment(row=Row(joint="fixed", d=FIVE_BAR_ROD, antecedent=2)),
    ),
    loops=(Loop(joint="pin", cut=5, end=6),),
)

_SHORT_TWIST = math.asin(BENNETT_SHORT / BENNETT_LONG * math.sin(BENNETT_TWIST))

BENNETT = Robot(
    name="bennett",
    title="Bennett's linkage",
    source="a spatial loop of four revolute joints, movable as its twists are",
    segments=(
        _turning("first", bar("first_bar", BENNETT_LONG, link_colour(1)), _driven(60.0)),
        _turning(
            "second",
            bar("second_bar", BENNETT_SHORT, link_colour(2)),
            _following(2.4),
            d=BENNETT_LONG,
            alpha=BENNETT_TWIST,
        ),
        _turning(
            "third",
            bar("third_bar", BENNETT_LONG, link_colour(3)),
            _following(-1.0),
            d=BENNETT_SHORT,
            alpha=_SHORT_TWIST,
        ),
        Segment(row=Row(joint="revolute", d=BENNETT_LONG, alpha=BENNETT_TWIST), mechanics=_CUT),
        Segment(row=Row(joint="fixed", d=-BENNETT_SHORT, alpha=-_SHORT_TWIST, antecedent=0)),
    ),
    loops=(Loop(joint="fourth", cut=4, end=5),),
)

_ELBOW = Link(
    name="elbow",
    solid=Solid(
        shape=Brick(length=WIDTH, width=ARM_D8, height=HEIGHT),
        density=DENSITY,
        centre=(0.0, -ARM_D8 / 2.0, 0.0),
        colour=link_colour(3),
    ),
    end=(0.0, -ARM_D8, 0.0),
)

# Khalil and Kleinfinger's table of an arm whose third joint is driven by a parallelogram: six
# degrees of freedom, NL = 8 moving links, NJ = 9 joints, NF = 2 NJ - NL = 10 frames.
PARALLELOGRAM_ARM = Robot(
    name="parallelogram_arm",
    title="Arm with a parallelogram",
    source="a table of the kind of the SR400's",
    segments=(
        _turning("joint1", bar("shoulder", ARM_D2, link_colour(1)), _driven(20.0)),
        _turning(
            "joint2",
            bar("upper_arm", ARM_D3, link_colour(2)),
            _driven(-70.0),
            d=ARM_D2,
            alpha=-QUARTER,
        ),
        _turning("joint3", _ELBOW, _following(1.9), d=ARM_D3),
        _turning(
            "joint4",
            ball("forearm", 0.04, link_colour(4)),
            _driven(30.0),
            d=ARM_D4,
            alpha=-QUARTER,
            r=ARM_RL4,
        ),
        _turning("joint5", ball("wrist", 0.03, link_colour(5)), _driven(-20.0), alpha=QUARTER),
        _turning("joint6", bar("hand", 0.08, link_colour(6)), _driven(10.0), alpha=-QUARTER),
        _turning(
            "joint7",
            bar("lever", ARM_D8, link_colour(7)),
            _driven(-40.0),
            d=ARM_D2,
            alpha=-QUARTER,
            antecedent=1,
        ),
        _turning("joint8", bar("tie_rod", ARM_D3, link_colour(1)), _following(-0.5), d=ARM_D8),
        Segment(row=Row(joint="revolute", d=ARM_D3), mechanics=_CUT),
        Segment(row=Row(joint="fixed", gamma=QUARTER, d=-ARM_D8, antecedent=3)),
    ),
    loops=(Loop(joint="joint9", cut=9, end=10),),
)

NAMED_LINKAGES = (FOUR_BAR, SLIDER_CRANK, FIVE_BAR, BENNETT, PARALLELOGRAM_ARM)
LINKAGES = (*NAMED_LINKAGES, SLIDER_CRANK_CUT_AT_SLIDE)
