"""Examines a posture before any simulation: rank, nearest singularities, strokes, limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import (
    RANK_TOLERANCE,
    freedoms,
    geometry_of,
    joint_positions,
    movable,
)
from drake_leg.kinematics.euler import euler_angles
from drake_leg.kinematics.feet import Feet, Solution, feet, lift_limits, limits_of
from drake_leg.kinematics.khalil import Array, chain_length, foot_pose, jacobian, moving_rows
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.robot.robot import Robot, Row, Segment, html_table, require_robot
from drake_leg.robot.tree import require_one_foot
from drake_leg.singularity.families import Families, Nearness, families_of
from drake_leg.singularity.stroke import (
    STRAIGHT,
    Stroke,
    chain_stroke,
    closed_stroke,
    greatest_amplitude,
    signed,
    unit,
)
from drake_leg.units import beyond, require_positive

ROUNDING = 1e-13  # of the length: singular values below it are zero


@dataclass(frozen=True, kw_only=True)
class RankReport:
    """Rank, singular values and lost directions of a Jacobian."""

    rank: int
    full_rank: int  # the rank that it has elsewhere: its smaller dimension
    sigma_min: float  # smallest singular value, in the Jacobian's unit
    manipulability: float  # product of the singular values (Yoshikawa)
    lost_directions: Array  # (full_rank - rank, rows), orthonormal; empty at full rank


def examine(J: Array, least: float = 0.0) -> RankReport:
    """Rank and lost directions of a Jacobian (m, n) whose rows have the same unit.

    Singular values below ``least`` count as zero. A lost direction is one in which no
    joint rate moves the foot; its first component that is not zero is positive.
    """
    U, sigma, _ = np.linalg.svd(J)
    smaller = len(sigma)
    rank = int((sigma > max(RANK_TOLERANCE * sigma[0], least)).sum())
    lost = U[:, rank:smaller].T
    return RankReport(
        rank=rank,
        full_rank=smaller,
        sigma_min=float(sigma[-1]),
        manipulability=float(np.prod(sigma)),
        lost_directions=np.array([signed(row, 1e-12) for row in lost]).reshape(-1, len(J)),
    )


@dataclass(frozen=True, kw_only=True)
class LostTwist:
    """A motion of the foot that no joint rates produce in this posture, but do nearby."""

    turning: Array | None  # unit axis, about which the foot does not turn while it stays in place
    moving: Array | None  # unit vector, along which it does not move while it holds its orientation


@dataclass(frozen=True, kw_only=True)
class WholeRank:
    """Rank of the whole Jacobian, rotation and translation."""

    rank: int
    full_rank: int  # 6, or as many as there are joints
    sigma_min: float  # smallest of full_rank singular values, with the chain's length as unit
    lost: tuple[LostTwist, ...]


def examine_whole(rows: Sequence[Row], q: ArrayLike, length: float) -> WholeRank:
    """Rank of the whole Jacobian of a chain's foot, with ``length`` [m] as its unit.

    A motion counts as lost only if nearby postures have it.
    """
    posture = np.asarray(q, dtype=np.float64)
    unit = np.where([rows[index].joint == "revolute" for index in moving_rows(rows)], 1.0, length)

    def scaled(at: Array) -> Array:
        J: Array = jacobian(rows, at) * unit
        J[..., 3:, :] /= length
        return J

    U, sigma, _ = np.linalg.svd(scaled(posture))
    rank = int((sigma > RANK_TOLERANCE * sigma[0]).sum()) if sigma[0] > 0.0 else 0
    nothing = U[:, rank:]
    near = posture + 1e-3 * unit * np.random.default_rng(0).uniform(-1.0, 1.0, (8, len(posture)))
    regained = nothing.T @ np.hstack(list(scaled(near)))
    return WholeRank(
        rank=rank,
        full_rank=len(sigma),
        sigma_min=float(sigma[-1]),
        lost=_lost_twists(nothing, regained, len(sigma) - rank),
    )


def _lost_twists(nothing: Array, regained: Array, most: int) -> tuple[LostTwist, ...]:
    """Of the motions that no joint rates produce here, return those that nearby postures have."""
    if not most:
        return ()
    V, gain, _ = np.linalg.svd(regained, full_matrices=False)
    count = min(most, int((gain > 1e-6).sum()))
    lost = nothing @ V[:, :count]
    _, _, Wt = np.linalg.svd(lost[3:], full_matrices=False)  # separates pure rotations
    return tuple(
        LostTwist(turning=_axis(twist[:3]), moving=_axis(twist[3:])) for twist in (lost @ Wt.T).T
    )


def _axis(vector: Array) -> Array | None:
    """Direction of a vector, as ``signed``; None if the vector is zero to rounding."""
    size = float(np.linalg.norm(vector))
    return None if size < 1e-6 else signed(vector / size, 1e-9)


@dataclass(frozen=True, kw_only=True)
class Outside:
    """A joint outside its limits."""

    segment: Segment
    position: float  # [rad or m]

    @property
    def sentence(self) -> str:
        """The joint, its position and its limits, in words."""
        turning = self.segment.row.joint == "revolute"
        ((low, high),) = limits_of([self.segment])
        position, low, high = (
            math.degrees(value) if turning else value for value in (self.position, low, high)
        )
        unit = "deg" if turning else "m"
        return (
            f"joint {self.segment.joint} is at {position:.6g} {unit}, outside its limits "
            f"{low:.6g} ... {high:.6g} {unit}"
        )


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """All results of an examination of a posture; lengths in m, angles in rad."""

    position: tuple[float, float, float | None]  # of the foot; the height is None without the lift
    orientation: tuple[float, float, float]  # of the foot: roll, pitch, yaw about x, y, z
    moved: str  # the motion that the rank refers to: the foot's translation, or part of it
    rank: RankReport
    most_rank: int  # in any posture
    whole: WholeRank | None  # of the whole Jacobian; None where there are at most three joints
    nearness: tuple[Nearness, ...]  # nearest first; empty for a chain without named families
    outside: tuple[Outside, ...]
    holds_orientation: bool  # along the stroke
    forward: Stroke | None  # None where the posture is singular already
    backward: Stroke | None
    greatest_amplitude: float | None  # [m/s], at the given frequency
    feet: Feet | None  # the inverse kinematics; None if not requested

    @property
    def solutions(self) -> tuple[Solution, ...] | None:
        """Joint positions that put the foot at the requested point; None without one."""
        return None if self.feet is None else self.feet.solutions

    @property
    def entries(self) -> list[tuple[str, str]]:
        """Its results in words, each with its name, which is empty where the last one goes on."""
        lost = () if self.whole is None else self.whole.lost
        return [
            *_pose_entries(self),
            *_rank_entries(self),
            *((near.family, near.meaning + self._mark(near)) for near in self.nearness),
            *(("lost direction", _vector(row)) for row in self.rank.lost_directions),
            *(("lost twist", _twist(twist)) for twist in lost),
            *(("outside limits", outside.sentence) for outside in self.outside),
            *_stroke_entries(self),
        ]

    def _mark(self, near: Nearness) -> str:
        several = len(self.nearness) > 1
        return "   (nearest)" if several and near is self.nearness[0] else ""

    def __repr__(self) -> str:
        rank = f"rank {self.rank.rank} of {self.rank.full_rank}"
        nearest = f", nearest to {self.nearness[0].family}" if self.nearness else ""
        return f"<Diagnosis: {rank}{nearest}>"

    def _repr_html_(self) -> str:
        feet = [] if self.feet is None else feet_entries(self.feet)
        return html_table(
            ("result", "value"), [*self.entries, *feet], title="Examination of a posture"
        )

    def as_json(self) -> dict[str, Any]:
        """Return the numbers under the command line's keys, with angles in degrees."""
        lost = self.rank.lost_directions
        return {
            "foot_m": list(self.position),
            "foot_rpy_deg": [math.degrees(angle) for angle in self.orientation],
            "rank": self.rank.rank,
            "full_rank": self.rank.full_rank,
            "greatest_rank": self.most_rank,
            "sigma_min_m": self.rank.sigma_min,
            "manipulability": self.rank.manipulability,
            "whole_jacobian": self.whole and _whole_json(self.whole),
            "nearest_family": self.nearness[0].family if self.nearness else None,
            "lost_direction": lost[-1].tolist() if len(lost) else None,
            "outside_limits": [outside.sentence for outside in self.outside],
            "stroke_holds_orientation": self.holds_orientation,
            "stroke_forward_m": _finite(self.forward.length if self.forward else None),
            "stroke_forward_ends": _end(self.forward),
            "stroke_backward_m": _finite(self.backward.length if self.backward else None),
            "stroke_backward_ends": _end(self.backward),
            "max_amplitude_m_s": _finite(self.greatest_amplitude),
            **feet_json(self.feet),
        }


def feet_json(found: Feet | None) -> dict[str, Any]:
    """The inverse kinematics under the command line's keys, in degrees; empty lists for None."""
    solutions = found.solutions if found else ()
    units = list(found.units) if found else []
    turning = all(unit == "deg" for unit in units)
    return {
        "branches_heading": found and found.heading,
        "units": units,
        **({"branches_deg": [_typed(s.q, units) for s in solutions if s.q]} if turning else {}),
        "branches": [
            {
                "name": s.name,
                "q_deg" if turning else "q": _typed(s.q, units),
                "within_limits": s.within_limits,
            }
            for s in solutions
        ],
    }


def feet_entries(found: Feet) -> list[tuple[str, str]]:
    """The inverse kinematics in words, each solution with its name."""
    entries = [("inverse", found.heading)]
    for solution in found.solutions:
        where = "out of reach"
        if solution.q is not None:
            where = _shown(solution.q, found.units)
            where += "" if solution.within_limits else "   (outside the joints' limits)"
        entries.append((solution.name, where))
    return entries


def examine_posture(
    robot: Robot,
    q: Sequence[float],
    *,
    direction: Sequence[float] | None = None,
    frequency: float | None = None,
    foot: Sequence[float] | None = None,
    yaw: float | None = None,
    rpy: Sequence[float] | None = None,
) -> Diagnosis:
    """Examine a posture of a robot.

    Parameters
    ----------
    robot : Robot
        A leg, the SCARA, or any chain.
    q : (n,) sequence of float
        Joint positions [rad or m]; the SCARA's lift may be left out.
    direction : (3,) sequence of float, optional
        Of the stroke, in the base frame; x by default.
    frequency : float, optional
        Of the sine along the direction whose greatest amplitude is computed [rad/s]; 1 by default.
    foot : (3,) sequence of float, optional
        Point for the inverse kinematics [m].
    yaw, rpy : float and (3,) sequence of float, optional
        Orientation of the foot there, as in ``feet`` [rad].

    Returns
    -------
    Diagnosis
        Position of the foot, rank, singular values, strokes both ways and, where ``foot`` is
        given, the joint positions that put the foot there; lengths in m, angles in rad.

    Raises
    ------
    InvalidValueError
        If the number of joint positions is wrong, a value is invalid, or what goes with another
        argument is given without it.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import LEG_B, examine_posture
    >>> q = [radians(90), radians(-50), radians(-90)]
    >>> found = examine_posture(LEG_B, q, direction=(1, 0, 0))
    >>> found.rank.rank
    3
    >>> round(found.forward.length, 4), found.forward.family  # how far the foot can go [m]
    (0.1882, 'stretch')
    """
    require_robot(robot)
    require_one_foot(robot)
    if frequency is not None and direction is None:
        raise InvalidValueError("a frequency needs a direction", advice="give `direction`, too")
    for name, value in (("yaw", yaw), ("rpy", rpy)):
        if value is not None and foot is None:
            raise InvalidValueError(f"{name} goes with a point", advice="give `foot`, too")
    frequency = 1.0 if frequency is None else frequency
    require_positive("the frequency", frequency, "rad/s")
    way = (1.0, 0.0, 0.0) if direction is None else direction
    unit(way)  # refuses what is not a direction, even where there is no stroke
    geometry = geometry_of(robot)
    least = 3 if isinstance(geometry, ScaraGeometry) else None
    q = joint_positions("q", robot, q, least=least)
    families = families_of(geometry)
    lifted = _lifted(robot, q)
    X_BF = foot_pose(robot.rows, lifted)
    size = chain_length(robot.rows)
    J = families.translation_jacobian(q) if families else jacobian(robot.rows, lifted)[3:]
    rank = examine(J, ROUNDING * size)
    most = freedoms(robot.rows)[0].rank
    moved = movable(robot, lifted) if most else None
    forward = backward = None
    if _is_regular(moved, lifted, ROUNDING * size):
        forward = _limited(robot, families, q, way, moved)
        backward = _limited(robot, families, q, [-value for value in way], moved)
    x, y, z = X_BF[:3, 3].tolist()
    yaw_there, pitch, roll = euler_angles("ZYX", X_BF[:3, :3]).tolist()
    many = len(robot.moving) > 3
    return Diagnosis(
        position=(x, y, z if len(q) == len(lifted) else None),
        orientation=(roll, pitch, yaw_there),
        moved=families.moved if families else "the foot's translation",
        rank=rank,
        most_rank=min(most, rank.full_rank),
        whole=examine_whole(robot.rows, lifted, size) if many else None,
        nearness=families.nearness(q) if families else (),
        outside=_outside(robot, q),
        holds_orientation=moved is not None and moved.keeps_orientation,
        forward=forward,
        backward=backward,
        greatest_amplitude=greatest_amplitude(forward, frequency) if forward else None,
        feet=None if foot is None else feet(robot, foot, q=q, yaw=yaw, rpy=rpy),
    )


def _is_regular(moved: Movable | None, q: Sequence[float], rounding: float) -> bool:
    """Whether the foot can make every commanded motion in a posture."""
    return moved is None or examine(moved.jacobian_in_lengths(q), rounding).rank == moved.size


def _lifted(robot: Robot, q: Sequence[float]) -> Sequence[float]:
    """Add a SCARA's lift if it was left out: only the height depends on it."""
    if isinstance(geometry_of(robot), ScaraGeometry) and len(q) == 3:
        low, high = lift_limits(robot)
        return [*q, low if math.isfinite(low) else min(high, 0.0)]
    return q


def _outside(robot: Robot, q: Sequence[float]) -> tuple[Outside, ...]:
    joints = robot.moving[: len(q)]
    return tuple(
        Outside(segment=joint, position=float(position))
        for joint, position, (low, high) in zip(joints, q, limits_of(joints), strict=True)
        if beyond(position, low, high)
    )


def _limited(
    robot: Robot,
    families: Families | None,
    q: Sequence[float],
    direction: Sequence[float],
    moved: Movable | None,
) -> Stroke:
    """Stroke to the first singularity, or to a joint limit before it."""
    lifted, limits = _lifted(robot, q), limits_of(robot.moving)
    already = _outside(robot, lifted)
    if already:
        return Stroke(length=0.0, family=None, joint=already[0].segment.joint)
    known = closed_stroke(families, q[:3], direction) if families else None
    if known is not None and not np.isfinite(limits).any():
        return known
    names = [str(joint.joint) for joint in robot.moving]
    found = chain_stroke(
        robot.rows,
        lifted,
        direction,
        moved=moved,
        farthest=None if known is None else known.length,
        limits=dict(zip(names, limits, strict=True)),
    ).stroke
    if known is not None and found.joint is None:
        return known
    curved = moved is not None and moved.varies
    leaves = curved and found.joint is None and found.length < STRAIGHT * chain_length(robot.rows)
    return replace(found, length=0.0) if leaves else found


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _end(stroke: Stroke | None) -> str | None:
    """What ends a stroke, in words."""
    if stroke is None or not math.isfinite(stroke.length):
        return None
    if stroke.joint is not None:
        return f"the limit of joint {stroke.joint}"
    return f"the {stroke.family} family" if stroke.family else None


def _typed(q: Sequence[float] | None, units: Sequence[str]) -> list[float] | None:
    if q is None:
        return None
    return [
        math.degrees(value) if unit == "deg" else value
        for value, unit in zip(q, units, strict=True)
    ]


def _whole_json(whole: WholeRank) -> dict[str, Any]:
    def listed(twist: LostTwist) -> dict[str, Any]:
        turning, moving = twist.turning, twist.moving
        return {
            "turning": None if turning is None else turning.tolist(),
            "moving": None if moving is None else moving.tolist(),
        }

    return {
        "rank": whole.rank,
        "full_rank": whole.full_rank,
        "sigma_min": whole.sigma_min,
        "lost_twists": [listed(twist) for twist in whole.lost],
    }


def _pose_entries(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    x, y, z = diagnosis.position
    height = "z unknown: give the lift as a fourth number" if z is None else _rounded(z)
    roll, pitch, yaw = (_rounded(math.degrees(angle)) for angle in diagnosis.orientation)
    return [
        ("foot", f"({_rounded(x)}, {_rounded(y)}, {height}) m"),
        ("orientation", f"roll {roll}, pitch {pitch}, yaw {yaw} deg, about the base's x, y, z"),
    ]


def _rounded(value: float) -> str:
    return f"{round(value, 12) + 0.0:.9g}"


def _rank_entries(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    rank, whole = diagnosis.rank, diagnosis.whole
    most = ""
    if rank.rank == diagnosis.most_rank < rank.full_rank:
        most = ", and no posture of this table has more"
    of = "" if whole is None else f" of {diagnosis.moved}"
    entries = [("rank", f"{rank.rank} of {rank.full_rank}{of}{most}")]
    if whole is not None:
        entries.append(("", f"{whole.rank} of {whole.full_rank} of the whole Jacobian"))
    return [
        *entries,
        ("sigma_min", f"{rank.sigma_min:.6g} m"),
        ("manipulability", f"{rank.manipulability:.6g}"),
    ]


def _twist(twist: LostTwist) -> str:
    parts = []
    if twist.turning is not None:
        parts.append(f"held in place, the foot cannot turn about {_vector(twist.turning)}")
    if twist.moving is not None:
        parts.append(f"its orientation held, it cannot move along {_vector(twist.moving)}")
    return "; ".join(parts)


def _vector(values: Iterable[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"


def _stroke_entries(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    if diagnosis.forward is None or diagnosis.backward is None:
        held = ", the foot's orientation held" if diagnosis.holds_orientation else ""
        return [("stroke", f"none: the posture is singular already{held}")]
    entries = [
        ("stroke forward", _stroke(diagnosis.forward)),
        ("stroke backward", _stroke(diagnosis.backward)),
    ]
    if diagnosis.whole is not None:
        held = "held" if diagnosis.holds_orientation else "left free"
        entries.append(("", f"with the foot's orientation {held}"))
    if diagnosis.forward.length > 0.0:
        entries.append(("amplitude", _amplitude(diagnosis.greatest_amplitude)))
    return entries


def _stroke(stroke: Stroke) -> str:
    if stroke.joint is not None:
        if stroke.length == 0.0:
            return f"none: joint {stroke.joint} is at its limit, or outside"
        return f"{stroke.length:.9g} m, where joint {stroke.joint} reaches its limit"
    if stroke.length == 0.0:
        return "none: the foot cannot go straight along it"
    if math.isinf(stroke.length):
        return "without end"
    family = f", where it meets the {stroke.family} family" if stroke.family else ""
    return f"{stroke.length:.9g} m{family}"


def _amplitude(greatest: float | None) -> str:
    if greatest is None or math.isinf(greatest):
        return "any: nothing is in the way"
    return f"below {greatest:.6g} m/s stays inside"


def _shown(q: Sequence[float], units: Sequence[str]) -> str:
    """Write joint positions as the command line takes them, and their units."""
    if all(unit == "deg" for unit in units):
        return ", ".join(f"{math.degrees(value):.6f}" for value in q) + " deg"
    return ", ".join(
        f"{math.degrees(value) if unit == 'deg' else value:.6f} {unit}"
        for value, unit in zip(q, units, strict=True)
    )
