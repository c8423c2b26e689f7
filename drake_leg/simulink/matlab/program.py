"""MATLAB text to be used: a parameter's number, the function of a MATLAB Function block."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.evaluation import (
    Compiled,
    Frame,
    Meanings,
    Routine,
    call_routine,
    compile_indices,
    compiled,
    enter,
    located,
)
from drake_leg.simulink.matlab.functions import SILENT
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.syntax import tokenize
from drake_leg.simulink.matlab.values import (
    ELEMENTS,
    SCRIPT_LENGTH,
    VALUE_LENGTH,
    Budget,
    MatlabError,
    Value,
    grid,
    numbers,
    settle,
    truth,
    write,
)

_Step = Callable[[Frame], str | None]  # returns the jump that it makes, if it makes one
_Store = Callable[[Frame, Value], None]


def compile_function(
    function: syntax.Function, routines: Mapping[str, Routine], own: frozenset[str]
) -> Routine:
    """Compile a function; `routines` will hold all functions of the script when it is called."""
    variables = {*function.inputs, *function.outputs, *_assigned(function.body)} - {"~"}
    meanings = Meanings(variables=frozenset(variables), routines=routines, own=own)
    return Routine(
        line=function.line,
        name=function.name,
        inputs=function.inputs,
        outputs=function.outputs,
        nesting=function.nesting,
        body=_block(function.body, meanings, function.name),
    )


def _assigned(statements: tuple[syntax.Statement, ...]) -> Iterator[str]:
    for statement in statements:
        match statement:
            case syntax.Assign(targets=targets):
                yield from (target.name for target in targets)
            case syntax.If(branches=branches, otherwise=otherwise):
                for _, _, body in branches:
                    yield from _assigned(body)
                yield from _assigned(otherwise)
            case syntax.For(variable=variable, body=body):
                yield variable
                yield from _assigned(body)
            case syntax.While(body=body):
                yield from _assigned(body)


def _block(statements: tuple[syntax.Statement, ...], meanings: Meanings, name: str) -> _Step:
    steps = [
        (statement.line, _compiled_step(statement, meanings, name)) for statement in statements
    ]

    def block(frame: Frame) -> str | None:
        for line, step in steps:
            try:
                frame.budget.spend(1)
                jump = step(frame)
            except MatlabError as fault:
                raise located(fault, name, line) from None
            if jump is not None:
                return jump
        return None

    return block


def _compiled_step(statement: syntax.Statement, meanings: Meanings, name: str) -> _Step:
    try:
        return _step(statement, meanings, name)
    except MatlabError as fault:
        raise located(fault, name, statement.line) from None


def _step(statement: syntax.Statement, meanings: Meanings, name: str) -> _Step:
    match statement:
        case syntax.Assign(targets=(target,), value=value):
            return _assign(_store(target, meanings), compiled(value, meanings))
        case syntax.Assign(targets=targets, value=value):
            return _assign_several(
                [_store(target, meanings) for target in targets], value, meanings
            )
        case syntax.Evaluate(value=value):
            return _evaluate(value, meanings)
        case syntax.If(branches=branches, otherwise=otherwise):
            choices = [
                (_condition(line, condition, meanings, name), _block(body, meanings, name))
                for line, condition, body in branches
            ]
            return _if(choices, _block(otherwise, meanings, name))
        case syntax.For(variable=variable, over=over, body=body):
            return _for(variable, compiled(over, meanings), _block(body, meanings, name))
        case syntax.While(line=line, condition=condition, body=body):
            return _while(_condition(line, condition, meanings, name), _block(body, meanings, name))
        case syntax.Jump(keyword=keyword):
            return lambda frame: keyword


def _store(target: syntax.Target, meanings: Meanings) -> _Store:
    name = target.name
    if name == "~":
        return lambda frame, value: None
    if target.indices is None:
        return lambda frame, value: frame.values.__setitem__(name, value)
    indices = compile_indices(name, target.indices, meanings)

    def store(frame: Frame, value: Value) -> None:
        new = write(frame.values.get(name), indices(frame), value, name)
        frame.budget.spend(new.size if isinstance(new, np.ndarray) else 1)
        frame.values[name] = new

    return store


def _assign(store: _Store, value: Compiled) -> _Step:
    def assign(frame: Frame) -> None:
        new = value(frame)
        if isinstance(new, str):
            raise MatlabError(f"the text '{new:.40}' is not a number")
        store(frame, new)

    return assign


def _assign_several(stores: list[_Store], value: syntax.Expression, meanings: Meanings) -> _Step:
    name, arguments = _call(value)
    if name not in meanings.own or name in meanings.variables:
        raise MatlabError("several values at once come only from a function of the same script")
    given = [compiled(argument, meanings) for argument in arguments]

    def assign(frame: Frame) -> None:
        values = call_routine(meanings.routines[name], given, len(stores), frame)
        for store, new in zip(stores, values, strict=True):
            store(frame, new)

    return assign


def _call(value: syntax.Expression) -> tuple[str, tuple[syntax.Expression, ...]]:
    match value:
        case syntax.Name(name=name):
            return name, ()
        case syntax.Apply(name=name, arguments=arguments):
            return name, arguments
    return "", ()


def _evaluate(value: syntax.Expression, meanings: Meanings) -> _Step:
    """Evaluate for nothing but its errors; what only prints is left out."""
    name, arguments = _call(value)
    if name in SILENT and name not in meanings.own | meanings.variables:
        return lambda frame: None
    if name in meanings.own and name not in meanings.variables:
        given = [compiled(argument, meanings) for argument in arguments]

        def call(frame: Frame) -> None:
            call_routine(meanings.routines[name], given, 0, frame)

        return call
    run = compiled(value, meanings)

    def evaluate(frame: Frame) -> None:
        run(frame)

    return evaluate


def _condition(
    line: int, condition: syntax.Expression, meanings: Meanings, name: str
) -> Callable[[Frame], bool]:
    try:
        value = compiled(condition, meanings)
    except MatlabError as fault:
        raise located(fault, name, line) from None

    def holds(frame: Frame) -> bool:
        frame.budget.spend(1)
        try:
            return truth(value(frame))
        except MatlabError as fault:
            raise located(fault, name, line) from None

    return holds


def _if(choices: list[tuple[Callable[[Frame], bool], _Step]], otherwise: _Step) -> _Step:
    def choose(frame: Frame) -> str | None:
        for holds, body in choices:
            if holds(frame):
                return body(frame)
        return otherwise(frame)

    return choose


def _for(variable: str, over: Compiled, body: _Step) -> _Step:
    def columns(frame: Frame) -> Iterator[None]:
        array = grid(over(frame))
        for k in range(array.shape[1]):
            frame.budget.spend(len(array) + 1)
            frame.values[variable] = settle(array[:, k : k + 1].copy())
            yield

    return _repeated(columns, body)


def _while(holds: Callable[[Frame], bool], body: _Step) -> _Step:
    def rounds(frame: Frame) -> Iterator[None]:
        while holds(frame):
            yield

    return _repeated(rounds, body)


def _repeated(rounds: Callable[[Frame], Iterator[None]], body: _Step) -> _Step:
    def loop(frame: Frame) -> str | None:
        for _ in rounds(frame):
            jump = body(frame)
            if jump == "return":
                return jump
            if jump == "break":
                break
        return None

    return loop


# --- text evaluated without a function -------------------------------------------------------

Numbers = float | tuple[float, ...] | tuple[tuple[float, ...], ...]


def value(text: str, names: Mapping[str, ArrayLike] | None = None) -> Numbers:
    """Evaluate numeric MATLAB text.

    Parameters
    ----------
    text : str
        An expression of numbers, operators, matrices, ranges and known functions.
    names : mapping, optional
        Variables: numbers, rows or matrices.

    Returns
    -------
    float, tuple of float, or tuple of tuple of float
        A number; the elements of a row or column; the rows of a matrix. Only a number alone may
        be infinite.

    Raises
    ------
    InvalidValueError
        With a short reason, to follow the name of what the text belongs to, and a colon.
    """
    try:
        with np.errstate(all="ignore"):
            return _plain(_evaluated(text, names or {}))
    except MatlabError as fault:
        raise InvalidValueError(str(fault)) from None


def _evaluated(text: str, names: Mapping[str, ArrayLike]) -> Value:
    if len(text) > VALUE_LENGTH:
        raise MatlabError(f"the text is longer than {VALUE_LENGTH} characters")
    parser = Parser(tokenize(text.strip()))
    if parser.next.kind == "stop":
        raise MatlabError("the text is empty")
    node = parser.expression()
    if parser.next.kind != "stop":
        raise parser.unexpected("where the text should end")
    variables = {name: variable(name, given) for name, given in names.items()}
    run = compiled(node, Meanings(variables=frozenset(variables)))
    return run(Frame(variables, Budget()))


def variable(name: str, given: ArrayLike | float, *, column: bool = False) -> Value:
    """Make a value of numbers from outside; a vector becomes a row, or a column."""
    if isinstance(given, float):
        return float(given)
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise MatlabError(
            f"'{name}' is given {given!r:.60}, which is not an array of numbers"
        ) from None
    if array.ndim > 2 or array.size > ELEMENTS:
        raise MatlabError(
            f"'{name}' is given an array of shape {array.shape}; it must be a small matrix"
        )
    if array.ndim < 2:
        array = array.reshape((-1, 1) if column else (1, -1))
    return settle(array)


def _plain(result: Value) -> Numbers:
    if isinstance(result, str):
        raise MatlabError(f"'{result:.40}' is a text, not a number")
    if not isinstance(result, np.ndarray):
        if math.isnan(result):
            raise MatlabError("it is not a number (NaN)")
        return float(result)
    array = grid(result).astype(float)
    if not np.isfinite(array).all():
        raise MatlabError("one of its elements is not finite")
    if not array.size:
        return ()
    if 1 in array.shape:
        return tuple(array.ravel().tolist())
    return tuple(tuple(row) for row in array.tolist())


@dataclass(frozen=True, kw_only=True)
class Program:
    """The function of a MATLAB Function block, parsed once.

    It keeps nothing between calls.
    """

    name: str
    inputs: tuple[str, ...]  # their names
    outputs: tuple[str, ...]
    routine: Routine = field(repr=False)

    def call(self, *arguments: ArrayLike) -> tuple[NDArray[np.float64], ...]:
        """Run the function.

        Parameters
        ----------
        *arguments : array_like
            One for each input: a number, a vector (it becomes a column, as a signal does) or a
            matrix.

        Returns
        -------
        tuple of (n,) ndarray
            One for each output, column by column. It is not finite where MATLAB's is not: the
            inverse of a singular matrix is infinite.

        Raises
        ------
        InvalidValueError
            With function and line, if the code fails or takes too many operations.
        """
        wanted, given = len(self.inputs), len(arguments)
        if wanted != given:
            raise InvalidValueError(
                f"MATLAB function {self.name} has {wanted} inputs ({', '.join(self.inputs)}), "
                f"but is given {given}"
            )
        try:
            with np.errstate(all="ignore"):
                values = [
                    variable(name, argument, column=True)
                    for name, argument in zip(self.inputs, arguments, strict=True)
                ]
                results = enter(self.routine, values, len(self.outputs), Budget())
        except MatlabError as fault:
            raise located(fault, self.name, self.routine.line) from None
        return tuple(numbers(result).flatten(order="F") for result in results)


def program(script: str) -> Program:
    """Parse the code of a MATLAB Function block.

    Parameters
    ----------
    script : str
        One function, and after it those that it calls.

    Raises
    ------
    InvalidValueError
        With function and line, if the code is not well formed, or needs what is not supported.
    """
    if len(script) > SCRIPT_LENGTH:
        raise InvalidValueError(f"MATLAB code of more than {SCRIPT_LENGTH} characters is refused")
    parser: Parser | None = None
    try:
        parser = Parser(tokenize(script))
        functions = parser.functions()
    except MatlabError as fault:
        raise located(fault, parser.name if parser else _named(script), 1) from None
    routines: dict[str, Routine] = {}
    own = frozenset(function.name for function in functions)
    for function in functions:
        routines[function.name] = compile_function(function, routines, own)
    main = routines[functions[0].name]
    return Program(
        name=main.name,
        inputs=main.inputs,
        outputs=main.outputs,
        routine=main,
    )


def _named(script: str) -> str:
    """Name of the first function, read off its head, where the code cannot be parsed."""
    for line in script.splitlines():
        if line.lstrip().startswith("function"):
            words = line.split("=")[-1].split("(")[0].split()
            return words[-1] if words and words[-1] != "function" else ""
    return ""
