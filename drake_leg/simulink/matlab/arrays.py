"""Functions of arrays: made, measured, reduced, searched, sorted, put together."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Known,
    LackError,
    array_of,
    boxed,
    extent,
    items_of,
    like,
    numbers_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.inputs import axis_of, line_like, matrix, scalar, sizes_of, whole
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.operators import each, stacked

# ruff: noqa: ANN401 - any value of a script


def _reduced(function: Callable[..., Any]) -> Known:
    def applied(budget: Allowance, wanted: int, value: Any, axis: Any = None, *rest: Any) -> Any:
        array = numbers_of(value)
        if axis == "all" or (array.shape == (0, 0) and not isinstance(axis, float)):
            return settled(np.asarray(function(array.ravel(), axis=0)))
        along = axis_of(array, None if isinstance(axis, str) else axis)
        if along >= array.ndim:
            return value
        return settled(function(array, axis=along, keepdims=True))

    return applied


def _running(function: Callable[..., Any]) -> Known:
    def applied(budget: Allowance, wanted: int, value: Any, axis: Any = None) -> Any:
        array = numbers_of(value)
        return settled(function(array, axis=axis_of(array, axis)))

    return applied


def _extreme(pick: Any, find: Any, pair: Any) -> Known:
    def applied(
        budget: Allowance, wanted: int, value: Any, other: Any = None, axis: Any = None, *rest: Any
    ) -> Any:
        if not all(isinstance(word, str) for word in rest):
            raise TypeError
        if other is not None and array_of(other).size:
            if axis is not None:
                raise MatlabError("the larger or smaller of two arrays takes no dimension")
            return each(pair, value, other, budget)
        array = numbers_of(value)
        if not array.size:
            return (np.zeros((0, 0)),) * max(1, wanted)
        if axis == "all":
            array, axis = array.reshape(-1, 1, order="F"), None
        along = axis_of(array, None if isinstance(axis, str) else axis)
        if along >= array.ndim:
            return value
        if np.iscomplexobj(array):
            at = find(np.abs(array), axis=along, keepdims=True)
            longest = settled(np.take_along_axis(array, at, along))
            return (longest, settled(at + 1.0)) if wanted > 1 else longest
        found = settled(pick(array, axis=along, keepdims=True))
        if wanted < 2:
            return found
        plain = np.where(np.isnan(array), -np.inf if find is np.argmax else np.inf, array)
        return found, settled(find(plain, axis=along, keepdims=True) + 1.0)

    return applied


def _made(fill: Callable[[tuple[int, ...]], Any]) -> Known:
    return lambda budget, wanted, *sizes: settled(fill(sizes_of(sizes, budget)))


def _eye(shape: tuple[int, ...]) -> Any:
    if len(shape) > 2:
        raise MatlabError("'eye' makes matrices only")
    return np.eye(shape[0], shape[1])


def _random(budget: Allowance, wanted: int, *sizes: Any) -> Any:
    raise LackError("random numbers differ from those that MATLAB draws: set the value itself")


def _size(budget: Allowance, wanted: int, value: Any, axis: Any = None) -> Any:
    shape = extent(value)
    if axis is not None:
        places = [int(k) - 1 for k in numbers_of(axis).real.ravel()]
        if any(k < 0 for k in places):
            raise MatlabError("a dimension counts from 1")
        return settled(np.array([[float(shape[k]) if k < len(shape) else 1.0 for k in places]]))
    if wanted < 2:
        return settled(np.array([shape], dtype=float))
    shape = (*shape, *(1,) * (wanted - len(shape)))
    return (*map(float, shape[: wanted - 1]), float(math.prod(shape[wanted - 1 :])))


def _diag(budget: Allowance, wanted: int, value: Any, offset: Any = 0.0) -> Any:
    array, off = numbers_of(value), whole(offset)
    if 1 in array.shape:
        budget.room((array.size + abs(off)) ** 2)
        return settled(np.diag(array.ravel(), off))
    return settled(np.diag(array, off)[:, np.newaxis])


def _find(budget: Allowance, wanted: int, value: Any, count: Any = None, *rest: Any) -> Any:
    array = array_of(value)
    where = np.flatnonzero(array.ravel(order="F"))
    if count is not None:
        where = where[-whole(count) :] if rest == ("last",) else where[: whole(count)]
    if wanted >= 2:
        columns, rows = np.divmod(where, array.shape[0])
        return line_like(rows + 1.0, array), line_like(columns + 1.0, array)
    if not where.size and array.shape == (0, 0):
        return np.zeros((0, 0))
    return line_like(where + 1.0, array)


def _sort(budget: Allowance, wanted: int, value: Any, *rest: Any) -> Any:
    down = any(isinstance(x, str) and x.lower() == "descend" for x in rest)
    if isinstance(value, Cell):
        words = [str(item) for item in value.items.ravel(order="F")]
        order = np.array(sorted(range(len(words)), key=words.__getitem__, reverse=down), int)
        sorted_items = value.items.ravel(order="F")[order].reshape(value.items.shape, order="F")
        return like(value, sorted_items), line_like(order + 1.0, value.items)
    array = numbers_of(value)
    along = axis_of(array, next((x for x in rest if not isinstance(x, str)), None))
    places = _order(array, along, down)
    return like(value, np.take_along_axis(array, places, along)), settled(places + 1.0)


def _order(array: NDArray[Any], along: int, down: bool) -> NDArray[np.intp]:
    """Places in order; complex numbers go by length, then by angle, and NaN counts as largest."""
    sign = -1.0 if down else 1.0
    keys = [array] if np.isrealobj(array) else [np.angle(array), np.abs(array)]
    nothing = np.isnan(array) != down
    return np.lexsort((*(sign * key for key in keys), nothing), axis=along)


def _unique(budget: Allowance, wanted: int, value: Any, *rest: Any) -> Any:
    if "rows" in rest:
        return _unique_rows(numbers_of(value))
    if "stable" in rest:
        raise LackError("unique by 'stable' is not known here")
    if isinstance(value, Cell):
        return Cell(boxed([[word] for word in sorted({str(item) for item in value.items.flat})]))
    array = array_of(value)
    found, back = np.unique(array.ravel(order="F"), return_inverse=True)
    first = np.zeros(found.size)
    first[back.ravel()[::-1]] = np.arange(array.size)[::-1] + 1.0
    return line_like(found, array), line_like(first, array), line_like(back + 1.0, array)


def _unique_rows(array: NDArray[Any]) -> Any:
    found, first, back = np.unique(array, axis=0, return_index=True, return_inverse=True)
    return settled(found), settled(first[:, np.newaxis] + 1.0), settled(back.reshape(-1, 1) + 1.0)


def _any(function: Any) -> Known:
    def applied(budget: Allowance, wanted: int, value: Any, axis: Any = None) -> Any:
        array = array_of(value) != 0
        if axis == "all" or array.shape == (0, 0):
            return bool(function(array))
        return settled(function(array, axis=axis_of(array, axis), keepdims=True))

    return applied


def _reshape(budget: Allowance, wanted: int, value: Any, *sizes: Any) -> Any:
    items = items_of(value)
    if any(not np.size(size) for size in sizes):
        known = [1 if not np.size(s) else whole(s) for s in sizes]
        rest = items.size // max(1, math.prod(known))
        shape = tuple(rest if not np.size(s) else whole(s) for s in sizes)
    else:
        shape = sizes_of(sizes, budget)
    if math.prod(shape) != items.size:
        size = "×".join(map(str, shape))
        raise MatlabError(f"{items.size} elements cannot be reshaped to {size}")
    return like(value, items.reshape(shape, order="F"))


def _repmat(budget: Allowance, wanted: int, value: Any, *sizes: Any) -> Any:
    items = items_of(value)
    shape = sizes_of(sizes, budget)
    budget.room(float(math.prod(shape)) * items.size)
    return like(value, np.tile(items, shape))


def _linspace(budget: Allowance, wanted: int, first: Any, last: Any, count: Any = 100.0) -> Any:
    number = max(1, math.floor(scalar(count)))
    budget.room(number)
    start, stop = scalar(first), scalar(last)
    row = np.linspace(start, stop, number) if number > 1 else np.array([stop])
    return settled(row[np.newaxis, :])


def _logspace(budget: Allowance, wanted: int, first: Any, last: Any, count: Any = 50.0) -> Any:
    return settled(10.0 ** numbers_of(_linspace(budget, 1, first, last, count)))


def _meshgrid(budget: Allowance, wanted: int, x: Any, y: Any = None) -> Any:
    a, b = numbers_of(x).ravel(), numbers_of(x if y is None else y).ravel()
    budget.room(2.0 * a.size * b.size)
    return tuple(settled(array) for array in np.meshgrid(a, b))


def _ndgrid(budget: Allowance, wanted: int, *lines: Any) -> Any:
    places = [numbers_of(line).ravel() for line in lines]
    places = places * max(2, wanted) if len(places) == 1 else places
    budget.room(len(places) * math.prod(float(each.size) for each in places))
    return tuple(settled(array) for array in np.meshgrid(*places, indexing="ij"))


def _gradient(budget: Allowance, wanted: int, value: Any, *steps: Any) -> Any:
    """Central differences, one-sided at the ends, along x (columns) and then y."""
    array = matrix(value)
    axes = [k for k in (1, 0) if array.shape[k] > 1][: max(1, wanted)]
    if len(steps) not in (0, 1, len(axes)):
        raise MatlabError(f"'gradient' takes one step, or one for each of {len(axes)} directions")
    each = steps * len(axes) if len(steps) == 1 else steps or (1.0,) * len(axes)
    found = (_slope(array, numbers_of(h), k) for k, h in zip(axes, each, strict=True))
    return tuple(map(settled, found))


def _slope(array: NDArray[Any], step: NDArray[Any], axis: int) -> NDArray[Any]:
    count = array.shape[axis]
    places = np.arange(count) * step.item() if step.size == 1 else step.ravel()
    if places.size != count:
        raise MatlabError(f"'gradient' has {count} values and {places.size} places")
    before, after = np.maximum(np.arange(count) - 1, 0), np.minimum(np.arange(count) + 1, count - 1)
    rise = np.take(array, after, axis) - np.take(array, before, axis)
    run = places[after] - places[before]
    return np.asarray(rise / (run[np.newaxis, :] if axis else run[:, np.newaxis]))


def _sortrows(budget: Allowance, wanted: int, value: Any, columns: Any = None) -> Any:
    array = matrix(value)
    keys = np.arange(1, array.shape[1] + 1) if columns is None else numbers_of(columns).ravel()
    order = np.arange(len(array))
    for key in keys[::-1]:
        index = int(abs(key)) - 1
        if not 0 <= index < array.shape[1]:
            raise MatlabError(f"'sortrows' has no column {key:g} of {array.shape[1]}")
        sign = 1.0 if key > 0 else -1.0
        order = order[np.argsort(sign * array[order, index], kind="stable")]
    return settled(array[order]), settled(order[:, np.newaxis] + 1.0)


def _rot90(budget: Allowance, wanted: int, value: Any, turns: Any = 1.0) -> Any:
    return settled(np.rot90(matrix(value), whole(turns)))


def _rms(budget: Allowance, wanted: int, value: Any, axis: Any = None) -> Any:
    array = numbers_of(value)
    along = axis_of(array, axis)
    return settled(np.sqrt(np.mean(np.abs(array) ** 2, axis=along, keepdims=True)))


def _joined(axis: int) -> Known:
    def applied(budget: Allowance, wanted: int, *blocks: Any) -> Any:
        return stacked([list(blocks)] if axis else [[block] for block in blocks], budget)

    return applied


def _cat(budget: Allowance, wanted: int, axis: Any, *blocks: Any) -> Any:
    along = whole(axis) - 1
    arrays = [items_of(block) for block in blocks if items_of(block).size]
    if not arrays or not 0 <= along < 32:
        return np.zeros((0, 0))
    deep = max(along + 1, *(array.ndim for array in arrays))
    budget.room(sum(array.size for array in arrays))
    arrays = [array.reshape((*array.shape, *(1,) * (deep - array.ndim))) for array in arrays]
    return like(blocks[0], np.concatenate(arrays, axis=along))


def _squeeze(value: Any) -> Any:
    items = items_of(value)
    if items.ndim < 3:
        return value
    kept = [n for n in items.shape if n != 1]
    return like(value, items.reshape((*kept, *(1,) * (2 - len(kept))), order="F"))


def _empty(value: Any) -> bool:
    return 0 in extent(value)


def _length(value: Any) -> float:
    return 0.0 if _empty(value) else float(max(extent(value)))


def _member(value: Any, among: Any) -> Any:
    if isinstance(among, Cell):
        words = {str(item) for item in among.items.flat}
        if isinstance(value, Cell):
            return settled(np.vectorize(lambda w: str(w) in words, otypes=[bool])(value.items))
        return str(value) in words
    return settled(np.isin(array_of(value), array_of(among)))


def _std(array: Any, axis: int, *, keepdims: bool = False) -> Any:
    return np.std(array, axis=axis, ddof=1 if array.shape[axis] > 1 else 0, keepdims=keepdims)


def _var(array: Any, axis: int, *, keepdims: bool = False) -> Any:
    return _std(array, axis, keepdims=keepdims) ** 2


def _lengths(array: Any, axis: int, *, keepdims: bool = False) -> Any:
    return np.sqrt(np.sum(np.abs(array) ** 2, axis=axis, keepdims=keepdims))


def _flip(axis: int | None) -> Known:
    def applied(budget: Allowance, wanted: int, value: Any, along: Any = None) -> Any:
        items = items_of(value)
        return like(value, np.flip(items, axis_of(items, along) if axis is None else axis))

    return applied


def _permute(value: Any, order: Any) -> Any:
    items = items_of(value)
    axes = [int(k) - 1 for k in numbers_of(order).real.ravel()]
    if sorted(axes) != list(range(len(axes))) or not items.ndim <= len(axes) <= 32:
        raise MatlabError("the order of dimensions must name each one once")
    items = items.reshape((*items.shape, *(1,) * (len(axes) - items.ndim)))
    return like(value, np.transpose(items, axes))


def _diff(value: Any, times: Any = 1.0) -> Any:
    array = numbers_of(value)
    return settled(np.diff(array, whole(times), axis=axis_of(array)))


def _circshift(value: Any, by: Any, axis: Any = None) -> Any:
    items = items_of(value)
    return like(value, np.roll(items, whole(by), axis_of(items, axis)))


def _set_of(function: Callable[[Any, Any], Any]) -> Known:
    def applied(budget: Allowance, wanted: int, left: Any, right: Any, *rest: Any) -> Any:
        a, b = array_of(left), array_of(right)
        both_rows = all(array.shape[0] == 1 for array in (a, b) if array.size)
        return settled(function(a.ravel(), b.ravel()).reshape((1, -1) if both_rows else (-1, 1)))

    return applied


def _filled_with(number: float) -> Known:
    def fill(shape: tuple[int, ...]) -> NDArray[np.float64]:
        return np.full(shape, number)

    return _made(fill)


ARRAYS: dict[str, Known] = {
    "sum": _reduced(np.sum),
    "prod": _reduced(np.prod),
    "mean": _reduced(np.mean),
    "median": _reduced(np.median),
    "std": _reduced(_std),
    "var": _reduced(_var),
    "vecnorm": lambda budget, wanted, value, order=2.0, axis=None: _reduced(_lengths)(
        budget, wanted, value, axis
    ),
    "cumsum": _running(np.cumsum),
    "cumprod": _running(np.cumprod),
    "unwrap": _running(np.unwrap),
    "max": _extreme(np.fmax.reduce, np.argmax, np.fmax),
    "min": _extreme(np.fmin.reduce, np.argmin, np.fmin),
    "any": _any(np.any),
    "all": _any(np.all),
    "zeros": _made(np.zeros),
    "ones": _made(np.ones),
    "eye": _made(_eye),
    **dict.fromkeys(("nan", "NaN"), _filled_with(math.nan)),
    **dict.fromkeys(("inf", "Inf"), _filled_with(math.inf)),
    "true": _made(lambda shape: np.ones(shape, dtype=bool)),
    "false": _made(lambda shape: np.zeros(shape, dtype=bool)),
    **dict.fromkeys(("randn", "randperm"), _random),
    "size": _size,
    "numel": of_values(lambda value: float(math.prod(extent(value)))),
    "length": of_values(_length),
    "ndims": of_values(lambda value: float(len(extent(value)))),
    **dict.fromkeys(("rows", "height"), of_values(lambda value: float(extent(value)[0]))),
    **dict.fromkeys(("columns", "width"), of_values(lambda value: float(extent(value)[1]))),
    "isempty": of_values(_empty),
    "isscalar": of_values(lambda value: math.prod(extent(value)) == 1),
    "isvector": of_values(lambda value: 1 in extent(value) and not _empty(value)),
    "ismatrix": of_values(lambda value: len(extent(value)) == 2),
    "issquare": of_values(lambda value: len(set(extent(value))) == 1),
    "isrow": of_values(lambda value: extent(value)[0] == 1),
    "iscolumn": of_values(lambda value: extent(value)[1] == 1),
    "diag": _diag,
    "reshape": _reshape,
    "repmat": _repmat,
    "permute": of_values(_permute),
    "squeeze": of_values(_squeeze),
    "linspace": _linspace,
    "logspace": _logspace,
    "meshgrid": _meshgrid,
    "ndgrid": _ndgrid,
    "gradient": _gradient,
    "sortrows": _sortrows,
    "rot90": _rot90,
    "rms": _rms,
    "find": _find,
    "sort": _sort,
    "unique": _unique,
    "ismember": of_values(_member),
    "union": _set_of(np.union1d),
    "intersect": _set_of(np.intersect1d),
    "setdiff": _set_of(np.setdiff1d),
    "fliplr": _flip(1),
    "flipud": _flip(0),
    "flip": _flip(None),
    "circshift": of_values(_circshift),
    "diff": of_values(_diff),
    "horzcat": _joined(1),
    "vertcat": _joined(0),
    "cat": _cat,
    "nnz": of_values(lambda value: float(np.count_nonzero(array_of(value)))),
}
