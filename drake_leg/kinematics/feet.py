"""Inverse kinematics: joint positions for a foot, in closed form or numerically."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import LEAST_LEVER, geometry_of, joint_positions, joints_in_words
from drake_leg.kinematics.euler import euler_rotation
from drake_leg.kinematics.khalil import (
    Array,
    chain_length,
    foot_pose,
    jacobian,
    moving_rows,
    nearest_turn,
    one_vector,
    principal,
    table_length,
    within_turns,
)
from drake_leg.kinematics.leg import LegGeometry, branches
from drake_leg.kinematics.scara import ScaraGeometry, branch_angles
from drake_leg.robot.robot import Robot, Row, Segment, require_robot
from drake_leg.robot.tree import require_one_foot
from drake_leg.units import AT_LIMIT, beyond, require_angle

STARTS = 400  # random postures
STEPS, POLISHING = 80, 12  # of the damped, then of the undamped search
NEAR = 1e-3  # of the length: nearer, the search goes on undamped
REACHED = 1e-10  # of the length
SAME = 1e-4  # [rad, or of the length]: postures that differ by less are one, as when stretched
STUCK = 1e3  # damping beyond which the search has stopped moving
LARGEST_STEP = 0.6  # [rad]
SHOWN = 4  # postures returned of infinitely many

Limits = Sequence[tuple[float, float]]


def ranges(robot: Robot) -> list[tuple[float, float]]:
    """Least and greatest position of every joint [rad or m].

    Its limits; without them a full turn, or twice the table's length.
    """
    length = _longest(robot)
    return [_range(segment, length) for segment in robot.moving]


def _longest(robot: Robot) -> float:
    """Greatest ``table_length`` up to any tip [m]."""
    return max(table_length(robot.rows[:tip]) for tip in robot.tips.values())


def _range(segment: Segment, length: float) -> tuple[float, float]:
    lower, upper = segment.mechanics.lower, segment.mechanics.upper
    span = 2.0 * (length if segment.row.joint == "prismatic" else math.pi)
    if lower is None:
        lower = -span / 2.0 if upper is None else upper - span
    return lower, lower + span if upper is None else upper


def random_configurations(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    """Draw configurations of m joints, (count, m) [rad or m], uniform within every range."""
    lower, upper = np.transpose(ranges(robot))
    return rng.uniform(lower, upper, (count, len(lower)))


def greatest_reach(robot: Robot) -> float:
    """Upper bound of any tip's distance from the base [m]: the table's lengths and the strokes."""
    strokes = (
        max(map(abs, bounds))
        for bounds, segment in zip(ranges(robot), robot.moving, strict=True)
        if segment.row.joint == "prismatic"
    )
    return _longest(robot) + sum(strokes)


@dataclass(frozen=True, kw_only=True)
class Postures:
    """Result of a numerical search for postures."""

    q: Array  # (k, n) [rad or m]
    miss: Array  # (k,) [m] from the foot's goal; rotations count times the chain's length
    infinitely_many: bool  # whether these are only some of them
    nearest: float  # [m], miss of the best start, also if none is found


def find_postures(
    rows: Sequence[Row],
    position: ArrayLike,
    rotation: ArrayLike | None = None,
    *,
    limits: Limits,
) -> Postures:
    """Find postures whose foot is at a point [m], or in a pose, by damped least squares.

    ``foot_pose(rows, q)`` is the goal to 1e-10 of the chain's length for every ``q`` found. All
    branches of an ordinary chain are found, without proof that there is no other. Without a
    rotation R_BF any orientation will do. Revolute joints are moved into their limits by whole
    turns where possible, otherwise into (-pi, pi]. Postures within the limits [rad or m] come
    first.
    """
    goal = np.eye(4)
    goal[:3, 3] = one_vector("the foot", position, 3)
    if rotation is not None:
        goal[:3, :3] = np.asarray(rotation, dtype=np.float64)
    search = _Search(rows, goal, turning=rotation is not None, limits=limits)
    kept, misses = search.run(inside=search.redundant)
    if search.redundant and not len(kept):
        kept, misses = search.run(inside=False)
    reached = misses <= REACHED * search.size
    q, miss = search.different(kept[reached], misses[reached])
    many = any(search.loses_a_joint(one) for one in q)
    if many:
        q, miss = _scattered(q, miss)
    return Postures(
        q=q, miss=miss, infinitely_many=many, nearest=float(misses.min(initial=math.inf))
    )


class _Search:
    """A chain and its goal; lengths are in units of the chain's length."""

    def __init__(self, rows: Sequence[Row], goal: Array, *, turning: bool, limits: Limits) -> None:
        self._rows, self._goal = rows, goal
        self.size = chain_length(rows)
        revolute = [rows[index].joint == "revolute" for index in moving_rows(rows)]
        self._turns = np.array(revolute)
        self._scale = np.where(self._turns, 1.0, self.size)
        self._low, self._high = np.array(limits, dtype=np.float64).T
        self._parts = slice(0, 6) if turning else slice(3, 6)
        self.redundant = len(revolute) > (6 if turning else 3)

    def run(self, *, inside: bool) -> tuple[Array, Array]:
        """Search from every start; return all ends and their misses [m]."""
        q = self._damped(self._starts(), inside=inside)
        near = self._miss(q) <= NEAR * self.size
        polished = self._polished(q[near], inside=inside)
        ends = np.concatenate([q[~near], polished])
        return ends, self._miss(ends)

    def _starts(self) -> Array:
        span = np.where(self._turns, math.pi, self.size + float(np.linalg.norm(self._goal[:3, 3])))
        low = np.where(np.isfinite(self._low), self._low, np.minimum(-span, self._high - span))
        high = np.where(np.isfinite(self._high), self._high, np.maximum(span, low + span))
        rng = np.random.default_rng(0)
        return rng.uniform(low, high, (STARTS, len(low)))

    def _damped(self, q: Array, *, inside: bool) -> Array:
        """Levenberg-Marquardt method for all starts at once, until near the goal or stuck."""
        ends, active = q.copy(), np.arange(len(q))
        damping, error = np.full(len(q), 1e-2), self._error(q)
        for _ in range(STEPS):
            J = self._jacobian(q)
            Jt = np.swapaxes(J, -1, -2)
            normal = J @ Jt + damping[:, np.newaxis, np.newaxis] * np.eye(J.shape[-2])
            change = (Jt @ np.linalg.solve(normal, error[..., np.newaxis]))[..., 0]
            tried = self._placed(q + self._shortened(change) * self._scale, inside=inside)
            after = self._error(tried)
            better = (after**2).sum(axis=-1) < (error**2).sum(axis=-1)
            q = np.where(better[:, np.newaxis], tried, q)
            error = np.where(better[:, np.newaxis], after, error)
            damping = np.where(better, np.maximum(damping / 4.0, 1e-14), damping * 4.0)
            ends[active] = q
            going = (np.linalg.norm(error, axis=-1) > NEAR) & (damping < STUCK)
            if not going.any():
                break
            q, error, damping, active = q[going], error[going], damping[going], active[going]
        return ends

    def _polished(self, q: Array, *, inside: bool) -> Array:
        """Newton's method; a step is taken only if it comes nearer to the goal."""
        for _ in range(POLISHING):
            if not len(q):
                break
            inverse = np.linalg.pinv(self._jacobian(q), rcond=1e-9)
            change = self._shortened((inverse @ self._error(q)[..., np.newaxis])[..., 0])
            tried = self._placed(q + change * self._scale, inside=inside)
            better = self._miss(tried) < self._miss(q)
            q = np.where(better[:, np.newaxis], tried, q)
        return q

    def _placed(self, q: Array, *, inside: bool) -> Array:
        return np.clip(q, self._low, self._high) if inside else q

    def _shortened(self, change: Array) -> Array:
        turns = np.where(self._turns, np.abs(change), 0.0)
        longest = turns.max(axis=-1, keepdims=True)
        shortened: Array = change * np.minimum(1.0, LARGEST_STEP / np.maximum(longest, 1e-300))
        return shortened

    def _jacobian(self, q: Array) -> Array:
        J = jacobian(self._rows, q) * self._scale
        J[..., 3:, :] /= self.size
        part: Array = J[..., self._parts, :]
        return part

    def _error(self, q: Array) -> Array:
        """Rotation vector and translation to the goal, in units of the chain's length."""
        X_BF = foot_pose(self._rows, q)
        way = (self._goal[:3, 3] - X_BF[..., :3, 3]) / self.size
        turn = _rotation_vector(self._goal[:3, :3] @ np.swapaxes(X_BF[..., :3, :3], -1, -2))
        part: Array = np.concatenate([turn, way], axis=-1)[..., self._parts]
        return part

    def _miss(self, q: Array) -> Array:
        miss: Array = self.size * np.linalg.norm(self._error(q), axis=-1)
        return miss

    def loses_a_joint(self, q: Array) -> bool:
        """Whether joints can move while the foot stays in place."""
        sigma = np.linalg.svd(self._jacobian(q), compute_uv=False)
        return len(sigma) < len(q) or bool(sigma[-1] < 1e-6 * max(sigma[0], LEAST_LEVER))

    def different(self, q: Array, miss: Array) -> tuple[Array, Array]:
        """Keep one of each posture, turned into the limits, those within the limits first."""
        placed = self._turned(q)
        chosen: list[int] = []
        for index in np.argsort(miss, kind="stable"):
            if not any(self._is_same(placed[index], placed[other]) for other in chosen):
                chosen.append(int(index))

        def order(index: int) -> tuple[bool, list[float]]:
            one = placed[index]
            out = bool(((one < self._low - AT_LIMIT) | (one > self._high + AT_LIMIT)).any())
            return out, np.round(one, 6).tolist()

        chosen.sort(key=order)
        return placed[chosen], miss[chosen]

    def _turned(self, q: Array) -> Array:
        turn = 2.0 * math.pi
        wrapped = principal(q)
        up = wrapped + turn * np.maximum(np.ceil((self._low - AT_LIMIT - wrapped) / turn), 0.0)
        down = up - turn * np.maximum(np.ceil((up - self._high - AT_LIMIT) / turn), 0.0)
        placed = np.where(down >= self._low - AT_LIMIT, down, wrapped)
        return np.where(self._turns, placed, q)

    def _is_same(self, a: Array, b: Array) -> bool:
        difference = (a - b) / self._scale
        turns = nearest_turn(difference, np.zeros(()))
        return bool(np.abs(np.where(self._turns, turns, difference)).max() < SAME)


def _rotation_vector(R: Array) -> Array:
    """Axis times angle of rotation matrices, (..., 3) [rad]."""
    spin = 0.5 * np.stack(
        [
            R[..., 2, 1] - R[..., 1, 2],
            R[..., 0, 2] - R[..., 2, 0],
            R[..., 1, 0] - R[..., 0, 1],
        ],
        axis=-1,
    )
    sine = np.linalg.norm(spin, axis=-1)
    cosine = 0.5 * (np.trace(R, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(sine, cosine)
    vector: Array = spin * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 1.0)[..., None]
    return vector


def _scattered(q: Array, miss: Array) -> tuple[Array, Array]:
    """Choose a few postures that are far apart."""
    chosen = [0]
    while len(chosen) < min(SHOWN, len(q)):
        distances = np.abs(q[:, np.newaxis] - q[chosen]).max(axis=-1).min(axis=-1)
        chosen.append(int(distances.argmax()))
    return q[chosen], miss[chosen]


@dataclass(frozen=True, kw_only=True)
class Solution:
    """One way of putting the foot at a point."""

    name: str
    q: tuple[float, ...] | None  # [rad or m], every joint; None where out of reach
    within_limits: bool


@dataclass(frozen=True, kw_only=True)
class Feet:
    """All ways of putting a robot's foot at a point."""

    solutions: tuple[Solution, ...]
    heading: str  # one line: how many, whether these are all, what was assumed
    units: tuple[str, ...]  # in which each joint's position is shown: deg or m


def limits_of(joints: Sequence[Segment]) -> Limits:
    """Lower and upper limits of the joints [rad or m], infinite where there is none."""
    return [joint.mechanics.bounds for joint in joints]


def units_of(robot: Robot) -> tuple[str, ...]:
    """Unit in which each joint's position is shown: ``deg`` or ``m``."""
    return tuple("deg" if joint.row.joint == "revolute" else "m" for joint in robot.moving)


def feet(
    robot: Robot,
    foot: Sequence[float],
    *,
    q: Sequence[float] | None = None,
    yaw: float | None = None,
    rpy: Sequence[float] | None = None,
) -> Feet:
    """Find the joint positions that put a robot's foot at a point (3,) [m], in the base frame.

    The leg and the SCARA have closed forms. A SCARA's tool has the yaw [rad], or else that of the
    posture q. The foot of a chain of more than three joints has the roll, pitch and yaw ``rpy``
    about the base's x, y, z [rad], or else any orientation.
    """
    require_robot(robot)
    require_one_foot(robot)
    foot = one_vector("the foot", foot, 3).tolist()
    if q is not None:
        q = joint_positions("q", robot, q, least=min(3, len(robot.moving)))
    if yaw is not None:
        require_angle("the yaw", yaw)
    if rpy is not None:
        rpy = one_vector("rpy", rpy, 3).tolist()
    geometry = geometry_of(robot)
    if isinstance(geometry, ScaraGeometry):
        return _scara_feet(robot, geometry, foot, q, yaw, rpy)
    if yaw is not None:
        otherwise = ", or give the orientation by `rpy`" if len(robot.moving) > 3 else ""
        raise InvalidValueError(
            f"a yaw is for a SCARA's tool; {robot.name!r} is not a SCARA",
            advice=f"leave it out{otherwise}",
        )
    if rpy is not None and len(robot.moving) <= 3:
        raise InvalidValueError(
            f"the foot of {robot.name!r} cannot choose its orientation, with "
            f"{joints_in_words(robot)}",
            advice="leave `rpy` out",
        )
    if isinstance(geometry, LegGeometry):
        return _leg_feet(robot, geometry, foot)
    return _chain_feet(robot, foot, rpy)


def _leg_feet(robot: Robot, leg: LegGeometry, foot: Sequence[float]) -> Feet:
    found = branches(leg, foot, limits_of(robot.moving))
    return Feet(
        solutions=tuple(
            Solution(name=branch.name, q=branch.q, within_limits=branch.within_limits)
            for branch in found
        ),
        heading="all four branches, in closed form",
        units=units_of(robot),
    )


def _scara_feet(
    robot: Robot,
    arm: ScaraGeometry,
    foot: Sequence[float],
    q: Sequence[float] | None,
    yaw: float | None,
    rpy: Sequence[float] | None,
) -> Feet:
    if rpy is not None:
        raise InvalidValueError("a SCARA's tool only yaws", advice="give `yaw` instead of `rpy`")
    whose = "as asked for"
    if yaw is None:
        if q is None:
            raise InvalidValueError(
                "a SCARA's tool has a yaw in addition to its position",
                advice="give `yaw`, or the posture whose yaw it keeps by `q`",
            )
        yaw, whose = float(sum(q[:3])), "that of the posture"
    limits = [*limits_of(robot.moving[:3]), lift_limits(robot)]
    lift = arm.height - foot[2]
    solutions = [
        _solution(robot, name, [*angles, lift], limits)
        for name, angles in zip(
            ("elbow left", "elbow right"),
            branch_angles(arm, [foot[0], foot[1], yaw]).tolist(),
            strict=True,
        )
    ]
    low, high = limits[3]
    heading = f"both branches, in closed form, at yaw {math.degrees(yaw):.6g} deg, {whose}"
    if beyond(lift, low, high):
        heading += (
            f"; the lift would be at {lift:.6g} m, outside {low:.6g} ... {high:.6g} m: the tool is "
            f"{arm.height - high:.6g} ... {arm.height - low:.6g} m high"
        )
    return Feet(solutions=tuple(solutions), heading=heading, units=units_of(robot))


def lift_limits(robot: Robot) -> tuple[float, float]:
    """Range of a SCARA's lift [m]: its limits, or else those of the report's table."""
    arm = ScaraGeometry.from_robot(robot)
    ((low, high),) = limits_of(robot.moving[3:4])
    if math.isinf(low) and math.isinf(high) and arm.height > arm.lowest:
        return 0.0, arm.height - arm.lowest
    return low, high


def _chain_feet(robot: Robot, foot: Sequence[float], rpy: Sequence[float] | None) -> Feet:
    limits = limits_of(robot.moving)
    rotation = None if rpy is None else euler_rotation("ZYX", [rpy[2], rpy[1], rpy[0]])
    found = find_postures(robot.rows, foot, rotation, limits=limits)
    solutions = tuple(
        _solution(robot, f"posture {number}", q, limits)
        for number, q in enumerate(found.q.tolist(), start=1)
    )
    heading = _found(robot, len(solutions), found.nearest, rpy, many=found.infinitely_many)
    return Feet(solutions=solutions, heading=heading, units=units_of(robot))


def _found(
    robot: Robot, count: int, nearest: float, rpy: Sequence[float] | None, *, many: bool
) -> str:
    """Heading of a numerical search: how many postures, and whether there may be more."""
    if not count:
        return f"no posture found; the nearest that was found misses by {nearest:.6g} m"
    if many and rpy is None and len(robot.moving) > 3:
        return (
            f"{count} found of infinitely many: {joints_in_words(robot)} reach a point in any of "
            "many orientations; choose one by rpy"
        )
    if many:
        return f"{count} found of infinitely many: joints can move while the foot stays"
    return f"{count} found from many starts; there may be more"


def _solution(robot: Robot, name: str, q: Sequence[float], limits: Limits) -> Solution:
    if not all(map(math.isfinite, q)):
        return Solution(name=name, q=None, within_limits=False)
    inside = all(
        within_turns(value, low, high)
        if segment.row.joint == "revolute"
        else not beyond(value, low, high)
        for value, (low, high), segment in zip(q, limits, robot.moving, strict=True)
    )
    return Solution(name=name, q=tuple(np.asarray(q).tolist()), within_limits=inside)
