"""Assignments to a part of a variable: elements, fields, contents of cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import Allowance, Cell, Object, SpentError, Struct, boxed
from drake_leg.simulink.matlab.indexing import read, removed, write
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script


@dataclass(frozen=True)
class Indexed:
    """A step to elements, or to the contents of a cell."""

    indices: Callable[[Any], Values]  # of the value that they index
    braces: bool = False


Step = str | Indexed  # to a field, or to elements


def write_target(
    interpreter: Interpreter,
    target: syntax.Target | syntax.Place,
    value: Any,
    frame: Frame,
    *,
    remove: bool = False,
) -> None:
    """Assign a value; with `remove`, take the elements away."""
    name = target.name
    if name == "~":
        return
    if isinstance(target, syntax.Target) and target.indices is not None:
        old = frame.values.get(name)
        empty = np.zeros((0, 0))
        indices = interpreter.indices(target.indices, empty if old is None else old, frame)
        if remove:
            value = removed(old, indices, name)
        elif name in frame.owned and written_in_place(old, indices, value):
            return
        else:
            value = write(old, indices, value, interpreter.budget, name)
    elif isinstance(target, syntax.Place):
        steps = [_step(interpreter, node, frame) for node in steps_of(target.to)]
        value = put(frame.values.get(name), steps, value, interpreter.budget, remove=remove)
    own = isinstance(value, np.ndarray) and isinstance(target, syntax.Target) and target.indices
    if own and not value.flags.owndata:
        value = value.copy(order="F")
    interpreter.store(name, value, frame)
    if own:
        frame.owned.add(name)


def written_in_place(old: Any, indices: Values, value: Any) -> bool:
    """Write one number into an array that is the variable's own, where there is a place for it."""
    if not (isinstance(old, np.ndarray) and old.ndim == 2 and type(value) is float):
        return False
    if old.dtype != np.float64 or not all(type(index) is float for index in indices):
        return False
    if any(not (index >= 1.0 and index.is_integer()) for index in indices) or len(indices) > 2:
        return False
    if len(indices) == 1:
        column, row = divmod(int(indices[0]) - 1, old.shape[0]) if old.size else (0, 0)
    else:
        row, column = (int(index) - 1 for index in indices)
    if row >= old.shape[0] or column >= old.shape[1]:
        return False
    old[row, column] = value
    return True


def steps_of(node: syntax.Expression) -> list[syntax.Field | syntax.Part]:
    """Fields and indices of a place, the outermost first."""
    steps: list[syntax.Field | syntax.Part] = []
    while isinstance(node, (syntax.Field, syntax.Part)):
        steps.append(node)
        node = node.base
    if isinstance(node, syntax.Apply):
        steps.append(syntax.Part(base=syntax.Name(name=node.name), arguments=node.arguments))
    return steps[::-1]


def _step(interpreter: Interpreter, node: syntax.Field | syntax.Part, frame: Frame) -> Step:
    if isinstance(node, syntax.Field):
        return interpreter.field_name(node, frame)
    arguments = node.arguments
    return Indexed(lambda base: interpreter.indices(arguments, base, frame), node.braces)


def put(
    old: Any, steps: Sequence[Step], value: Any, budget: Allowance, *, remove: bool = False
) -> Any:
    """Return a value in which a part is replaced; the old one is left as it was."""
    if not steps:
        return value
    step, rest = steps[0], steps[1:]
    nothing = old is None or (isinstance(old, np.ndarray) and not old.size)
    if isinstance(step, str):
        if isinstance(old, Object):
            inner = old.property(step) if rest else None
            old.set(step, put(inner, rest, value, budget, remove=remove))
            return old
        if nothing:
            old = Struct()
        if not isinstance(old, Struct):
            raise MatlabError(f"the field '{step}' is set in what is no structure")
        made = Struct(old)
        made[step] = put(old.get(step), rest, value, budget, remove=remove)
        return made
    indices = step.indices(np.zeros((0, 0)) if old is None else old)
    if step.braces:
        return _put_inside(old, indices, rest, value, budget, remove=remove)
    if not rest:
        return removed(old, indices) if remove else write(old, indices, value, budget)
    part = None if nothing else _part_or_none(old, indices, budget)
    if isinstance(part, Cell) and part.items.size == 1 and isinstance(rest[0], str):
        part = part.items.flat[0]
    return write(old, indices, put(part, rest, value, budget, remove=remove), budget)


def without(old: Struct, fields: Sequence[str]) -> Struct:
    """Return a structure without a field, or a field of a field; the old one is left as it was."""
    made = Struct(old)
    inner = made.get(fields[0])
    if len(fields) > 1 and isinstance(inner, Struct):
        made[fields[0]] = without(inner, fields[1:])
    else:
        made.pop(fields[0], None)
    return made


def _put_inside(
    old: Any,
    indices: Values,
    rest: Sequence[Step],
    value: Any,
    budget: Allowance,
    *,
    remove: bool,
) -> Any:
    """Replace the contents of an element of a cell."""
    nothing = old is None or (isinstance(old, np.ndarray) and not old.size)
    cell = Cell(np.empty((0, 0), dtype=object)) if nothing else old
    if not isinstance(cell, Cell):
        raise MatlabError("braces index what is no cell")
    inner = _part_or_none(cell, indices, budget) if rest else None
    part = inner.items.flat[0] if isinstance(inner, Cell) and inner.items.size else None
    new = put(part, rest, value, budget, remove=remove and bool(rest))
    return write(cell, indices, Cell(boxed([[new]])), budget)


def _part_or_none(value: Any, indices: Values, budget: Allowance) -> Any:
    try:
        return read(value, indices, budget)
    except SpentError:
        raise
    except MatlabError:
        return None  # it is about to grow
