"""The signals that a Signal Builder block keeps: times and values of each, as MATLAB text."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.objects import Objects, elements_of, read_element


def built_signals(content: bytes) -> list[NDArray[np.float64]]:
    """Read the signals of the active group of a block, each a table (n, 2) of time and value.

    Raises
    ------
    LackError
        If the data are damaged.
    """
    try:
        _, others = elements_of(content)
        objects = Objects(read_element(others, content[:4]).tobytes())
        (suite,) = [each for each in objects.all() if "Groups" in each]
        groups = [objects.of(number) for number in objects.numbers_in(suite["Groups"])]
        active = int(np.asarray(suite.get("ActiveGroup", 1)).ravel()[0])
        numbers = objects.numbers_in(groups[active - 1]["Signals"])
        return [_table(objects.of(number)) for number in numbers]
    except Exception as error:
        raise LackError(f"its signals cannot be read: {str(error)[:80]}") from None


def text_of_signals(tables: list[NDArray[np.float64]]) -> str:
    """Write tables as a cell of matrices."""
    return "{" + ", ".join(_text(table) for table in tables) + "}"


def _table(signal: dict[str, Any]) -> NDArray[np.float64]:
    columns = [np.asarray(signal[name], dtype=float).ravel() for name in ("XData", "YData")]
    return np.column_stack(columns)


def _text(table: NDArray[np.float64]) -> str:
    return "[" + ";".join(f"{time!r} {value!r}" for time, value in table.tolist()) + "]"
