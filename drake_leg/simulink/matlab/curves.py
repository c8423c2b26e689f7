"""Piecewise polynomials, interpolation, moving averages and round surfaces of MATLAB."""

from __future__ import annotations

from collections.abc import Callable
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
from drake_leg.simulink.matlab.inputs import axis_of, scalar, whole
from drake_leg.simulink.matlab.numeric import MatlabError, span

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


def _smoothed(y: Any, span: Any = 5.0, *more: Any) -> Any:
    """Average over a span of an odd count, as ``smooth`` does; at the ends, over what is in it.

    There the span is as long as it can be around its middle.
    """
    if more and more != ("moving",):
        raise LackError("'smooth' by other methods than the moving average is not known here")
    column, width = numbers_of(y).ravel(order="F"), numbers_of(span)
    if width.size != 1:
        raise LackError("'smooth' of values at places of their own is not known here")
    length = float(width.item())
    length = np.ceil(length * column.size) if 0.0 < length < 1.0 else length
    half = (int(min(length, column.size)) - 1) // 2
    places = np.arange(column.size)
    reach = np.minimum(np.minimum(places, places[::-1]), max(half, 0))
    sums = np.append(0.0, np.cumsum(column))
    means = (sums[places + reach + 1] - sums[places - reach]) / (2 * reach + 1)
    return settled(means[:, np.newaxis])


def _interp1(budget: Allowance, wanted: int, x: Any, y: Any, *rest: Any) -> Any:
    """Values between points: of one curve, in the shape of the places, or of each column."""
    if not rest or isinstance(rest[0], str):
        x, y, rest = numbers_of(span(1.0, 1.0, float(len(_curves(x))), budget.room)), x, (y, *rest)
    at, options = numbers_of(rest[0]), list(rest[1:])
    outside = None if not options or isinstance(options[-1], str) else scalar(options.pop())
    kinds = [str(option) for option in options if option != "extrap"] or ["linear"]
    rule = _RULES.get(kinds[0].lower())
    if rule is None or len(kinds) > 1:
        raise LackError(f"interp1 by {', '.join(map(repr, kinds))} is not known here")
    places, curves = numbers_of(x).ravel(), _curves(y)
    order = np.argsort(places, kind="stable")
    if places.size < 2 or len(curves) != places.size or np.any(np.diff(places[order]) == 0.0):
        raise MatlabError("interp1 needs two points at least, all at different places")
    budget.work(float(at.size) * curves.shape[1])
    beyond = "extrap" in options or (kinds[0].lower() in _EXTENDED and outside is None)
    inside = (at.ravel() >= places.min()) & (at.ravel() <= places.max())
    fill = np.nan if outside is None else outside
    found = [
        np.where(beyond | inside, rule(places[order], curve[order], at.ravel()), fill)
        for curve in curves.T
    ]
    return settled(np.column_stack(found) if len(found) > 1 else found[0].reshape(at.shape))


def _interp2(budget: Allowance, wanted: int, *given: Any) -> Any:
    """Values of a surface, whose rows run along y, between its points."""
    from scipy.interpolate import RegularGridInterpolator  # takes a while to load

    arrays, rest = [], list(given)
    while rest and not isinstance(rest[0], str):
        arrays.append(numbers_of(rest.pop(0)))
    method, outside = str(rest[0]) if rest else "linear", rest[1:] or [np.nan]
    if method not in ("linear", "nearest") or len(outside) > 1:
        raise LackError(f"interp2 by {method!r} is not known here")
    if len(arrays) == 3:
        rows, columns = arrays[0].shape
        arrays = [np.arange(1.0, columns + 1.0), np.arange(1.0, rows + 1.0), *arrays]
    if len(arrays) != 5:
        raise MatlabError("interp2 takes X, Y, the values, and the places")
    x, y, values, at_x, at_y = arrays
    if x.ndim == 2 and 1 not in x.shape:
        x, y = x[0], y[:, 0]
    if at_x.shape != at_y.shape and 1 in at_x.shape and 1 in at_y.shape:
        at_x, at_y = np.meshgrid(at_x.ravel(), at_y.ravel())
    budget.work(10.0 * at_x.size)
    surface = RegularGridInterpolator(
        (y.ravel(), x.ravel()), values, method, bounds_error=False, fill_value=scalar(outside[0])
    )
    return settled(surface(np.stack([at_y, at_x], axis=-1)).reshape(at_x.shape))


def _curves(y: Any) -> NDArray[np.float64]:
    values = numbers_of(y)
    return values.reshape(-1, 1) if min(values.shape) == 1 else values


def _lines(x: NDArray[np.float64], y: NDArray[np.float64], at: NDArray[np.float64]) -> Any:
    place = np.clip(np.searchsorted(x, at, side="right") - 1, 0, x.size - 2)
    share = (at - x[place]) / (x[place + 1] - x[place])
    return np.where(at == x[place + 1], y[place + 1], y[place] + share * (y[place + 1] - y[place]))


def _steps(round_up: float) -> Callable[..., Any]:
    """Rule that takes the value at one of both ends: that after a share of the way, or at all."""

    def rule(x: NDArray[np.float64], y: NDArray[np.float64], at: NDArray[np.float64]) -> Any:
        place = np.clip(np.searchsorted(x, at, side="right") - 1, 0, x.size - 2)
        share = (at - x[place]) / (x[place + 1] - x[place])
        return y[np.clip(place + (share >= round_up) + (share > 1.0), 0, x.size - 1)]

    return rule


def _by(curve: Callable[..., Any]) -> Callable[..., Any]:
    return lambda x, y, at: numbers_of(curve(x[None, :], y[None, :], at[None, :])).ravel()


def _convolved(x: NDArray[np.float64], y: NDArray[np.float64], at: NDArray[np.float64]) -> Any:
    """Cubic convolution, as 'cubic' is since R2020b; a spline where distances differ.

    By R. Keys: Cubic convolution interpolation for digital image processing, IEEE Trans. Acoustics,
    Speech, and Signal Processing 29 (1981).
    """
    from scipy.interpolate import CubicHermiteSpline

    if x.size < 3 or np.ptp(np.diff(x)) > 1e-9 * abs(x[-1] - x[0]):
        return _by(_spline)(x, y, at)
    before, after = 3.0 * (y[0] - y[1]) + y[2], 3.0 * (y[-1] - y[-2]) + y[-3]
    around = np.concatenate([[before], y, [after]])
    return CubicHermiteSpline(x, y, (around[2:] - around[:-2]) / (x[2:] - x[:-2])[0])(at)


_EXTENDED = ("spline", "pchip")  # which go on beyond their ends
_RULES: dict[str, Callable[..., Any]] = {
    "linear": _lines,
    "nearest": _steps(0.5),
    "previous": _steps(1.0),
    "next": _steps(float(np.nextafter(0.0, 1.0))),
    "spline": _by(_spline),
    "pchip": _by(_pchip),
    "cubic": _convolved,
}


def _series(data: Any, time: Any = None, *more: Any) -> Any:
    """``timeseries``: values at times, rows of a matrix, or a row's or a column's entries."""
    values = numbers_of(data)
    if more or isinstance(time, str):
        raise LackError("'timeseries' of values and times only is known here")
    if values.ndim == 2 and 1 in values.shape:
        values = values.reshape(-1, 1)
    samples = values.shape[0] if values.ndim == 2 else values.shape[-1]
    times = np.arange(float(samples)) if time is None else numbers_of(time).ravel()
    if times.size != samples:
        raise MatlabError(f"{samples} values at {times.size} times make no 'timeseries'")
    return Struct(Time=settled(times[:, np.newaxis]), Data=settled(values), Length=float(samples))


def _cylinder(budget: Allowance, wanted: int, radii: Any = 1.0, count: Any = 20.0) -> Any:
    """Points of a surface of revolution of height 1, round by round."""
    r, n = numbers_of(radii).ravel(), whole(count)
    r = np.repeat(r, 2) if r.size == 1 else r
    budget.room(3.0 * r.size * (n + 1))
    turn = 2.0 * np.pi * np.arange(n + 1) / n
    sines = np.append(np.sin(turn[:-1]), 0.0)
    heights = np.linspace(0.0, 1.0, r.size)[:, np.newaxis] * np.ones(n + 1)
    found = (np.outer(r, np.cos(turn)), np.outer(r, sines), heights)
    return tuple(map(settled, found))[:wanted]


def _sphere(budget: Allowance, wanted: int, count: Any = 20.0) -> Any:
    """Points of a sphere of radius 1, from pole to pole."""
    n = whole(count)
    budget.room(3.0 * (n + 1) ** 2)
    turn, up = np.linspace(-np.pi, np.pi, n + 1), np.linspace(-np.pi / 2, np.pi / 2, n + 1)
    around, sines = np.cos(up), np.sin(turn)
    around[[0, -1]], sines[[0, -1]] = 0.0, 0.0
    found = (np.outer(around, np.cos(turn)), np.outer(around, sines))
    return tuple(map(settled, (*found, np.outer(np.sin(up), np.ones(n + 1)))))[:wanted]


CURVES: dict[str, Known] = {
    "interp1": _interp1,
    "interp2": _interp2,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "spline": of_values(_spline),
    "pchip": of_values(_pchip),
    "ppval": of_values(_ppval),
    "mkpp": of_values(_pieces),
    "unmkpp": _unmkpp,
    "movmean": of_values(_moving),
    "smooth": of_values(_smoothed),
    "timeseries": of_values(_series),
}
