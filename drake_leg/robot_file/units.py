"""The units of a robot file: what it says once, and what it says at a key."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from drake_leg.quantities import DAMPING_UNITS, SPRING_UNITS
from drake_leg.robot import JointType

AngleUnit = Literal["deg", "rad"]

SLIDING_DAMPING_UNITS = {"N*s/m": 1.0}
SLIDING_SPRING_UNITS = {"N/m": 1.0}


@dataclass(frozen=True, kw_only=True)
class JointUnits:
    """The units that the file uses at one joint, and how they become SI and radians."""

    position: str  # as in sentences and comments: deg, rad or m
    effort: str
    stiffness: dict[str, float]  # unit to its value in SI, the default first
    damping: dict[str, float]  # the same

    @property
    def velocity(self) -> str:
        """Unit of the joint's speed."""
        return f"{self.position}/s"

    def si(self, value: float) -> float:
        """Return a position or a speed in rad, m, rad/s or m/s."""
        return math.radians(value) if self.position == "deg" else value


def joint_units(joint: JointType, angles: AngleUnit) -> JointUnits:
    """Choose the units of a joint.

    Parameters
    ----------
    joint : {"revolute", "prismatic", "fixed"}
        Whether it turns or slides.
    angles : {"deg", "rad"}
        The file's unit of angles.
    """
    if joint == "prismatic":
        return JointUnits(
            position="m",
            effort="N",
            stiffness=SLIDING_SPRING_UNITS,
            damping=SLIDING_DAMPING_UNITS,
        )
    return JointUnits(position=angles, effort="N*m", stiffness=SPRING_UNITS, damping=DAMPING_UNITS)


def in_radians(angle: float, angles: AngleUnit) -> float:
    """Return an angle of the file in rad.

    Parameters
    ----------
    angle : float
        In the file's unit.
    angles : {"deg", "rad"}
        The file's unit of angles.

    Returns
    -------
    float
        [rad].
    """
    return math.radians(angle) if angles == "deg" else angle


def exact_degrees(angle: float) -> float | None:
    """Find the shortest number of degrees that is read back as exactly this angle.

    Parameters
    ----------
    angle : float
        [rad].

    Returns
    -------
    float or None
        [deg]; None where no number is read back exactly.
    """
    degrees = math.degrees(angle)
    rounded = (round(degrees, digits) for digits in range(16))
    neighbours = (math.nextafter(degrees, math.inf), math.nextafter(degrees, -math.inf))
    for candidate in (*rounded, degrees, *neighbours):
        if math.radians(candidate) == angle:
            return candidate
    return None
