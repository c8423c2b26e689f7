"""Functions of structures, cells, functions as values, and kinds of values."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Function,
    Known,
    Object,
    Struct,
    Structs,
    array_of,
    boxed,
    extent,
    items_of,
    kind_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.inputs import sizes_of
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.operators import stacked

# ruff: noqa: ANN401 - any value of a script


def _struct(*pairs: Any) -> Any:
    if len(pairs) % 2:
        raise MatlabError("'struct' takes names, each with its value")
    shapes = {v.items.shape for v in pairs[1::2] if isinstance(v, Cell) and v.items.size != 1}
    if len(shapes) > 1:
        raise MatlabError("the cells of a structure differ in size")
    shape = shapes.pop() if shapes else (1, 1)
    made = np.empty(shape, dtype=object)
    for k in range(made.size):
        one = Struct()
        for name, value in zip(pairs[::2], pairs[1::2], strict=True):
            inside = value.items.ravel(order="F") if isinstance(value, Cell) else None
            one[str(name)] = value if inside is None else inside[k if inside.size > 1 else 0]
        made[np.unravel_index(k, shape, order="F")] = one
    return made.flat[0] if made.size == 1 else Structs(made, tuple(map(str, pairs[::2])))


def _names(value: Any) -> tuple[str, ...]:
    if isinstance(value, Structs):
        return value.names
    return tuple(value) if isinstance(value, Struct) else ()


def _fieldnames(value: Any) -> Any:
    names = _names(value)
    return Cell(boxed([[name] for name in names]) if names else np.empty((0, 1), object))


def _isfield(value: Any, name: Any) -> Any:
    if isinstance(name, Cell):
        return settled(np.vectorize(lambda n: n in _names(value), otypes=[bool])(name.items))
    return isinstance(name, str) and name in _names(value)


def _one(value: Any) -> Struct:
    if not isinstance(value, Struct):
        raise MatlabError(f"a structure is needed, not a {kind_of(value)}")
    return value


def _rmfield(value: Any, name: Any) -> Any:
    return Struct({key: item for key, item in _one(value).items() if key != name})


def _setfield(value: Any, name: Any, item: Any) -> Any:
    return Struct({**_one(value), str(name): item})


def _getfield(value: Any, name: Any) -> Any:
    if name not in _one(value):
        raise MatlabError(f"the structure has no field '{name}'")
    return value[str(name)]


def _cell(budget: Allowance, wanted: int, *sizes: Any) -> Any:
    made = np.empty(sizes_of(sizes, budget) if sizes else (0, 0), dtype=object)
    made.fill(np.zeros((0, 0)))
    return Cell(made)


def _num2cell(budget: Allowance, wanted: int, value: Any) -> Any:
    items = items_of(value)
    budget.step(items.size)
    made = np.empty(items.shape, dtype=object)
    for k in range(items.size):
        item = items.flat[k]
        made.flat[k] = settled(item) if isinstance(item, np.generic) else item
    return Cell(made)


def _cell2mat(budget: Allowance, wanted: int, value: Any) -> Any:
    if not isinstance(value, Cell):
        raise MatlabError("'cell2mat' needs a cell")
    return stacked([list(row) for row in value.items], budget)


def _struct2cell(value: Any) -> Any:
    return Cell(boxed([[item] for item in _one(value).values()]))


def _cell2struct(cell: Any, names: Any, axis: Any = 1.0) -> Any:
    words = names.items.ravel() if isinstance(names, Cell) else [names]
    items = cell.items.ravel(order="F")
    if len(words) != items.size:
        raise MatlabError("'cell2struct' needs as many names as values")
    return Struct({str(word): item for word, item in zip(words, items, strict=True)})


def _isequal(*values: Any) -> bool:
    return all(_alike(values[0], other) for other in values[1:])


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, Struct) and isinstance(b, Struct):
        return set(a) == set(b) and all(_alike(a[key], b[key]) for key in a)
    if isinstance(a, Object) or isinstance(b, Object):
        return a is b
    if isinstance(a, Function) or isinstance(b, Function):
        return a is b or (isinstance(a, Function) and isinstance(b, Function) and _same(a, b))
    if isinstance(a, (Struct, Structs, Cell)) or isinstance(b, (Struct, Structs, Cell)):
        same = type(a) is type(b) and extent(a) == extent(b)
        return same and all(map(_alike, items_of(a).flat, items_of(b).flat))
    x, y = array_of(a), array_of(b)
    return x.shape == y.shape and bool(np.all(x == y))


def _same(a: Function, b: Function) -> bool:
    return bool(a.name) and a.name == b.name


def _isa(value: Any, kind: Any) -> bool:
    kinds = {"numeric": ("double",), "float": ("double",)}
    return kind_of(value) in kinds.get(str(kind), (str(kind),))


def _named(value: Any) -> str:
    return value.name or "@(...)" if isinstance(value, Function) else str(value)


def _is_kind(*kinds: str) -> Known:
    return of_values(lambda value: kind_of(value) in kinds)


RECORDS: dict[str, Known] = {
    "struct": of_values(_struct),
    "fieldnames": of_values(_fieldnames),
    "isfield": of_values(_isfield),
    "rmfield": of_values(_rmfield),
    "setfield": of_values(_setfield),
    "getfield": of_values(_getfield),
    "cell": _cell,
    "num2cell": _num2cell,
    "cell2mat": _cell2mat,
    "struct2cell": of_values(_struct2cell),
    "cell2struct": of_values(_cell2struct),
    "iscell": _is_kind("cell"),
    "isstruct": _is_kind("struct"),
    "ischar": _is_kind("char"),
    "isstring": _is_kind("string"),
    "iscellstr": of_values(
        lambda v: isinstance(v, Cell) and all(isinstance(x, str) for x in v.items.flat)
    ),
    "isnumeric": _is_kind("double"),
    "isfloat": _is_kind("double"),
    "islogical": _is_kind("logical"),
    "isreal": of_values(lambda value: bool(np.isrealobj(array_of(value)))),
    "isequal": of_values(_isequal),
    "isa": of_values(_isa),
    "class": of_values(kind_of),
    "func2str": of_values(_named),
    "str2func": of_values(lambda name: Function(name=str(name).removeprefix("@"))),
}
