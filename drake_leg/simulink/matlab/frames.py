"""What running code has at hand: its variables, its budget, and how functions are entered."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.arrays import Value
from drake_leg.simulink.matlab.limits import CALLS, Budget, MatlabError


class Frame:
    """The variables of one call of a function.

    Parameters
    ----------
    budget : Budget
        Shared by all calls.
    nesting : int
        How deep the functions that wait for this one are nested, together.
    """

    __slots__ = ("budget", "nesting", "values")

    def __init__(self, values: dict[str, Value], budget: Budget, nesting: int = 0) -> None:
        self.values, self.budget, self.nesting = values, budget, nesting


@dataclass(frozen=True, kw_only=True)
class Routine:
    """A function of a script, ready to run."""

    line: int
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    nesting: int
    body: Callable[[Frame], object]


def located(fault: MatlabError, name: str, line: int) -> InvalidValueError:
    """Say where a fault is.

    Parameters
    ----------
    name : str
        Of the function; may be empty.
    line : int
        Of the statement, where the fault itself knows none.
    """
    what = f"MATLAB function {name}" if name else "MATLAB function"
    return InvalidValueError(f"{what}, line {fault.line or line}: {fault}")


def enter(
    routine: Routine, arguments: list[Value], wanted: int, budget: Budget, nesting: int = 0
) -> list[Value]:
    """Call a function.

    Parameters
    ----------
    arguments : list of Value
        Its inputs, or the first of them.
    wanted : int
        How many outputs are taken.
    budget : Budget
        Shared by all calls.
    nesting : int
        Of the functions that wait for it.

    Raises
    ------
    MatlabError
        If it cannot be called so.
    InvalidValueError
        With function and line, if it fails.
    """
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
        raise MatlabError(f"the calls of {name} inside one another are too deep")
    inputs = dict(zip(routine.inputs, arguments, strict=False))
    frame = Frame(inputs, budget, nesting + routine.nesting)
    routine.body(frame)
    missing = [output for output in routine.outputs[:wanted] if output not in frame.values]
    if missing:
        raise located(
            MatlabError(f"the output '{missing[0]}' is never given a value"), name, routine.line
        )
    return [frame.values[output] for output in routine.outputs[:wanted]]
