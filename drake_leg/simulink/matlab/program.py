"""The code of a MATLAB Function block as something that can be called."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.arrays import numbers
from drake_leg.simulink.matlab.execution import ready_function
from drake_leg.simulink.matlab.frames import Routine, enter, located
from drake_leg.simulink.matlab.limits import SCRIPT_LENGTH, Budget, MatlabError
from drake_leg.simulink.matlab.numeric import variable
from drake_leg.simulink.matlab.statements import ScriptParser
from drake_leg.simulink.matlab.tokens import tokenize


@dataclass(frozen=True, kw_only=True)
class Program:
    """The function of a MATLAB Function block, parsed once.

    It keeps nothing between calls.
    """

    name: str
    inputs: tuple[str, ...]  # their names
    outputs: tuple[str, ...]
    lines: tuple[str, ...] = field(repr=False)  # of the code, for messages
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
        With function and line, if the code is not well formed, or needs what is not known here.
    """
    if len(script) > SCRIPT_LENGTH:
        raise InvalidValueError(f"MATLAB code of more than {SCRIPT_LENGTH} characters is refused")
    parser: ScriptParser | None = None
    try:
        parser = ScriptParser(tokenize(script))
        functions = parser.functions()
    except MatlabError as fault:
        raise located(fault, parser.name if parser else _named(script), 1) from None
    routines: dict[str, Routine] = {}
    own = frozenset(function.name for function in functions)
    for function in functions:
        routines[function.name] = ready_function(function, routines, own)
    main = routines[functions[0].name]
    return Program(
        name=main.name,
        inputs=main.inputs,
        outputs=main.outputs,
        lines=tuple(script.splitlines()),
        routine=main,
    )


def _named(script: str) -> str:
    """Name of the first function, read off its head, where the code cannot be parsed."""
    for line in script.splitlines():
        if line.lstrip().startswith("function"):
            words = line.split("=")[-1].split("(")[0].split()
            return words[-1] if words and words[-1] != "function" else ""
    return ""
