"""Greatest values of series over a step: where they are, and whether they have derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BPoly
from scipy.optimize import minimize_scalar

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array

TIED = 1e-9  # of the scale of a series: values that are nearer to each other are one
NEARLY_TIED = 1e-2  # the same of rows: the greatest value of the motion may be near another one
MOST = 12  # peaks that are looked at
SAME = 1e-6  # of the derivatives of tied peaks, relative: they are one derivative
WINDOW = 2  # rows on either side of a peak that its motion is interpolated from
FOUND = 1e-10  # [s], to which the instant of a peak is found


class Peak(NamedTuple):
    """A local maximum of one of several series."""

    time: float  # [s]
    series: int


class Slope(NamedTuple):
    """A value, its derivatives (size,), and when it is taken [s]."""

    value: float
    slope: Array
    time: float


def peaks(series: Array, within: float) -> list[tuple[int, int]]:
    """Rows and columns of the local maxima of series (rows, m) that are near the greatest value.

    ``within`` is relative to the greatest magnitude; the highest come first.
    """
    padded = np.pad(series, ((1, 1), (0, 0)), constant_values=-np.inf)
    local = (series >= padded[:-2]) & (series >= padded[2:])
    high = series >= series.max() - within * np.abs(series).max()
    rows, columns = np.nonzero(local & high)
    order = np.argsort(-series[rows, columns], kind="stable")[:MOST]
    return list(zip(rows[order].tolist(), columns[order].tolist(), strict=True))


def joints_between(time: Array, joints: Sequence[Array], row: int) -> BPoly:
    """Interpolate joints' positions, velocities and accelerations (rows, n) each, around a row."""
    window = slice(max(row - WINDOW, 0), row + WINDOW + 1)
    return BPoly.from_derivatives(time[window], np.stack([each[window] for each in joints], axis=1))


def top_between(time: Array, row: int, value: Callable[[float], float]) -> float:
    """Find when a function of time is greatest between the rows before and after one [s]."""
    before, after = time[max(row - 1, 0)], time[min(row + 1, len(time) - 1)]
    inside = minimize_scalar(
        lambda t: -value(t), bounds=(before, after), method="bounded", options={"xatol": FOUND}
    )
    ends = (float(before), float(inside.x), float(after))
    return max(ends, key=value)


def one_of(what: str, found: Sequence[Slope]) -> Slope:
    """Return the greatest of some values.

    Raises
    ------
    InvalidValueError
        If the greatest value is taken at several instants, with different derivatives.
    """
    best = max(found, key=lambda each: each.value)
    scale = max(abs(each.value) for each in found)
    tied = [each for each in found if best.value - each.value <= TIED * scale]
    for each in tied:
        apart = float(np.abs(each.slope - best.slope).max(initial=0.0))
        if apart > SAME * float(np.abs(best.slope).max(initial=0.0)) + TIED * scale:
            raise InvalidValueError(
                f"{what} is {abs(best.value):.9g} both at {best.time:.6g} s and at {each.time:.6g} "
                "s, with different derivatives: it has none",
                advice="change an option a little, or choose a shorter `duration`",
            )
    return best
