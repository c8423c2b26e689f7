"""Determinant, inverse and solution of two or three equations, in plain numbers.

By elimination with row pivots, as LAPACK does it for larger ones. The numbers of a matrix come
column by column.
"""

from __future__ import annotations

import math

from drake_leg.simulink.matlab.compiling.runtime import DepartureError

Numbers = tuple[float, ...]


def det_2(a: float, b: float, c: float, d: float) -> float:
    """Determinant of a matrix (2, 2)."""
    swapped, a, _, c, d = _eliminated_2(a, b, c, d)
    return -a * d if swapped else a * d


def inv_2(a: float, b: float, c: float, d: float) -> Numbers:
    """Inverse of a matrix (2, 2); infinite where it is singular."""
    swapped, a, low, c, d = _eliminated_2(a, b, c, d)
    if not (a and d):
        return (math.inf,) * 4
    left = (1.0 + c * low / d) / a, -low / d
    right = -c / d / a, 1.0 / d
    return (*right, *left) if swapped else (*left, *right)


def solve_2(a: float, b: float, c: float, d: float, x: float, y: float) -> Numbers:
    """Solve two equations."""
    swapped, a, low, c, d = _eliminated_2(a, b, c, d)
    if not (a and d):
        raise DepartureError
    if swapped:
        x, y = y, x
    y = (y - low * x) / d
    return (x - c * y) / a, y


def _eliminated_2(
    a: float, b: float, c: float, d: float
) -> tuple[bool, float, float, float, float]:
    """Return whether rows are swapped, then L and U: a, b/a, c, d - b/a c."""
    swapped = abs(b) > abs(a)
    if swapped:
        a, b, c, d = b, a, d, c
    low = b / a if a else 0.0
    return swapped, a, low, c, d - low * c


def det_3(*matrix: float) -> float:
    """Determinant of a matrix (3, 3)."""
    (i, j, _), a, _, _, _, _, e, _, _, k = _eliminated_3(*matrix)
    product = a * e * k
    return product if (j - i) % 3 == 1 else -product


def inv_3(*matrix: float) -> Numbers:
    """Inverse of a matrix (3, 3); infinite where it is singular."""
    order, a, b, c, d, g, e, f, h, k = _eliminated_3(*matrix)
    if not (a and e and k):
        return (math.inf,) * 9
    columns: list[Numbers] = [(), (), ()]
    for place, (y, z) in zip(order, ((-b, f * b - c), (1.0, -f), (0.0, 1.0)), strict=True):
        z /= k
        y = (y - h * z) / e
        x = 1.0 if place == order[0] else 0.0
        columns[place] = (x - d * y - g * z) / a, y, z
    return (*columns[0], *columns[1], *columns[2])


def solve_3(*numbers: float) -> Numbers:
    """Solve three equations: a matrix (3, 3), and what it makes of the solution."""
    (i, j, m), a, b, c, d, g, e, f, h, k = _eliminated_3(*numbers[:9])
    if not (a and e and k):
        raise DepartureError
    wanted = numbers[9:]
    x = wanted[i]
    y = wanted[j] - b * x
    z = (wanted[m] - c * x - f * y) / k
    y = (y - h * z) / e
    return (x - d * y - g * z) / a, y, z


def _eliminated_3(
    a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float, k: float
) -> tuple[
    tuple[int, int, int], float, float, float, float, float, float, float, float, float
]:  # fmt: skip
    """Return the order of the rows, then L and U, column by column, in the same places."""
    i, j, m = 0, 1, 2
    if abs(b) > abs(a) and not abs(c) > abs(b):
        a, b, d, e, g, h, i, j = b, a, e, d, h, g, j, i
    elif abs(c) > abs(a):
        a, c, d, f, g, k, i, m = c, a, f, d, k, g, m, i
    if a:
        b /= a
        c /= a
    e -= b * d
    f -= c * d
    h -= b * g
    k -= c * g
    if abs(f) > abs(e):
        b, c, e, f, h, k, j, m = c, b, f, e, k, h, m, j
    if e:
        f /= e
    return (i, j, m), a, b, c, d, g, e, f, h, k - f * h
