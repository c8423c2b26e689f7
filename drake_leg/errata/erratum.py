"""What an erratum is, and how its numbers are written."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Erratum:
    """One error of a report."""

    number: int  # from 1 through both reports, and from 26 through both once more
    source: str  # the report
    where: str  # section, equation, table or figure there
    printed: str  # what it prints: text in quotation marks, a formula without
    right: str  # what it should print
    effect: str  # a sentence on what the error does, its numbers computed


def number(value: float, decimals: int = 1) -> str:
    """Write a number with a true minus sign, and no sign before a zero.

    Parameters
    ----------
    decimals : int
        Digits after the point.
    """
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def vector(values: Iterable[float], decimals: int = 1) -> str:
    """Write a vector in parentheses.

    Parameters
    ----------
    decimals : int
        Digits after the point.
    """
    return f"({', '.join(number(value, decimals) for value in values)})"


def angles(q: Iterable[float]) -> str:
    """Write angles in whole degrees.

    Parameters
    ----------
    q : iterable of float
        [rad].
    """
    return f"({', '.join(number(math.degrees(angle), 0) + '°' for angle in q)})"
