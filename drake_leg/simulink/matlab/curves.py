"""Piecewise polynomials and moving averages of MATLAB."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import (
    Allowance,
    Known,
    LackError,
    Struct,
    numbers_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.inputs import axis_of, whole
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script


def _points(x: Any, y: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    a, b = numbers_of(x).ravel(), numbers_of(y)
    if min(b.shape) != 1:
        raise LackError("a spline of several rows is not known here")
    order = np.argsort(a, kind="stable")
    if len(a) < 2 or np.any(np.diff(a[order]) == 0.0):
        raise MatlabError("a curve needs two points at least, all at different places")
    values = b.ravel()
    if values.size == a.size:
        return a[order], values[order]
    if values.size == a.size + 2:
        return a[order], np.concatenate([values[:1], values[1:-1][order], values[-1:]])
    raise MatlabError(f"a curve has {a.size} places and {values.size} values")


def _pieces(breaks: Any, coefs: Any) -> Struct:
    b, c = numbers_of(breaks).reshape(1, -1), np.atleast_2d(numbers_of(coefs))
    if b.size < 2 or c.size % (b.size - 1):
        raise MatlabError(f"{c.size} coefficients do not fit {b.size - 1} pieces")
    c = c.reshape(b.size - 1, -1) if c.shape[0] != b.size - 1 else c
    return Struct(
        form="pp",
        breaks=settled(b),
        coefs=settled(c),
        pieces=float(b.size - 1),
        order=float(c.shape[1]),
        dim=1.0,
    )


def _spline(x: Any, y: Any, at: Any = None) -> Any:
    from scipy.interpolate import CubicSpline  # takes a while to load, and few scripts need it

    a, values = _points(x, y)
    if values.size == a.size + 2:
        ends = ((1, values[0]), (1, values[-1]))
        curve = CubicSpline(a, values[1:-1], bc_type=ends)
    else:
        curve = CubicSpline(a, values, bc_type="natural" if a.size == 2 else "not-a-knot")
    found = _pieces(curve.x, curve.c.T)
    return found if at is None else _ppval(found, at)


def _pchip(x: Any, y: Any, at: Any = None) -> Any:
    from scipy.interpolate import PchipInterpolator

    curve = PchipInterpolator(*_points(x, y))
    found = _pieces(curve.x, curve.c.T)
    return found if at is None else _ppval(found, at)


def _ppval(curve: Any, at: Any) -> Any:
    """Values of a curve; beyond its ends, of its first and last pieces."""
    if not isinstance(curve, Struct) or "breaks" not in curve:
        raise MatlabError("ppval is given what is no piecewise polynomial")
    breaks = numbers_of(curve["breaks"]).ravel()
    coefs = numbers_of(curve["coefs"])[:, : whole(curve["order"])]
    q = numbers_of(at)
    place = np.clip(np.searchsorted(breaks, q.ravel(), side="right") - 1, 0, breaks.size - 2)
    since, value = q.ravel() - breaks[place], np.zeros(q.size)
    for column in coefs.T:
        value = value * since + column[place]
    return settled(value.reshape(q.shape))


def _unmkpp(budget: Allowance, wanted: int, curve: Any) -> Any:
    parts = tuple(curve[name] for name in ("breaks", "coefs", "pieces", "order", "dim"))
    return parts[: max(wanted, 1)] if wanted > 1 else parts[0]


def _moving(values: Any, window: Any, axis: Any = None) -> Any:
    """Average over a window, which is shorter at the ends."""
    array, spans = numbers_of(values), numbers_of(window).ravel()
    length = whole(float(spans[0])) if spans.size == 1 else 0
    before, after = (length // 2, (length - 1) // 2) if spans.size == 1 else map(int, spans)
    if min(before, after) < 0 or (spans.size == 1 and length < 1):
        raise MatlabError("the window of a moving average has no length")
    along = axis_of(array, axis)
    rows = np.moveaxis(array, along, 0)
    sums = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    places = np.arange(len(rows))
    first, last = np.maximum(places - before, 0), np.minimum(places + after + 1, len(rows))
    counts = (last - first).reshape(-1, *(1,) * (rows.ndim - 1))
    return settled(np.moveaxis((sums[last] - sums[first]) / counts, 0, along))


CURVES: dict[str, Known] = {
    "spline": of_values(_spline),
    "pchip": of_values(_pchip),
    "ppval": of_values(_ppval),
    "mkpp": of_values(_pieces),
    "unmkpp": _unmkpp,
    "movmean": of_values(_moving),
}
