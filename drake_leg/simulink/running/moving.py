"""Motions through way points as signals: position, speed and acceleration at a time that comes in.

Way points are (n, p), or (p,) of one dimension. Each result is (n,), or (n, samples) where several
times come in.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.motions import (
    Pieces,
    polynomial_motion,
    polynomial_pieces,
    spline_pieces,
    trapezoidal_motion,
    trapezoidal_pieces,
)
from drake_leg.simulink.running.settings import Signal, as_signal

Array = NDArray[np.float64]
Motion = tuple[Signal, Signal, Signal]


def _signals(found: Sequence[Array], t: Signal) -> Motion:
    several = np.size(t) > 1
    position, speed, rate = (as_signal(each if several else each[:, :1]) for each in found)
    return position, speed, rate


def polynomial_at(t: Signal, breaks: Array, rows: Array) -> Motion:
    """Evaluate polynomials of pieces that stay."""
    return _signals(polynomial_motion((breaks, rows), np.ravel(t)), t)


def trapezoids_at(t: Signal, breaks: Array, states: Array) -> Motion:
    """Evaluate trapezoids of pieces that stay."""
    return _signals(trapezoidal_motion((breaks, states), np.ravel(t)), t)


def on_polynomial(t: Signal, way: Signal, at: Signal, *derivatives: Signal) -> Motion:
    """Follow polynomials through way points at times; they have derivatives there."""
    points, times = np.atleast_2d(way), np.ravel(at)
    if np.any(np.diff(times) <= 0.0):
        return _none(points, t)
    given = np.stack([points, *(np.reshape(each, points.shape) for each in derivatives)])
    pieces = polynomial_pieces(times, given)
    return polynomial_at(t, *pieces)


def on_spline(t: Signal, way: Signal, ends: Signal) -> Motion:
    """Follow a cubic B-spline of control points between two times."""
    points, interval = np.atleast_2d(way), np.ravel(ends)
    if not interval[1] > interval[0]:
        return _none(points, t)
    return polynomial_at(t, *spline_pieces(points, interval))


def on_trapezoids(
    t: Signal, way: Signal, names: Sequence[str] = (), values: Sequence[Signal] = ()
) -> Motion:
    """Follow way points with trapezoids of velocity."""
    points = np.atleast_2d(way)
    given = {name: np.asarray(value) for name, value in zip(names, values, strict=True)}
    try:
        pieces: Pieces = trapezoidal_pieces(points, given)
    except ValueError:
        return _none(points, t)
    return trapezoids_at(t, *pieces)


def _none(points: Array, t: Signal) -> Motion:
    """No number, which stops the run and names the block, where there is no such motion."""
    return _signals([np.full((len(points), np.size(t)), np.nan)] * 3, t)
