"""Motions through way points: polynomials, B-splines, trapezoids of velocity.

Each is evaluated at samples of time [s], and returns position and two derivatives, (n, samples).
Before its start and after its end it rests.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pieces = tuple[Array, Array]  # when pieces begin, and what begins there

PROFILE = ("PeakVelocity", "Acceleration", "EndTime", "AccelTime")


def polynomial_pieces(at: Array, derivatives: Array) -> Pieces:
    """Pieces of a polynomial that has values and derivatives (k, n, p) at times (p,).

    Returns the times, and coefficients (powers, p - 1, n), the highest power first.
    """
    from scipy.interpolate import BPoly, PPoly  # take a while to load, and few models need them

    curve = PPoly.from_bernstein_basis(BPoly.from_derivatives(at, np.moveaxis(derivatives, -1, 0)))
    return curve.x, curve.c


def spline_pieces(way: Array, ends: Array) -> Pieces:
    """Pieces of a cubic B-spline: control points (n, p), uniform knots, clamped at both ends."""
    from scipy.interpolate import BSpline

    inner = np.linspace(ends[0], ends[1], way.shape[1] - 2)
    knots = np.concatenate([[ends[0]] * 3, inner, [ends[1]] * 3])
    curve = BSpline(knots, way.T, 3)
    factors = (6.0, 2.0, 1.0, 1.0)
    rows = [curve.derivative(3 - k)(inner[:-1]) / factors[k] for k in range(3)]
    return inner, np.array([*rows, curve(inner[:-1])])


def polynomial_motion(pieces: Pieces, t: Array) -> list[Array]:
    """Evaluate polynomials; the speed at the very end is still that of the last piece."""
    breaks, rows = pieces
    inside, rests = np.clip(t, breaks[0], breaks[-1]), (t < breaks[0]) | (t > breaks[-1])
    place = np.clip(np.searchsorted(breaks, inside, side="right") - 1, 0, breaks.size - 2)
    since, found = (inside - breaks[place])[:, np.newaxis], []
    for order in range(3):
        value = np.zeros((t.size, rows.shape[-1]))
        for row in rows:
            value = value * since + row[place]
        found.append(np.where(rests, 0.0, value.T) if order else value.T)
        powers = np.arange(len(rows) - 1, 0, -1.0)
        rows = rows[:-1] * powers[:, np.newaxis, np.newaxis]
    return found


def trapezoidal_pieces(way: Array, given: Mapping[str, Array]) -> Pieces:
    """Accelerate, run and slow down between way points (n, p), with rest at each.

    Parameters
    ----------
    way : (n, p)
        The way points.
    given : dict
        At most two of `PROFILE`: a number, (n,) or (n, p - 1), for each way from point to point.
        `EndTime` is how long a way takes; alone it sets the speed to 1.5 times the mean one, so
        that each phase takes a third. So does `PeakVelocity` alone, and without any a way takes
        1 s.

    Returns
    -------
    tuple
        For each dimension, the times at which the acceleration changes, (n, 3 p - 2); and the
        position, the speed and the acceleration that begin there, (n, 3 p - 2, 3).

    Raises
    ------
    ValueError
        With one sentence, if there is no such motion.
    """
    n, p = way.shape
    if p < 2:
        raise ValueError("give two way points or more")
    if len(given) > 2 or set(given) in ({"Acceleration"}, {"AccelTime"}):
        raise ValueError("give EndTime or PeakVelocity, or two of the four parameters")
    each = {name: _for_each_way(name, value, n, p) for name, value in given.items()}
    times, begins = [], []
    for k in range(n):
        breaks, states = [0.0], []
        for j in range(p - 1):
            start, way_long = way[k, j], way[k, j + 1] - way[k, j]
            values = {name: float(value[k, j]) for name, value in each.items()}
            speed, rate, ramp, long = _profile(abs(way_long), values)
            sign = np.sign(way_long)
            speed, rate = sign * speed, sign * rate
            states += [
                [start, 0.0, rate],
                [start + 0.5 * rate * ramp**2, speed, 0.0],
                [start + way_long - 0.5 * rate * ramp**2, speed, -rate],
            ]
            begin = breaks[-1]
            breaks += [begin + ramp, begin + long - ramp, begin + long]
        states.append([way[k, -1], 0.0, 0.0])
        times.append(breaks)
        begins.append(states)
    return np.array(times), np.array(begins)


def _for_each_way(name: str, value: Array, n: int, p: int) -> Array:
    value = np.asarray(value, dtype=float)
    column = value.reshape(-1, 1) if value.size == n and n > 1 else value
    try:
        found: Array = np.broadcast_to(column, (n, p - 1))
    except ValueError:
        raise ValueError(f"{name} is a number, or {n}, or {n} by {p - 1}") from None
    if not np.all(found > 0.0):
        raise ValueError(f"{name} must be positive")
    return found


def _profile(way: float, given: Mapping[str, float]) -> tuple[float, float, float, float]:
    """Speed, acceleration, and how long that and the whole take, for a way that is not negative."""
    v, a = given.get("PeakVelocity"), given.get("Acceleration")
    long, ramp = given.get("EndTime"), given.get("AccelTime")
    if way == 0.0:
        long = long or 1.0
        return 0.0, 0.0, min(ramp or long / 3.0, long / 2.0), long
    if ramp is not None and a is not None:
        v = a * ramp
    elif long is not None and a is not None:
        under = (a * long) ** 2 - 4.0 * a * way
        if under < 0.0:
            raise ValueError(f"no motion over {way:g} ends after {long:g} with acceleration {a:g}")
        v = 0.5 * (a * long - np.sqrt(under))
    elif long is not None and ramp is not None:
        v = way / (long - ramp) if long > ramp else np.inf
    elif v is None:
        v = 1.5 * way / (long or 1.0)
    if ramp is None:
        ramp = v / a if a is not None else (long - way / v) if long else 0.5 * way / v
    long = way / v + ramp
    if not 0.0 < ramp <= 0.5 * long * (1.0 + 1e-12):
        raise ValueError(
            f"no trapezoid goes {way:g} at the speed {v:g} with {ramp:g} s to get there: its "
            "phases overlap"
        )
    return float(v), float(v / ramp), float(ramp), float(long)


def trapezoidal_motion(pieces: Pieces, t: Array) -> list[Array]:
    """Evaluate what `trapezoidal_pieces` returns."""
    rows = []
    for breaks, states in zip(*pieces, strict=True):
        place = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(states) - 1)
        since = np.maximum(t - breaks[place], 0.0)
        position, speed, rate = states[place].T
        rate = np.where(t < breaks[0], 0.0, rate)
        rows.append([position + since * (speed + 0.5 * since * rate), speed + since * rate, rate])
    return list(np.array(rows).transpose(1, 0, 2))
