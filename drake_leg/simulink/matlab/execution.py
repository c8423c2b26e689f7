"""Statements made ready: each becomes a step on a frame, with its line for messages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.arrays import Value, grid, settle, truth
from drake_leg.simulink.matlab.calls import Ready, Scope, call_routine
from drake_leg.simulink.matlab.evaluation import ready, ready_indices
from drake_leg.simulink.matlab.frames import Frame, Routine, located
from drake_leg.simulink.matlab.functions import SILENT
from drake_leg.simulink.matlab.indexing import write
from drake_leg.simulink.matlab.limits import MatlabError

_Step = Callable[[Frame], str | None]  # returns the jump that it makes, if it makes one
_Store = Callable[[Frame, Value], None]


def ready_function(
    function: syntax.Function, routines: Mapping[str, Routine], own: frozenset[str]
) -> Routine:
    """Make a function ready to be called any number of times.

    Parameters
    ----------
    routines : mapping
        Where all functions of the script will be found when it is called.

    Raises
    ------
    InvalidValueError
        With function and line, if a name means nothing.
    """
    variables = {*function.inputs, *function.outputs, *_assigned(function.body)} - {"~"}
    scope = Scope(variables=frozenset(variables), routines=routines, own=own)
    return Routine(
        line=function.line,
        name=function.name,
        inputs=function.inputs,
        outputs=function.outputs,
        nesting=function.nesting,
        body=_block(function.body, scope, function.name),
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


def _block(statements: tuple[syntax.Statement, ...], scope: Scope, name: str) -> _Step:
    steps = [(statement.line, _ready_step(statement, scope, name)) for statement in statements]

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


def _ready_step(statement: syntax.Statement, scope: Scope, name: str) -> _Step:
    try:
        return _step(statement, scope, name)
    except MatlabError as fault:
        raise located(fault, name, statement.line) from None


def _step(statement: syntax.Statement, scope: Scope, name: str) -> _Step:
    match statement:
        case syntax.Assign(targets=(target,), value=value):
            return _assign(_store(target, scope), ready(value, scope))
        case syntax.Assign(targets=targets, value=value):
            return _assign_several([_store(target, scope) for target in targets], value, scope)
        case syntax.Evaluate(value=value):
            return _evaluate(value, scope)
        case syntax.If(branches=branches, otherwise=otherwise):
            choices = [
                (_condition(line, condition, scope, name), _block(body, scope, name))
                for line, condition, body in branches
            ]
            return _if(choices, _block(otherwise, scope, name))
        case syntax.For(variable=variable, over=over, body=body):
            return _for(variable, ready(over, scope), _block(body, scope, name))
        case syntax.While(line=line, condition=condition, body=body):
            return _while(_condition(line, condition, scope, name), _block(body, scope, name))
        case syntax.Jump(keyword=keyword):
            return lambda frame: keyword


def _store(target: syntax.Target, scope: Scope) -> _Store:
    name = target.name
    if name == "~":
        return lambda frame, value: None
    if target.indices is None:
        return lambda frame, value: frame.values.__setitem__(name, value)
    indices = ready_indices(name, target.indices, scope)

    def store(frame: Frame, value: Value) -> None:
        new = write(frame.values.get(name), indices(frame), value, name)
        frame.budget.spend(new.size if isinstance(new, np.ndarray) else 1)
        frame.values[name] = new

    return store


def _assign(store: _Store, value: Ready) -> _Step:
    def assign(frame: Frame) -> None:
        new = value(frame)
        if isinstance(new, str):
            raise MatlabError(f"the text '{new:.40}' is no value here")
        store(frame, new)

    return assign


def _assign_several(stores: list[_Store], value: syntax.Expression, scope: Scope) -> _Step:
    name, arguments = _call(value)
    if name not in scope.own or name in scope.variables:
        raise MatlabError("several values at once come only from a function of the same script")
    given = [ready(argument, scope) for argument in arguments]

    def assign(frame: Frame) -> None:
        values = call_routine(scope.routines[name], given, len(stores), frame)
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


def _evaluate(value: syntax.Expression, scope: Scope) -> _Step:
    """Evaluate for nothing but its errors; what only prints is left out."""
    name, arguments = _call(value)
    if name in SILENT and name not in scope.own | scope.variables:
        return lambda frame: None
    if name in scope.own and name not in scope.variables:
        given = [ready(argument, scope) for argument in arguments]

        def call(frame: Frame) -> None:
            call_routine(scope.routines[name], given, 0, frame)

        return call
    run = ready(value, scope)

    def evaluate(frame: Frame) -> None:
        run(frame)

    return evaluate


def _condition(
    line: int, condition: syntax.Expression, scope: Scope, name: str
) -> Callable[[Frame], bool]:
    try:
        value = ready(condition, scope)
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


def _for(variable: str, over: Ready, body: _Step) -> _Step:
    def loop(frame: Frame) -> str | None:
        array = grid(over(frame))
        for k in range(array.shape[1]):
            frame.budget.spend(len(array) + 1)
            frame.values[variable] = settle(array[:, k : k + 1].copy())
            jump = body(frame)
            if jump == "return":
                return jump
            if jump == "break":
                break
        return None

    return loop


def _while(holds: Callable[[Frame], bool], body: _Step) -> _Step:
    def loop(frame: Frame) -> str | None:
        while holds(frame):
            jump = body(frame)
            if jump == "return":
                return jump
            if jump == "break":
                break
        return None

    return loop
