"""What an erratum is, and how numbers are filled into its sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from string import Formatter
from typing import Any

Values = Mapping[str, Any]  # numbers, vectors and texts, by their names in errata.toml
Effects = Mapping[int, Callable[[], Values]]  # by the errata's numbers


@dataclass(frozen=True, kw_only=True)
class Erratum:
    """One error of a report."""

    number: int  # from 1 through both reports, and from 26 through both once more
    source: str  # the report
    where: str  # section, equation, table or figure there
    printed: str  # what it prints: text in quotation marks, a formula without
    right: str  # what it should print
    effect: str  # a sentence on what the error does, its numbers computed


class _Filled(Formatter):
    """Fills in numbers and vectors with so many decimals, one by default; texts as they are."""

    def format_field(self, value: Any, format_spec: str) -> str:  # noqa: ANN401
        if isinstance(value, str):
            return value
        write = vector if isinstance(value, Iterable) else number
        return write(value, int(format_spec or 1))


def filled(sentence: str, values: Values) -> str:
    """Fill values into a sentence of ``errata.toml``."""
    return _Filled().vformat(sentence, (), values)


def number(value: float, decimals: int = 1) -> str:
    """Write a number with a true minus sign, and no sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def vector(values: Iterable[float], decimals: int = 1) -> str:
    """Write a vector in parentheses."""
    return f"({', '.join(number(value, decimals) for value in values)})"


def angles(q: Iterable[float]) -> str:
    """Write angles [rad] in whole degrees."""
    return f"({', '.join(number(math.degrees(angle), 0) + '°' for angle in q)})"
