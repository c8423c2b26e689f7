"""The named singular families of the leg and the SCARA, and how near a posture is to them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.kinematics import leg, scara
from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.singularity.edges import (
    Edges,
    Family,
    leg_edges,
    leg_extremes,
    scara_edges,
)


@dataclass(frozen=True, kw_only=True)
class Nearness:
    """How near a posture is to a singular family."""

    family: Family
    measure: float  # 0 on the family, 1 farthest from it
    meaning: str  # the measure in words


class LegFamilies:
    """The two of the hexabot's leg: ``stretch`` and ``hip-axis``.

    It is stretched or folded where ``sin q3 = 0``; elsewhere it is singular with its foot on the
    hip axis.
    """

    moved = "the foot's translation"

    def __init__(self, geometry: LegGeometry) -> None:
        self._leg = geometry

    def nearness(self, q: Sequence[float]) -> tuple[Nearness, ...]:
        """How near a posture is to each family, the nearest first."""
        length = self._leg.l1 + self._leg.l2 + self._leg.l3
        bend, reach = abs(math.sin(q[2])), abs(self._reach(q))
        near = (
            Nearness(
                family="stretch",
                measure=bend,
                meaning=f"|sin q3| = {bend:.4g}; at 0 it is stretched or folded",
            ),
            Nearness(
                family="hip-axis",
                measure=reach / length,
                meaning=f"the foot is {reach:.4g} m from the hip axis, of {length:.4g} m",
            ),
        )
        return tuple(sorted(near, key=lambda one: one.measure))

    def words(self, q: Sequence[float], nearly: str) -> str:
        """Say what is nearest, as "the leg is nearly stretched"."""
        if self.nearness(q)[0].family == "hip-axis":
            return f"the foot is {nearly}on the hip axis"
        return f"the leg is {nearly}{'stretched' if math.cos(q[2]) > 0.0 else 'folded'}"

    def translation_jacobian(self, q: Sequence[float]) -> Array:
        """Jacobian of the foot's position, (3, 3) [m/rad]."""
        return leg.foot_jacobian(self._leg, q)

    def foot(self, q: Sequence[float]) -> Array:
        """Position of the foot, (3,) [m]."""
        return leg.foot_position(self._leg, q)

    def edges(self, q: Sequence[float]) -> Edges:
        """The stretched and the folded leg and the hip axis, on the side where the foot is."""
        return leg_edges(self._leg, facing(self._leg, q))

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Ways along a line from p in direction d at which a clearance may be extreme [m]."""
        return leg_extremes(self._leg, p, d)

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """Joint angles (3,) on the branch of ``like``; NaN out of reach."""
        return leg.inverse_kinematics(self._leg, p, like=like)

    def _reach(self, q: Sequence[float]) -> float:
        _, q2, q3 = q
        return self._leg.l1 + self._leg.l2 * math.cos(q2) + self._leg.l3 * math.cos(q2 + q3)


class ScaraFamilies:
    """The one of the SCARA in its plane: ``stretch``, where ``sin q2 = 0``."""

    moved = "the tool's horizontal motion"

    def __init__(self, geometry: ScaraGeometry) -> None:
        self._arm = geometry

    def nearness(self, q: Sequence[float]) -> tuple[Nearness, ...]:
        """How near a posture is to the family."""
        measure = abs(math.sin(q[1]))
        meaning = f"|sin q2| = {measure:.4g}; the arm is stretched or folded at 0"
        return (Nearness(family="stretch", measure=measure, meaning=meaning),)

    def words(self, q: Sequence[float], nearly: str) -> str:
        """Say what is nearest, as "the arm is nearly stretched"."""
        return f"the arm is {nearly}{'stretched' if math.cos(q[1]) > 0.0 else 'folded'}"

    def translation_jacobian(self, q: Sequence[float]) -> Array:
        """Jacobian of the tool's x and y against the first two angles, (2, 2) [m/rad]."""
        J: Array = scara.task_jacobian(self._arm, q[:3])[:2, :2]
        return J

    def foot(self, q: Sequence[float]) -> Array:
        """Position of the tool, (3,) [m], with the lift at 0."""
        return scara.tool_position(self._arm, [*q[:3], 0.0])

    def edges(self, _q: Sequence[float]) -> Edges:
        """The stretched and the folded arm."""
        return scara_edges(self._arm)

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Way along a line to the point nearest to the base [m]."""
        return [-float(p[:2] @ d[:2])]

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """The three angles with the elbow and the yaw of ``like``; NaN out of reach."""
        return scara.inverse_kinematics(self._arm, [p[0], p[1], sum(like)], like=like)


Families = LegFamilies | ScaraFamilies


def families_of(geometry: object) -> Families | None:
    """Named families of what ``of_robot.geometry_of`` tells; None where none has a name."""
    match geometry:
        case LegGeometry():
            return LegFamilies(geometry)
        case ScaraGeometry():
            return ScaraFamilies(geometry)
    return None


def singular_words(geometry: object, q: Sequence[float] | Array, nearly: str = "nearly ") -> str:
    """Say which singularity is near, such as "the leg is nearly stretched".

    Parameters
    ----------
    geometry : LegGeometry, ScaraGeometry or None
        What is known of the robot.
    q : (n,) sequence of float
        Joint positions [rad or m].
    nearly : str
        Put before what it is; empty at the singularity itself.
    """
    families = families_of(geometry)
    return f"the robot is {nearly}singular" if families is None else families.words(list(q), nearly)


def facing(geometry: LegGeometry, q: Sequence[float] | Array) -> float:
    """+1 with the foot in front of the hip axis, -1 behind it."""
    _, q2, q3 = one_vector("q", q, 3).tolist()
    reach = geometry.l1 + geometry.l2 * np.cos(q2) + geometry.l3 * np.cos(q2 + q3)
    return 1.0 if reach >= 0.0 else -1.0
