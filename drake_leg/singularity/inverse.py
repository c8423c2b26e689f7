"""Inverts the Jacobian: exactly, damped, or within the limits of the joints' rates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.movable import Floats, Functions, Movable, Values
from drake_leg.robot.robot import Segment
from drake_leg.units import require_positive

FLOOR = 0.25  # of lambda: about where sigma settles while the command pushes outwards
LEAST = 1e-7  # of the arm's length: selects the smallest of a redundant robot's rates
DIFFERENCE = 1e-7  # [s], of the derivative of damped rates; it magnifies their rounding 1e7 times
TYPICAL = 0.2  # of the arm's length: slope of sigma along w at a boundary
STEEPEST = 0.5  # [1/rad] of the arm's length: bound of the slope of the smallest singular value

METHODS = ("exact", "damped", "limited")
DAMPED_BELOW = 0.03  # of the arm's length: singular value at which damping begins
DEFAULT_RATE = 2.0 * math.pi  # [rad/s or m/s] of a joint without a limit of its own
SETTLING = 0.1  # [s], time constant of a joint's approach to its limit
LAGS = 8.0  # least settling in time constants of the filters: from 27/4 on it does not overshoot

# A joint stops this far before its limit: where its rate has a kink, the error of an integration
# step is about 1e-5 rad, which would carry a joint beyond a limit at which it stops exactly.
MARGIN = 5e-4  # [rad or m], at most
PART = 0.1  # of the distance between the limits, at most
RETREAT = 2.0  # [s], time constant of the retreat of a joint that starts nearer than that
HEADROOM = 0.02  # part of the greatest rate that is reserved for the same errors

FREE, FASTEST, BRAKING = range(3)  # what bounds a rate


class _Joint(NamedTuple):
    low: float  # [rad or m], where it comes to rest, before its limit
    high: float
    most: float  # [rad/s or m/s]
    settling: float  # [s]

    def allowed(self, room: float) -> float:
        """Greatest rate toward a limit at the distance ``room``."""
        rate = room / (self.settling if room >= 0.0 else RETREAT)
        return min(max(rate, -self.most), self.most)

    def bounds(self, q: float) -> tuple[float, float]:
        up = self.allowed(self.high - q)
        return min(-self.allowed(q - self.low), up - 1e-9 * self.most), up

    def kind(self, bound: float) -> int:
        """Kind of a bound: of the rate itself, or of braking before a limit."""
        return FASTEST if bound >= self.most else BRAKING


class RateBox:
    """Bounds of the joint rates in every posture, from limits of positions (n,) and of rates (n,).

    With ``room = upper - margin - q``, a rate is at most ``room / settling`` if the room is
    positive, and ``room / RETREAT`` if it is not: a joint approaches a point just before its limit
    exponentially, and does not cross it. The lower limit is treated alike. Limits of positions may
    be infinite; units are rad or m, and s.
    """

    def __init__(self, lower: Floats, upper: Floats, fastest: Floats, settling: float) -> None:
        self._joints = []
        for low, high, most in zip(lower, upper, fastest, strict=True):
            margin = min(MARGIN, PART * (high - low))
            joint = _Joint(low + margin, high - margin, (1.0 - HEADROOM) * most, settling)
            self._joints.append(joint)

    def bounds(self, q: Floats) -> tuple[list[float], list[float]]:
        """Lowest and highest rates (n,) in a posture [rad/s or m/s]; they always differ."""
        pairs = [joint.bounds(position) for joint, position in zip(self._joints, q, strict=True)]
        return [low for low, _ in pairs], [high for _, high in pairs]

    def holds(self, q: Floats, qdot: Floats) -> bool:
        """Whether rates (n,) in a posture are within their bounds."""
        low, high = self.bounds(q)
        return all(a <= rate <= b for a, rate, b in zip(low, qdot, high, strict=True))

    def regime(self, q: Floats, qdot: Floats) -> tuple[int, ...]:
        """Which bound limits each joint's rate; the rates have a kink where that changes.

        FREE, FASTEST or BRAKING, negative at a lower bound, (n,), for rates within the bounds.
        """
        bounds = zip(self._joints, qdot, *self.bounds(q), strict=True)
        return tuple(
            joint.kind(high) if rate >= high else -joint.kind(-low) if rate <= low else FREE
            for joint, rate, low, high in bounds
        )


class _Damping(NamedTuple):
    """The damping at a posture where the smallest singular value is small."""

    J: Array  # rows in [m]
    squared: float  # lambda^2 [m^2]
    steepness: float  # slope of the smallest singular value along w [m]
    outwards: Array  # w, signed so that J becomes more regular, and 0 where that changes nothing


class Damped(Movable):
    """A robot whose rates are damped where its Jacobian is nearly singular.

    With the singular value decomposition J = U S V^T, the rates of an exact inverse grow like
    1/sigma along the last right singular vector w. Damping replaces that factor by
    ``sigma / (sigma^2 + lambda^2)``. The rates are those that minimize
    ``|J qdot - v|^2 + lambda^2 |qdot - b|^2`` with

    ``lambda = (below / 2) (1 - (sigma / below)^2)`` where sigma < below [m], and 0 elsewhere,

    sigma being the smallest singular value: there the inverse is exact. The rates and their slopes
    are continuous. The small ``b``, along w toward more regular postures, is proportional to the
    command: a leg that is pushed against the boundary rests just before it and not on it, and so
    keeps the side on which its knee is bent. Rates are at most about ``1.3 |v| / below``.

    With a box the rates are the least squares within it, by SciPy's bounded-variable algorithm.
    """

    is_exact = False

    def __init__(self, exact: Movable, below: float, box: RateBox | None = None) -> None:
        self.exact = exact
        self.turning, self.twists, self.row_lengths = exact.turning, exact.twists, exact.row_lengths
        self.length, self.determinant_scale = exact.length, exact.determinant_scale
        self.geometry, self.varies = exact.geometry, exact.varies
        self._below, self._strongest = below, below / 2.0
        self._box = box
        self._lengths = np.array(exact.row_lengths)
        # Rates, their derivative and stiffness are computed one after another in the same posture.
        self._damping_at = lru_cache(maxsize=2)(self._damping)

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""
        return self.exact.foot(q)

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Position that is commanded, (m,)."""
        return self.exact.task_position(q, functions)

    @property
    def has_positions(self) -> tuple[bool, ...]:
        """Which of its components are positions, (m,)."""
        return self.exact.has_positions

    def jacobian(self, q: Floats) -> Array:
        """J, (m, n)."""
        return self.exact.jacobian(q)

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (m,)."""
        return self.exact.bias(q, qdot)

    def determinant(self, q: Floats) -> float:
        """Determinant of the exact robot."""
        return self.exact.determinant(q)

    def at(self, q: Floats) -> Damped:
        """The robot with the twists of a posture, with the same damping."""
        return Damped(self.exact.at(q), self._below, self._box) if self.varies else self

    def rates(self, q: Floats, v: Floats) -> Floats:
        """Least-squares rates, within the box."""
        here = self._damping_at(tuple(q))
        free: list[float] = self._free(q, v, here).tolist()
        if self._box is None or self._box.holds(q, free):
            return free
        within: list[float] = self._bounded(q, v, here, *self._box.bounds(q)).tolist()
        return within

    def accelerations(
        self,
        q: Floats,
        qdot: Floats,
        a: Floats,
        v: Floats | None = None,
        w: Floats | None = None,
    ) -> Floats:
        """Derivative of the rates: exact where they are, else a difference, which needs v."""
        if self._is_exact_at(q, qdot):
            return self.exact.accelerations(q, qdot, a)
        if v is None:
            raise InvalidValueError("the derivative of damped rates needs the commanded velocity")
        later = self.rates(_moved(q, qdot if w is None else w), _moved(v, a))
        return [(after - now) / DIFFERENCE for after, now in zip(later, qdot, strict=True)]

    def regime(self, q: Floats, v: Floats) -> tuple[int, ...]:
        """Which bound limits each joint's rate, as ``RateBox.regime``; () without a box."""
        return () if self._box is None else self._box.regime(q, self.rates(q, v))

    def stiffness(self, q: Floats, v: Floats) -> tuple[float, float]:
        """How fast the rates change with the posture: at most, and in this one [1/s]."""
        speed = float(np.linalg.norm(self._lengths * np.asarray(v)))
        most = STEEPEST * self.length * speed / self._strongest**2
        here = self._damping_at(tuple(q))
        if here is None:
            return most, 0.0
        return most, here.steepness * speed / max(here.squared, self._strongest**2)

    def is_exact_along(self, q: Array, qdot: Array, sigma_min: Array) -> bool:
        """Whether neither the damping nor the box acts along a motion (rows, n).

        ``sigma_min`` (rows,) are the smallest singular values [m]. Between two rows the value may
        fall by as much as it changes from one row to the next.
        """
        fall = float(np.abs(np.diff(sigma_min)).max(initial=0.0))
        if sigma_min.min() - fall < self._below:
            return False
        box = self._box
        rows = zip(q.tolist(), qdot.tolist(), strict=True)
        return box is None or not any(any(box.regime(*row)) for row in rows)

    def _damping(self, q: tuple[float, ...]) -> _Damping | None:
        J = self.jacobian_in_lengths(q)
        U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
        if sigma[-1] >= self._below:
            return None
        w = Vt[-1]
        slope = float((U[:, -1] * self._lengths) @ self.bias(q, w.tolist()))
        part = 1.0 - (float(sigma[-1]) / self._below) ** 2
        outwards = slope / (TYPICAL * self.length) * w
        return _Damping(J, (self._strongest * part) ** 2, abs(slope), outwards)

    def _free(self, q: Floats, v: Floats, here: _Damping | None) -> Array:
        """Rates without a box."""
        if here is None:
            return np.array(self.exact.rates(q, v))
        weighted = self._lengths * np.asarray(v)
        rest = self._rest(weighted, here)
        normal = here.J @ here.J.T + here.squared * np.eye(self.size)
        free: Array = rest + here.J.T @ np.linalg.solve(normal, weighted - here.J @ rest)
        return free

    def _bounded(
        self, q: Floats, v: Floats, here: _Damping | None, low: Floats, high: Floats
    ) -> Array:
        """Rates within bounds."""
        from scipy.optimize import lsq_linear  # slow to load

        weighted = self._lengths * np.asarray(v)
        matrix, right = self.jacobian_in_lengths(q), weighted
        damper, rest = LEAST * self.length * self.is_redundant, np.zeros(self.joints)
        if here is not None:
            damper, rest = math.sqrt(here.squared), self._rest(weighted, here)
        if damper > 0.0:
            matrix = np.vstack([matrix, damper * np.eye(self.joints)])
            right = np.concatenate([weighted, damper * rest])
        solution = lsq_linear(matrix, right, bounds=(low, high), method="bvls", tol=1e-14)
        inside: Array = np.clip(solution.x, low, high)
        return inside

    def _is_exact_at(self, q: Floats, qdot: Floats) -> bool:
        if self._damping_at(tuple(q)) is not None:
            return False
        return self._box is None or not any(self._box.regime(q, qdot))

    def _rest(self, v: Array, here: _Damping) -> Array:
        """Rates toward which damping pulls: at rest sigma is about ``FLOOR`` of the damping."""
        rest: Array = FLOOR * float(np.linalg.norm(v)) / self._strongest * here.outwards
        return rest


def _moved(start: Floats, rate: Floats) -> list[float]:
    return [x + DIFFERENCE * dx for x, dx in zip(start, rate, strict=True)]


@dataclass(frozen=True, kw_only=True)
class Inverse:
    """A method of inversion and its parameters."""

    method: str = "exact"
    damped_below: float | None = None  # [m]; None: DAMPED_BELOW of the arm's length
    rate_limit: float | None = None  # [rad/s] of turning joints; None: their own, or DEFAULT_RATE

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise InvalidValueError(
                f"the inverse is {self.method!r}; it must be one of {', '.join(METHODS)}"
            )
        rate = None if self.rate_limit is None else math.degrees(self.rate_limit)
        for name, value, unit, methods in (
            ("the singular value at which damping begins", self.damped_below, "m", METHODS[1:]),
            ("the rate limit", rate, "deg/s", METHODS[2:]),
        ):
            if value is None:
                continue
            require_positive(name, value, unit)
            if self.method not in methods:
                raise InvalidValueError(
                    f"{name} is {value:.9g} {unit}, which means nothing to the inverse "
                    f"{self.method!r}",
                    advice="leave it out, or choose `inverse='damped'` or `'limited'`"
                    if len(methods) > 1
                    else "leave it out, or choose `inverse='limited'`",
                )

    @property
    def is_exact(self) -> bool:
        """Whether the robot has to stop at a singularity."""
        return self.method == METHODS[0]

    def of(self, exact: Movable, joints: tuple[Segment, ...], lag: float = 0.0) -> Movable:
        """Invert a robot's Jacobian this way.

        ``joints`` are the moving ones, with their limits; ``lag`` is the time constant [s] of the
        two first-order lags in series between commanded and actual joint rates.
        """
        if self.is_exact:
            return exact
        below = DAMPED_BELOW * exact.length if self.damped_below is None else self.damped_below
        if self.method == "damped":
            return Damped(exact, below)
        mechanics = [segment.mechanics for segment in joints]
        lower, upper = zip(*(joint.bounds for joint in mechanics), strict=True)
        box = RateBox(
            lower,
            upper,
            [self._fastest(segment) for segment in joints],
            max(SETTLING, LAGS * lag),
        )
        return Damped(exact, below, box)

    def _fastest(self, segment: Segment) -> float:
        own = segment.mechanics.velocity
        if self.rate_limit is not None and segment.row.joint == "revolute":
            return self.rate_limit
        return DEFAULT_RATE if own is None else own
