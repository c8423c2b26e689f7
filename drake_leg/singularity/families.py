"""The named singular families, the workspace boundaries they form, and distances to them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import leg, scara
from drake_leg.kinematics.khalil import Array, one_vector
from drake_leg.kinematics.leg import LegGeometry, foot_position
from drake_leg.kinematics.roots import sign_change
from drake_leg.kinematics.scara import ScaraGeometry

Family = Literal["stretch", "hip-axis"]
Path = Callable[[Array], Array]  # parameters (n,) -> points (n, 3), [m]

TOUCH = 1e-12  # of the arm's length: a path meets a boundary if it comes nearer than this
NEAR = 0.02  # of the arm's length: a path's minimum is refined if it comes nearer than this


class Edge(NamedTuple):
    """One boundary of a workspace."""

    family: Family
    clearance: Callable[[Array], Array]  # points (n, 3) -> distance (n,), inside > 0


@dataclass(frozen=True, kw_only=True)
class Edges:
    """The boundaries of the part of the workspace that a foot is in."""

    all: tuple[Edge, ...]
    size: float  # [m], length of the stretched arm


class Approach(NamedTuple):
    """Where a path comes nearest to a boundary, or first meets it."""

    parameter: float  # of the path
    family: Family
    clearance: float  # [m]


def _from_axis(p: Array) -> Array:
    """Distances of points from the base's z axis [m]."""
    return np.hypot(p[:, 0], p[:, 1])


def _flat_arm(a: float, b: float, distance: Callable[[Array], Array]) -> tuple[Edge, Edge]:
    return (
        Edge("stretch", lambda p: a + b - distance(p)),
        Edge("stretch", lambda p: distance(p) - abs(a - b)),
    )


def line(p: Array, d: Array) -> Path:
    """Straight path from p (3,) [m] along a unit vector d; its parameter is a distance [m]."""
    return lambda ways: p + np.multiply.outer(ways, d)


def approaches(edges: Edges, path: Path, breaks: Sequence[float] | Array) -> list[Approach]:
    """Find where a path first meets each boundary, with a clearance of 0 or less, or comes nearest.

    ``breaks`` (n,) are increasing parameters from the beginning to the end of the path, so close to
    each other that no clearance has more than one extremum between two of them.
    """
    found = []
    for family, clearance in edges.all:

        def at(parameter: float, clearance: Callable[[Array], Array] = clearance) -> float:
            return float(clearance(path(np.array([parameter])))[0])

        places = np.asarray(breaks, dtype=np.float64)
        heights = clearance(path(places))
        places, heights = _with_minima(at, places, heights, NEAR * edges.size)
        touching = np.flatnonzero(heights <= TOUCH * edges.size)
        if not len(touching):
            nearest = int(heights.argmin())
            found.append(Approach(float(places[nearest]), family, float(heights[nearest])))
            continue
        first = int(touching[0])
        place = float(places[first])
        if first > 0 and heights[first] < 0.0:
            place = sign_change(at, places[first - 1], place)
        found.append(Approach(place, family, min(float(heights[first:].min()), 0.0)))
    return found


def _with_minima(
    at: Callable[[float], float], places: Array, heights: Array, near: float
) -> tuple[Array, Array]:
    """Add the low minima between the places."""
    lower = (heights[1:-1] <= heights[:-2]) & (heights[1:-1] <= heights[2:])
    low = np.flatnonzero(lower & (heights[1:-1] < near) & (heights[1:-1] > 0.0)) + 1
    if not len(low):
        return places, heights
    from scipy.optimize import minimize_scalar  # slow to load, and seldom needed

    added = []
    for index in low:
        bounds = (places[index - 1], places[index + 1])
        width = 1e-15 * (bounds[1] - bounds[0])
        best = minimize_scalar(at, bounds=bounds, method="bounded", options={"xatol": width}).x
        added.append(float(best))
    every = np.concatenate([places, added])
    order = np.argsort(every, kind="stable")
    return every[order], np.concatenate([heights, [at(place) for place in added]])[order]


def breaks_of_line(extremes: Sequence[float], end: float) -> Array:
    """The extremes within a line, sorted, with its beginning at 0 and its end [m]."""
    inside = sorted(way for way in extremes if math.isfinite(way) and 0.0 < way < end)
    return np.array([0.0, *inside, end])


@dataclass(frozen=True, kw_only=True)
class Nearness:
    """Distance of a posture from a singular family."""

    family: Family
    measure: float  # 0 on the family, 1 farthest from it
    meaning: str  # the measure in words


class LegFamilies:
    """The families of the hexabot's leg: ``stretch`` and ``hip-axis``.

    The leg is stretched or folded where ``sin q3 = 0``; its other singular postures have the foot
    on the hip axis.
    """

    moved = "the foot's translation"

    def __init__(self, geometry: LegGeometry) -> None:
        self._leg = geometry

    def nearness(self, q: Sequence[float]) -> tuple[Nearness, ...]:
        """Distances of a posture from both families, the nearest first."""
        length = self._leg.l1 + self._leg.l2 + self._leg.l3
        bend, reach = abs(math.sin(q[2])), abs(float(leg.foot_reach(self._leg, q)))
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
        """The nearest family in words, such as "the leg is nearly stretched"."""
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
        """The stretched and the folded leg and the hip axis, on the side where the foot is.

        Seen from the knee, ``sqrt((h - l1)^2 + z^2)`` away with ``h = sqrt(x^2 + y^2)``, negative
        behind the hip axis, the foot is farthest on the stretched leg, at ``l2 + l3``, and nearest
        on the folded one, at ``|l2 - l3|``. On the hip axis ``h = 0``.
        """
        l1, l2, l3, side = self._leg.l1, self._leg.l2, self._leg.l3, facing(self._leg, q)

        def from_knee(p: Array) -> Array:
            return np.hypot(side * _from_axis(p) - l1, p[:, 2])

        edges = (*_flat_arm(l2, l3, from_knee), Edge("hip-axis", _from_axis))
        return Edges(all=edges, size=l1 + l2 + l3)

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Distances along a line from p in direction d at which a clearance may be extreme [m].

        With ``T = |p + s d|^2`` and ``H = h^2`` the distance from the knee is stationary where
        ``T' = l1 H' / h`` or, behind the hip axis, its negative: a quartic, ``T'^2 H = l1^2 H'^2``.
        Among them are all extremes on either side of the axis, and the point nearest to it.
        """
        a, b, c = d[0] ** 2 + d[1] ** 2, 2.0 * (p[0] * d[0] + p[1] * d[1]), p[0] ** 2 + p[1] ** 2
        slope_T, slope_H = np.array([2.0, 2.0 * float(p @ d)]), np.array([2.0 * a, b])
        quartic = np.convolve(np.convolve(slope_T, slope_T), [a, b, c])
        quartic[2:] -= self._leg.l1**2 * np.convolve(slope_H, slope_H)
        nearest = [] if a == 0.0 else [-float(b / a) / 2.0]
        return [*np.roots(quartic).real.tolist(), *nearest]

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """Joint angles (3,) on the branch of ``like``; NaN out of reach."""
        return leg.inverse_kinematics(self._leg, p, like=like)


class ScaraFamilies:
    """The only family of the SCARA in its plane: ``stretch``, where ``sin q2 = 0``."""

    moved = "the tool's horizontal motion"

    def __init__(self, geometry: ScaraGeometry) -> None:
        self._arm = geometry

    def nearness(self, q: Sequence[float]) -> tuple[Nearness, ...]:
        """Distance of a posture from the family."""
        measure = abs(math.sin(q[1]))
        meaning = f"|sin q2| = {measure:.4g}; the arm is stretched or folded at 0"
        return (Nearness(family="stretch", measure=measure, meaning=meaning),)

    def words(self, q: Sequence[float], nearly: str) -> str:
        """The family in words, such as "the arm is nearly stretched"."""
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
        l1, l2 = self._arm.l1, self._arm.l2
        return Edges(all=_flat_arm(l1, l2, _from_axis), size=l1 + l2)

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Distance along a line to the point nearest to the base [m]."""
        return [-float(p[:2] @ d[:2])]

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """The three angles with the elbow and the yaw of ``like``; NaN out of reach."""
        return scara.inverse_kinematics(self._arm, [p[0], p[1], sum(like)], like=like)


Families = LegFamilies | ScaraFamilies


def families_of(geometry: object) -> Families | None:
    """Named families of a geometry from ``chain.geometry_of``; None if it has none."""
    match geometry:
        case LegGeometry():
            return LegFamilies(geometry)
        case ScaraGeometry():
            return ScaraFamilies(geometry)
    return None


def singular_words(geometry: object, q: Sequence[float] | Array, nearly: str = "nearly ") -> str:
    """The nearest singularity in words, such as "the leg is nearly stretched".

    The word ``nearly`` is empty at the singularity itself; q (n,) is in rad or m.
    """
    families = families_of(geometry)
    return f"the robot is {nearly}singular" if families is None else families.words(list(q), nearly)


def facing(geometry: LegGeometry, q: Sequence[float] | Array) -> float:
    """+1 with the foot in front of the hip axis, -1 behind it."""
    return 1.0 if leg.foot_reach(geometry, one_vector("q", q, 3)) >= 0.0 else -1.0


def hip_axis_arcs(leg: LegGeometry, samples: int = 181) -> tuple[Array, ...]:
    """Knee and ankle angles with which the foot is on the hip axis, as arcs (samples, 2) [rad].

    ``l1 + l2 cos q2 + l3 cos(q2 + q3) == 0`` for each of them. They are continuous along an arc and
    not wrapped: both signs of q2, both of q2 + q3. There are none where the leg is too short to
    reach its hip axis. MATLAB lists them as solutions after the first (report A, appendix).
    """
    if samples < 2:
        raise InvalidValueError(f"there are {samples} samples of an arc; it takes at least 2")
    least, greatest = (-leg.l3 - leg.l1) / leg.l2, (leg.l3 - leg.l1) / leg.l2
    if greatest < -1.0:
        return ()
    from_, to = math.acos(min(greatest, 1.0)), math.acos(max(least, -1.0))
    knee = np.linspace(from_, to, samples)
    across = np.arccos(np.clip(-(leg.l1 + leg.l2 * np.cos(knee)) / leg.l3, -1.0, 1.0))
    signs = [(a, b) for a in (1.0, -1.0) for b in (1.0, -1.0)]
    return tuple(np.column_stack([a * knee, b * across - a * knee]) for a, b in signs)


def stretched_feet(leg: LegGeometry, turns: Array, lean: Array) -> Array:
    """Feet of the stretched leg: a torus about the hip axis, of radii l1 and l2 + l3.

    Hip angles (m,) and knee angles (n,) [rad] make positions p_BF (n, m, 3) [m].
    """
    return _feet(leg, turns, lean, 0.0)


def folded_feet(leg: LegGeometry, turns: Array, lean: Array) -> Array:
    """Feet of the folded leg: as ``stretched_feet``, with radii l1 and ``|l2 - l3|``."""
    return _feet(leg, turns, lean, math.pi)


def _feet(leg: LegGeometry, turns: Array, lean: Array, ankle: float) -> Array:
    hip, knee = np.meshgrid(turns, lean)
    return foot_position(leg, np.stack([hip, knee, np.full_like(hip, ankle)], axis=-1))


def leaning_over(leg: LegGeometry) -> float:
    """Greatest knee angle [rad] at which the stretched leg has its foot in front of the hip.

    There both families meet, and the rank is 1. pi where the foot never is behind.
    """
    return math.acos(max(-leg.l1 / (leg.l2 + leg.l3), -1.0))


def axis_reach(leg: LegGeometry) -> tuple[float, float]:
    """Least and greatest distance from the hip at which the foot reaches the hip axis [m].

    They are the same above and below the hip. The least is 0 except for legs whose foot cannot come
    near the knee; both are 0 if the leg is too short to reach its hip axis.
    """
    reaches = (abs(leg.l2 - leg.l3), leg.l2 + leg.l3)
    near, far = (math.sqrt(max(reach**2 - leg.l1**2, 0.0)) for reach in reaches)
    return near, far
