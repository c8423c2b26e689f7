"""Joint rates that stay bounded at a singularity: damped, and within limits, least squares.

In the eyes of the singular value decomposition J = U S V^T the rates of an exact inverse grow like
1/sigma along the last right singular vector w. Damping lets that part go through
``sigma / (sigma^2 + lambda^2)`` instead, with a lambda that is zero where sigma is not small.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import lsq_linear

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.rate_box import RateBox
from drake_leg.kinematics.task import Floats, Task

FLOOR = 0.25  # of lambda: about where sigma comes to rest while the command pushes outwards
LEAST = 1e-7  # of the arm's length: what chooses the least of a redundant task's rates
DIFFERENCE = 1e-7  # [s], of the derivative of damped rates
TYPICAL = 0.2  # of the arm's length: slope of sigma along w at a boundary
STEEPEST = 0.5  # [1/rad] of the arm's length: bound of the slope of the smallest singular value


class _Damping(NamedTuple):
    """The damping at a posture where the smallest singular value is small."""

    J: Array  # rows in [m]
    squared: float  # lambda^2 [m^2]
    steepness: float  # slope of the smallest singular value along w [m]
    outwards: Array  # w, signed so that J becomes more regular, and 0 where that changes nothing


def damped_task(task: Task, below: float, box: RateBox | None = None) -> Task:
    """Damp a task's inverse where its Jacobian is nearly singular.

    The rates are those that minimise ``|J qdot - v|^2 + lambda^2 |qdot - b|^2`` with

    ``lambda = (below / 2) (1 - (sigma / below)^2)`` where sigma < below, and 0 elsewhere,

    sigma being the smallest singular value: there the inverse is exact. The rates and their slopes
    are continuous. The small ``b``, along w towards more regular postures, is proportional to the
    command: a leg that is pushed against the boundary rests just before it and not on it, and so
    keeps the side on which its knee is bent. Rates are at most about ``1.3 |v| / below``.

    With a box the rates are the least squares' within it, by SciPy's bounded-variable algorithm.

    Parameters
    ----------
    below : float
        Singular value at which damping begins [m].
    box : RateBox, optional
        The lowest and the highest rates of every posture.

    Returns
    -------
    Task
        With a stiffness: it goes through singularities.
    """
    lengths = np.array(task.row_lengths)
    strongest = below / 2.0

    def damping(q: Floats) -> _Damping | None:
        return damping_at(tuple(q))

    @lru_cache(maxsize=2)  # rates, their derivative and their stiffness ask at the same posture
    def damping_at(q: tuple[float, ...]) -> _Damping | None:
        J = lengths[:, np.newaxis] * task.jacobian(q)
        U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
        if sigma[-1] >= below:
            return None
        w = Vt[-1]
        slope = float((U[:, -1] * lengths) @ task.bias(q, w.tolist()))
        part = 1.0 - (float(sigma[-1]) / below) ** 2
        outwards = slope / (TYPICAL * task.length) * w
        return _Damping(J, (strongest * part) ** 2, abs(slope), outwards)

    def free_rates(q: Floats, v: Floats) -> tuple[Array, _Damping | None]:
        here = damping(q)
        if here is None:
            return np.array(task.rates(q, v)), None
        weighted = lengths * np.asarray(v)
        rest = _rest(weighted, here, strongest)
        normal = here.J @ here.J.T + here.squared * np.eye(task.size)
        return rest + here.J.T @ np.linalg.solve(normal, weighted - here.J @ rest), here

    def rates(q: Floats, v: Floats) -> Floats:
        free, here = free_rates(q, v)
        found: list[float] = free.tolist()
        if box is None or box.holds(q, found):
            return found
        within: list[float] = bounded(q, v, here, *box.bounds(q)).tolist()
        return within

    def bounded(q: Floats, v: Floats, here: _Damping | None, low: Floats, high: Floats) -> Array:
        weighted = lengths * np.asarray(v)
        matrix, right = lengths[:, np.newaxis] * task.jacobian(q), weighted
        damper, rest = LEAST * task.length * task.is_redundant, np.zeros(task.joints)
        if here is not None:
            damper, rest = math.sqrt(here.squared), _rest(weighted, here, strongest)
        if damper > 0.0:
            matrix = np.vstack([matrix, damper * np.eye(task.joints)])
            right = np.concatenate([weighted, damper * rest])
        solution = lsq_linear(matrix, right, bounds=(low, high), method="bvls", tol=1e-14)
        inside: Array = np.clip(solution.x, low, high)
        return inside

    def accelerations(q: Floats, qdot: Floats, a: Floats, v: Floats = (), w: Floats = ()) -> Floats:
        if is_exact_at(q, qdot):
            return task.accelerations(q, qdot, a)
        later = rates(_moved(q, w or qdot), _moved(v, a))
        return [(after - now) / DIFFERENCE for after, now in zip(later, qdot, strict=True)]

    def is_exact_at(q: Floats, qdot: Floats) -> bool:
        if damping(q) is not None:
            return False
        return box is None or not any(box.regime(q, qdot))

    def regime(q: Floats, v: Floats) -> tuple[int, ...]:
        return () if box is None else box.regime(q, rates(q, v))

    def stiffness(q: Floats, v: Floats) -> tuple[float, float]:
        speed = float(np.linalg.norm(lengths * np.asarray(v)))
        most = STEEPEST * task.length * speed / strongest**2
        here = damping(q)
        if here is None:
            return most, 0.0
        return most, here.steepness * speed / max(here.squared, (below / 2.0) ** 2)

    return replace(
        task, rates=rates, accelerations=accelerations, stiffness=stiffness, regime=regime
    )


def _rest(v: Array, here: _Damping, strongest: float) -> Array:
    """Rates to which the damping draws: at rest sigma is about ``FLOOR * strongest``."""
    rest: Array = FLOOR * float(np.linalg.norm(v)) / strongest * here.outwards
    return rest


def _moved(start: Floats, rate: Floats) -> list[float]:
    return [x + DIFFERENCE * dx for x, dx in zip(start, rate, strict=True)]
