"""How much a pendulum's motion magnifies an error of its start: near upright without bound."""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.pendulum import PendulumModel, acceleration

STEP = 1e-6  # [rad], [rad/s], of the differences
MOST = 1e300  # greatest growth that is reported
GAUSS = (0.5 - math.sqrt(3.0) / 6.0, 0.5 + math.sqrt(3.0) / 6.0)  # points of a step
WEIGHTS = (0.25 - math.sqrt(3.0) / 6.0, 0.25 + math.sqrt(3.0) / 6.0)  # of the slopes there


def instability(model: PendulumModel, q: Array, qdot: Array) -> float:
    """Greatest rate at which neighbouring motions part, anywhere on a motion q, qdot (n,) [1/s].

    Upright it is the positive root of ``s^2 + (c / I) s = m g (L/2) / I``; it is 0 where the motion
    is stable everywhere.
    """
    stiffness, damping = _slopes(model, q, qdot)
    roots = damping / 2.0 + np.sqrt(np.maximum(damping**2 / 4.0 + stiffness, 0.0))
    return float(max(np.max(np.where(stiffness > 0.0, roots, 0.0)), 0.0))


def error_growth(model: PendulumModel, time: Array, q: Array, qdot: Array) -> float:
    """Greatest factor, from 1 to ``MOST``, by which an error of the start becomes one of the angle.

    The motion q, qdot (n,) at times (n,) [s] is linearized, by two exponentials from row to row
    (Magnus, fourth order); a rate counts as the angle that it is at the frequency of small swings.
    """
    if len(time) < 2:
        return 1.0
    rate = model.natural_frequency or 1.0
    steps = _steps(model, rate, time, q, qdot)
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


def _steps(model: PendulumModel, rate: float, time: Array, q: Array, qdot: Array) -> Array:
    """Return two exponentials for each step, from the slopes at its two Gauss points, (2 n, 4)."""
    step = np.diff(time)
    (stiff, damp), (stiffer, damper) = (
        _slopes(model, *_between(time, q, qdot, at)) for at in GAUSS
    )
    halves = [
        _exponentials(
            2.0 * (a * stiff + b * stiffer) / rate, 2.0 * (a * damp + b * damper), rate, step / 2.0
        )
        for a, b in (WEIGHTS[::-1], WEIGHTS)
    ]
    return np.stack(halves, axis=1).reshape(-1, 4)


def _between(time: Array, q: Array, qdot: Array, at: float) -> tuple[Array, Array]:
    """Interpolate a motion at a part of every step, by cubics."""
    motion = CubicHermiteSpline(time, q, qdot)
    there = time[:-1] + at * np.diff(time)
    return motion(there), motion(there, 1)


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
