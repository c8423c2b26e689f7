"""MATLAB text to be used: a parameter's number, the function of a MATLAB Function block."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import Allowance, Function, numbers_of, settled
from drake_leg.simulink.matlab.frames import Alone, File, Frame
from drake_leg.simulink.matlab.interpreter import Interpreter
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN, NOT_RUN, QUIET
from drake_leg.simulink.matlab.names import assigned, names_in
from drake_leg.simulink.matlab.numeric import (
    ELEMENTS,
    SCRIPT_LENGTH,
    VALUE_LENGTH,
    MatlabError,
    quiet,
)
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.specials import COMMANDS, SPECIAL
from drake_leg.simulink.matlab.syntax import tokenize

STEPS = 1_000_000  # of one call of a function block

Numbers = float | tuple[float, ...] | tuple[tuple[float, ...], ...]


def small_budget() -> Allowance:
    """What a parameter or one call of a function block may take."""
    return Allowance(steps=STEPS, largest=ELEMENTS)


@lru_cache(maxsize=4096)
def parsed_expression(text: str) -> syntax.Expression:
    """Parse an expression."""
    if len(text) > VALUE_LENGTH:
        raise MatlabError(f"the text is longer than {VALUE_LENGTH} characters")
    parser = Parser(tokenize(text.strip()))
    if parser.next.kind == "stop":
        raise MatlabError("the text is empty")
    node = parser.expression()
    parser.accept(";")
    if parser.next.kind != "stop":
        raise parser.unexpected("where the text should end")
    return node


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
        with quiet():
            node = parsed_expression(text)
            for name in names_in(node):
                if name not in (names or {}) and not _means_something(name):
                    raise MatlabError(f"'{name}' is not a known function or constant")
            values = {name: variable(name, given) for name, given in (names or {}).items()}
            frame = Frame(values=values, file=File(name="the text"))
            return plain(Interpreter(Alone(), small_budget()).value(node, frame))
    except MatlabError as fault:
        raise InvalidValueError(str(fault)) from None


def variable(name: str, given: ArrayLike | float, *, column: bool = False) -> Any:  # noqa: ANN401
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
    return settled(array)


def plain(result: Any) -> Numbers:  # noqa: ANN401
    """Take a value for numbers, as a parameter has them.

    Raises
    ------
    MatlabError
        If it is none.
    """
    if isinstance(result, str):
        raise MatlabError(f"'{result!s:.40}' is a text, not a number")
    array = _real(result)
    if array.ndim > 2:
        raise MatlabError("it is an array of more than two dimensions")
    if array.size == 1:
        if math.isnan(array.item()):
            raise MatlabError("it is not a number (NaN)")
        return float(array.item())
    if not np.isfinite(array).all():
        raise MatlabError("one of its elements is not finite")
    if not array.size:
        return ()
    if 1 in array.shape:
        return tuple(array.ravel().tolist())
    return tuple(tuple(row) for row in array.tolist())


def in_shape(result: Any) -> Numbers:  # noqa: ANN401
    """Take a value for numbers, as `plain` does, but a column stays rows of one number each."""
    numbers = plain(result)
    if isinstance(result, np.ndarray) and result.shape[1:] == (1,) and result.size:
        return tuple((float(entry),) for entry in result[:, 0])
    return numbers


def _real(result: Any) -> NDArray[np.float64]:  # noqa: ANN401
    if isinstance(result, Function):
        raise MatlabError("it is a function, not a number")
    array = numbers_of(result)
    if np.iscomplexobj(array):
        raise MatlabError("it is complex; only real numbers are supported")
    return array


def located(fault: MatlabError, name: str, line: int) -> InvalidValueError:
    """Name the place of a fault: its own function and line, or those that are given."""
    name = fault.function or name
    what = f"MATLAB function {name}" if name else "MATLAB function"
    return InvalidValueError(f"{what}, line {fault.line or line}: {fault}")


@dataclass(frozen=True, kw_only=True)
class Program:
    """The function of a MATLAB Function block, parsed once.

    It keeps nothing between calls.
    """

    name: str
    inputs: tuple[str, ...]  # their names
    outputs: tuple[str, ...]
    functions: tuple[syntax.Function, ...] = field(repr=False)  # the block's own first

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
            With function and line, if the code fails or takes too many steps.
        """
        wanted, given = len(self.inputs), len(arguments)
        if wanted != given:
            raise InvalidValueError(
                f"MATLAB function {self.name} has {wanted} inputs ({', '.join(self.inputs)}), "
                f"but is given {given}"
            )
        main = self.functions[0]
        file = File(name=self.name, functions={one.name: one for one in self.functions})
        try:
            with quiet():
                values = [
                    variable(name, argument, column=True)
                    for name, argument in zip(self.inputs, arguments, strict=True)
                ]
                interpreter = Interpreter(Alone(), small_budget())
                results = interpreter.main(main, file, values, len(self.outputs))
                return tuple(_signal(result).flatten(order="F") for result in results)
        except MatlabError as fault:
            raise located(fault, self.name, main.line) from None


def _signal(result: Any) -> NDArray[np.float64]:  # noqa: ANN401
    if isinstance(result, str):
        raise MatlabError(f"the text '{result!s:.40}' is not a number")
    return _real(result)


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
    own = frozenset(function.name for function in functions)
    for name in ("varargin", "varargout"):
        if name in (*functions[0].inputs, *functions[0].outputs):
            refusal = MatlabError(f"'{name}' is not supported")
            raise located(refusal, functions[0].name, functions[0].line)
    for function in functions:
        _require_supported(function, own)
    main = functions[0]
    return Program(
        name=main.name, inputs=main.inputs, outputs=main.outputs, functions=tuple(functions)
    )


def _require_supported(function: syntax.Function, own: frozenset[str]) -> None:
    """Refuse what keeps values between calls, and names that mean nothing."""
    known = {*function.inputs, *function.outputs, *assigned(function.body), *own}
    for statement, expressions in _walked(function.body):
        if isinstance(statement, syntax.Declare):
            fault = MatlabError(f"'{statement.keyword}' is not supported", statement.line)
            raise located(fault, function.name, function.line)
        for line, expression in expressions:
            for name in names_in(expression):
                if name not in known and not _means_something(name):
                    fault = MatlabError(f"'{name}' is not a known function or constant", line)
                    raise located(fault, function.name, function.line)


def _means_something(name: str) -> bool:
    tables = (KNOWN, CONSTANTS, SPECIAL, COMMANDS, NOT_RUN, QUIET)
    return name == "coder" or any(name in table for table in tables)


_Located = tuple[int, Any]  # line, and a node of the tree


def _walked(
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
                    yield from _walked(body)
                yield from _walked(otherwise)
            case syntax.Switch(on=on, cases=cases, otherwise=otherwise):
                yield statement, [(line, on)]
                for at, case, body in cases:
                    yield statement, [(at, case)]
                    yield from _walked(body)
                yield from _walked(otherwise)
            case syntax.For(over=over, body=body):
                yield statement, [(line, over)]
                yield from _walked(body)
            case syntax.While(condition=condition, body=body):
                yield statement, [(line, condition)]
                yield from _walked(body)
            case syntax.Try(body=body, handler=handler):
                yield statement, []
                yield from _walked(body)
                yield from _walked(handler)
            case _:
                yield statement, []


def _named(script: str) -> str:
    """Name of the first function, read off its head, where the code cannot be parsed."""
    for line in script.splitlines():
        if line.lstrip().startswith("function"):
            words = line.split("=")[-1].split("(")[0].split()
            return words[-1] if words and words[-1] != "function" else ""
    return ""
