"""Expressions made ready: each becomes a function of a frame, never Python code."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.arithmetic import OPERATORS, SIGNS, span, transpose
from drake_leg.simulink.matlab.arrays import Value, shape, stack, truth
from drake_leg.simulink.matlab.calls import Ready, Scope, called, paid
from drake_leg.simulink.matlab.frames import Frame
from drake_leg.simulink.matlab.indexing import ALL, Index, read
from drake_leg.simulink.matlab.limits import CALL, FACTOR, MatlabError, require_room

_HEAVY = ("*", "/", "\\", "^")


@dataclass(frozen=True, kw_only=True)
class _Place:
    """Where ``end`` stands: in which index of how many, of which variable."""

    name: str
    index: int
    count: int


def ready(node: syntax.Expression, scope: Scope, place: _Place | None = None) -> Ready:
    """Make an expression ready to be evaluated any number of times.

    Parameters
    ----------
    scope : Scope
        What its names mean.
    place : optional
        The index that it stands in.

    Returns
    -------
    callable
        From a frame to the expression's value. It raises MatlabError where there is none.

    Raises
    ------
    MatlabError
        If a name means nothing.
    """
    match node:
        case syntax.Number(value=constant):
            return lambda frame: constant
        case syntax.Text(text=text):
            return lambda frame: text
        case syntax.Name(name=name) if name in scope.variables:
            return _variable(name)
        case syntax.Name(name=name):
            return called(name, [], scope)
        case syntax.Apply(name=name, arguments=arguments) if name in scope.variables:
            return _indexed(name, arguments, scope)
        case syntax.Apply(name=name, arguments=arguments):
            return called(name, [ready(item, scope, place) for item in arguments], scope)
        case syntax.Matrix(rows=rows):
            return _matrix([[ready(item, scope, place) for item in row] for row in rows])
        case syntax.Signs(signs=signs, operand=operand):
            return _signed(signs, ready(operand, scope, place))
        case syntax.Chain(first=first, rest=rest):
            links = [(sign, ready(item, scope, place) if item else None) for sign, item in rest]
            return _chain(ready(first, scope, place), links)
        case syntax.Logic(symbol=symbol, operands=operands):
            return _logic(symbol == "&&", [ready(item, scope, place) for item in operands])
        case syntax.Range(parts=parts):
            return _range([ready(part, scope, place) for part in parts])
        case syntax.End() if place:
            return _end(place)
        case syntax.End():
            raise MatlabError("'end' stands in the index of no variable")
        case syntax.Colon():
            raise MatlabError("':' stands in the index of no variable")


def ready_indices(
    name: str, arguments: tuple[syntax.Expression, ...], scope: Scope
) -> Callable[[Frame], list[Index]]:
    """Make the indices of a variable ready.

    Returns
    -------
    callable
        From a frame to the indices.

    Raises
    ------
    MatlabError
        If a name means nothing.
    """
    items: list[Callable[[Frame], Index]] = []
    for k, node in enumerate(arguments):
        place = _Place(name=name, index=k, count=len(arguments))
        colon = isinstance(node, syntax.Colon)
        items.append((lambda frame: ALL) if colon else ready(node, scope, place))
    return lambda frame: [item(frame) for item in items]


def _variable(name: str) -> Ready:
    def variable(frame: Frame) -> Value:
        value = _valued(frame, name)
        if isinstance(value, np.ndarray):
            frame.budget.spend(value.size)
        return value

    return variable


def _valued(frame: Frame, name: str) -> Value:
    try:
        return frame.values[name]
    except KeyError:
        raise MatlabError(f"'{name}' is used before it has a value") from None


def _indexed(name: str, arguments: tuple[syntax.Expression, ...], scope: Scope) -> Ready:
    indices = ready_indices(name, arguments, scope)

    def indexed(frame: Frame) -> Value:
        part = read(_valued(frame, name), indices(frame), name)
        frame.budget.spend(CALL + part.size if isinstance(part, np.ndarray) else 1)
        return part

    return indexed


def _matrix(rows: list[list[Ready]]) -> Ready:
    count = sum(len(row) for row in rows)
    require_room(count, 1)
    even = bool(rows) and len({len(row) for row in rows}) == 1 and max(len(rows), len(rows[0])) > 1

    def matrix(frame: Frame) -> Value:
        frame.budget.spend(count)
        cells = [[item(frame) for item in row] for row in rows]
        if even and all(type(cell) is float for row in cells for cell in row):
            return np.array(cells)
        return paid(frame, stack(cells))

    return matrix


def _signed(signs: tuple[str, ...], operand: Ready) -> Ready:
    actions = [SIGNS[sign] for sign in reversed(signs)]

    def signed(frame: Frame) -> Value:
        frame.budget.spend(len(actions))
        value = operand(frame)
        for action in actions:
            value = action(value)
        return value

    return signed


def _chain(first: Ready, links: list[tuple[str, Ready | None]]) -> Ready:
    steps = [
        (OPERATORS.get(sign), operand, FACTOR if sign in _HEAVY else 1) for sign, operand in links
    ]

    def chain(frame: Frame) -> Value:
        frame.budget.spend(len(steps))
        value = first(frame)
        for operator, operand, factor in steps:
            if operator is None or operand is None:
                value = transpose(value)
            else:
                value = operator(value, operand(frame))
            if isinstance(value, np.ndarray):
                frame.budget.spend(factor * value.size)
        return value

    return chain


def _logic(both: bool, operands: list[Ready]) -> Ready:
    def logic(frame: Frame) -> Value:
        return both == all(truth(operand(frame)) == both for operand in operands)

    return logic


def _range(parts: list[Ready]) -> Ready:
    def ranged(frame: Frame) -> Value:
        values = [part(frame) for part in parts]
        step = values[1] if len(values) == 3 else 1.0
        return paid(frame, span(values[0], step, values[-1]))

    return ranged


def _end(place: _Place) -> Ready:
    def end(frame: Frame) -> Value:
        rows, columns = shape(frame.values.get(place.name, np.empty((0, 0))))
        return float(
            rows * columns if place.count == 1 else (rows, columns, 1)[min(place.index, 2)]
        )

    return end
