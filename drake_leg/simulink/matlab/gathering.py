"""Functions that gather elements: by subscripts, from lists, along a filter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab.data import (
    Allowance,
    Known,
    LackError,
    array_of,
    numbers_of,
    settled,
)
from drake_leg.simulink.matlab.inputs import axis_of, whole
from drake_leg.simulink.matlab.numeric import MatlabError, measure

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script


def _deal(budget: Allowance, wanted: int, *values: Any) -> Any:
    """``[a, b] = deal(x, y)``, or one value for all of them."""
    count = max(1, wanted)
    if len(values) not in (1, count):
        raise MatlabError(f"'deal' has {len(values)} values for {count} variables")
    return tuple(values) if len(values) == count else tuple(values) * count


def _accumulate(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``accumarray(subscripts, values, size, function, fill)``."""
    subscripts, given, *rest = arguments
    at = numbers_of(subscripts)
    at = at.reshape(-1, 1) if 1 in at.shape and at.shape[1] != 2 else at
    if np.any(at < 1) or np.any(at % 1):
        raise MatlabError("'accumarray' takes subscripts that are whole numbers from 1")
    values = np.broadcast_to(numbers_of(given).ravel(order="F"), (len(at),))
    least = at.max(axis=0).astype(int) if at.size else np.zeros(at.shape[1], dtype=int)
    size = numbers_of(rest[0]).ravel() if rest and np.size(rest[0]) else least
    shape = tuple(int(n) for n in size) if len(size) > 1 else (int(size[0]), 1)
    if any(n > m for n, m in zip(least, shape, strict=False)):
        raise MatlabError(f"'accumarray' has subscripts beyond its size {measure(np.empty(shape))}")
    self.budget.room(float(np.prod(shape)))
    columns = (at.astype(int) - 1).T
    if len(columns) == 1:
        columns = np.vstack([columns, np.zeros_like(columns)])
    places = np.ravel_multi_index(tuple(columns), shape, order="F")
    made = np.zeros(int(np.prod(shape)), dtype=values.dtype)
    if len(rest) < 2 or not rest[1]:
        np.add.at(made, places, values)
    else:
        made += numbers_of(rest[2]).flat[0] if len(rest) > 2 else 0.0
        for place in np.unique(places):
            group = settled(values[places == place].reshape(-1, 1))
            made[place] = numbers_of(self.apply(rest[1], [group], 1, frame)[0]).flat[0]
    return [settled(made.reshape(shape, order="F"))]


def _filter(
    budget: Allowance,
    wanted: int,
    numerator: Any,
    denominator: Any,
    signal: Any,
    start: Any = None,
    axis: Any = None,
) -> Any:
    """``[y, zf] = filter(b, a, x, zi, dim)``: a difference equation, in direct form II."""
    b, a = (numbers_of(each).ravel() for each in (numerator, denominator))
    x = numbers_of(signal)
    along = axis_of(x, axis)
    if not a.size or a[0] == 0.0:
        raise MatlabError("'filter' divides by its first denominator, which is 0")
    budget.work(100.0 * x.shape[along] + float(x.size) * (a.size + b.size))
    size = max(a.size, b.size)
    b, a = (np.pad(each / a[0], (0, size - each.size)) for each in (b, a))
    lines = np.moveaxis(x, along, 0)
    held = numbers_of(start) if start is not None else np.zeros((0, 0))
    if held.size not in (0, size - 1) or (held.size and x.size != x.shape[along]):
        raise LackError("'filter' takes a start for one signal, with an entry for each delay")
    kind = np.result_type(b, a, x, held)
    delays = np.zeros((size, *lines.shape[1:]), dtype=kind)  # the last one stays zero
    delays[:-1] = held.reshape(size - 1, *(1,) * (x.ndim - 1)) if held.size else 0.0
    made = np.empty(lines.shape, dtype=kind)
    weights = tuple(each.reshape(size, *(1,) * (x.ndim - 1)) for each in (b, a))
    for k, line in enumerate(lines):
        made[k] = b[0] * line + delays[0]
        delays[:-1] = delays[1:] + (weights[0] * line - weights[1] * made[k])[1:]
    end = delays[:-1].reshape(-1, 1) if x.size == len(lines) else np.moveaxis(delays[:-1], 0, along)
    return settled(np.moveaxis(made, 0, along)), settled(end)


def _linear(budget: Allowance, wanted: int, size: Any, *subscripts: Any) -> Any:
    """``sub2ind``."""
    shape = [whole(float(n)) for n in numbers_of(size).ravel()]
    at = [numbers_of(each) - 1 for each in subscripts]
    if len(at) > len(shape) or any(
        np.any((each < 0) | (each >= n)) for each, n in zip(at, shape, strict=False)
    ):
        raise MatlabError("'sub2ind' has subscripts beyond the size")
    steps = np.cumprod([1, *shape])
    total = sum((each * step for each, step in zip(at, steps, strict=False)), np.zeros(()))
    return settled(np.asarray(total + 1.0))


def _subscripts(budget: Allowance, wanted: int, size: Any, index: Any) -> Any:
    """``[i, j] = ind2sub(size, k)``; the last one counts through what is left."""
    shape = [whole(float(n)) for n in numbers_of(size).ravel()]
    rest = numbers_of(index) - 1.0
    if np.any(rest < 0) or np.any(rest >= np.prod(shape)):
        raise MatlabError("'ind2sub' has an index beyond the size")
    found = []
    for n in shape[: max(wanted, 1) - 1]:
        found.append(settled(np.mod(rest, n) + 1.0))
        rest = np.floor(rest / n)
    found.append(settled(rest + 1.0))
    while len(found) < wanted:
        found.append(settled(np.ones(np.shape(rest))))
    return tuple(found)


def _counted(budget: Allowance, wanted: int, value: Any) -> Any:
    """``mode``: the most frequent value, the least of several, column by column."""
    array = array_of(value)
    lines = [array.ravel()] if 1 in array.shape else list(array.T)
    best = []
    for line in lines:
        values, counts = np.unique(line, return_counts=True)
        best.append((float(values[np.argmax(counts)]), float(counts.max())))
    found = np.array(best).T
    return tuple(settled(row.reshape(1, -1)) for row in found)


GATHERING: dict[str, Known] = {
    "deal": _deal,
    "filter": _filter,
    "sub2ind": _linear,
    "ind2sub": _subscripts,
    "mode": _counted,
}
GATHERING_BY_FUNCTIONS: dict[str, Any] = {"accumarray": _accumulate}
