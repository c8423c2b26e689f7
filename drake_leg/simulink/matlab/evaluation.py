"""Expressions and calls compiled to Python functions of a frame; none becomes Python code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.functions import CONSTANTS, HEAVY, KNOWN, SILENT
from drake_leg.simulink.matlab.values import (
    ALL,
    CALL,
    CALLS,
    FACTOR,
    OPERATORS,
    SIGNS,
    Budget,
    Index,
    MatlabError,
    Value,
    read,
    require_room,
    shape,
    span,
    stack,
    transpose,
    truth,
)


class Frame:
    """The variables of one call; the calls around it share its budget and add up their nesting."""

    __slots__ = ("budget", "nesting", "values")

    def __init__(self, values: dict[str, Value], budget: Budget, nesting: int = 0) -> None:
        self.values, self.budget, self.nesting = values, budget, nesting


@dataclass(frozen=True, kw_only=True)
class Routine:
    """A function of a script, compiled."""

    line: int
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    nesting: int
    body: Callable[[Frame], object]


def located(fault: MatlabError, name: str, line: int) -> InvalidValueError:
    """Name the place of a fault: the function, and its line or that of the statement."""
    what = f"MATLAB function {name}" if name else "MATLAB function"
    return InvalidValueError(f"{what}, line {fault.line or line}: {fault}")


def enter(
    routine: Routine, arguments: list[Value], wanted: int, budget: Budget, nesting: int = 0
) -> list[Value]:
    """Call a function with its first arguments for its first outputs, so many as are wanted."""
    name = routine.name
    if len(arguments) > len(routine.inputs):
        raise MatlabError(
            f"{name} is given {len(arguments)} values; its inputs are {len(routine.inputs)}"
        )
    if wanted > len(routine.outputs):
        raise MatlabError(
            f"{name} is asked for {wanted} values; its outputs are {len(routine.outputs)}"
        )
    if nesting + routine.nesting > CALLS:
        raise MatlabError(f"the calls of {name} are nested too deeply")
    inputs = dict(zip(routine.inputs, arguments, strict=False))
    frame = Frame(inputs, budget, nesting + routine.nesting)
    routine.body(frame)
    missing = [output for output in routine.outputs[:wanted] if output not in frame.values]
    if missing:
        raise located(
            MatlabError(f"the output '{missing[0]}' never gets a value"), name, routine.line
        )
    return [frame.values[output] for output in routine.outputs[:wanted]]


Compiled = Callable[[Frame], Value]
_SOME_ERROR = "it stops with an error"


@dataclass(frozen=True, kw_only=True)
class Meanings:
    """What names mean in a text: variables first, then its own functions, then the known ones."""

    variables: frozenset[str]
    routines: Mapping[str, Routine] = field(default_factory=dict)  # may be filled afterwards
    own: frozenset[str] = frozenset()  # names of the routines


def paid(frame: Frame, value: Value) -> Value:
    """Count the elements of a value that was made, and pass it on."""
    frame.budget.spend(value.size if isinstance(value, np.ndarray) else 1)
    return value


def compile_call(name: str, given: list[Compiled], meanings: Meanings) -> Compiled:
    """Compile a call of a function, or a constant."""
    if name in meanings.own:
        return lambda frame: call_routine(meanings.routines[name], given, 1, frame)[0]
    if not given and name in CONSTANTS:
        constant = CONSTANTS[name]
        return lambda frame: constant
    if name in SILENT:
        raise MatlabError(f"'{name}' returns no value")
    if name == "error":
        return _error(given)
    if name not in KNOWN:
        if name in CONSTANTS:
            raise MatlabError(f"'{name}' takes no arguments here")
        raise MatlabError(f"'{name}' is not a known function or constant")
    least, most, function = KNOWN[name]
    if not least <= len(given) <= most:
        counts = f"{least}" if least == most else f"{least} to {most}"
        raise MatlabError(f"'{name}' takes {counts} argument{'s' * (most > 1)}, not {len(given)}")
    factor = FACTOR if name in HEAVY else 0

    def call(frame: Frame) -> Value:
        values = [argument(frame) for argument in given]
        work = factor * sum(value.size for value in values if isinstance(value, np.ndarray))
        frame.budget.spend(CALL + work)
        return paid(frame, function(*values))

    return call


def _error(given: list[Compiled]) -> Compiled:
    def error(frame: Frame) -> Value:
        said = [text for text in (argument(frame) for argument in given) if isinstance(text, str)]
        if len(said) > 1 and ":" in said[0] and " " not in said[0]:
            said = said[1:]  # the first one was the error's identifier
        raise MatlabError(f"it stops with the error {said[0]!r:.80}" if said else _SOME_ERROR)

    return error


def call_routine(
    routine: Routine, arguments: list[Compiled], wanted: int, frame: Frame
) -> list[Value]:
    """Call a function of the same script with compiled arguments."""
    given = [argument(frame) for argument in arguments]
    return enter(routine, given, wanted, frame.budget, frame.nesting)


_HEAVY = ("*", "/", "\\", "^")


@dataclass(frozen=True, kw_only=True)
class _Place:
    """The place of an ``end``: in which index of how many, of which variable."""

    name: str
    index: int
    count: int


def compiled(node: syntax.Expression, meanings: Meanings, place: _Place | None = None) -> Compiled:
    """Compile an expression; `place` is the index that it is in, for ``end``."""
    match node:
        case syntax.Number(value=constant):
            return lambda frame: constant
        case syntax.Text(text=text):
            return lambda frame: text
        case syntax.Name(name=name) if name in meanings.variables:
            return _variable(name)
        case syntax.Name(name=name):
            return compile_call(name, [], meanings)
        case syntax.Apply(name=name, arguments=arguments) if name in meanings.variables:
            return _indexed(name, arguments, meanings)
        case syntax.Apply(name=name, arguments=arguments):
            return compile_call(
                name, [compiled(item, meanings, place) for item in arguments], meanings
            )
        case syntax.Matrix(rows=rows):
            return _matrix([[compiled(item, meanings, place) for item in row] for row in rows])
        case syntax.Signs(signs=signs, operand=operand):
            return _signed(signs, compiled(operand, meanings, place))
        case syntax.Chain(first=first, rest=rest):
            links = [
                (sign, compiled(item, meanings, place) if item else None) for sign, item in rest
            ]
            return _chain(compiled(first, meanings, place), links)
        case syntax.Logic(symbol=symbol, operands=operands):
            return _logic(symbol == "&&", [compiled(item, meanings, place) for item in operands])
        case syntax.Range(parts=parts):
            return _range([compiled(part, meanings, place) for part in parts])
        case syntax.End() if place:
            return _end(place)
        case syntax.End():
            raise MatlabError("'end' is used outside the index of a variable")
        case syntax.Colon():
            raise MatlabError("':' is used outside the index of a variable")


def compile_indices(
    name: str, arguments: tuple[syntax.Expression, ...], meanings: Meanings
) -> Callable[[Frame], list[Index]]:
    """Compile the indices of a variable to a function of a frame."""
    items: list[Callable[[Frame], Index]] = []
    for k, node in enumerate(arguments):
        place = _Place(name=name, index=k, count=len(arguments))
        colon = isinstance(node, syntax.Colon)
        items.append((lambda frame: ALL) if colon else compiled(node, meanings, place))
    return lambda frame: [item(frame) for item in items]


def _variable(name: str) -> Compiled:
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


def _indexed(name: str, arguments: tuple[syntax.Expression, ...], meanings: Meanings) -> Compiled:
    indices = compile_indices(name, arguments, meanings)

    def indexed(frame: Frame) -> Value:
        part = read(_valued(frame, name), indices(frame), name)
        frame.budget.spend(CALL + part.size if isinstance(part, np.ndarray) else 1)
        return part

    return indexed


def _matrix(rows: list[list[Compiled]]) -> Compiled:
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


def _signed(signs: tuple[str, ...], operand: Compiled) -> Compiled:
    actions = [SIGNS[sign] for sign in reversed(signs)]

    def signed(frame: Frame) -> Value:
        frame.budget.spend(len(actions))
        value = operand(frame)
        for action in actions:
            value = action(value)
        return value

    return signed


def _chain(first: Compiled, links: list[tuple[str, Compiled | None]]) -> Compiled:
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


def _logic(both: bool, operands: list[Compiled]) -> Compiled:
    def logic(frame: Frame) -> Value:
        return both == all(truth(operand(frame)) == both for operand in operands)

    return logic


def _range(parts: list[Compiled]) -> Compiled:
    def ranged(frame: Frame) -> Value:
        values = [part(frame) for part in parts]
        step = values[1] if len(values) == 3 else 1.0
        return paid(frame, span(values[0], step, values[-1]))

    return ranged


def _end(place: _Place) -> Compiled:
    def end(frame: Frame) -> Value:
        rows, columns = shape(frame.values.get(place.name, np.empty((0, 0))))
        return float(
            rows * columns if place.count == 1 else (rows, columns, 1)[min(place.index, 2)]
        )

    return end
