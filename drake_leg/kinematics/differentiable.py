"""Robots whose joint positions may be any scalars with ``sin`` and ``cos``, such as AutoDiffXd.

They repeat in those scalars what ``leg`` and ``chain`` do in floats, which are much faster.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.khalil import (
    Array,
    Frame,
    chain_frames,
    foot_jacobian_rate,
    joint_columns,
    links_of,
)
from drake_leg.kinematics.movable import SINGULAR_BELOW, Floats, Functions, Movable, Values
from drake_leg.robot.robot import Row


def cosine(angle: Any) -> Any:  # noqa: ANN401 - of its scalar
    """Cosine of a float, or of a scalar with derivatives."""
    return math.cos(angle) if isinstance(angle, float | int) else angle.cos()


def sine(angle: Any) -> Any:  # noqa: ANN401
    """Sine of a float, or of a scalar with derivatives."""
    return math.sin(angle) if isinstance(angle, float | int) else angle.sin()


class DifferentiableChain(Movable):
    """A chain in scalars with derivatives; ``plain`` is the same robot in floats."""

    def __init__(self, plain: Movable, rows: Sequence[Row]) -> None:
        self._plain, self._links = plain, links_of(rows)
        self.turning, self.twists, self.row_lengths = plain.turning, plain.twists, plain.row_lengths
        self.length, self.determinant_scale = plain.length, plain.determinant_scale
        self._lengths = np.array(plain.row_lengths)

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""
        return np.array(self._frames(q)[-1][3])

    @property
    def has_positions(self) -> tuple[bool, ...]:
        """Which components of ``task_position`` are positions, (m,)."""
        return self._plain.has_positions

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """What the commanded velocities are the derivatives of, (m,)."""
        if self._plain.has_formula:
            return self._plain.task_position(q, functions)
        return super().task_position(q, functions)

    def jacobian(self, q: Floats) -> Array:
        """J, (m, n)."""
        return self._jacobian(self._frames(q))

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (m,)."""
        bias: Array = self._rate(self._frames(q), qdot) @ np.asarray(qdot)
        return bias

    def determinant(self, q: Floats) -> Any:  # noqa: ANN401 - a scalar of the kind of q
        """Det J, or ``sqrt(det(J J^T))`` of a redundant chain."""
        J = self.jacobian(q)
        if self.is_redundant:
            return _eliminated(J @ J.T, np.zeros(self.size))[0] ** 0.5
        return _eliminated(J, np.zeros(self.size))[0]

    def singular(self, q: Floats, time: float | None = None) -> SingularConfigurationError:
        """Make the error of a singular posture, in floats."""
        now = None if time is None else value_of(time)
        return self._plain.singular([value_of(each) for each in q], now)

    def rates(self, q: Floats, v: Floats) -> Floats:
        """Smallest rates that produce v."""
        J = self._lengths[:, np.newaxis] * self.jacobian(q)
        qdot: list[float] = self._smallest(J, self._lengths * np.asarray(v), q).tolist()
        return qdot

    def accelerations(
        self,
        q: Floats,
        qdot: Floats,
        a: Floats,
        v: Floats | None = None,
        w: Floats | None = None,
    ) -> Floats:
        """Derivative of the smallest rates (see ``chain``)."""
        frames, scale = self._frames(q), self._lengths[:, np.newaxis]
        J, u = scale * self._jacobian(frames), np.asarray(qdot)
        J_rate = scale * self._rate(frames, qdot if w is None else w)
        qddot = self._smallest(J, self._lengths * np.asarray(a) - J_rate @ u, q)
        if self.is_redundant:
            y = self._solved(J @ J.T, J @ u, q)
            swing = J_rate.T @ y
            qddot = qddot + swing - self._smallest(J, J @ swing, q)
        found: list[float] = qddot.tolist()
        return found

    def differentiable(self) -> Movable:
        """The chain itself."""
        return self

    def _frames(self, q: Floats) -> list[Frame]:
        return chain_frames(self._links, (q, cosine, sine))

    def _jacobian(self, frames: list[Frame]) -> Array:
        J: Array = self.twists.T @ np.array(joint_columns(self._links, frames)).T
        return J

    def _rate(self, frames: list[Frame], w: Floats) -> Array:
        rate: Array = self.twists.T @ foot_jacobian_rate(self._links, frames, w)
        return rate

    def _smallest(self, J: Array, v: Array, q: Floats) -> Array:
        if not self.is_redundant:
            return self._solved(J, v, q)
        smallest: Array = J.T @ self._solved(J @ J.T, v, q)
        return smallest

    def _solved(self, matrix: Array, right: Array, q: Floats) -> Array:
        _, solution = _eliminated(matrix, right)
        if solution is None:
            raise self.singular(q)
        return solution


def value_of(scalar: Any) -> float:  # noqa: ANN401
    """Return the value of a scalar without its derivatives."""
    return float(scalar.value() if hasattr(scalar, "value") else scalar)


def _eliminated(matrix: Array, right: Array) -> tuple[Any, Array | None]:
    """Determinant and solution of a linear system, by elimination with partial pivoting.

    The solution is None if the smallest pivot is at most ``SINGULAR_BELOW`` of the largest.
    """
    rows = [[*row, end] for row, end in zip(matrix.tolist(), right.tolist(), strict=True)]
    size = len(rows)
    determinant: Any = 1.0
    for k in range(size):
        largest = max(range(k, size), key=lambda i: abs(value_of(rows[i][k])))
        if largest != k:
            rows[k], rows[largest] = rows[largest], rows[k]
            determinant = -determinant
        determinant = determinant * rows[k][k]
        if value_of(rows[k][k]) == 0.0:
            return determinant, None
        for row in rows[k + 1 :]:
            factor = row[k] / rows[k][k]
            row[k:] = [x - factor * y for x, y in zip(row[k:], rows[k][k:], strict=True)]
    pivots = [abs(value_of(rows[k][k])) for k in range(size)]
    if not min(pivots) > SINGULAR_BELOW * max(pivots):
        return determinant, None
    solution: list[Any] = []
    for row, k in zip(reversed(rows), range(size - 1, -1, -1), strict=True):
        known = sum((x * y for x, y in zip(row[k + 1 : size], solution, strict=True)), 0.0)
        solution.insert(0, (row[size] - known) / row[k])
    return determinant, np.array(solution)
