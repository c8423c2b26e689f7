"""How far the foot of any three-joint chain can go along a line, found numerically."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.khalil import foot_pose, jacobian, moving_rows
from drake_leg.kinematics.stroke import Stroke, unit
from drake_leg.robot import Row

CHAIN_STEPS = 200  # steps of a numerical stroke over the length of the chain
CHAIN_RESOLUTION = 1e-10  # smallest step, of the length of the chain
LARGEST_CHANGE = 0.5  # [rad or m] of a joint in one step; more is a jump to another branch


class ChainStroke(NamedTuple):
    """A way found numerically, and where it ends."""

    stroke: Stroke
    q: Array  # (3,), [rad or m], just before the singularity


def chain_stroke(rows: Sequence[Row], q: ArrayLike, direction: ArrayLike) -> ChainStroke:
    """Way of any three-joint chain's foot along a direction to the first singularity, numerically.

    The posture is followed along the line in small steps, each closed by Newton's method, until
    a step fails or the determinant changes its sign; the last step is then bisected.

    Parameters
    ----------
    rows : sequence of Row
        The table; three rows move.
    q : (3,) array_like
        Joint positions at the start [rad or m], not singular.
    direction : (3,) array_like
        Unit vector in the base frame.

    Returns
    -------
    ChainStroke
        Of no named family; infinite where no singularity is met within ten times the chain's
        length.

    Raises
    ------
    InvalidValueError
        If the chain has not three joints, a shape is wrong or a value is not finite.
    """
    if len(moving_rows(rows)) != 3:
        raise InvalidValueError(
            f"the chain has {len(moving_rows(rows))} joints; a stroke needs exactly three"
        )
    d = unit(direction)
    posture = one_vector("q", q, 3)
    start = foot_pose(rows, posture)[:3, 3]
    size = sum(math.hypot(row.d, row.r) for row in rows) or 1.0
    way, step = 0.0, size / CHAIN_STEPS
    sign = np.sign(np.linalg.det(jacobian(rows, posture)[3:]))
    while way < 10.0 * size:
        closed = _closed(rows, posture, start + (way + step) * d, step)
        if closed is None or np.sign(np.linalg.det(jacobian(rows, closed)[3:])) != sign:
            step /= 2.0
            if step < CHAIN_RESOLUTION * size:
                return ChainStroke(Stroke(length=way, family=None), posture)
        else:
            way, posture = way + step, closed
            step = min(2.0 * step, size / CHAIN_STEPS)
    return ChainStroke(Stroke(length=math.inf, family=None), posture)


def _closed(rows: Sequence[Row], q: Array, goal: Array, step: float) -> Array | None:
    """Move the foot onto the goal by Newton's method; None where that fails or jumps."""
    posture = q.copy()
    for _ in range(12):
        miss = goal - foot_pose(rows, posture)[:3, 3]
        if float(np.abs(miss).max()) < 1e-14:
            break
        try:
            change = np.linalg.solve(jacobian(rows, posture)[3:], miss)
        except np.linalg.LinAlgError:
            return None
        if float(np.abs(change).max()) > LARGEST_CHANGE:
            return None
        posture = posture + change
    reached = float(np.abs(goal - foot_pose(rows, posture)[:3, 3]).max()) < 1e-6 * step
    return posture if reached else None
