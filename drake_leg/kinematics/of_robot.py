"""Chooses a robot's closed forms, and the motions of its foot that can be commanded."""

from __future__ import annotations

from collections.abc import Sequence

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import MovableChain, freedoms, tangent_twists
from drake_leg.kinematics.khalil import Array, one_vector, real_numbers
from drake_leg.kinematics.leg import LegGeometry, MovableLeg, is_hexabot_leg
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.pendulum import PendulumModel, is_pendulum
from drake_leg.kinematics.scara import ScaraGeometry, is_scara
from drake_leg.robot.robot import Robot, require_robot

TASKS = ("position", "pose")


def geometry_of(robot: Robot) -> LegGeometry | ScaraGeometry | PendulumModel | None:
    """Dimensions for a robot's closed forms; None if it has no closed forms."""
    if is_hexabot_leg(robot):
        return LegGeometry.from_robot(robot)
    if is_scara(robot):
        return ScaraGeometry.from_robot(robot)
    return PendulumModel.from_robot(robot) if is_pendulum(robot) else None


def movable(robot: Robot, q0: Sequence[float] | None = None, task: str | None = None) -> Movable:
    """Choose how a robot's foot is moved: in closed form for the hexabot's leg, else numerically.

    Parameters
    ----------
    q0 : (n,) sequence of float, optional
        Initial posture [rad or m], on which the foot's motions may depend. All 0 by default.
    task : {"position", "pose"}, optional
        Whether only the foot's translation is commanded, or its rotation, too. By default the
        pose, if there are enough joints for it and they can rotate the foot; else the position.

    Returns
    -------
    Movable
        Its velocities are in m/s and, of a pose, rad/s; base frame.

    Raises
    ------
    InvalidValueError
        If the robot cannot do that, or the number of joint positions is wrong.

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
    require_robot(robot)
    if task is not None and task not in TASKS:
        raise InvalidValueError(f"the task is {task!r}; it must be {' or '.join(TASKS)}")
    posture = [0.0] * len(robot.moving) if q0 is None else joint_positions("q0", robot, q0)
    if is_hexabot_leg(robot) and task != "pose":
        return MovableLeg(LegGeometry.from_robot(robot))
    span = _constant_span(robot, task)
    if span is not None:
        return MovableChain(robot.rows, span)
    return MovableChain(robot.rows, tangent_twists(robot.rows, posture), varies=True)


def _constant_span(robot: Robot, task: str | None) -> Array | None:
    """Choose the twists that are commanded in every posture; None if they vary."""
    position, pose = freedoms(robot.rows)
    if position.rank == 0:
        raise InvalidValueError(
            f"no joint of {robot.name!r} moves its foot, the last frame of its table: put the foot "
            "farther out by a fixed row at the table's end"
        )
    if (
        pose.span is not None
        and task != "position"
        and (task == "pose" or pose.rank > position.rank)
    ):
        return pose.span
    if task == "pose":
        raise InvalidValueError(
            f"{robot.name!r} cannot hold its foot's orientation with its "
            f"{joints_in_words(robot)} while the foot moves",
            advice="choose `task='position'`",
        )
    return position.span


def joint_positions(
    what: str, robot: Robot, q: Sequence[float], *, least: int | None = None
) -> list[float]:
    """Check joint positions [rad or m]: one for each joint that moves, or ``least`` at least.

    Raises
    ------
    InvalidValueError
        If they are not that many finite numbers.
    """
    values, count = real_numbers(what, q), len(robot.moving)
    if values.ndim != 1:
        found = f"has shape {values.shape}" if values.ndim else f"is {q!r}"
        raise InvalidValueError(f"{what} {found}; it must be {count} joint positions")
    if not (least or count) <= len(values) <= count:
        raise InvalidValueError(
            f"{what} has {len(values)} numbers; {robot.name} has {count} joint positions"
        )
    positions: list[float] = one_vector(what, values, len(values)).tolist()
    return positions


def joints_in_words(robot: Robot) -> str:
    """Number of joints in words, such as "3 joints"."""
    count = len(robot.moving)
    return f"{count} joint{'s' * (count > 1)}"
