"""The scenario of a Signal Editor: the series of a data set in a .mat file."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.matfiles import read_mat, require_readable
from drake_leg.simulink.matlab.objects import Objects, elements_of

_BEFORE = 120  # bytes before the end of a file's head
_WHERE = "__function_workspace__"  # SciPy's name of what holds a file's objects


def scenario(path: Path, name: str) -> list[NDArray[np.float64]]:
    """Read the signals of the only scenario of a file, each a table of time and values.

    Raises
    ------
    LackError
        If the file holds another scenario, several, or what is no series.
    """
    content = require_readable(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = loadmat(path)
        count = sum(1 for _ in elements_of(content[_BEFORE:])) - 1  # all but the objects
        (held,) = [value for key, value in found.items() if not key.startswith("__")]
        known = held["s0"][0].decode()
        tables = [*_series(Objects(found[_WHERE].tobytes()))]
    except Exception as error:
        raise LackError(f"the scenarios of {path.name!r} cannot be read: {error!s:.80}") from None
    if count > 1 or known != name:
        raise LackError(
            f"{path.name!r} holds several scenarios, of which only one is read"
            if count > 1
            else f"{path.name!r} holds the scenario {known!r}, not {name!r}"
        )
    if not tables:
        raise LackError(f"{path.name!r} holds no series")
    return tables


def held_series(path: Path) -> NDArray[np.float64]:
    """Read what a file holds over time, a table of time and values.

    It is a matrix whose columns are points of time, the time first, or a ``timeseries``.

    Raises
    ------
    LackError
        If the file holds something else, several of them, or is damaged.
    """
    values = [each for each in read_mat(path).values() if isinstance(each, np.ndarray)]
    if len(values) == 1 and values[0].ndim == 2 and len(values[0]) > 1:
        found: NDArray[np.float64] = np.asarray(values[0], dtype=float).T
        return found
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tables = [*_series(Objects(loadmat(path)[_WHERE].tobytes()))]
    except (KeyError, NotImplementedError):
        tables = []
    if len(tables) != 1:
        raise LackError(
            f"{path.name!r} holds {len(tables)} series and {len(values)} matrices: let it hold one"
        )
    return tables[0]


def _series(objects: Objects) -> Iterator[NDArray[np.float64]]:
    """Yield the series of a file, in their order."""
    for one in objects.all():
        if "Data_" not in one:
            continue
        (number,) = objects.numbers_in(one["TimeInfo"])
        times, values = _times(objects.of(number)), np.asarray(one["Data_"], dtype=float)
        if values.ndim != 2 or len(values) != len(times):
            raise LackError(f"a series has {len(times)} times and values of {values.shape}")
        yield np.column_stack([times, values])


def _times(info: dict[str, Any]) -> NDArray[np.float64]:
    times = np.asarray(info.get("Time_", ()), dtype=float).ravel()
    if times.size:
        return times
    first, step, count = (
        float(np.ravel(info[name])[0]) for name in ("Start_", "Increment_", "Length")
    )
    even: NDArray[np.float64] = first + step * np.arange(float(int(count)))
    return even
