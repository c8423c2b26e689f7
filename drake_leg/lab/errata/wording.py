"""How the errata's numbers and vectors are written into their texts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from string import Formatter
from typing import Any

Values = Mapping[str, Any]  # numbers, vectors and texts, by their names in errata.toml


class Filled(Formatter):
    """Formats numbers and vectors with a number of decimals, 1 by default; texts unchanged."""

    def format_field(self, value: Any, format_spec: str) -> str:  # noqa: ANN401, D102 - Formatter's
        if isinstance(value, str):
            return value
        write = vector if isinstance(value, Iterable) else number
        return write(value, int(format_spec or 1))


def number(value: float, decimals: int = 1) -> str:
    """Write a number with a true minus sign, and no sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def vector(values: Iterable[float], decimals: int = 1) -> str:
    """Write a vector in parentheses."""
    return f"({', '.join(number(value, decimals) for value in values)})"


def angles(q: Iterable[float]) -> str:
    """Write angles [rad] in whole degrees."""
    return f"({', '.join(number(math.degrees(angle), 0) + '°' for angle in q)})"
