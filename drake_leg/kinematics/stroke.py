"""How far a foot or a tool can go along a straight line before it meets a singularity."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.edges import (
    Approach,
    Family,
    approaches,
    breaks_of_line,
    leg_edges,
    leg_extremes,
    line,
    scara_edges,
)
from drake_leg.kinematics.leg import LegGeometry, foot_position
from drake_leg.kinematics.scara import ScaraGeometry, tool_position


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """The way along a line to the first singularity, or to a joint's limit."""

    length: float  # [m]
    family: Family | None  # which singular family is met there; None where it has no name
    joint: str | None = None  # whose limit comes first; None where none does


def leg_stroke(leg: LegGeometry, q: ArrayLike, direction: ArrayLike) -> Stroke:
    """Way of the foot from a posture along a direction to the first singularity.

    With the foot in front of the hip axis (reach > 0) the leg is stretched or folded where
    ``(h - l1)^2 + z^2 = (l2 +- l3)^2``, ``h = sqrt(x^2 + y^2)``; behind it l1 changes sign. Along
    a line the distance from the knee is extreme at the roots of a quartic in the way; between
    two of them it is monotonic, and crosses an edge at most once. A line that passes through the
    hip axis meets the other family there.

    Parameters
    ----------
    q : (3,) array_like
        Joint angles at the start [rad], not singular.
    direction : (3,) array_like
        Unit vector in the base frame.

    Returns
    -------
    Stroke
        Its length is at most ``2 (l1 + l2 + l3)``.

    Raises
    ------
    InvalidValueError
        If a shape is wrong, a value is not finite, or the direction is zero.
    """
    return _first(leg_approaches(leg, q, unit(direction), 3.0 * (leg.l1 + leg.l2 + leg.l3)))


def leg_approaches(leg: LegGeometry, q: ArrayLike, d: Array, end: float) -> list[Approach]:
    """Say how near the foot comes to each edge on a line from a posture.

    Parameters
    ----------
    q : (3,) array_like
        Joint angles at the start [rad].
    d : (3,) ndarray
        Unit vector in the base frame.
    end : float
        Length of the line [m].

    Returns
    -------
    list of Approach
        Its parameters are ways [m].
    """
    angles = one_vector("q", q, 3)
    p = foot_position(leg, angles)
    breaks = breaks_of_line(leg_extremes(leg, p, d), end)
    return approaches(leg_edges(leg, facing(leg, angles)), line(p, d), breaks)


def facing(leg: LegGeometry, q: ArrayLike) -> float:
    """Tell whether the foot is in front of the hip axis or behind it.

    Parameters
    ----------
    q : (3,) array_like
        Joint angles [rad].
    """
    _, q2, q3 = one_vector("q", q, 3).tolist()
    reach = leg.l1 + leg.l2 * math.cos(q2) + leg.l3 * math.cos(q2 + q3)
    return 1.0 if reach >= 0.0 else -1.0


def scara_approaches(arm: ScaraGeometry, q: ArrayLike, d: Array, end: float) -> list[Approach]:
    """Say how near the tool comes to each edge on a horizontal line from a posture.

    Parameters
    ----------
    q : (3,) array_like
        The three angles at the start [rad].
    d : (3,) ndarray
        Horizontal unit vector in the base frame.
    end : float
        Length of the line [m].

    Returns
    -------
    list of Approach
        Its parameters are ways [m].
    """
    angles = one_vector("q", q, 3)
    p = tool_position(arm, [*angles, 0.0])
    nearest = -float(p[:2] @ d[:2])
    return approaches(scara_edges(arm), line(p, d), breaks_of_line([nearest], end))


def _first(met: list[Approach]) -> Stroke:
    """Return the way to the first meeting: a line that is long enough has one."""
    first = min(
        (approach for approach in met if approach.clearance <= 0.0),
        key=lambda approach: approach.parameter,
    )
    return Stroke(length=first.parameter, family=first.family)


def scara_stroke(arm: ScaraGeometry, q: ArrayLike, direction: ArrayLike) -> Stroke:
    """Way of the tool from a posture along a horizontal direction to the stretched or folded arm.

    ``|p + s d| = l1 + l2`` or ``|l1 - l2|``.

    Parameters
    ----------
    q : (3,) array_like
        The three angles at the start [rad], not singular.
    direction : (3,) array_like
        Unit vector in the base frame; its third number is zero.

    Raises
    ------
    InvalidValueError
        If a shape is wrong, a value is not finite, or the direction is zero or not horizontal.
    """
    d = unit(direction)
    if d[2] != 0.0:
        raise InvalidValueError(
            f"the direction is {d.tolist()}; a SCARA's stroke is horizontal (third number 0)"
        )
    return _first(scara_approaches(arm, q, d, 3.0 * (arm.l1 + arm.l2)))


def greatest_amplitude(stroke: Stroke, frequency: float) -> float:
    """Greatest speed of a sine whose stroke ``2 A / w`` stays inside.

    Parameters
    ----------
    stroke : Stroke
        In the direction of the motion.
    frequency : float
        w [rad/s].

    Returns
    -------
    float
        A [m/s].
    """
    return stroke.length * frequency / 2.0


def unit(direction: ArrayLike) -> Array:
    """Give a direction length 1.

    Parameters
    ----------
    direction : (3,) array_like
        Of any length but zero.

    Returns
    -------
    (3,) ndarray

    Raises
    ------
    InvalidValueError
        If it is zero or not finite.
    """
    d = one_vector("the direction", direction, 3)
    greatest = float(np.abs(d).max())
    if greatest == 0.0:
        raise InvalidValueError("the direction is zero; it must point somewhere, as 1,0,0")
    scaled = d / greatest
    one: Array = scaled / np.linalg.norm(scaled)
    return one
