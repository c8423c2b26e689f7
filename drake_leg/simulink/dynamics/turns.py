"""Rotations as quaternions and rotation vectors, in floats: a call costs a few microseconds."""

from __future__ import annotations

import math

import numpy as np

from drake_leg.simulink.multibody.mass import Array


def quaternion(R: Array) -> Array:
    """Return the quaternion w, x, y, z of a rotation matrix, with w not negative."""
    return np.array(_quaternion(R))


def rotvec(R: Array) -> Array:
    """Return the rotation vector of a rotation matrix [rad], of a length of at most pi."""
    w, x, y, z = _quaternion(R)
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-9 else 2.0
    return np.array([scale * x, scale * y, scale * z])


def _quaternion(R: Array) -> tuple[float, float, float, float]:
    """Divide by the greatest component, whose square is at least a quarter."""
    (a, b, c), (d, e, f), (g, h, i) = R.tolist()
    if a + e + i > max(a, e, i):
        found = (1.0 + a + e + i, h - f, c - g, d - b)
    elif a >= e and a >= i:
        found = (h - f, 1.0 + a - e - i, b + d, c + g)
    elif e >= i:
        found = (c - g, b + d, 1.0 - a + e - i, f + h)
    else:
        found = (d - b, c + g, f + h, 1.0 - a - e + i)
    length = math.copysign(math.hypot(*found), found[0])
    w, x, y, z = (part / length for part in found)
    return w, x, y, z
