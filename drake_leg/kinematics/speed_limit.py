"""A commanded velocity that is not faster than a given speed, and its derivative."""

from __future__ import annotations

import math

from drake_leg.kinematics.task import Floats


def limited_speed(
    v: Floats, a: Floats, top: float, lengths: Floats
) -> tuple[list[float], list[float]]:
    """Shorten a velocity to a greatest speed, its direction kept.

    Where ``|v| > top``, the velocity is ``top v / |v|`` and its derivative
    ``(top / |v|) (a - n (n . a))`` with ``n = v / |v|``; elsewhere both are what they were.

    Parameters
    ----------
    v, a : (n,) sequence of float
        Velocity [m/s] and its derivative [m/s^2].
    top : float
        Greatest speed [m/s].
    lengths : (n,) sequence of float
        What makes each part a length; 1 where it is one [m/unit].

    Returns
    -------
    list of float, list of float
        In the units of ``v`` and ``a``.
    """
    weights = [length * length for length in lengths]
    square = sum(w * part * part for w, part in zip(weights, v, strict=True))
    if square <= top * top:
        return list(v), list(a)
    along = sum(w * x * y for w, x, y in zip(weights, v, a, strict=True)) / square
    factor = top / math.sqrt(square)
    return [factor * x for x in v], [factor * (y - along * x) for x, y in zip(v, a, strict=True)]
