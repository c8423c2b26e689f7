"""Names made ready to be called: a script's own functions first, then the known ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from drake_leg.simulink.matlab.arrays import Value
from drake_leg.simulink.matlab.frames import Frame, Routine, enter
from drake_leg.simulink.matlab.functions import CONSTANTS, HEAVY, KNOWN, SILENT
from drake_leg.simulink.matlab.limits import CALL, FACTOR, MatlabError

Ready = Callable[[Frame], Value]
_SOME_ERROR = "it stops with an error"


@dataclass(frozen=True, kw_only=True)
class Scope:
    """What names mean in a text: variables first, then its own functions, then the known ones."""

    variables: frozenset[str]
    routines: Mapping[str, Routine] = field(default_factory=dict)  # may be filled afterwards
    own: frozenset[str] = frozenset()  # names of the routines


def paid(frame: Frame, value: Value) -> Value:
    """Count the elements of a value that was made, and pass it on."""
    frame.budget.spend(value.size if isinstance(value, np.ndarray) else 1)
    return value


def called(name: str, given: list[Ready], scope: Scope) -> Ready:
    """Make a call of a function ready.

    Parameters
    ----------
    name : str
        Of the function, or of a constant.
    given : list of callable
        Its arguments, made ready.

    Returns
    -------
    callable
        From a frame to the first value.

    Raises
    ------
    MatlabError
        If there is no such function, or it takes no such arguments.
    """
    if name in scope.own:
        return lambda frame: call_routine(scope.routines[name], given, 1, frame)[0]
    if not given and name in CONSTANTS:
        constant = CONSTANTS[name]
        return lambda frame: constant
    if name in SILENT:
        raise MatlabError(f"'{name}' gives no value")
    if name == "error":
        return _error(given)
    if name not in KNOWN:
        if name in CONSTANTS:
            raise MatlabError(f"'{name}' takes no arguments here")
        raise MatlabError(f"'{name}' is no number and no function known here")
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


def _error(given: list[Ready]) -> Ready:
    def error(frame: Frame) -> Value:
        said = [text for text in (argument(frame) for argument in given) if isinstance(text, str)]
        if len(said) > 1 and ":" in said[0] and " " not in said[0]:
            said = said[1:]  # the first one was the error's identifier
        raise MatlabError(f"it stops with the error {said[0]!r:.80}" if said else _SOME_ERROR)

    return error


def call_routine(
    routine: Routine, arguments: list[Ready], wanted: int, frame: Frame
) -> list[Value]:
    """Call a function of the same script.

    Parameters
    ----------
    arguments : list of callable
        Its arguments, made ready.
    wanted : int
        How many outputs are taken.

    Raises
    ------
    MatlabError
        If it cannot be called so.
    InvalidValueError
        If it fails.
    """
    given = [argument(frame) for argument in arguments]
    return enter(routine, given, wanted, frame.budget, frame.nesting)
