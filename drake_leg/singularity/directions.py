"""In which directions a robot's foot can be commanded to go straight."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.chain import RANK_TOLERANCE, size_of
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.of_robot import joints_in_words
from drake_leg.robot import Robot
from drake_leg.singularity.stroke import chain_stroke

STRAIGHT = 1e-3  # of the robot's length: way along which a foot must be able to go straight
OUTSIDE = 1e-5  # of a direction's length, outside of what the foot can do, that is let pass


def first_direction(
    robot: Robot, moved: Movable, q0: Sequence[float]
) -> tuple[float, float, float]:
    """Unit vector along x, or else y or z, if the foot can go along it from q0, or another."""
    U, _, _ = np.linalg.svd(moved.twists[3:])
    commanded = (one for one in np.eye(3) if _is_commanded(moved, one))
    ways = (one for one in commanded if _straight(robot, moved, q0, one))
    x, y, z = next(ways, U[:, 0]).tolist()
    return x, y, z


def require_direction(
    robot: Robot, moved: Movable, q0: Sequence[float], direction: Sequence[float]
) -> None:
    """Refuse a direction (unit vector) along which the foot cannot be moved straight from q0.

    Raises
    ------
    InvalidValueError
        With what the foot can do.
    """
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
    """Tell whether a foot that starts along a direction stays on the line."""
    if not moved.varies:
        return True
    enough = STRAIGHT * size_of(robot.rows)
    way = chain_stroke(robot.rows, q0, direction, moved=moved, farthest=enough).stroke
    return way.length > enough


def _is_commanded(moved: Movable, direction: Array) -> bool:
    wanted = np.concatenate([np.zeros(3), direction])
    outside = wanted - moved.twists @ (moved.twists.T @ wanted)
    return float(np.linalg.norm(outside)) <= OUTSIDE


def motion_in_words(moved: Movable) -> str:
    """Say which translations can be commanded, such as "moves along (0, 0, 1) only"."""
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
