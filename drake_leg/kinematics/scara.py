"""Closed forms of the SCARA arm: tool, Jacobian of (x, y, yaw), determinant.

The task coordinates are the tool's x and y [m] and its yaw q1 + q2 + q3 [rad], driven by the
first three joints; the fourth sets only the height.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.differentiable import DifferentiableChain
from drake_leg.kinematics.khalil import (
    Array,
    assemble,
    finite_vectors,
    nearest_turn,
    one_vector,
    split,
    triangle_angle,
)
from drake_leg.kinematics.movable import (
    Floats,
    Functions,
    Movable,
    Values,
    smallest_singular_value,
)
from drake_leg.robot.robot import Robot, Row
from drake_leg.robot.robots import SCARA_HEIGHT, SCARA_LOWEST
from drake_leg.units import require_positive


@dataclass(frozen=True, kw_only=True)
class ScaraGeometry:
    """Dimensions of a SCARA arm for its closed forms."""

    l1: float  # [m], first arm
    l2: float  # [m], second arm
    height: float = SCARA_HEIGHT  # [m], of the arms over the base
    lowest: float = SCARA_LOWEST  # [m], height of the tool at R = 0

    def __post_init__(self) -> None:
        for name in ("l1", "l2", "height"):
            require_positive(f"the SCARA's {name}", getattr(self, name), "m")

    @classmethod
    def from_robot(cls, robot: Robot) -> Self:
        """Read the lengths off the Khalil table of a SCARA such as ``robots.scara()``."""
        if not is_scara(robot):
            raise InvalidValueError(f"{robot.name!r} does not have the table of the report's SCARA")
        rows = robot.rows
        return cls(l1=rows[1].d, l2=rows[2].d, height=rows[0].r)


def is_scara(robot: Robot) -> bool:
    """Whether a robot has the table of the report's SCARA, of any lengths."""
    rows = robot.rows
    kinds = ("revolute", "revolute", "revolute", "prismatic")
    return (
        robot.is_plain
        and tuple(row.joint for row in rows) == kinds
        and tuple(row.alpha for row in rows) == (0.0, 0.0, 0.0, math.pi)
        and not any(row.theta for row in rows)
        and not any((rows[0].d, rows[3].d, rows[1].r, rows[2].r, rows[3].r))
    )


def lift_position(arm: ScaraGeometry, R: float) -> float:
    """Position of the fourth joint for a height R of the tool above its lowest one [m].

    ``q4 = height - lowest - R``, with R in 0 ... height - lowest (report B, table 1.2).
    """
    stroke = arm.height - arm.lowest
    if not 0.0 <= R <= stroke:
        raise InvalidValueError(f"the tool height R is {R!r} m; it must be in 0 ... {stroke:.4g} m")
    return stroke - R


def tool_position(arm: ScaraGeometry, q: ArrayLike) -> Array:
    """Position p_BF of the tool, (..., 3) [m], at three angles and the lift, (..., 4).

    Report B, 1.4 (printed without the height 452.4 mm).
    """
    (q1, q2, _, q4), cos, sin = split("q", q, 4)
    x = arm.l1 * cos(q1) + arm.l2 * cos(q1 + q2)
    y = arm.l1 * sin(q1) + arm.l2 * sin(q1 + q2)
    return assemble((x, y, arm.height - q4))


def task_jacobian(arm: ScaraGeometry, q: ArrayLike) -> Array:
    """Jacobian of the task (x, y, yaw) against the three angles (..., 3), (..., 3, 3).

    ``[vx, vy, yaw rate] = J @ qdot[:3]``. Rows 0 and 1 are in m/rad, row 2 in rad/rad; singular
    where sin(q2) = 0 (report B, 1.5).
    """
    (q1, q2, _), cos, sin = split("q", q, 3)
    x2, y2 = arm.l2 * cos(q1 + q2), arm.l2 * sin(q1 + q2)
    x1, y1 = arm.l1 * cos(q1) + x2, arm.l1 * sin(q1) + y2
    return assemble(((-y1, -y2, 0.0), (x1, x2, 0.0), (1.0, 1.0, 1.0)))


def determinant(arm: ScaraGeometry, q: ArrayLike) -> Array:
    """Determinant of the task Jacobian: ``l1 l2 sin(q2)`` [m^2], independent of q1.

    Report B, 1.6, calls q1 = 0 singular; it is not.
    """
    return arm.l1 * arm.l2 * np.sin(finite_vectors("q", q, 3)[..., 1])


def jacobian_rate_bias(arm: ScaraGeometry, q: ArrayLike, qdot: ArrayLike) -> Array:
    """Task acceleration at zero joint acceleration: ``dJ/dt @ qdot``, (..., 3).

    In m/s^2, m/s^2 and rad/s^2.
    """
    (q1, q2, _), cos, sin = split("q", q, 3)
    (w1, w2, _), _, _ = split("qdot", qdot, 3)
    q12, w12 = q1 + q2, w1 + w2
    x = -arm.l1 * cos(q1) * w1**2 - arm.l2 * cos(q12) * w12**2
    y = -arm.l1 * sin(q1) * w1**2 - arm.l2 * sin(q12) * w12**2
    return assemble((x, y, 0.0))


class MovableScara(Movable):
    """The tool's x, y and yaw, moved by the first three joints; the lift stays (report B, 1.5)."""

    geometry: ScaraGeometry
    has_formula = True
    twists = np.eye(6)[:, [3, 4, 2]]

    def __init__(self, arm: ScaraGeometry, lift: float = 0.0) -> None:
        self.geometry = arm
        self.length = arm.l1 + arm.l2
        self.row_lengths = (1.0, 1.0, self.length)
        self.determinant_scale = arm.l1 * arm.l2
        self._lift = lift

    def foot(self, q: Floats) -> Array:
        """Position of the tool in the base frame, (3,) [m]."""
        return tool_position(self.geometry, [*q[:3], self._lift])

    def jacobian(self, q: Floats) -> Array:
        """Jacobian of x and y [m/rad] and yaw, (3, 3)."""
        return task_jacobian(self.geometry, q)

    def sigma_mins(self, q: Array) -> Array:
        """Smallest singular value of J, its rows in lengths, of postures (rows, 3), (rows,) [m]."""
        J = task_jacobian(self.geometry, q)
        return smallest_singular_value(np.array(self.row_lengths)[:, np.newaxis] * J)

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (3,)."""
        return jacobian_rate_bias(self.geometry, q, qdot)

    def formula(
        self, q: Values, a: Values, qdot: Values, w: Values, functions: Functions
    ) -> tuple[Values, ...]:
        """``J^-1 (a - dJ/dt qdot)`` in the arithmetic of ``functions``."""
        x1, y1, x2, y2 = plane = self._plane(q, functions)
        square1, square2 = qdot[0] * w[0], (qdot[0] + qdot[1]) * (w[0] + w[1])
        x, y = a[0] + x1 * square1 + x2 * square2, a[1] + y1 * square1 + y2 * square2
        return self._inverted(plane, q, (x, y, a[2]), functions)

    def rate_formula(self, q: Values, v: Values, functions: Functions) -> tuple[Values, ...]:
        """``J^-1 v`` in the arithmetic of ``functions``."""
        return self._inverted(self._plane(q, functions), q, v, functions)

    def _plane(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Both links in the base frame: x1, y1, x2, y2 [m]."""
        l1, l2 = self.geometry.l1, self.geometry.l2
        cos, sin = functions
        first, both = q[0], q[0] + q[1]
        return l1 * cos(first), l1 * sin(first), l2 * cos(both), l2 * sin(both)

    def _inverted(
        self, plane: tuple[Values, ...], q: Values, v: Values, functions: Functions
    ) -> tuple[Values, ...]:
        x1, y1, x2, y2 = plane
        determinant = self.geometry.l1 * self.geometry.l2 * functions[1](q[1])
        first = (x2 * v[0] + y2 * v[1]) / determinant
        second = -((x1 + x2) * v[0] + (y1 + y2) * v[1]) / determinant
        return first, second, v[2] - first - second

    @property
    def has_positions(self) -> tuple[bool, ...]:
        """The yaw is one, too."""
        return True, True, True

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Position [m] and yaw [rad] of the tool, (3,)."""
        x1, y1, x2, y2 = self._plane(q, functions)
        return x1 + x2, y1 + y2, q[0] + q[1] + q[2]

    def postures(self, task: Array, like: Floats) -> Array:
        """Angles for x, y [m] and yaw [rad] (rows, 3), with the elbow on the side of ``like``."""
        return inverse_kinematics(self.geometry, task, like)

    def differentiable(self) -> DifferentiableChain:
        """The arm for angles that carry derivatives; x, y and yaw are those of the wrist."""
        arm = self.geometry
        lengths = (0.0, arm.l1, arm.l2)
        return DifferentiableChain(self, [Row(joint="revolute", d=length) for length in lengths])


def branch_angles(arm: ScaraGeometry, task: ArrayLike) -> Array:
    """Angles of both branches for x, y [m] and yaw [rad] (..., 3), (..., 2, 3) [rad].

    Elbow left (sin q2 > 0) comes first; NaN where the point is out of reach.
    """
    goals = finite_vectors("task", task, 3)
    x, y, yaw = goals[..., 0], goals[..., 1], goals[..., 2]
    elbow = triangle_angle(arm.l1, arm.l2, np.hypot(x, y))
    solutions = []
    for q2 in (elbow, -elbow):
        q1 = np.arctan2(y, x) - np.arctan2(arm.l2 * np.sin(q2), arm.l1 + arm.l2 * np.cos(q2))
        solutions.append(np.stack([q1, q2, yaw - q1 - q2], axis=-1))
    return np.stack(solutions, axis=-2)


def inverse_kinematics(arm: ScaraGeometry, task: ArrayLike, like: ArrayLike) -> Array:
    """Angles (..., 3) that put the tool at (x, y, yaw), with the elbow on the side of a posture.

    The side and the turns are those of ``like`` (3,) [rad]; NaN where the point is out of reach.
    """
    near = one_vector("like", like, 3)
    return nearest_turn(branch_angles(arm, task)[..., 0 if np.sin(near[1]) >= 0.0 else 1, :], near)
