"""Chains that are not the reports': fewer and more joints, planes, lines, textbooks' arms."""

import math
from pathlib import Path

import numpy as np

from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.solids import Inertial

RIGHT = math.pi / 2
TEXTBOOKS = Path(__file__).parent / "lab" / "grader" / "robots"


def turn(**row):
    return Row(joint="revolute", **row)


def slide(**row):
    return Row(joint="prismatic", **row)


def fixed(**row):
    return Row(joint="fixed", **row)


def chain_of(rows, name="chain"):
    """Give every row that moves a joint and a link with mass."""
    inertial = Inertial(mass=0.5, centre=(0.02, 0.01, 0.03), moments=(1e-3, 1.2e-3, 1.1e-3))
    segments = tuple(
        Segment(row=row)
        if row.joint == "fixed"
        else Segment(row=row, joint=f"j{index}", link=Link(name=f"l{index}", inertial=inertial))
        for index, row in enumerate(rows, start=1)
    )
    return Robot(name=name, title=name, source="", segments=segments)


def textbook_arm(name):
    return chain_of(load_robot(TEXTBOOKS / f"{name}.toml").rows, name)


def random_chain(rng, joints):
    """Return a chain of joints of both kinds, and a posture."""
    rows = [
        Row(
            joint=str(rng.choice(["revolute", "revolute", "prismatic"])),
            d=float(rng.uniform(-0.3, 0.3)),
            alpha=float(rng.uniform(-2.0, 2.0)),
            r=float(rng.uniform(-0.2, 0.2)),
            theta=float(rng.uniform(-2.0, 2.0)),
        )
        for _ in range(joints)
    ]
    q = [rng.uniform(-1.0, 1.0) if row.joint == "revolute" else rng.uniform(0, 0.2) for row in rows]
    return chain_of([*rows, fixed(d=0.1, r=0.05)], f"random_{joints}"), np.array(q)


PUMA, RX90 = textbook_arm("puma560_classic"), textbook_arm("rx90")
SEVEN = chain_of(
    [
        turn(r=0.34),
        turn(alpha=-RIGHT),
        turn(alpha=RIGHT, r=0.4),
        turn(alpha=RIGHT),
        turn(alpha=-RIGHT, r=0.4),
        turn(alpha=-RIGHT),
        turn(alpha=RIGHT, r=0.126),
    ],
    "seven",
)
PLANAR_2 = chain_of([turn(), turn(d=0.3), fixed(d=0.2)], "planar_2")
PLANAR_3 = chain_of([turn(), turn(d=0.3), turn(d=0.2), fixed(d=0.1)], "planar_3")
PLANAR_4 = chain_of([turn(), turn(d=0.3), turn(d=0.2), turn(d=0.2), fixed(d=0.1)], "planar_4")
TILTED = chain_of([turn(alpha=0.3), turn(d=0.3), fixed(d=0.2)], "tilted")
SLIDER = chain_of([slide()], "slider")
POLAR = chain_of([turn(), slide(alpha=RIGHT), fixed(r=0.2)], "polar")
CYLINDER = chain_of([turn(), slide(), fixed(d=0.1)], "cylinder")
WHEEL = chain_of([turn(), fixed(d=0.3)], "wheel")
SPINDLE = chain_of([turn()], "spindle")
FIVE = chain_of(
    [
        turn(r=0.2),
        turn(alpha=RIGHT),
        turn(d=0.3),
        turn(d=0.25),
        turn(alpha=RIGHT, r=0.05),
        fixed(d=0.05),
    ],
    "five",
)
GANTRY = chain_of(
    [slide(), slide(alpha=RIGHT, theta=RIGHT), slide(alpha=RIGHT), turn(), fixed(d=0.1)], "gantry"
)

SIX = np.radians([10.0, -30.0, 40.0, 20.0, 50.0, 10.0])
POSTURES = {
    "puma560_classic": (PUMA, SIX),
    "rx90": (RX90, SIX),
    "seven": (SEVEN, np.radians([10.0, 30.0, 20.0, -60.0, 10.0, 50.0, 20.0])),
    "planar_2": (PLANAR_2, np.radians([20.0, 60.0])),
    "planar_3": (PLANAR_3, np.radians([20.0, 60.0, 30.0])),
    "planar_4": (PLANAR_4, np.radians([20.0, 60.0, 30.0, 10.0])),
    "tilted": (TILTED, np.radians([20.0, 60.0])),
    "slider": (SLIDER, np.array([0.1])),
    "polar": (POLAR, np.array([0.3, 0.2])),
    "five": (FIVE, np.radians([10.0, 30.0, 40.0, 30.0, 20.0])),
    "gantry": (GANTRY, np.array([0.1, 0.2, 0.3, 0.4])),
}
