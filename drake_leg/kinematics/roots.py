"""Where a function of one number changes its sign."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable

ROUNDING = 2.0 * sys.float_info.epsilon  # of a root: two neighbours of it
MOST = 200  # steps; bisection alone takes about 60, or all of these to 1e-60 where the root is 0


def sign_change(function: Callable[[float], float], left: float, right: float) -> float:
    """Find a root between two places where a function has different signs, to rounding.

    It interpolates by the inverse quadratic where that is safe, and bisects elsewhere
    (Chandrupatla, *Advances in Engineering Software* 28, 1997). ``scipy.optimize.brentq`` finds
    the same, but its package takes longer to load than everything else that a posture needs.
    """
    a, b, share = float(left), float(right), 0.5
    at_a, at_b = function(a), function(b)
    c, at_c = a, at_a
    best = a if abs(at_a) < abs(at_b) else b
    for _ in range(MOST):
        if 0.0 in (at_a, at_b):
            return a if at_a == 0.0 else b
        least = ROUNDING * abs(best) / abs(b - a)  # of the interval
        if least > 0.5 or b == a:
            break
        middle = a + min(max(share, least), 1.0 - least) * (b - a)
        at_middle = function(middle)
        if (at_middle > 0.0) == (at_a > 0.0):
            c, at_c = a, at_a
        else:
            c, at_c, b, at_b = b, at_b, a, at_a
        a, at_a = middle, at_middle
        best = a if abs(at_a) < abs(at_b) else b
        share = _share(a, at_a, b, at_b, c, at_c)
    return best


def _share(a: float, at_a: float, b: float, at_b: float, c: float, at_c: float) -> float:
    """Part of the way from a to b at which the inverse quadratic through three points is zero."""
    x, y = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
    if not (y * y < x and (1.0 - y) ** 2 < 1.0 - x):
        return 0.5
    by_b = at_a / (at_b - at_a) * at_c / (at_b - at_c)
    by_c = (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
    return by_b + by_c if math.isfinite(by_b + by_c) else 0.5
