"""The code of a MATLAB Function block, to be called as often as a simulation needs it."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from functools import cached_property, partial
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.checking import (
    checked_functions,
    located,
    means_something,
    require_supported,
)
from drake_leg.simulink.matlab.compiling.beside import Beside, is_beside, keeps, shared_names
from drake_leg.simulink.matlab.compiling.machine import Machine
from drake_leg.simulink.matlab.compiling.values import inward, outward
from drake_leg.simulink.matlab.compiling.variants import Variants
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import GLOBAL, Alone, File, Memory
from drake_leg.simulink.matlab.numeric import MatlabError, quiet
from drake_leg.simulink.matlab.program import small_budget

# ruff: noqa: ANN401 - any value of a signal
REFUSED = ("global",)  # declarations
# Calls whose results are known: derivatives by differences ask again for most of them, as do
# commands and derivatives at one time.
KNOWN_CALLS = 4


class CompiledFunction:
    """The function of a MATLAB Function block; make it by `compiled`.

    Attributes
    ----------
    name : str
        Name for messages.
    inputs, outputs : tuple of str
        Names of the inputs, without those that are parameters, and of the outputs.
    """

    def __init__(
        self,
        functions: tuple[syntax.Function, ...],
        parameters: Mapping[str, Any],
        host: Alone,
        name: str,
    ) -> None:
        self._main, self._parameters = functions[0], parameters
        self._machine = Machine(host, small_budget())
        # A block's own function cannot be recursive: by the name of one of MATLAB's, it calls that.
        own = "" if means_something(self._main.name) else self._main.name
        others = {one.name: one for one in functions[1:]}
        self._file = File(name=self._main.name, functions={own: self._main, **others})
        self.name = name or self._main.name
        self.inputs = tuple(one for one in self._main.inputs if one not in parameters)
        self.outputs = self._main.outputs
        self._variants = Variants(self._machine, self._main, self._file, parameters)
        self._known: dict[Any, tuple[Any, ...]] = {}  # results of the last calls

    @property
    def source(self) -> str:
        """Python source for the kinds of arguments of the calls so far; "" before the first."""
        return self._variants.source

    @cached_property
    def _is_pure(self) -> bool:
        return not self.keeps

    @property
    def keeps(self) -> bool:
        """Whether a call may leave something for the next: in functions of other files, too."""
        return keeps(self._main, self._file, self._machine.host)

    def start(self, shared: Mapping[str, Any] | None = None) -> Memory:
        """Return the persistent variables before the first call, and global ones.

        A copy by ``dict`` keeps them as they are: a call puts other values into the dict, and
        leaves the values themselves as they were.

        Parameters
        ----------
        shared : mapping, optional
            The global variables of scripts; those are taken that the function declares.
        """
        if not shared:
            return {}
        names = shared_names(self._main, self._file, self._machine.host)
        return {f"{GLOBAL}{name}": shared[name] for name in sorted(names & shared.keys())}

    def call(self, persistent: Memory, *arguments: Any) -> tuple[Any, ...]:
        """Call the function once.

        Parameters
        ----------
        persistent : dict
            The persistent variables, from `start`; the call changes them.
        *arguments
            One for each input: a number, a vector (n,), which is a column, an array of more
            dimensions, or a dict for a bus.

        Returns
        -------
        tuple
            One for each output, of the same kinds.

        Raises
        ------
        InvalidValueError
            With function and line, if the code fails or takes too many steps; then the persistent
            variables are as before the call.
        """
        if len(arguments) != len(self.inputs):
            names = ", ".join(self.inputs)
            raise InvalidValueError(
                f"MATLAB function {self.name} has {len(self.inputs)} inputs ({names}), "
                f"but is given {len(arguments)}"
            )
        key = exact(arguments) if self._is_pure else None
        if key is not None and key in self._known:
            return self._known[key]
        found = self._computed(persistent, arguments)
        if key is not None:
            if len(self._known) >= KNOWN_CALLS:
                del self._known[next(iter(self._known))]
            self._known[key] = found
        return found

    def _computed(self, persistent: Memory, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
        variant = self._variants.find(persistent, arguments)
        if variant is not None and variant.entry is not None:
            self._machine.begin(persistent)
            try:
                if variant.arrays:
                    with np.errstate(all="ignore"):
                        found = variant.entry(*arguments)
                else:
                    found = variant.entry(*arguments)
            except Exception:  # whatever it is, the interpreter computes it, or says what is wrong
                self._variants.depart(variant, persistent, arguments)
            else:
                persistent.update(self._machine.memory)
                return found
        return self._interpreted(persistent, arguments)

    def _interpreted(self, persistent: Memory, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
        given = iter(arguments)
        self._machine.begin(persistent)
        try:
            values = [
                self._parameters[name] if name in self._parameters else inward(name, next(given))
                for name in self._main.inputs
            ]
            with quiet():
                results = self._machine.main(self._main, self._file, values, len(self.outputs))
            found = tuple(map(outward, self.outputs, results))
        except MatlabError as fault:
            raise located(fault, self._main.name, self._main.line) from None
        persistent.update(self._machine.memory)
        return found


def exact(arguments: tuple[Any, ...]) -> tuple[Any, ...] | None:
    """Tell arguments apart by all their bits; None where one is neither a number nor an array."""
    found: list[Any] = []
    for one in arguments:
        kind = type(one)
        if kind is float:
            found.append(_PACKED(one))
        elif kind is np.ndarray and one.dtype == np.float64:
            found.append((one.shape, one.tobytes()))
        else:
            return None
    return tuple(found)


_PACKED = struct.Struct("d").pack


def compiled(
    script: str,
    *,
    parameters: Mapping[str, Any] | None = None,
    functions: Folders | None = None,
    name: str = "",
) -> CompiledFunction:
    """Make the code of a MATLAB Function block callable.

    Parameters
    ----------
    script : str
        One function, and after it those that it calls.
    parameters : mapping, optional
        Values of the inputs that are parameters of the block.
    functions : Folders, optional
        Where functions in files are looked for.
    name : str, optional
        Name for messages, instead of the function's own.

    Raises
    ------
    InvalidValueError
        With function and line, if the code is not well formed, or needs what is not supported.
    """
    host = Alone() if functions is None else Beside(functions)
    found = checked_functions(script, refused=REFUSED, beside=partial(is_beside, host))
    return _with_parameters(found, parameters or {}, host, name)


def made(
    functions: tuple[syntax.Function, ...],
    parameters: Mapping[str, Any],
    folders: Folders | None,
) -> CompiledFunction:
    """Make functions callable that are parsed already, the first one of them first.

    Raises
    ------
    InvalidValueError
        If they need what is not supported.
    """
    host = Alone() if folders is None else Beside(folders)
    require_supported(functions, refused=REFUSED, beside=partial(is_beside, host))
    return _with_parameters(functions, parameters, host, "")


def _with_parameters(
    functions: tuple[syntax.Function, ...], given: Mapping[str, Any], host: Alone, name: str
) -> CompiledFunction:
    main = functions[0]
    for parameter in given:
        if parameter not in main.inputs:
            raise InvalidValueError(
                f"MATLAB function {main.name} has no input {parameter!r}",
                advice=did_you_mean(parameter, main.inputs, "leave the parameter out"),
            )
    try:
        values = {parameter: inward(parameter, value) for parameter, value in given.items()}
    except MatlabError as fault:
        raise located(fault, main.name, main.line) from None
    return CompiledFunction(functions, values, host, name)
