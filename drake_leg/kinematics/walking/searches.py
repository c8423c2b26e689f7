"""Greatest and least values that work, by doubling and bisection, and with few digits."""

from __future__ import annotations

import math
from collections.abc import Callable

HALVINGS, DOUBLINGS = 8, 10  # of the interval in which a greatest value lies
DIGITS = 3  # of a greatest value


def greatest(works: Callable[[float], bool], start: float = 1.0, most: float = math.inf) -> float:
    """Greatest value that works, near to a start, all smaller ones doing so; 0 if none does."""
    value, tried = start, 0
    if works(value):
        while value < most and tried < DOUBLINGS and works(2.0 * value):
            value, tried = 2.0 * value, tried + 1
        return value if value >= most else rounded_down(bisected(works, value, 2.0 * value))
    for _ in range(DOUBLINGS):
        value /= 2.0
        if works(value):
            return rounded_down(bisected(works, value, 2.0 * value))
    return 0.0


def bisected(
    works: Callable[[float], bool], good: float, bad: float, halvings: int = HALVINGS
) -> float:
    """Value nearest to a bad one that works, from a good one."""
    for _ in range(halvings):
        middle = 0.5 * (good + bad)
        if works(middle):
            good = middle
        else:
            bad = middle
    return good


def rounded_down(value: float) -> float:
    """Leave as many digits as are said."""
    if value == 0.0:
        return 0.0
    scale = 10.0 ** (DIGITS - 1 - math.floor(math.log10(abs(value))))
    return math.floor(value * scale) / scale


def rounded_up(value: float) -> float:
    """Leave as many digits, upwards."""
    return -rounded_down(-value)
