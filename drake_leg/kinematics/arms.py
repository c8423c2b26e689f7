"""What is asked of a robot to say where its singularities are: its edges, postures, Jacobian."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.chain_task import chain_task
from drake_leg.kinematics.edges import Edges, Family, leg_edges, leg_extremes, scara_edges
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian, foot_position, is_hexabot_leg
from drake_leg.kinematics.leg_inverse import inverse_kinematics
from drake_leg.kinematics.scara import ScaraGeometry, task_jacobian, tool_position
from drake_leg.kinematics.scara import inverse_kinematics as scara_inverse
from drake_leg.kinematics.stroke import facing
from drake_leg.kinematics.task import TRANSLATION, Task
from drake_leg.robot import Robot

# Of the greatest singular value of the foot's translation: where the smallest one is greater, the
# foot goes everywhere.
STILL_MOVES = 1e-3


class Arm(Protocol):
    """A robot, or its joints that a command moves."""

    turning: tuple[bool, ...]  # joint by joint: revolute, not prismatic
    twists: Array  # (6, m): turning, then translation of the foot, that each row of J is

    def foot(self, q: Sequence[float]) -> Array:
        """Return the foot's or the tool's position, (3,) [m]."""
        ...

    def jacobian(self, q: Sequence[float]) -> Array:
        """Return the Jacobian of what is commanded, its rows made lengths, (m, n) [m/rad]."""
        ...

    def family(self, q: Sequence[float]) -> Family | None:
        """Name the singular family that is nearest; None where families have no names."""
        ...


class ClosedArm(Arm, Protocol):
    """An arm whose edges and inverse kinematics have closed forms."""

    def edges(self, q: Sequence[float]) -> Edges:
        """Return the edges of the workspace, seen from a posture."""
        ...

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Return the ways along a line at which a clearance may be extreme [m]."""
        ...

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """Return the joint angles (3,) of a posture's branch; NaN out of reach."""
        ...


class LegArm:
    """The hexabot's leg."""

    turning: tuple[bool, ...] = (True, True, True)
    twists = TRANSLATION

    def __init__(self, leg: LegGeometry) -> None:
        self._leg = leg

    def foot(self, q: Sequence[float]) -> Array:
        """Return the foot, in closed form."""
        return foot_position(self._leg, q)

    def jacobian(self, q: Sequence[float]) -> Array:
        """Return its Jacobian, (3, 3)."""
        return foot_jacobian(self._leg, q)

    def family(self, q: Sequence[float]) -> Family:
        """Compare |sin q3| with the distance from the hip axis over the length."""
        leg = self._leg
        reach = leg.l1 + leg.l2 * math.cos(q[1]) + leg.l3 * math.cos(q[1] + q[2])
        off_axis = abs(reach) / (leg.l1 + leg.l2 + leg.l3)
        return "stretch" if abs(math.sin(q[2])) <= off_axis else "hip-axis"

    def edges(self, q: Sequence[float]) -> Edges:
        """Return the stretched and the folded leg and the hip axis."""
        return leg_edges(self._leg, facing(self._leg, q))

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Return the roots of a quartic."""
        return leg_extremes(self._leg, p, d)

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """Return the inverse kinematics on the branch of ``like``."""
        return inverse_kinematics(self._leg, p, like=like)


class ScaraArm:
    """The SCARA in its plane, its yaw held."""

    turning: tuple[bool, ...] = (True, True, True)
    twists = TRANSLATION[:, :2]

    def __init__(self, arm: ScaraGeometry, lift: float = 0.0) -> None:
        self._arm = arm
        self._lift = lift  # position of the fourth joint [m]

    def foot(self, q: Sequence[float]) -> Array:
        """Return the tool, in closed form."""
        return tool_position(self._arm, [*q[:3], self._lift])

    def jacobian(self, q: Sequence[float]) -> Array:
        """Return the Jacobian of x and y, (2, 2)."""
        J: Array = task_jacobian(self._arm, q[:3])[:2, :2]
        return J

    def family(self, _q: Sequence[float]) -> Family:
        """Return the only one that there is."""
        return "stretch"

    def edges(self, _q: Sequence[float]) -> Edges:
        """Return the stretched and the folded arm."""
        return scara_edges(self._arm)

    def extremes(self, p: Array, d: Array) -> list[float]:
        """Return the point nearest to the base."""
        return [-float(p[:2] @ d[:2])]

    def posture(self, p: Array, like: Sequence[float]) -> Array:
        """Return the inverse kinematics with the yaw of ``like``."""
        return scara_inverse(self._arm, [p[0], p[1], sum(like)], like=like)


class ChainArm:
    """Any chain; nothing of it is known in closed form."""

    def __init__(self, robot: Robot, task: Task | None = None) -> None:
        self.rows = robot.rows
        self.task = task or chain_task(robot.rows, TRANSLATION)
        self.twists = self.task.twists
        self.turning = tuple(segment.row.joint == "revolute" for segment in robot.moving)

    def foot(self, q: Sequence[float]) -> Array:
        """Return the foot by the chain of transforms."""
        p: Array = foot_pose(self.rows, q)[:3, 3]
        return p

    def jacobian(self, q: Sequence[float]) -> Array:
        """Return the task's Jacobian."""
        J: Array = np.array(self.task.row_lengths)[:, np.newaxis] * self.task.jacobian(q)
        return J

    def family(self, _q: Sequence[float]) -> None:
        """Name none."""


def arm_of(robot: Robot, task: Task) -> LegArm | ChainArm:
    """Return what is known of a robot whose foot follows a task.

    Parameters
    ----------
    robot : Robot
        The leg, or any chain.
    """
    if is_hexabot_leg(robot):
        return LegArm(LegGeometry.from_robot(robot))
    return ChainArm(robot, task)


def loses_turning(arm: Arm, q: Sequence[float]) -> bool:
    """Tell whether it is only a turning of the foot that is lost: it still goes everywhere.

    Parameters
    ----------
    q : (n,) sequence of float
        A posture that is singular, or nearly [rad or m].
    """
    _, sigma, moved = _translations(arm, q)
    return bool(arm.twists[:3].any() and sigma[moved - 1] > STILL_MOVES * sigma[0])


def lost_direction(arm: Arm, q: Sequence[float]) -> tuple[float, float, float]:
    """Return the direction in which the foot moves least for all that its joints do.

    Parameters
    ----------
    q : (n,) sequence of float
        A posture that is singular, or nearly [rad or m].

    Returns
    -------
    (3,) tuple of float
        Unit vector in the base frame, its first component that is not zero positive: of a
        translation or, where only a turning is lost, of its axis.
    """
    U, _, moved = _translations(arm, q)
    lost = U[:, moved - 1]
    if loses_turning(arm, q):
        U, _, _ = np.linalg.svd(arm.jacobian(q))
        lost = arm.twists[:3] @ U[:, -1]
        lost = lost / np.linalg.norm(lost)
    lost = np.where(np.abs(lost) < 1e-9, 0.0, lost)
    sign = np.sign(lost[np.flatnonzero(lost)[0]])
    x, y, z = (sign * lost + 0.0).tolist()
    return x, y, z


def _translations(arm: Arm, q: Sequence[float]) -> tuple[Array, Array, int]:
    """Take the foot's translation apart: directions, singular values, and how many it has."""
    moved = int(np.linalg.matrix_rank(arm.twists[3:]))
    U, sigma, _ = np.linalg.svd(arm.twists[3:] @ arm.jacobian(q))
    return U, sigma, moved
