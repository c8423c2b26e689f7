"""The protocol of a robot whose foot can be moved: commanded velocities to joint rates.

There are as many commanded velocities as moving joints, or fewer: then the robot is redundant.
These functions run inside a simulation, thousands of times a second, for one posture at a time, so
they take and return plain floats.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Self

import numpy as np

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.khalil import Array

Floats = Sequence[float]
Values = Any  # floats, arrays, or symbols
Functions = tuple[Callable[[Any], Any], Callable[[Any], Any]]  # their cosine and sine

# Smallest pivot of the Jacobian's LU factors, relative to the largest: below it the joint rates
# have lost half of their digits.
SINGULAR_BELOW = 1e-8

TRANSLATION = np.eye(6)[:, 3:]  # twists of the foot, rotation first: x, y, z
TRANSLATION.setflags(write=False)


class Movable(ABC):
    """A robot whose foot can be commanded.

    n joints move and m velocities are commanded; ``v = J qdot``. A subclass defines J, and may
    replace the numerical inverse of a square J.
    """

    turning: tuple[bool, ...] = (True, True, True)  # (n,): revolute, not prismatic
    twists: Array = TRANSLATION  # (6, m): rotation, then translation, for each component of v
    row_lengths: tuple[float, ...] = (1.0, 1.0, 1.0)  # that scale the rows of J to lengths [m/unit]
    length: float  # of the stretched arm [m]
    determinant_scale: float  # roughly the greatest determinant, in its unit
    geometry: object = None  # for closed forms, as chain.geometry_of returns it
    is_exact: bool = True  # whether the rates are undefined where J is singular
    varies: bool = False  # whether the twists depend on the posture
    has_formula: bool = False  # whether ``formula`` and ``task_position`` take any arithmetic

    @abstractmethod
    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""

    @abstractmethod
    def jacobian(self, q: Floats) -> Array:
        """J, (m, n)."""

    @abstractmethod
    def bias(self, q: Floats, qdot: Floats) -> Array:
        """Acceleration of the foot without acceleration of the joints: ``dJ/dt qdot``, (m,)."""

    def determinant(self, q: Floats) -> float:
        """Det J, or ``sqrt(det(J J^T))`` of a redundant robot."""
        return float(np.linalg.det(self.jacobian(q)))

    def determinants(self, q: Array) -> Array:
        """``determinant`` of many postures (rows, n), (rows,)."""
        return np.array([self.determinant(posture) for posture in q.tolist()])

    def rates(self, q: Floats, v: Floats) -> Floats:
        """``J^-1 v``, or the smallest rates that produce v, (n,) [rad/s or m/s].

        Raises
        ------
        SingularConfigurationError
            If J has no inverse and the robot ``is_exact``.
        """
        qdot: list[float] = exact_rates(self.jacobian(q), np.asarray(v), q).tolist()
        return qdot

    def accelerations(
        self,
        q: Floats,
        qdot: Floats,
        a: Floats,
        v: Floats | None = None,
        w: Floats | None = None,
    ) -> Floats:
        """Derivative of the rates while the joints move at rates w, by default ``qdot``.

        ``J^-1 (a - dJ/dt qdot)`` where J is square. Near a singularity, or where they are damped,
        rates may change so steeply with the posture that a small difference between commanded and
        actual rates would grow, unless w is the actual ones.
        """
        right_side = np.asarray(a) - self._bias_along(q, qdot, qdot if w is None else w)
        qddot: list[float] = exact_rates(self.jacobian(q), right_side, q).tolist()
        return qddot

    def formula(
        self, q: Values, a: Values, qdot: Values, w: Values, functions: Functions
    ) -> tuple[Values, ...]:
        """``J^-1 (a - dJ/dt qdot)`` in any arithmetic, of a robot that ``has_formula``.

        A singular posture is not refused: the division by zero is left to the arithmetic.
        """
        raise NotImplementedError

    def rate_formula(self, q: Values, v: Values, functions: Functions) -> tuple[Values, ...]:
        """``J^-1 v`` in any arithmetic, as ``formula``."""
        raise NotImplementedError

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """What the commanded velocities are the derivatives of, (m,); 0 for a rotation."""
        position: tuple[float, ...] = tuple((self.twists[3:].T @ self.foot(q)).tolist())
        return position

    def postures(self, task: Array, like: Floats) -> Array | None:
        """Joint positions for task positions along a path, (rows, m), in closed form, (rows, n).

        The first one is ``like`` (n,), the others are on its branch; NaN out of reach. None where
        there is no closed form.
        """
        return None

    @property
    def has_positions(self) -> tuple[bool, ...]:
        """Which components of ``task_position`` are positions, (m,); the others are 0."""
        return tuple(bool(column.any()) for column in self.twists[3:].T)

    def _bias_along(self, q: Floats, qdot: Floats, w: Floats) -> Array:
        """``dJ/dt qdot`` with J changing along w: the bias is a quadratic form, polarised."""
        u, along = np.asarray(qdot), np.asarray(w)
        if (u == along).all():
            return self.bias(q, qdot)
        return (self.bias(q, (u + along).tolist()) - self.bias(q, (u - along).tolist())) / 4.0

    def stiffness(self, q: Floats, v: Floats) -> tuple[float, float]:
        """How fast inexact rates change with the posture: at most, and in this one [1/s]."""
        return 0.0, 0.0

    def regime(self, q: Floats, v: Floats) -> tuple[int, ...]:
        """Which bound limits each joint's rate; the rates have a kink where that changes."""
        return ()

    def at(self, q: Floats) -> Self:
        """The robot with the twists of a posture: itself, unless it ``varies``."""
        return self

    def differentiable(self) -> Movable:
        """The same robot for joint positions that carry derivatives, such as AutoDiffXd.

        Raises
        ------
        InvalidValueError
            If its inverse is not exact.
        """
        raise InvalidValueError(
            f"a {type(self).__name__} robot has no derivatives",
            advice="choose the exact inverse",
        )

    @property
    def joints(self) -> int:
        """Number of moving joints, n."""
        return len(self.turning)

    @property
    def size(self) -> int:
        """Number of commanded velocities, m."""
        return int(self.twists.shape[1])

    @property
    def is_redundant(self) -> bool:
        """Whether more joints move than velocities are commanded."""
        return self.joints > self.size

    @property
    def keeps_orientation(self) -> bool:
        """Whether the foot's rotation is commanded, too."""
        return bool(self.twists[:3].any())

    def command(self, v: Floats | Array) -> Array:
        """Command (m,) for a velocity (3,) [m/s] of a foot that does not rotate."""
        return np.asarray(self.twists[3:].T @ np.asarray(v))

    def jacobian_in_lengths(self, q: Floats) -> Array:
        """J with all of its rows scaled to lengths, (m, n) [m]."""
        J: Array = np.array(self.row_lengths)[:, np.newaxis] * self.jacobian(q)
        return J

    def normalised_determinant(self, q: Floats) -> float:
        """Determinant over its scale, in about -1 ... 1: zero where J is singular."""
        return self.determinant(q) / self.determinant_scale

    def sigma_min(self, q: Floats) -> float:
        """Smallest singular value of J, its rows scaled to lengths [m]."""
        return float(smallest_singular_value(self.jacobian_in_lengths(q)))

    def sigma_mins(self, q: Array) -> Array:
        """``sigma_min`` of many postures (rows, n), (rows,)."""
        return np.array([self.sigma_min(posture) for posture in q.tolist()])

    def singular(self, q: Floats, time: float | None = None) -> SingularConfigurationError:
        """Make the error of a singular posture at a time [s], to be raised."""
        return SingularConfigurationError(q=q, sigma_min=self.sigma_min(q), time=time)


@cache
def lapack() -> Any:  # noqa: ANN401 - SciPy has no types
    """LAPACK's routines; SciPy takes long to load, and closed forms do without it."""
    from scipy.linalg import lapack as routines

    return routines


def exact_rates(J: Array, v: Array, q: Floats) -> Array:
    """Solve ``J @ qdot = v``: the reports' ``inv(J) * v`` (report A, eq. 19).

    J (n, n) is singular if its smallest pivot is at most ``SINGULAR_BELOW`` times the largest; the
    error names the posture q. LAPACK's ``dgesv`` is called by itself: ``numpy.linalg.solve`` wraps
    it at four times the cost for a matrix this small, and hides the pivots.
    """
    lu, _, qdot, _ = lapack().dgesv(J, v)
    pivots = [abs(pivot) for pivot in lu.diagonal().tolist()]
    if not min(pivots) > SINGULAR_BELOW * max(pivots):
        raise SingularConfigurationError(q=q, sigma_min=float(smallest_singular_value(J)))
    solution: Array = qdot
    return solution


def smallest_singular_value(J: Array) -> Array:
    """Smallest singular values of Jacobians (..., m, n), in the unit of J, (...)."""
    return np.linalg.svd(J, compute_uv=False)[..., -1].astype(np.float64, copy=False)


def require_movable(robot: object) -> None:
    """Refuse what is not a Movable, such as a Robot."""
    if not isinstance(robot, Movable):
        raise InvalidValueError(
            f"what is commanded must be a Movable, not a {type(robot).__name__}",
            advice="pass movable(robot)",
        )
