"""How much a pendulum's motion magnifies an error of its start: near upright without bound."""

from __future__ import annotations

import math

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.pendulum import PendulumModel, acceleration

STEP = 1e-6  # [rad], [rad/s], of the differences
MOST = 1e300  # a growth beyond it is given as this


def instability(model: PendulumModel, q: Array, qdot: Array) -> float:
    """Greatest rate at which neighbouring motions part, anywhere on a motion.

    Upright it is the positive root of ``s^2 + (c / I) s = m g (L/2) / I``.

    Parameters
    ----------
    model : PendulumModel
        The pendulum.
    q, qdot : (n,) ndarray
        The motion [rad], [rad/s].

    Returns
    -------
    float
        [1/s]; 0 where the motion is stable everywhere.
    """
    stiffness, damping = _slopes(model, q, qdot)
    roots = damping / 2.0 + np.sqrt(np.maximum(damping**2 / 4.0 + stiffness, 0.0))
    return float(max(np.max(np.where(stiffness > 0.0, roots, 0.0)), 0.0))


def error_growth(model: PendulumModel, time: Array, q: Array, qdot: Array) -> float:
    """Greatest factor by which an error of the start becomes one of the angle.

    The product of the exponentials of the linearized motion, row by row; a rate counts as the
    angle that it is at the frequency of small swings.

    Parameters
    ----------
    model : PendulumModel
        The pendulum.
    time : (n,) ndarray
        [s].
    q, qdot : (n,) ndarray
        The motion [rad], [rad/s].

    Returns
    -------
    float
        At least 1, at most ``MOST``.
    """
    rate = model.natural_frequency or 1.0
    stiffness, damping = ((slope[1:] + slope[:-1]) / 2.0 for slope in _slopes(model, q, qdot))
    steps = _exponentials(stiffness / rate, damping, rate, np.diff(time))
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    size, greatest = 0.0, 0.0  # logarithms
    for e, f, g, h in steps.tolist():
        a, b, c, d = e * a + f * c, e * b + f * d, g * a + h * c, g * b + h * d
        length = math.hypot(a, b)
        if length > 0.0:
            greatest = max(greatest, size + math.log(length))
        if max(length, abs(c), abs(d)) > 1e100:
            a, b, c, d, size = a / 1e100, b / 1e100, c / 1e100, d / 1e100, size + math.log(1e100)
    return math.exp(min(greatest, math.log(MOST)))


def _slopes(model: PendulumModel, q: Array, qdot: Array) -> tuple[Array, Array]:
    """Differentiate the acceleration by the angle [1/s^2] and by the rate [1/s]."""
    by_angle = acceleration(model, q + STEP, qdot) - acceleration(model, q - STEP, qdot)
    by_rate = acceleration(model, q, qdot + STEP) - acceleration(model, q, qdot - STEP)
    return by_angle / (2.0 * STEP), by_rate / (2.0 * STEP)


def _exponentials(stiffness: Array, damping: Array, rate: float, step: Array) -> Array:
    """Return ``exp([[0, rate], [stiffness, damping]] step)``, row by row, (n, 4)."""
    middle = damping / 2.0
    root = np.sqrt(middle**2 + stiffness * rate + 0j)
    plus, minus = np.exp((middle + root) * step), np.exp((middle - root) * step)
    even = ((plus + minus) / 2.0).real
    apart = np.abs(root * step) > 1e-6
    odd = np.where(
        apart,
        ((plus - minus) / np.where(apart, 2.0 * root, 1.0)).real,
        step * np.exp(middle * step),
    )
    return np.stack(
        [even - middle * odd, rate * odd, stiffness * odd, even + middle * odd], axis=-1
    )
