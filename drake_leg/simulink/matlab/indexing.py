"""Elements of arrays, cells and structures: read, written, removed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Object,
    Struct,
    Structs,
    array_of,
    boxed,
    extent,
    items_of,
    like,
)
from drake_leg.simulink.matlab.numeric import MatlabError, measure

# ruff: noqa: ANN401 - any value of a script
_Places = NDArray[np.intp]


class All:
    """The index ``:``."""


ALL = All()


def is_all(index: Any) -> bool:
    """Whether an index means all elements: ``:``, bare or as a text."""
    return isinstance(index, All) or (isinstance(index, str) and index == ":")


def places(index: Any, count: int, name: str = "") -> _Places:
    """Places from 0 that an index means."""
    if is_all(index):
        return np.arange(count)
    given = array_of(index).ravel(order="F")
    if given.dtype == np.bool_:
        return np.flatnonzero(given)
    wrong = given[~((given.real >= 1) & (given.real % 1 == 0) & (given.imag == 0))]
    if wrong.size:
        raise MatlabError(
            f"{_named(name)} has the index {wrong[0]:g}; indices are whole numbers from 1"
        )
    found: _Places = np.minimum(given.real - 1, 2**40).astype(np.intp)
    return found


def _named(name: str) -> str:
    return f"'{name}'" if name else "a value"


def read(value: Any, indices: list[Any], budget: Allowance, name: str = "") -> Any:
    """Read elements, in parentheses; messages call the value by its name."""
    if not indices:
        return value
    if isinstance(value, np.ndarray) and all(type(index) is float for index in indices):
        found = _element(value, indices)
        if found is not None:
            return found
    if isinstance(value, Object):
        return value.get(indices)
    items = items_of(value)
    if len(indices) == 1:
        where = places(indices[0], items.size, name)
        _require(where, items.size, "element", items, name)
        budget.room(where.size)
        flat = items.ravel(order="F")[where]
        return like(value, flat.reshape(_shape(items.shape, indices[0], where.size), order="F"))
    shape = _folded(items.shape, len(indices))
    folded = items.reshape(shape, order="F")
    chosen = [places(index, count, name) for index, count in zip(indices, shape, strict=True)]
    for k, (where, count) in enumerate(zip(chosen, shape, strict=True)):
        _require(where, count, ("row", "column", "page")[min(k, 2)], items, name)
    budget.room(math.prod(where.size for where in chosen))
    return like(value, folded[np.ix_(*chosen)])


def _element(array: NDArray[Any], indices: list[float]) -> Any:
    """Read one element of a matrix quickly; None where it is not there."""
    rows = array.shape[0]
    if array.ndim > 2 or len(indices) > 2:
        return None
    if any(not (index >= 1.0 and index.is_integer()) for index in indices):
        return None
    if len(indices) == 1:
        column, row = divmod(int(indices[0]) - 1, max(rows, 1))
    else:
        row, column = (int(index) - 1 for index in indices)
    return array.item(row, column) if row < rows and column < array.shape[1] else None


def _require(where: _Places, count: int, what: str, items: NDArray[Any], name: str) -> None:
    if where.size and where.max() >= count:
        far = where.max() + 1
        raise MatlabError(f"{_named(name)} is {measure(items)} and has no {what} {far}")


def _folded(shape: tuple[int, ...], count: int) -> tuple[int, ...]:
    """Shape seen by so many indices: the last one counts through what is left."""
    if len(shape) <= count:
        return (*shape, *(1,) * (count - len(shape)))
    return (*shape[: count - 1], math.prod(shape[count - 1 :]))


def _shape(source: tuple[int, ...], index: Any, count: int) -> tuple[int, ...]:
    """Shape of what one index reads: a vector keeps its direction, else it is that of the index."""
    if is_all(index):
        return count, 1
    given = array_of(index)
    vector = len(source) == 2 and 1 in source and source != (1, 1)
    if given.dtype == np.bool_ and given.size != 1:
        row = source[0] == 1 if vector else given.shape[0] == 1
        return (1, count) if row else (count, 1)
    if vector and given.ndim == 2 and 1 in given.shape:
        return (1, count) if source[0] == 1 else (count, 1)
    return given.shape if given.size == count else (1, count)


def write(old: Any, indices: list[Any], new: Any, budget: Allowance, name: str = "") -> Any:
    """Write elements, in parentheses, into a copy that grows as needed, or into an object."""
    if isinstance(old, Object):
        old.put(indices, new)
        return old
    if old is None or (isinstance(old, np.ndarray) and not old.size):
        old = old if isinstance(old, np.ndarray) and _plain(new) else _empty_like(new)
    new_items = boxed([[new]]) if _is_boxed(old, new) else items_of(new)
    if isinstance(old, (Struct, Structs)):
        if not isinstance(new, (Struct, Structs)):
            raise MatlabError("only a structure fits into an array of structures")
        old, new_items = _same_fields(old, new)
    elif new_items.dtype == object and not isinstance(old, Cell):
        raise MatlabError("a value of another kind does not fit into this array")
    return like(old, _filled(items_of(old), indices, new_items, _blank(old), budget, name))


def _is_boxed(old: Any, new: Any) -> bool:
    return isinstance(old, Cell) and not isinstance(new, Cell)


def _plain(new: Any) -> bool:
    return isinstance(new, (float, bool, complex, np.ndarray))


def _empty_like(new: Any) -> Any:
    if isinstance(new, Cell):
        return Cell(np.empty((0, 0), dtype=object))
    if isinstance(new, (Struct, Structs)):
        return Structs(
            np.empty((0, 0), dtype=object), tuple(new) if isinstance(new, Struct) else new.names
        )
    if isinstance(new, str):
        return ""
    kind = bool if array_of(new).dtype == np.bool_ else float
    return np.zeros((0, 0), dtype=kind)


def _blank(old: Any) -> Any:
    if isinstance(old, (Struct, Structs)):
        names = old.names if isinstance(old, Structs) else tuple(old)
        return Struct({name: np.zeros((0, 0)) for name in names})
    return np.zeros((0, 0)) if isinstance(old, Cell) else 0


def _same_fields(old: Any, new: Any) -> tuple[Any, NDArray[Any]]:
    """Give two structures the same fields, in the old one's order."""
    first, other = (tuple(v.names if isinstance(v, Structs) else v) for v in (old, new))
    if set(first) == set(other):
        return Structs(items_of(old), first), items_of(new)
    names = (*first, *(name for name in other if name not in first))

    def widened(items: NDArray[Any]) -> NDArray[Any]:
        made = np.empty(items.shape, dtype=object)
        for k in range(items.size):
            one = items.flat[k]
            made.flat[k] = Struct({name: one.get(name, np.zeros((0, 0))) for name in names})
        return made

    return Structs(widened(items_of(old)), names), widened(items_of(new))


def _filled(
    items: NDArray[Any],
    indices: list[Any],
    new: NDArray[Any],
    blank: Any,
    budget: Allowance,
    name: str,
) -> NDArray[Any]:
    if np.iscomplexobj(new) and not np.iscomplexobj(items) and items.dtype != object:
        items = items.astype(np.complex128)
    if items.dtype == np.bool_ and new.dtype != np.bool_:
        if items.size:
            new = new != 0  # an array of logicals stays one
        else:
            items = items.astype(np.float64)
    if len(indices) == 1:
        return _filled_in_order(items, indices[0], new, blank, budget, name)
    shape = _folded(items.shape, len(indices))
    found = _rectangle(indices, shape, new, name)
    needed = tuple(
        max(count, int(where.max(initial=-1)) + 1)
        for where, count in zip(found, shape, strict=True)
    )
    if needed != shape:
        if len(shape) < items.ndim:
            raise MatlabError("the last of fewer indices than dimensions is beyond the array")
        items = _grown(items.reshape(shape, order="F"), needed, blank, budget)
    else:
        items = items.copy()
        budget.room(items.size)
    folded = items.reshape(_folded(items.shape, len(indices)), order="F")
    sizes = [where.size for where in found]
    if new.size == 1:
        folded[np.ix_(*found)] = _spread(new, tuple(sizes))
    elif [n for n in sizes if n != 1] == [n for n in new.shape if n != 1]:
        folded[np.ix_(*found)] = new.reshape(sizes, order="F")
    else:
        size = "×".join(map(str, sizes))
        raise MatlabError(f"{measure(new)} does not fit {size} elements of {_named(name)}")
    return folded.reshape(items.shape, order="F")


def _rectangle(
    indices: list[Any], shape: tuple[int, ...], new: NDArray[Any], name: str
) -> list[_Places]:
    """Places in each dimension; ``:`` of nothing is as long as what is written."""
    lengths = list(new.shape)
    others = [index for index in indices if not is_all(index)]
    if len(lengths) != len(indices) or any(np.size(array_of(one)) == 1 for one in others):
        lengths = [n for n in lengths if n != 1]  # a vector goes where there is room for it
        spread = iter(lengths)
        lengths = [next(spread, 1) if is_all(index) else 1 for index in indices]
    return [
        places(index, count or length if is_all(index) else count, name)
        for index, count, length in zip(indices, shape, lengths, strict=True)
    ]


def _filled_in_order(
    items: NDArray[Any],
    index: Any,
    new: NDArray[Any],
    blank: Any,
    budget: Allowance,
    name: str,
) -> NDArray[Any]:
    where = places(index, items.size or new.size, name)
    needed = int(where.max(initial=-1)) + 1
    if needed > items.size:
        if items.ndim > 2 or (items.size and 1 not in items.shape):
            raise MatlabError(f"{_named(name)} of {measure(items)} cannot grow by one index")
        tall = items.shape[1] == 1 and items.size > 1
        items = _grown(items, (needed, 1) if tall else (1, needed), blank, budget)
    budget.room(items.size)
    flat = items.flatten(order="F")
    if new.size not in (1, where.size):
        raise MatlabError(f"{new.size} values do not fit {where.size} elements of {_named(name)}")
    flat[where] = _spread(new, where.shape) if new.size == 1 else new.ravel(order="F")
    return flat.reshape(items.shape, order="F")


def _spread(one: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    made = np.empty(shape, one.dtype)
    made.fill(one.flat[0])
    return made


def _grown(
    items: NDArray[Any], shape: tuple[int, ...], blank: Any, budget: Allowance
) -> NDArray[Any]:
    shape = tuple(max(a, b) for a, b in zip(items.shape, shape, strict=True))
    budget.room(float(np.prod([float(n) for n in shape])))
    made = np.zeros(shape, items.dtype)
    if items.dtype == object:
        made.fill(blank)
    made[tuple(slice(n) for n in items.shape)] = items
    return made


def removed(old: Any, indices: list[Any], name: str = "") -> Any:
    """Remove elements: ``x(2) = []``."""
    items = items_of(old)
    if len(indices) == 1:
        gone = places(indices[0], items.size, name)
        _require(gone, items.size, "element", items, name)
        flat = np.delete(items.ravel(order="F"), gone)
        tall = items.ndim == 2 and items.shape[1] == 1 and items.shape[0] > 1
        return like(old, flat.reshape((-1, 1) if tall else (1, -1)))
    shape = _folded(items.shape, len(indices))
    items = items.reshape(shape, order="F")
    found = [places(index, count, name) for index, count in zip(indices, shape, strict=True)]
    part = [
        k
        for k, (where, count) in enumerate(zip(found, shape, strict=True))
        if not is_all(indices[k]) and np.unique(where).size < count
    ]
    axis = part[0] if part else next((k for k, i in enumerate(indices) if not is_all(i)), 0)
    if len(part) > 1:
        raise MatlabError("only whole rows or columns can be removed")
    _require(found[axis], shape[axis], ("row", "column", "page")[min(axis, 2)], items, name)
    return like(old, np.delete(items, found[axis], axis=axis))


def last(value: Any, place: int, count: int) -> float:
    """What ``end`` means in an index."""
    shape = extent(value)
    return float(math.prod(shape)) if count == 1 else float(_folded(shape, count)[place])


def columns(value: Any, budget: Allowance) -> Iterator[Any]:
    """Columns of a value, one after the other, as a loop runs over them; each is a step."""
    if isinstance(value, np.ndarray) and value.shape[:1] == (1,) and value.ndim == 2:
        for one in value[0].tolist():
            budget.step()
            yield one
        return
    shape = extent(value)
    for k in range(math.prod(shape[1:]) if shape[0] else 0):
        budget.step()
        yield read(value, [ALL, float(k + 1)], budget)
