"""MATLAB text to be used: a parameter's number, the function of a MATLAB Function block."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.evaluation import Frame, Meanings, Routine, compiled, enter, located
from drake_leg.simulink.matlab.execution import compile_function
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
)

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
        With a short reason, to stand behind what the text belongs to and a colon.
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
            f"'{name}' is given {given!r:.60}, which is no array of numbers"
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
