"""Equations in the position of one joint: Paul's types, and the quartic of Pieper's method.

Roots are candidates: one that misses being real by a little is returned, too, since a double root,
as where an arm is stretched, splits by rounding. Whoever uses them checks the posture.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import numpy as np

from drake_leg.kinematics.khalil import Array

NEARLY = 1e-3  # how far from real a root may be, relative to its size
VANISHES = 1e-11  # relative to its scale: a function that is zero everywhere
LEADS = 1e-13  # relative to the greatest coefficient: a smaller leading one is rounding
SMALL = 1e-5  # likewise: one so small that the equation without it is solved, too

_ANGLES: Array = np.linspace(0.0, math.tau, 8, endpoint=False)
_PLACES: Array = np.cos(np.arange(5) * (math.pi / 4.0)).astype(np.float64)
_POWERS = np.linalg.inv(np.vander(_PLACES, 5))

Function = Callable[[Array], Array]


def sine_and_cosine(x: float, y: float, z: float) -> list[float]:
    """Angles with ``x sin + y cos = z`` (type 2), two, or none where ``|z|`` is too large."""
    size = math.hypot(x, y)
    if abs(z) > (1.0 + NEARLY) * size or size == 0.0:
        return []
    middle = math.atan2(x, y)
    half = math.atan2(math.sqrt(max((size - z) * (size + z), 0.0)), z)
    return [middle + half, middle - half]


def quadratic(a: float, b: float, c: float) -> list[float]:
    """Roots of ``a x^2 + 2 b x + c``, where a is positive: two, or none."""
    inside = b * b - a * c
    if inside < -NEARLY * (b * b + abs(a * c)):
        return []
    root = math.sqrt(max(inside, 0.0))
    far = -(b + math.copysign(root, b))
    return [far / a, c / far] if far else [0.0, 0.0]


def roots(function: Function, *, turns: bool, scale: float, reach: float) -> list[float] | None:
    """Where a function of a joint position is zero; None if it is zero everywhere.

    Of an angle it is a trigonometric polynomial of degree 2, of a length a polynomial of degree
    4: both are determined by their values in some places. ``scale`` is the size of the terms that
    it is the sum of, ``reach`` that of the lengths.
    """
    return _angles(function, scale) if turns else _lengths(function, scale, reach)


def _angles(function: Function, scale: float) -> list[float] | None:
    values = function(_ANGLES)
    spectrum = np.fft.fft(values) / len(values)
    second, first, mean = complex(spectrum[2]), complex(spectrum[1]), float(spectrum[0].real)
    greatest = max(abs(second), abs(first), abs(mean))
    if greatest < VANISHES * scale:
        return None
    found: list[float] = []
    if abs(second) < SMALL * greatest:
        found += sine_and_cosine(-2.0 * first.imag, 2.0 * first.real, -mean)
    if abs(second) >= LEADS * greatest:
        conjugates = first.conjugate(), second.conjugate()
        for root in np.roots([second, first, mean, *conjugates]).tolist():
            if abs(abs(root) - 1.0) < NEARLY:
                found.append(cmath.phase(root))
    return found


def _lengths(function: Function, scale: float, reach: float) -> list[float] | None:
    coefficients = _POWERS @ function(reach * _PLACES)
    greatest = float(np.abs(coefficients).max())
    if greatest < VANISHES * scale:
        return None
    found: list[float] = []
    for least in (SMALL, LEADS):
        leading = np.flatnonzero(np.abs(coefficients) >= least * greatest)
        if not len(leading):
            continue
        for root in np.roots(coefficients[leading[0] :]).tolist():
            if abs(root.imag) < NEARLY * max(abs(root), NEARLY):
                found.append(reach * root.real)
    return found
