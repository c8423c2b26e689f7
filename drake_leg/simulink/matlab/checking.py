"""The code of a MATLAB Function block, parsed and checked before any of it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.handles import METHODS
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN, NOT_RUN, QUIET
from drake_leg.simulink.matlab.names import assigned, names_in
from drake_leg.simulink.matlab.numeric import SCRIPT_LENGTH, MatlabError
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.specials import COMMANDS, SPECIAL
from drake_leg.simulink.matlab.tokens import DECLARATIONS, tokenize


def checked_functions(
    script: str,
    *,
    refused: tuple[str, ...] = DECLARATIONS,
    beside: Callable[[str], bool] | None = None,
) -> tuple[syntax.Function, ...]:
    """Parse the functions of a block, its own first.

    Parameters
    ----------
    script : str
        One function, and after it those that it calls.
    refused : tuple of str, optional
        Declarations that are not supported, ``persistent`` or ``global``.
    beside : callable, optional
        Whether a name is that of a function in another file.

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
    for name in ("varargin", "varargout"):
        if name in (*functions[0].inputs, *functions[0].outputs):
            refusal = MatlabError(f"'{name}' is not supported")
            raise located(refusal, functions[0].name, functions[0].line)
    require_supported(functions, refused=refused, beside=beside)
    return functions


def located(fault: MatlabError, name: str, line: int) -> InvalidValueError:
    """Name the place of a fault: its own function and line, or those that are given."""
    name = fault.function or name
    what = f"MATLAB function {name}" if name else "MATLAB function"
    return InvalidValueError(f"{what}, line {fault.line or line}: {fault}")


def require_supported(
    functions: tuple[syntax.Function, ...],
    *,
    refused: tuple[str, ...],
    beside: Callable[[str], bool] | None,
) -> None:
    """Refuse what keeps values where none can be kept, and names that mean nothing.

    Raises
    ------
    InvalidValueError
        With function and line.
    """
    own = {function.name for function in functions}
    for function in functions:
        _require_supported(function, own, refused, beside)


def _require_supported(
    function: syntax.Function,
    own: set[str],
    refused: tuple[str, ...],
    beside: Callable[[str], bool] | None,
) -> None:
    known = {*function.inputs, *function.outputs, *assigned(function.body), *own}
    for statement, expressions in walked(function.body):
        if isinstance(statement, syntax.Declare) and statement.keyword in refused:
            fault = MatlabError(f"'{statement.keyword}' is not supported", statement.line)
            raise located(fault, function.name, function.line)
        for line, expression in expressions:
            for name in names_in(expression):
                if name in known or means_something(name) or (beside and beside(name)):
                    continue
                fault = MatlabError(f"'{name}' is not a known function or constant", line)
                raise located(fault, function.name, function.line)


def means_something(name: str) -> bool:
    """Tell whether a name is that of a known function or constant, if only to be left out."""
    tables = (KNOWN, CONSTANTS, SPECIAL, METHODS, COMMANDS, NOT_RUN, QUIET)
    return name == "coder" or any(name in table for table in tables)


_Located = tuple[int, Any]  # line, and a node of the tree


def walked(
    statements: tuple[syntax.Statement, ...],
) -> Iterator[tuple[syntax.Statement, list[_Located]]]:
    """All statements, each with the expressions that are its own."""
    for statement in statements:
        line = statement.line
        match statement:
            case syntax.Assign(targets=targets, value=value):
                yield statement, [(line, targets), (line, value)]
            case syntax.Evaluate(value=value):
                yield statement, [(line, value)]
            case syntax.If(branches=branches, otherwise=otherwise):
                for at, condition, body in branches:
                    yield statement, [(at, condition)]
                    yield from walked(body)
                yield from walked(otherwise)
            case syntax.Switch(on=on, cases=cases, otherwise=otherwise):
                yield statement, [(line, on)]
                for at, case, body in cases:
                    yield statement, [(at, case)]
                    yield from walked(body)
                yield from walked(otherwise)
            case syntax.For(over=over, body=body):
                yield statement, [(line, over)]
                yield from walked(body)
            case syntax.While(condition=condition, body=body):
                yield statement, [(line, condition)]
                yield from walked(body)
            case syntax.Try(body=body, handler=handler):
                yield statement, []
                yield from walked(body)
                yield from walked(handler)
            case _:
                yield statement, []


def _named(script: str) -> str:
    """Name of the first function, read off its head, where the code cannot be parsed."""
    for line in script.splitlines():
        if line.lstrip().startswith("function"):
            words = line.split("=")[-1].split("(")[0].split()
            return words[-1] if words and words[-1] != "function" else ""
    return ""
