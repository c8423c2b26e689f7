"""Statements compiled: each becomes a step on a frame, with its line for messages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.evaluation import (
    Compiled,
    Frame,
    Meanings,
    Routine,
    call_routine,
    compile_indices,
    compiled,
    located,
)
from drake_leg.simulink.matlab.functions import SILENT
from drake_leg.simulink.matlab.values import MatlabError, Value, grid, settle, truth, write

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
