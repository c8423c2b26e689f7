"""The compiled forms of one block's function, chosen by the kinds of what it is given."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    SCALAR,
    TRUTH,
    Kind,
    Numbers,
    Record,
    kind_of_value,
)
from drake_leg.simulink.matlab.compiling.machine import Machine
from drake_leg.simulink.matlab.compiling.module import Module
from drake_leg.simulink.matlab.frames import File, Memory

# ruff: noqa: ANN401 - any value of a signal
MOST = 12  # forms of one function
_DEPARTURES = 4  # after which a form no longer dares
_SHARE = 0.1  # of the calls of a form, that may depart: a form that dares is ten times faster


@dataclass
class Variant:
    """One compiled form; without an entry it is left to the interpreter."""

    source: str = ""
    entry: Callable[..., tuple[Any, ...]] | None = None
    arrays: bool = True
    daring: bool = True
    calls: int = 0
    departures: int = 0

    def departs(self) -> bool:
        """Count a departure; tell whether there are too many."""
        self.departures += 1
        return self.departures > _DEPARTURES and self.departures > _SHARE * self.calls


def signature(given: Any) -> Any:
    """Say what kind of signal this is, so that alike signals have equal signatures."""
    kind = type(given)
    if kind is float or kind is bool:
        return kind
    if kind is np.ndarray:
        return given.dtype.char, given.shape
    if isinstance(given, Mapping):
        return tuple((name, signature(one)) for name, one in given.items())
    return None


def kind_of_signal(given: Any) -> tuple[Kind, Any]:
    """Kind of a signal, and the shape that it comes in."""
    if type(given) is float:
        return SCALAR, ()
    if type(given) is bool:
        return TRUTH, ()
    if isinstance(given, np.ndarray) and given.dtype in (np.float64, np.bool_) and given.ndim:
        kind = "bool" if given.dtype == np.bool_ else "float"
        shape = (given.size, 1) if given.ndim == 1 else given.shape
        while len(shape) > 2 and shape[-1] == 1:
            shape = shape[:-1]
        return Numbers(kind, tuple(map(int, shape))), given.shape
    if isinstance(given, Mapping):
        found = {name: kind_of_signal(one) for name, one in given.items()}
        kind_of = Record(tuple((name, one) for name, (one, _) in found.items()))
        return kind_of, {name: shape for name, (_, shape) in found.items()}
    return ANYTHING, None


class Variants:
    """All compiled forms of a function."""

    def __init__(
        self,
        machine: Machine,
        main: syntax.Function,
        file: File,
        parameters: Mapping[str, Any],
    ) -> None:
        self._machine, self._main, self._file = machine, main, file
        self._parameters = parameters
        self._found: dict[Any, Variant] = {}
        self._seen: set[Any] = set()

    @property
    def source(self) -> str:
        """Source of all forms, one after the other."""
        return "\n\n".join(one.source for one in self._found.values() if one.source)

    def find(self, memory: Memory, arguments: tuple[Any, ...]) -> Variant | None:
        """Find the form for such arguments and persistent variables; None: to be interpreted."""
        key = (*map(signature, arguments), tuple(memory), *map(signature, memory.values()))
        variant = self._found.get(key)
        if variant is None:
            variant = self._next(key, memory, arguments)
        if variant is None or variant.entry is None:
            return None
        variant.calls += 1
        return variant

    def _next(self, key: Any, memory: Memory, arguments: tuple[Any, ...]) -> Variant | None:
        """Compile a form when it is needed for the second time, if it keeps anything."""
        if len(self._found) >= MOST:
            return None
        if key not in self._seen and len(self._seen) < 100 * MOST and self._keeps():
            self._seen.add(key)
            return None
        variant = self._made(memory, arguments, daring=True)
        self._found[key] = variant
        return variant

    def _keeps(self) -> bool:
        return any(
            isinstance(one, syntax.Declare)
            for function in self._file.functions.values()
            for one in function.body
        )

    def _made(self, memory: Memory, arguments: tuple[Any, ...], *, daring: bool) -> Variant:
        kept = {name: kind_of_value(value) for name, value in memory.items()}
        module = Module(self._machine, kept, daring=daring)
        given = iter(arguments)
        inputs: dict[str, Any] = {}
        shapes: dict[str, Any] = {}
        for k, name in enumerate(self._main.inputs):
            if name in self._parameters:
                inputs[name] = module.code_of(self._parameters[name])
            else:
                name = name if name != "~" else f"~{k}"
                inputs[name], shapes[name] = kind_of_signal(next(given))
        try:
            source = module.source(self._main, self._file, inputs, shapes)
            code = compile(source, f"<MATLAB function {self._main.name}>", "exec")
        except Exception:  # the interpreter takes what the compiler does not
            return Variant()
        namespace = module.namespace()
        exec(code, namespace)
        return Variant(source=source, entry=namespace["entry"], arrays=module.arrays, daring=daring)

    def depart(self, variant: Variant, memory: Memory, arguments: tuple[Any, ...]) -> None:
        """Note that a form did not fit; one that seldom does is compiled anew."""
        if not variant.departs():
            return
        made = self._made(memory, arguments, daring=False) if variant.daring else Variant()
        for key, one in self._found.items():
            if one is variant:
                self._found[key] = made
