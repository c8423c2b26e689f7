"""How far and in which directions a foot can move straight before a singularity or limit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.chain import (
    RANK_TOLERANCE,
    MovableChain,
    foot_frame,
    joints_in_words,
    twist_between,
)
from drake_leg.kinematics.khalil import Array, Frame, chain_length, moving_rows, one_vector
from drake_leg.kinematics.movable import TRANSLATION, Movable
from drake_leg.robot.robot import Robot, Row
from drake_leg.singularity.families import (
    Approach,
    Families,
    Family,
    ScaraFamilies,
    approaches,
    breaks_of_line,
    line,
)
from drake_leg.units import AT_LIMIT

CHAIN_STEPS = 200  # steps of a numerical stroke over the length of the chain
CHAIN_RESOLUTION = 1e-10  # smallest step, of the length of the chain
LARGEST_CHANGE = 0.5  # [rad or m] of a joint in one step; a larger one jumps to another branch
ROUNDING = 1e-13  # of the length of the chain: least achievable miss of a goal
FARTHEST = 10.0  # of the length of the chain: the longest search by default

STRAIGHT = 1e-3  # of the robot's length: distance that a foot must be able to move straight
OUTSIDE = 1e-5  # of a direction's length: tolerated part outside the foot's motions


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """Distance along a line to the first singularity or joint limit."""

    length: float  # [m]
    family: Family | None  # that ends it; None if unnamed
    joint: str | None = None  # whose limit ends it; None if none does


def closed_stroke(families: Families, q: ArrayLike, direction: ArrayLike) -> Stroke:
    """Distance from a posture along a direction to the first singularity, in closed form.

    Along a line the distances from the boundaries have their extremes at known places, for a leg
    the roots of a quartic; between two of them a boundary is crossed at most once. The angles (3,)
    [rad] at the start are not singular; the direction (3,), in the base frame, is horizontal for a
    SCARA. A stroke is at most twice as long as the stretched arm.
    """
    d, angles = unit(direction), one_vector("q", q, 3).tolist()
    if isinstance(families, ScaraFamilies) and d[2] != 0.0:
        raise InvalidValueError(
            f"the direction is {d.tolist()}; a SCARA's stroke is horizontal (third number 0)"
        )
    longest = 3.0 * families.edges(angles).size
    met = approaches_on_line(families, angles, families.foot(angles), d, longest)
    first = min(
        (approach for approach in met if approach.clearance <= 0.0),
        key=lambda approach: approach.parameter,
    )
    return Stroke(length=first.parameter, family=first.family)


def approaches_on_line(
    families: Families, q: Sequence[float], p: Array, d: Array, end: float
) -> list[Approach]:
    """Approaches of the foot to each boundary on a line; parameters are distances [m].

    It starts at p (3,) [m], at the joint angles q (3,) [rad], and goes along the unit vector d,
    both in the base frame, to a distance ``end`` [m].
    """
    breaks = breaks_of_line(families.extremes(p, d), end)
    return approaches(families.edges(q), line(p, d), breaks)


def greatest_amplitude(stroke: Stroke, frequency: float) -> float:
    """Greatest speed A [m/s] of a sine of frequency w [rad/s] that spans a stroke: ``2 A / w``."""
    return stroke.length * frequency / 2.0


def unit(direction: ArrayLike) -> Array:
    """Normalise a direction (3,), which must be finite and not zero."""
    d = one_vector("the direction", direction, 3)
    greatest = float(np.abs(d).max())
    if greatest == 0.0:
        raise InvalidValueError("the direction is zero; it must point somewhere, as (1, 0, 0)")
    scaled = d / greatest
    one: Array = scaled / np.linalg.norm(scaled)
    return one


def signed(vector: Array, rounding: float) -> Array:
    """Flip a vector if its first nonzero component is negative."""
    cleaned = np.where(np.abs(vector) < rounding, 0.0, vector)
    flipped: Array = np.sign(cleaned[np.flatnonzero(cleaned)[0]]) * cleaned + 0.0
    return flipped


class ChainStroke(NamedTuple):
    """A stroke found numerically, and the posture where it ends."""

    stroke: Stroke
    q: Array  # (n,), [rad or m], just before its end


def chain_stroke(
    rows: Sequence[Row],
    q: ArrayLike,
    direction: ArrayLike,
    *,
    moved: Movable | None = None,
    farthest: float | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
) -> ChainStroke:
    """Distance of any chain's foot along a direction to a singularity or joint limit, numerically.

    The posture is followed along the line in small steps, each closed by Newton's method, until
    a step fails, the determinant changes its sign or a joint passes a limit; the last step is then
    bisected. A redundant chain takes the smallest joint rates. The start q (n,) [rad or m] is not
    singular; the direction (3,) is in the base frame. The foot's translation is moved by default,
    and at most ten times the chain's length is searched. ``limits`` maps the name of every moving
    joint, in order, to its lower and upper limit [rad or m], which may be infinite. The stroke is
    infinite where nothing ends it.
    """
    d = unit(direction)
    posture = one_vector("q", q, len(moving_rows(rows)))
    moved = moved or MovableChain(tuple(rows), TRANSLATION)
    x, y, z, foot = foot_frame(rows, posture.tolist())
    size = chain_length(rows)
    longest = max(size, farthest or 0.0) / CHAIN_STEPS
    farthest = FARTHEST * size if farthest is None else farthest
    names = list(limits or ())
    low, high = _room(moved, posture, d * size, limits)
    way, step = 0.0, longest
    sign = np.sign(moved.determinant(posture.tolist()))
    while way < farthest:
        goal: Frame = (x, y, z, tuple(foot + (way + step) * d))
        closed = _closed(rows, moved, posture, goal, step * d)
        if closed is not None and np.sign(moved.determinant(closed.tolist())) != sign:
            closed = None
        past = [] if closed is None else np.flatnonzero((closed < low) | (closed > high)).tolist()
        if closed is None or past:
            step /= 2.0
            if step < CHAIN_RESOLUTION * size:
                joint = names[past[0]] if past else None
                return ChainStroke(Stroke(length=way, family=None, joint=joint), posture)
        else:
            way, posture = way + step, closed
            step = min(2.0 * step, longest)
    return ChainStroke(Stroke(length=math.inf, family=None), posture)


def _room(
    moved: Movable, q: Array, way: Array, limits: Mapping[str, tuple[float, float]] | None
) -> tuple[Array, Array]:
    """Range of each joint: one that does not move may be at its limit."""
    if limits is None:
        return np.full_like(q, -math.inf), np.full_like(q, math.inf)
    low, high = np.array(list(limits.values())).T
    moves = np.linalg.pinv(moved.jacobian(q.tolist())) @ moved.command(way)
    slack = np.where(np.abs(moves) < AT_LIMIT, AT_LIMIT, 0.0)
    return np.minimum(low, q - slack), np.maximum(high, q + slack)


def _closed(rows: Sequence[Row], moved: Movable, q: Array, goal: Frame, way: Array) -> Array | None:
    """Bring the foot to the goal by Newton's method; None where that fails or jumps."""
    try:
        posture = _ahead(moved, q, moved.command(way)) if moved.is_redundant else q.copy()
        for _ in range(12):
            miss = moved.twists.T @ twist_between(foot_frame(rows, posture.tolist()), goal)
            if float(np.abs(miss).max()) < 1e-14:
                break
            change = np.array(moved.rates(posture.tolist(), miss.tolist()))
            if float(np.abs(change).max()) > LARGEST_CHANGE:
                return None
            posture = posture + change
    except SingularConfigurationError:
        return None
    translation = twist_between(foot_frame(rows, posture.tolist()), goal)[3:]
    enough = max(1e-6 * float(np.linalg.norm(way)), ROUNDING * chain_length(rows))
    return posture if float(np.abs(translation).max()) < enough else None


def _ahead(moved: Movable, q: Array, v: Array) -> Array:
    """Follow the smallest rates for a step by the midpoint rule, before Newton's method."""
    half = 0.5 * np.array(moved.rates(q.tolist(), v.tolist()))
    there = q + half * min(1.0, LARGEST_CHANGE / float(np.abs(half).max() or 1.0))
    ahead: Array = q + np.array(moved.rates(there.tolist(), v.tolist()))
    return ahead


def first_direction(
    robot: Robot, moved: Movable, q0: Sequence[float]
) -> tuple[float, float, float]:
    """First of x, y, z along which the foot can move from q0, or else another unit vector."""
    U, _, _ = np.linalg.svd(moved.twists[3:])
    commanded = (one for one in np.eye(3) if _is_commanded(moved, one))
    ways = (one for one in commanded if _straight(robot, moved, q0, one))
    x, y, z = next(ways, U[:, 0]).tolist()
    return x, y, z


def require_direction(
    robot: Robot, moved: Movable, q0: Sequence[float], direction: Sequence[float]
) -> None:
    """Refuse a direction (unit vector) along which the foot cannot be moved straight from q0."""
    if not _is_commanded(moved, np.asarray(direction)):
        where = "at q0 " if moved.varies else ""
        raise InvalidValueError(
            f"{where}the foot of {robot.name!r} {motion_in_words(moved)}: it cannot go along "
            f"{_vector(np.asarray(direction))}",
            advice="choose another `direction`",
        )
    if not _straight(robot, moved, q0, direction):
        raise InvalidValueError(
            f"{robot.name!r} takes its foot along a curve with its {joints_in_words(robot)}: "
            f"from q0 it cannot go straight along {_vector(np.asarray(direction))}",
            advice="choose another `direction`, or a robot with more joints",
        )


def _straight(
    robot: Robot, moved: Movable, q0: Sequence[float], direction: Sequence[float] | Array
) -> bool:
    """Whether a foot that starts along a direction stays on the line."""
    if not moved.varies:
        return True
    enough = STRAIGHT * chain_length(robot.rows)
    way = chain_stroke(robot.rows, q0, direction, moved=moved, farthest=enough).stroke
    return way.length > enough


def _is_commanded(moved: Movable, direction: Array) -> bool:
    wanted = np.concatenate([np.zeros(3), direction])
    outside = wanted - moved.twists @ (moved.twists.T @ wanted)
    return float(np.linalg.norm(outside)) <= OUTSIDE


def motion_in_words(moved: Movable) -> str:
    """Translations that can be commanded, in words, such as "moves along (0, 0, 1) only"."""
    U, sigma, _ = np.linalg.svd(moved.twists[3:])
    rank = int((sigma > RANK_TOLERANCE).sum())
    if rank == 1:
        return f"moves along {_vector(U[:, 0])} only"
    if rank == 2:
        return f"moves in the plane at right angles to {_vector(U[:, 2])} only"
    return "moves along x, y and z"


def _vector(direction: Array) -> str:
    x, y, z = (round(float(part), 6) + 0.0 for part in direction)
    return f"({x:g}, {y:g}, {z:g})"
