"""Assignments to a part of a variable: elements, fields, contents of cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import Cell, SpentError, Struct, boxed
from drake_leg.simulink.matlab.indexing import read, removed, write
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script


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
        elif name in frame.owned and _written_in_place(old, indices, value):
            return
        else:
            value = write(old, indices, value, interpreter.budget, name)
    elif isinstance(target, syntax.Place):
        steps = _steps(target.to)
        value = _put(interpreter, frame.values.get(name), steps, value, frame, remove=remove)
    own = isinstance(value, np.ndarray) and isinstance(target, syntax.Target) and target.indices
    if own and not value.flags.owndata:
        value = value.copy(order="F")
    interpreter.store(name, value, frame)
    if own:
        frame.owned.add(name)


def _written_in_place(old: Any, indices: Values, value: Any) -> bool:
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


def _steps(node: syntax.Expression) -> list[syntax.Expression]:
    """Fields and indices of a place, the outermost first."""
    steps: list[syntax.Expression] = []
    while not isinstance(node, syntax.Name):
        if isinstance(node, (syntax.Field, syntax.Part)):
            steps.append(node)
            node = node.base
        elif isinstance(node, syntax.Apply):
            steps.append(syntax.Part(base=syntax.Name(name=node.name), arguments=node.arguments))
            break
    return steps[::-1]


def _put(
    interpreter: Interpreter,
    old: Any,
    steps: list[syntax.Expression],
    value: Any,
    frame: Frame,
    *,
    remove: bool,
) -> Any:
    """Return a value in which a part is replaced; the old one is left as it was."""
    if not steps:
        return value
    step, rest = steps[0], steps[1:]
    nothing = old is None or (isinstance(old, np.ndarray) and not old.size)
    if isinstance(step, syntax.Field):
        name = interpreter.field_name(step, frame)
        if nothing:
            old = Struct()
        if not isinstance(old, Struct):
            raise MatlabError(f"the field '{name}' is set in what is no structure")
        made = Struct(old)
        made[name] = _put(interpreter, old.get(name), rest, value, frame, remove=remove)
        return made
    if not isinstance(step, syntax.Part):
        raise MatlabError("the left side of an assignment must be a variable")
    base = np.zeros((0, 0)) if old is None else old
    indices = interpreter.indices(step.arguments, base, frame)
    if step.braces:
        return _put_inside(interpreter, old, indices, rest, value, frame, remove=remove)
    if not rest:
        return removed(old, indices) if remove else write(old, indices, value, interpreter.budget)
    part = None if nothing else _part_or_none(interpreter, old, indices)
    if isinstance(part, Cell) and part.items.size == 1 and not isinstance(rest[0], syntax.Part):
        part = part.items.flat[0]
    new = _put(interpreter, part, rest, value, frame, remove=remove)
    return write(old, indices, new, interpreter.budget)


def _put_inside(
    interpreter: Interpreter,
    old: Any,
    indices: Values,
    rest: list[syntax.Expression],
    value: Any,
    frame: Frame,
    *,
    remove: bool,
) -> Any:
    """Replace the contents of an element of a cell."""
    nothing = old is None or (isinstance(old, np.ndarray) and not old.size)
    cell = Cell(np.empty((0, 0), dtype=object)) if nothing else old
    if not isinstance(cell, Cell):
        raise MatlabError("braces index what is no cell")
    inner = _part_or_none(interpreter, cell, indices) if rest else None
    part = inner.items.flat[0] if isinstance(inner, Cell) and inner.items.size else None
    new = _put(interpreter, part, rest, value, frame, remove=remove and bool(rest))
    return write(cell, indices, Cell(boxed([[new]])), interpreter.budget)


def _part_or_none(interpreter: Interpreter, value: Any, indices: Values) -> Any:
    try:
        return read(value, indices, interpreter.budget)
    except SpentError:
        raise
    except MatlabError:
        return None  # it is about to grow
