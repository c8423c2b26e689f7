"""How far a foot that is driven by hand may follow its command, near a singularity or a limit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.movable import Floats, Movable
from drake_leg.singularity.families import singular_words

STOP, SLOW = 0.01, 0.04  # of the arm's length: singular values at which the foot stops, is slowed
GREATEST_RATE = 4.0  # [rad/s or m/s] of a joint
LOOK = 1e-4  # [rad or m] of the fastest joint, by which it is tried where the singular value goes


class Braked(NamedTuple):
    """How much of a command may act, and why not all of it."""

    share: float  # 0 ... 1
    obstacle: str  # for a person; empty where nothing is in the way


def room(robot: Movable, sigma_min: float) -> float:
    """Share of a way towards a singularity that may be gone, from the smallest singular value [m].

    It is 1 and more where nothing is slowed, 0 and less where the foot stops.
    """
    stop, slow = STOP * robot.length, SLOW * robot.length
    return (sigma_min - stop) / (slow - stop)


def braked(robot: Movable, q: Floats, v: Floats, fastest: float = GREATEST_RATE) -> Braked:
    """How much of a commanded velocity may act in a posture.

    Whatever lowers the smallest singular value is slowed in proportion to what is left of it above
    ``STOP``; whatever raises it is not. No joint goes faster than ``fastest``.

    Parameters
    ----------
    robot : Movable
        In the posture: ``robot.at(q)``.
    q : (n,) sequence of float
        Joint positions [rad or m].
    v : (m,) sequence of float
        Commanded velocity of the foot, as ``robot.command`` makes it [m/s].
    fastest : float
        [rad/s or m/s].

    Raises
    ------
    SingularConfigurationError
        If the posture is singular.
    """
    rates = np.asarray(robot.rates(q, v), dtype=np.float64)
    peak = float(np.abs(rates).max())
    if peak == 0.0:
        return Braked(1.0, "")
    share, obstacle = 1.0, ""
    if peak > fastest:
        share, obstacle = fastest / peak, "a joint is at its greatest speed"
    before = robot.sigma_min(q)
    left = room(robot, before)
    if left < 1.0:
        later = (np.asarray(q) + LOOK / peak * rates).tolist()
        crosses = robot.determinant(q) * robot.determinant(later) <= 0.0
        if crosses or robot.sigma_min(later) < before:
            return Braked(share * max(left, 0.0), singular_words(robot.geometry, q))
    return Braked(share, obstacle)
