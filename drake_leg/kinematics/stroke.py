"""How far a foot or a tool can go along a straight line before it meets a singularity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.khalil import foot_pose, jacobian, moving_rows
from drake_leg.kinematics.leg import LegGeometry, foot_position
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.robot import Row

Family = Literal["stretch", "hip-axis"]

ON_AXIS = 1e-12  # of the leg's length: a line that passes the hip axis closer than this meets it
CHAIN_STEPS = 200  # steps of a numerical stroke over the length of the chain
CHAIN_RESOLUTION = 1e-10  # smallest step, of the length of the chain
LARGEST_CHANGE = 0.5  # [rad or m] of a joint in one step; more is a jump to another branch
NEWTON_STEPS = 20
TANGENT = 1e-7  # relative imaginary part below which a pair of roots counts as one that touches


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """The way to the first singularity along a line."""

    length: float  # [m]
    family: Family | None  # which singular family is met there; None where it has no name


def leg_stroke(leg: LegGeometry, q: ArrayLike, direction: ArrayLike) -> Stroke:
    """Way of the foot from a posture along a direction to the first singularity.

    With the foot in front of the hip axis (reach > 0) the leg is stretched or folded where
    ``(h - l1)^2 + z^2 = (l2 +- l3)^2``, ``h = sqrt(x^2 + y^2)``; behind it l1 changes sign. Along
    a line this is a quartic in the way, solved for its smallest positive root. A line that
    passes through the hip axis meets the other family there.

    Parameters
    ----------
    leg : LegGeometry
        Lengths and variant.
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
    angles = one_vector("q", q, 3)
    d = _unit(direction)
    p = foot_position(leg, angles)
    reach = leg.l1 + leg.l2 * math.cos(angles[1]) + leg.l3 * math.cos(angles[1] + angles[2])
    facing = 1.0 if reach >= 0.0 else -1.0
    found = [Stroke(length=s, family="stretch") for s in _boundary_crossings(leg, p, d, facing)]
    found += [Stroke(length=s, family="hip-axis") for s in _axis_crossings(leg, p, d)]
    on_it = Stroke(length=0.0, family="stretch")  # no way is left where the start is singular
    return min(found, key=lambda stroke: stroke.length, default=on_it)


def _boundary_crossings(leg: LegGeometry, p: Array, d: Array, facing: float) -> list[float]:
    """Solve ``(h^2 + z^2 + l1^2 - R^2)^2 = 4 l1^2 h^2`` on the given side of the hip axis."""
    h2 = np.array([d[0] ** 2 + d[1] ** 2, 2.0 * (p[0] * d[0] + p[1] * d[1]), p[0] ** 2 + p[1] ** 2])
    crossings = []
    for radius in (leg.l2 + leg.l3, abs(leg.l2 - leg.l3)):
        total = np.array([1.0, 2.0 * float(p @ d), float(p @ p) + leg.l1**2 - radius**2])
        quartic = np.polysub(np.polymul(total, total), 4.0 * leg.l1**2 * h2)
        for root in np.roots(quartic):
            if abs(root.imag) > TANGENT * (abs(root) + leg.l1) or root.real <= 0.0:
                continue
            s = _polished(leg, p, d, facing, radius, float(root.real))
            if s is not None:
                crossings.append(s)
    return crossings


def _polished(
    leg: LegGeometry, p: Array, d: Array, facing: float, radius: float, s: float
) -> float | None:
    """Refine a root by Newton's method on the distance; None if it is on the other side."""
    for _ in range(NEWTON_STEPS):
        x, y, z = p + s * d
        h = math.hypot(x, y)
        u = facing * h - leg.l1
        distance = math.hypot(u, z)
        if h == 0.0 or distance == 0.0:
            break
        slope = (u * facing * (x * d[0] + y * d[1]) / h + z * d[2]) / distance
        if abs(slope) < 1e-9:
            break
        change = float((distance - radius) / slope)
        s -= change
        if abs(change) < 1e-15 * leg.l1:
            break
    x, y, z = p + s * d
    miss = abs(math.hypot(facing * math.hypot(x, y) - leg.l1, z) - radius)
    return s if s > 0.0 and miss < 1e-9 * (leg.l1 + leg.l2 + leg.l3) else None


def _axis_crossings(leg: LegGeometry, p: Array, d: Array) -> list[float]:
    horizontal = d[0] ** 2 + d[1] ** 2
    if horizontal == 0.0:
        return []
    s = -float(p[0] * d[0] + p[1] * d[1]) / horizontal
    nearest = math.hypot(p[0] + s * d[0], p[1] + s * d[1])
    met = s > 0.0 and nearest <= ON_AXIS * (leg.l1 + leg.l2 + leg.l3)
    return [s] if met else []


def scara_stroke(arm: ScaraGeometry, q: ArrayLike, direction: ArrayLike) -> Stroke:
    """Way of the tool from a posture along a horizontal direction to the stretched or folded arm.

    ``|p + s d| = l1 + l2`` or ``|l1 - l2|``.

    Parameters
    ----------
    arm : ScaraGeometry
        Lengths.
    q : (3,) array_like
        The three angles at the start [rad], not singular.
    direction : (3,) array_like
        Unit vector in the base frame; its third number is zero.

    Returns
    -------
    Stroke

    Raises
    ------
    InvalidValueError
        If a shape is wrong, a value is not finite, or the direction is zero or not horizontal.
    """
    angles = one_vector("q", q, 3)
    d = _unit(direction)
    if d[2] != 0.0:
        raise InvalidValueError(
            f"the direction is {d.tolist()}; a SCARA's stroke is horizontal (third number 0)"
        )
    q1, q12 = angles[0], angles[0] + angles[1]
    p = np.array(
        [
            arm.l1 * math.cos(q1) + arm.l2 * math.cos(q12),
            arm.l1 * math.sin(q1) + arm.l2 * math.sin(q12),
        ]
    )
    along = float(p @ d[:2])
    lengths = []
    for radius in (arm.l1 + arm.l2, abs(arm.l1 - arm.l2)):
        discriminant = along**2 - float(p @ p) + radius**2
        if discriminant >= 0.0:
            roots = (-along - math.sqrt(discriminant), -along + math.sqrt(discriminant))
            lengths += [root for root in roots if root > 0.0]
    return Stroke(length=min(lengths, default=0.0), family="stretch")


def chain_stroke(rows: Sequence[Row], q: ArrayLike, direction: ArrayLike) -> Stroke:
    """Way of any three-joint chain's foot along a direction to the first singularity, numerically.

    The posture is followed along the line in small steps, each closed by Newton's method, until
    a step fails or the determinant changes its sign; the last step is then bisected.

    Parameters
    ----------
    rows : sequence of Row
        The table; three rows move.
    q : (3,) array_like
        Joint positions at the start [rad or m], not singular.
    direction : (3,) array_like
        Unit vector in the base frame.

    Returns
    -------
    Stroke
        Of no named family; infinite where no singularity is met within ten times the chain's
        length.

    Raises
    ------
    InvalidValueError
        If the chain has not three joints, a shape is wrong or a value is not finite.
    """
    if len(moving_rows(rows)) != 3:
        raise InvalidValueError(
            f"the chain has {len(moving_rows(rows))} joints; a stroke needs exactly three"
        )
    d = _unit(direction)
    posture = one_vector("q", q, 3)
    start = foot_pose(rows, posture)[:3, 3]
    size = sum(math.hypot(row.d, row.r) for row in rows) or 1.0
    way, step = 0.0, size / CHAIN_STEPS
    sign = np.sign(np.linalg.det(jacobian(rows, posture)[3:]))
    while way < 10.0 * size:
        closed = _closed(rows, posture, start + (way + step) * d, step)
        if closed is None or np.sign(np.linalg.det(jacobian(rows, closed)[3:])) != sign:
            step /= 2.0
            if step < CHAIN_RESOLUTION * size:
                return Stroke(length=way, family=None)
        else:
            way, posture = way + step, closed
            step = min(2.0 * step, size / CHAIN_STEPS)
    return Stroke(length=math.inf, family=None)


def _closed(rows: Sequence[Row], q: Array, goal: Array, step: float) -> Array | None:
    """Move the foot onto the goal by Newton's method; None where that fails or jumps."""
    posture = q.copy()
    for _ in range(12):
        miss = goal - foot_pose(rows, posture)[:3, 3]
        if float(np.abs(miss).max()) < 1e-14:
            break
        try:
            change = np.linalg.solve(jacobian(rows, posture)[3:], miss)
        except np.linalg.LinAlgError:
            return None
        if float(np.abs(change).max()) > LARGEST_CHANGE:
            return None
        posture = posture + change
    reached = float(np.abs(goal - foot_pose(rows, posture)[:3, 3]).max()) < 1e-6 * step
    return posture if reached else None


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


def _unit(direction: ArrayLike) -> Array:
    d = one_vector("the direction", direction, 3)
    greatest = float(np.abs(d).max())
    if greatest == 0.0:
        raise InvalidValueError("the direction is zero; it must point somewhere, as 1,0,0")
    scaled = d / greatest
    unit: Array = scaled / np.linalg.norm(scaled)
    return unit
