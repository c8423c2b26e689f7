"""MATLAB S-functions of level 1: a function in a file, which is called with a flag for each task.

==== ===================================================== ==========================
flag what ``sys = f(t, x, u, flag, p1, p2, ...)`` returns  when it is called here
==== ===================================================== ==========================
0    sizes; then the states at the start, text, the rate   once, before all others
1    the derivatives of the continuous states              wherever rates are asked for
2    the discrete states, after this sample                at samples or major steps
3    the outputs                                           wherever signals are asked for
==== ===================================================== ==========================

The states x are the continuous ones, then the discrete ones; x and u are columns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import CompiledFunction, compiled
from drake_leg.simulink.matlab.data import Cell
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import Memory
from drake_leg.simulink.model import Block
from drake_leg.simulink.running.settings import Settings

Array = NDArray[np.float64]
START, RATES, UPDATE, OUTPUTS = 0, 1, 2, 3  # flags
AS_GIVEN = -1  # a size, or a sample time, that is that of what comes in
NEXT_HIT = -2  # a sample time that the function tells each time


@dataclass(frozen=True, kw_only=True)
class Routine:
    """An S-function of a block, with its parameters, and what it says of itself."""

    name: str
    parameters: Mapping[str, Any]  # of MATLAB's values, by the names in its scripts
    continuous: int  # states
    discrete: int
    outputs: int
    inputs: int
    is_direct: bool  # whether its outputs depend on its inputs at once
    start: Array  # all states
    rate: tuple[float, float] | None  # period and offset [s], None where it is inherited
    kept: Memory  # persistent and global variables after the first call

    def script(self, flag: int) -> str:
        """Write a MATLAB function of t, x and u that calls this one with a flag."""
        return _script(self.name, "sys", "t, x, u", str(flag), self.parameters)

    def function(self, flag: int, folders: Folders | None) -> CompiledFunction:
        """Make the function for a flag callable with t, x and u."""
        return compiled(
            self.script(flag), parameters=self.parameters, functions=folders, name=self.name
        )


def routine_of(
    block: Block, folders: Folders | None, shared: Mapping[str, Any] | None = None
) -> Routine:
    """Ask the S-function of a block for its sizes.

    Parameters
    ----------
    block : Block
        The S-Function.
    folders : Folders, optional
        Where its file is looked for.
    shared : mapping, optional
        Global variables of scripts.

    Raises
    ------
    InvalidValueError
        If there is no such file, one of its parameters is not known, or its answer makes no sense.
    """
    settings = Settings(block)
    name = settings.text("FunctionName")
    about = f"block {block.name!r} (SID {block.sid})"
    if folders is None or not name.isidentifier() or folders.code(name) is None:
        raise InvalidValueError(
            f"{about} is an S-Function without a file {name or 'NAME'}.m in the given folders, and "
            "compiled ones do not run: let `replace` say what it puts out instead"
        )
    values = settings.evaluate(f"{{{settings.text('Parameters')}}}", "Parameters")
    assert isinstance(values, Cell)
    given = {f"p{k}": value for k, value in enumerate(values.items.ravel(), start=1)}
    script = _script(name, "[sys, x0, str, ts]", "", "0, [], [], 0", given)
    function = compiled(script, parameters=given, functions=folders, name=name)
    kept = function.start(shared)
    try:
        sys, x0, _, ts = function.call(kept)
        return _read(name, given, _numbers(sys), _numbers(x0), _numbers(ts), kept)
    except InvalidValueError as error:
        raise InvalidValueError(f"{about}: {error}") from None


def _script(name: str, results: str, inputs: str, first: str, given: Mapping[str, Any]) -> str:
    arguments = ", ".join(filter(None, (inputs, first, *given)))
    head = ", ".join(filter(None, (inputs, *given)))
    return f"function {results} = {name}_{first[-1]}({head})\n{results} = {name}({arguments});\n"


def _numbers(value: Any) -> Array:  # noqa: ANN401 - of the function's making
    return np.asarray(value, dtype=float).ravel(order="F")


def _read(
    name: str, given: Mapping[str, Any], sizes: Array, x0: Array, ts: Array, kept: Memory
) -> Routine:
    if sizes.size not in (6, 7) or (sizes != np.round(sizes)).any():
        raise InvalidValueError(
            f"{name} answers the flag 0 by {sizes.size} numbers: let it return the 7 of `simsizes`"
        )
    continuous, discrete, outputs, inputs = (int(each) for each in sizes[:4])
    if x0.size != continuous + discrete:
        raise InvalidValueError(
            f"{name} has {continuous + discrete} states, but {x0.size} initial values: make them "
            "as many"
        )
    return Routine(
        name=name,
        parameters=given,
        continuous=continuous,
        discrete=discrete,
        outputs=outputs,
        inputs=inputs,
        is_direct=bool(sizes[5]),
        start=x0,
        rate=_rate(name, ts),
        kept=kept,
    )


def _rate(name: str, ts: Array) -> tuple[float, float] | None:
    if ts.size > 2:
        raise InvalidValueError(
            f"{name} has {ts.size // 2} sample times, and runs here at one: give it a single row"
        )
    period, offset = (*ts, 0.0, 0.0)[:2] if ts.size else (AS_GIVEN, 0.0)
    if period == NEXT_HIT:
        raise InvalidValueError(
            f"{name} tells its next sample time each time ({NEXT_HIT}), which does not run: give "
            "it a fixed one"
        )
    if period == AS_GIVEN:
        return None
    return (float(period), float(offset) if period > 0.0 else 0.0)
