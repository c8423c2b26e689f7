"""The task of moving a robot's foot, whichever three-joint robot it is."""

from __future__ import annotations

import math
from functools import partial

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import jacobian, jacobian_rate_bias, moving_rows
from drake_leg.kinematics.leg import LegGeometry, is_hexabot_leg, leg_task
from drake_leg.kinematics.task import Floats, Task, task_from_jacobian
from drake_leg.robot import Robot, Row


def foot_task(robot: Robot) -> Task:
    """Make the task of the foot's translation, in closed form for the hexabot's leg.

    Parameters
    ----------
    robot : Robot
        With three joint positions.

    Returns
    -------
    Task
        Velocities in m/s, base frame.

    Raises
    ------
    InvalidValueError
        If the robot has not three joint positions.
    """
    joints = len(moving_rows(robot.rows))
    if joints != 3:
        raise InvalidValueError(
            f"{robot.name!r} has {joints} joint positions; moving its foot takes exactly three"
        )
    if is_hexabot_leg(robot):
        return leg_task(LegGeometry.from_robot(robot))
    return _chain_task(robot.rows)


def _chain_task(rows: tuple[Row, ...]) -> Task:
    reach = max(sum(math.hypot(row.d, row.r) for row in rows), 1e-3)
    turning = sum(row.joint == "revolute" for row in rows)
    return task_from_jacobian(
        jacobian=partial(_translational, rows),
        bias=partial(_translational_bias, rows),
        determinant_scale=reach**turning,
        length=reach,
    )


def _translational(rows: tuple[Row, ...], q: Floats) -> Array:
    J: Array = jacobian(rows, q)[3:]
    return J


def _translational_bias(rows: tuple[Row, ...], q: Floats, qdot: Floats) -> Array:
    bias: Array = jacobian_rate_bias(rows, q, qdot)[3:]
    return bias
