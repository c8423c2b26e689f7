"""What of a robot's foot can be commanded, and the task of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.chain_stroke import chain_stroke
from drake_leg.kinematics.chain_task import LEAST_LEVER, chain_task, sampled_jacobians, size_of
from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.leg import LegGeometry, is_hexabot_leg, leg_task
from drake_leg.kinematics.singularity import RANK_TOLERANCE
from drake_leg.kinematics.task import Task
from drake_leg.robot import Robot, Row

TASKS = ("position", "pose")
STRAIGHT = 1e-3  # of the robot's length: way along which a foot must be able to go straight
OUTSIDE = 1e-5  # of a direction's length, outside of what the foot can do, that is let pass


@dataclass(frozen=True)
class Freedom:
    """What motions a chain's foot has, looked at from postures everywhere.

    Where the motions of all postures together span no more than those of one, that span is the
    task: a plane, a line, all of space. A foot that goes round a sphere has no such span.
    """

    rank: int  # of the motions at one posture
    span: Array | None  # (6, rank), orthonormal twists, turning first; None: it turns on its way


def foot_task(robot: Robot, q0: Sequence[float] | None = None, keep: str | None = None) -> Task:
    """Make the task of moving a robot's foot, in closed form for the hexabot's leg.

    Parameters
    ----------
    q0 : (n,) sequence of float, optional
        Where it starts [rad or m]: what the foot can do may depend on it. All 0 by default.
    keep : {"position", "pose"}, optional
        Whether the foot's translation is commanded alone, or its turning, too. By default the
        pose, where the joints suffice for it and can turn the foot; else the position.

    Returns
    -------
    Task
        Velocities in m/s and, of a pose, rad/s; base frame.

    Raises
    ------
    InvalidValueError
        If the robot cannot do that, or the count of joint positions is another.

    Examples
    --------
    >>> from drake_leg import LEG_B, movable
    >>> leg = movable(LEG_B)
    >>> leg.joints, leg.size  # three joints, three velocities of the foot
    (3, 3)
    >>> q, v = [1.57, -0.87, -1.57], [0.05, 0.0, 0.0]
    >>> qdot = leg.rates(q, v)
    >>> bool(abs(leg.jacobian(q) @ qdot - v).max() < 1e-12)
    True
    """
    if keep is not None and keep not in TASKS:
        raise InvalidValueError(f"the task is {keep!r}; it must be {' or '.join(TASKS)}")
    q0 = [0.0] * len(robot.moving) if q0 is None else q0
    if len(q0) != len(robot.moving):
        raise InvalidValueError(
            f"q0 has {len(q0)} numbers; {robot.name} has {len(robot.moving)} joint positions"
        )
    if is_hexabot_leg(robot) and keep != "pose":
        return leg_task(LegGeometry.from_robot(robot))
    return chain_task(robot.rows, _twists(robot, q0, keep))


def _twists(robot: Robot, q0: Sequence[float], keep: str | None) -> Array:
    """Choose the twists that are commanded."""
    position, pose = freedoms(robot.rows)
    if position.rank == 0:
        raise InvalidValueError(
            f"no joint of {robot.name!r} moves its foot, the last frame of its table: put the foot "
            "farther out by a fixed row at the table's end"
        )
    if (
        pose.span is not None
        and keep != "position"
        and (keep == "pose" or pose.rank > position.rank)
    ):
        return pose.span
    if keep == "pose":
        raise InvalidValueError(
            f"{robot.name!r} cannot hold its foot's orientation with its "
            f"{joints_in_words(robot)} while the foot moves",
            advice="choose `task='position'`",
        )
    if position.span is not None:
        return position.span
    U, _, _ = np.linalg.svd(jacobian(robot.rows, q0)[3:])
    return np.vstack([np.zeros((3, position.rank)), U[:, : position.rank]])


def first_direction(robot: Robot, task: Task, q0: Sequence[float]) -> tuple[float, float, float]:
    """Return x, or the first of y and z that a foot can go along, or some direction else.

    Parameters
    ----------
    q0 : (n,) sequence of float
        Where it starts [rad or m].

    Returns
    -------
    (3,) tuple of float
        Unit vector, base frame.
    """
    U, _, _ = np.linalg.svd(task.twists[3:])
    commanded = (one for one in np.eye(3) if _is_commanded(task, one))
    ways = (one for one in commanded if _straight(robot, task, q0, one))
    x, y, z = next(ways, U[:, 0]).tolist()
    return x, y, z


def require_direction(
    robot: Robot, task: Task, q0: Sequence[float], direction: Sequence[float]
) -> None:
    """Refuse a direction in which a robot's foot cannot be moved.

    Parameters
    ----------
    q0 : (n,) sequence of float
        Where it starts [rad or m].
    direction : (3,) sequence of float
        Unit vector, base frame.

    Raises
    ------
    InvalidValueError
        With what the foot can do.
    """
    if not _is_commanded(task, np.asarray(direction)):
        where = "at q0 " if turns_on_its_way(robot, task) else ""
        raise InvalidValueError(
            f"{where}the foot of {robot.name!r} {motion_in_words(task)}: it cannot go along "
            f"{_vector(np.asarray(direction))}",
            advice="choose another `direction`",
        )
    if not _straight(robot, task, q0, direction):
        raise InvalidValueError(
            f"{robot.name!r} takes its foot along a curve with its {joints_in_words(robot)}: "
            f"from q0 it cannot go straight along {_vector(np.asarray(direction))}",
            advice="choose another `direction`, or a robot with more joints",
        )


def _straight(
    robot: Robot, task: Task, q0: Sequence[float], direction: Sequence[float] | Array
) -> bool:
    """Tell whether a foot that can go along a direction stays on the line."""
    if not turns_on_its_way(robot, task):
        return True
    enough = STRAIGHT * size_of(robot.rows)
    way = chain_stroke(robot.rows, q0, direction, task=task, farthest=enough).stroke
    return way.length > enough


def _is_commanded(task: Task, direction: Array) -> bool:
    wanted = np.concatenate([np.zeros(3), direction])
    outside = wanted - task.twists @ (task.twists.T @ wanted)
    return float(np.linalg.norm(outside)) <= OUTSIDE


def turns_on_its_way(robot: Robot, task: Task) -> bool:
    """Tell whether what a foot can do changes from posture to posture."""
    return not task.keeps_orientation and freedoms(robot.rows)[0].span is None


def motion_in_words(task: Task) -> str:
    """Say which translations a task commands.

    Returns
    -------
    str
        Such as "moves in the plane at right angles to (0, 0, 1)".
    """
    U, sigma, _ = np.linalg.svd(task.twists[3:])
    moved = int((sigma > RANK_TOLERANCE).sum())
    if moved == 1:
        return f"moves along {_vector(U[:, 0])} only"
    if moved == 2:
        return f"moves in the plane at right angles to {_vector(U[:, 2])} only"
    return "moves along x, y and z"


@lru_cache(maxsize=16)
def freedoms(rows: tuple[Row, ...]) -> tuple[Freedom, Freedom]:
    """Find out what a chain's foot can do.

    Returns
    -------
    Freedom, Freedom
        Of its translation alone, and of its turning and translation.
    """
    J = sampled_jacobians(rows)
    only = J.copy()
    only[:, :3] = 0.0
    size = size_of(rows)
    return _freedom(only, size), _freedom(J, size)


def _freedom(J: Array, size: float) -> Freedom:
    """Compare what one posture can do with what all together can, (samples, 6, n)."""
    scaled = np.array([size] * 3 + [1.0] * 3)[:, np.newaxis] * J
    each = np.linalg.svd(scaled, compute_uv=False)
    greatest = max(float(each.max()), LEAST_LEVER * size)
    rank = int((each > RANK_TOLERANCE * greatest).sum(axis=1).max())
    U, sigma, _ = np.linalg.svd(np.hstack(list(scaled)), full_matrices=False)
    together = int((sigma > RANK_TOLERANCE * greatest).sum())
    return Freedom(rank, _tidy(U[:, :together]) if together == rank else None)


def _tidy(span: Array) -> Array:
    """Choose orthonormal vectors of a span along the axes, or near to them."""
    projector = span @ span.T
    straight = np.round(projector)
    if np.abs(projector - straight).max() < RANK_TOLERANCE:
        projector = straight
    chosen: list[Array] = []
    for column in projector[:, [3, 4, 5, 0, 1, 2]].T:  # translations first
        left = column - sum((np.dot(column, one) * one for one in chosen), np.zeros(6))
        size = float(np.linalg.norm(left))
        if size > 1e-6:
            chosen.append(left / size)
    tidy = np.array(chosen[: span.shape[1]]).reshape(-1, 6).T
    return np.where(np.abs(tidy) < RANK_TOLERANCE, 0.0, tidy)


def joints_in_words(robot: Robot) -> str:
    """Say how many joints a robot has.

    Returns
    -------
    str
        Such as "3 joints".
    """
    count = len(robot.moving)
    return f"{count} joint{'s' * (count > 1)}"


def _vector(direction: Array) -> str:
    x, y, z = (round(float(part), 6) + 0.0 for part in direction)
    return f"({x:g}, {y:g}, {z:g})"
