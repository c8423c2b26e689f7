"""Runge-Kutta steps of the kinematic loop, all of them at once.

The steps ``q[i+1] = Phi(t[i], q[i])`` of the method of Dormand and Prince, which is Drake's
``runge_kutta5``, are equations for all rows q. They are solved by Newton's method, from joint
positions in closed form that put the foot exactly on its path. An error of the foot stays what it
is from one step to the next, or decays as the drift correction says, so that the errors of the
single steps need only be summed up, in the task; the inverse Jacobian makes joint positions of
their sum. Each stage of the method is one evaluation of arrays, not one a step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.loop import KinematicEquation

# Each stage: when it is taken, as a part of the step, and the weights of the stages before it.
STAGES: tuple[tuple[float, tuple[float, ...]], ...] = (
    (0.0, ()),
    (1 / 5, (1 / 5,)),
    (3 / 10, (3 / 40, 9 / 40)),
    (4 / 5, (44 / 45, -56 / 15, 32 / 9)),
    (8 / 9, (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729)),
    (1.0, (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656)),
)
WEIGHTS = (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84)
ARRAYS = (np.cos, np.sin)
NEWTON = 8  # corrections, at most
JUMP = 1.0  # [rad] from one row to where a step leads: onto another branch, or by a turn
FIRST = 1e-3  # [rad]: the first correction is compared with this one
ROUNDING = 1e-15  # [rad], of a correction that is not needed


def all_steps(equation: KinematicEquation, start: Sequence[float], times: Array) -> Array | None:
    """Joint positions (rows, n) at increasing times (rows,), the first of them ``start`` (n,).

    None where the joints have no closed form, and where the steps are not found: at a singularity.
    """
    if equation.time_constant is not None:
        return None
    with np.errstate(all="ignore"):
        path = equation.path(start, times)
        exact = equation.robot.postures(path.T, start)
        if exact is None:
            return None
        return _solved(equation, times, (exact + (np.array(start) - exact[0])).T)


def _solved(equation: KinematicEquation, times: Array, q: Array) -> Array | None:
    """Correct rows near the solution, (n, rows), whose first one is right; return (rows, n)."""
    robot, size = equation.robot, FIRST
    kept = np.exp(-equation.correction * np.diff(times))  # of the foot's error, in each step
    for _ in range(NEWTON):
        after = q[:, 1:]
        stepped = _stepped(equation, times, q)
        if not np.abs(stepped - after).max() < JUMP:
            break
        error = _task(equation, stepped) - _task(equation, after)
        correction = np.array(robot.rate_formula(after, _summed(error, kept), ARRAYS))
        after += correction
        size, before = float(np.abs(correction).max()), size
        if size * size <= ROUNDING * before:  # the next one is smaller by the same factor
            return q.T
    return None


def _task(equation: KinematicEquation, q: Array) -> Array:
    return np.array(equation.robot.task_position(q, ARRAYS))


def _stepped(equation: KinematicEquation, times: Array, q: Array) -> Array:
    """Phi(t, q): where one step leads from each row but the last, (n, rows - 1)."""
    step, time, q = np.diff(times), times[:-1], q[:, :-1]
    rates: list[Array] = []
    for part, weights in STAGES:
        rate = equation.formula(time + part * step, _moved(q, step, weights, rates), ARRAYS)
        rates.append(np.array(rate))
    return _moved(q, step, WEIGHTS, rates)


def _moved(q: Array, step: Array, weights: Sequence[float], rates: Sequence[Array]) -> Array:
    if not weights:
        return q
    moved: Array = q + step * sum(
        weight * rate for weight, rate in zip(weights, rates, strict=True) if weight
    )
    return moved


def _summed(errors: Array, kept: Array) -> Array:
    """Sum up errors of steps (m, steps), of which a part is ``kept`` (steps,) in each next one."""
    if (kept == 1.0).all():
        return np.cumsum(errors, axis=1)
    total = errors.copy()
    for step in range(1, len(kept)):
        total[:, step] += kept[step] * total[:, step - 1]
    return total
