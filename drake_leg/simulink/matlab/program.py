"""MATLAB text to be used: a parameter's number, the function of a MATLAB Function block."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.checking import checked_functions, located, means_something
from drake_leg.simulink.matlab.data import Allowance, Function, numbers_of, settled
from drake_leg.simulink.matlab.frames import Alone, File, Frame
from drake_leg.simulink.matlab.interpreter import Interpreter
from drake_leg.simulink.matlab.names import names_in
from drake_leg.simulink.matlab.numeric import ELEMENTS, VALUE_LENGTH, MatlabError, quiet
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.tokens import tokenize

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


def value(
    text: str, names: Mapping[str, ArrayLike] | None = None, *, unbounded: bool = False
) -> Numbers:
    """Evaluate numeric MATLAB text.

    Parameters
    ----------
    text : str
        An expression of numbers, operators, matrices, ranges and known functions.
    names : mapping, optional
        Variables: numbers, rows or matrices.
    unbounded : bool, optional
        Whether elements of an array may be infinite.

    Returns
    -------
    float, tuple of float, or tuple of tuple of float
        A number, which may be infinite; the elements of a row or column; the rows of a matrix.

    Raises
    ------
    InvalidValueError
        With a short reason, to follow the name of what the text belongs to, and a colon.
    """
    try:
        with quiet():
            node = parsed_expression(text)
            for name in names_in(node):
                if name not in (names or {}) and not means_something(name):
                    raise MatlabError(f"'{name}' is not a known function or constant")
            values = {name: variable(name, given) for name, given in (names or {}).items()}
            frame = Frame(values=values, file=File(name="the text"))
            return plain(
                Interpreter(Alone(), small_budget()).value(node, frame), unbounded=unbounded
            )
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


def plain(result: Any, *, unbounded: bool = False) -> Numbers:  # noqa: ANN401
    """Take a value for numbers, as a parameter has them; ``unbounded`` elements may be infinite.

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
    if np.isnan(array).any() or not (unbounded or np.isfinite(array).all()):
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
    functions = checked_functions(script)
    main = functions[0]
    return Program(name=main.name, inputs=main.inputs, outputs=main.outputs, functions=functions)
