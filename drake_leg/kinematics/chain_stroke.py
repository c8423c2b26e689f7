"""How far the foot of any chain can go along a line, found numerically."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.chain_task import chain_task, size_of
from drake_leg.kinematics.khalil import moving_rows
from drake_leg.kinematics.stroke import Stroke, unit
from drake_leg.kinematics.sweep import Sweep, sweep, twist_between
from drake_leg.kinematics.task import TRANSLATION, Task
from drake_leg.quantities import AT_LIMIT
from drake_leg.robot import Row

CHAIN_STEPS = 200  # steps of a numerical stroke over the length of the chain
CHAIN_RESOLUTION = 1e-10  # smallest step, of the length of the chain
LARGEST_CHANGE = 0.5  # [rad or m] of a joint in one step; more is a jump to another branch
ROUNDING = 1e-13  # of the length of the chain: what a foot misses its goal by at best
FARTHEST = 10.0  # of the length of the chain: what is looked at where nothing else is said


class ChainStroke(NamedTuple):
    """A way found numerically, and where it ends."""

    stroke: Stroke
    q: Array  # (n,), [rad or m], just before its end


def chain_stroke(
    rows: Sequence[Row],
    q: ArrayLike,
    direction: ArrayLike,
    *,
    task: Task | None = None,
    farthest: float | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
) -> ChainStroke:
    """Way of any chain's foot along a direction to a singularity or a limit, numerically.

    The posture is followed along the line in small steps, each closed by Newton's method, until
    a step fails, the determinant changes its sign or a joint passes a limit; the last step is then
    bisected. A redundant chain takes the least rates on its way.

    Parameters
    ----------
    rows : sequence of Row
        The table; n rows move.
    q : (n,) array_like
        Joint positions at the start [rad or m], not singular.
    direction : (3,) array_like
        Unit vector in the base frame.
    task : Task, optional
        What the foot is commanded; its translation by default.
    farthest : float, optional
        Way that is looked at [m]; by default ten times the chain's length.
    limits : mapping, optional
        Name of every moving joint, in order -> its lower and upper limit [rad or m]; they may be
        infinite.

    Returns
    -------
    ChainStroke
        Of no named family; infinite where nothing ends it.

    Raises
    ------
    InvalidValueError
        If a shape is wrong or a value is not finite.
    """
    d = unit(direction)
    posture = one_vector("q", q, len(moving_rows(rows)))
    task = task or chain_task(tuple(rows), TRANSLATION)
    start = sweep(rows, posture.tolist())
    size = size_of(rows)
    longest = max(size, farthest or 0.0) / CHAIN_STEPS
    farthest = FARTHEST * size if farthest is None else farthest
    names = list(limits or ())
    low, high = _room(task, posture, d * size, limits)
    way, step = 0.0, longest
    sign = np.sign(task.determinant(posture.tolist()))
    while way < farthest:
        goal = start._replace(foot=tuple(start.foot + (way + step) * d))
        closed = _closed(rows, task, posture, goal, step * d)
        if closed is not None and np.sign(task.determinant(closed.tolist())) != sign:
            closed = None
        past = [] if closed is None else np.flatnonzero((closed < low) | (closed > high)).tolist()
        if closed is None or past:
            step /= 2.0
            if step < CHAIN_RESOLUTION * size:
                joint = names[past[0]] if past else None
                return ChainStroke(Stroke(length=way, family=None, joint=joint), posture)
        else:
            way, posture = way + step, closed
            step = min(2.0 * step, longest)
    return ChainStroke(Stroke(length=math.inf, family=None), posture)


def _room(
    task: Task, q: Array, way: Array, limits: Mapping[str, tuple[float, float]] | None
) -> tuple[Array, Array]:
    """Return between what each joint may move: one that stays where it is may do so at a limit."""
    if limits is None:
        return np.full_like(q, -math.inf), np.full_like(q, math.inf)
    low, high = np.array(list(limits.values())).T
    moves = np.linalg.pinv(task.jacobian(q.tolist())) @ task.command(way)
    slack = np.where(np.abs(moves) < AT_LIMIT, AT_LIMIT, 0.0)
    return np.minimum(low, q - slack), np.maximum(high, q + slack)


def _closed(rows: Sequence[Row], task: Task, q: Array, goal: Sweep, way: Array) -> Array | None:
    """Bring the foot to the goal by Newton's method; None where that fails or jumps."""
    try:
        posture = _ahead(task, q, task.command(way)) if task.is_redundant else q.copy()
        for _ in range(12):
            miss = task.twists.T @ twist_between(sweep(rows, posture.tolist()), goal)
            if float(np.abs(miss).max()) < 1e-14:
                break
            change = np.array(task.rates(posture.tolist(), miss.tolist()))
            if float(np.abs(change).max()) > LARGEST_CHANGE:
                return None
            posture = posture + change
    except SingularConfigurationError:
        return None
    translation = twist_between(sweep(rows, posture.tolist()), goal)[3:]
    enough = max(1e-6 * float(np.linalg.norm(way)), ROUNDING * size_of(rows))
    return posture if float(np.abs(translation).max()) < enough else None


def _ahead(task: Task, q: Array, v: Array) -> Array:
    """Follow the least rates for a step by the midpoint rule; Newton's method does the rest."""
    half = 0.5 * np.array(task.rates(q.tolist(), v.tolist()))
    there = q + half * min(1.0, LARGEST_CHANGE / float(np.abs(half).max() or 1.0))
    ahead: Array = q + np.array(task.rates(there.tolist(), v.tolist()))
    return ahead
