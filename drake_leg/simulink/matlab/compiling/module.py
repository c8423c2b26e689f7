"""Compiled source of a whole block: its function, and those that it calls, for kinds of inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, is_dataclass
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import operators, syntax, writing
from drake_leg.simulink.matlab.checking import walked
from drake_leg.simulink.matlab.compiling import runtime, small_matrices
from drake_leg.simulink.matlab.compiling.beside import own_function
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    FaultError,
    UncompilableError,
    constant,
    converted,
    fields_of,
    one_piece,
    record,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    Kind,
    Numbers,
    Record,
    is_scalar,
    is_small,
    places,
    variable,
)
from drake_leg.simulink.matlab.compiling.machine import Machine
from drake_leg.simulink.matlab.compiling.source import Lines, Loop, called, rendered
from drake_leg.simulink.matlab.compiling.statements import function_of
from drake_leg.simulink.matlab.compiling.translation import Translation, places_of
from drake_leg.simulink.matlab.compiling.values import inward, outward
from drake_leg.simulink.matlab.data import Struct
from drake_leg.simulink.matlab.frames import File
from drake_leg.simulink.matlab.indexing import ALL, columns, last, read, removed, write
from drake_leg.simulink.matlab.names import names_in

# ruff: noqa: ANN401 - any value of a script
_MOST = 24  # kinds of inputs for which functions are written anew
_EXACT = 4  # of one function, for which constants among its inputs count


@dataclass
class Written:
    """A function for inputs of some kinds."""

    name: str
    function: syntax.Function
    inputs: list[Kind]
    outputs: list[Kind] = field(default_factory=list)
    lines: Lines = field(default_factory=Lines)
    unfinished: bool = True  # it is being written
    failed: bool = False  # it is left to the interpreter
    fails: bool = False  # it surely fails where it is called


class Module:
    """The source of a block's function for inputs and persistent variables of some kinds."""

    def __init__(self, machine: Machine, kept: Mapping[str, Kind], *, daring: bool) -> None:
        self.machine, self.kept, self.daring = machine, kept, daring
        self.nodes = 0
        self.arrays = False  # whether NumPy's warnings must be kept away
        self.applies = False  # whether functions that are values are called
        self.keeps = False
        self._written: dict[Any, Written] = {}
        self._recursive: set[int] = set()
        self._constants: dict[str, Any] = {}

    # --- what translations ask for ------------------------------------------------------------

    def held(self, value: Any) -> str:
        """Return the name of a constant that lies outside of the source."""
        name = f"k{len(self._constants)}"
        self._constants[name] = value
        return name

    def code_of(self, value: Any) -> Code:
        """Return code of a constant, wherever it lies."""
        found = constant(value)
        if found is not None:
            return found
        if isinstance(value, Struct):
            fields = {name: self.code_of(one) for name, one in value.items()}
            return record(fields)
        name = self.held(value)
        if isinstance(value, np.ndarray) and value.dtype in (np.float64, np.bool_):
            kind = "bool" if value.dtype == np.bool_ else "float"
            return Code(Numbers(kind, tuple(value.shape)), (name,))
        return Code(ANYTHING, (name,))

    def own(self, name: str, file: File) -> tuple[syntax.Function, File] | None:
        """Find a function that is written in MATLAB."""
        return own_function(name, file, self.machine.host)

    def uses_answer(self, function: syntax.Function) -> bool:
        """Whether a function uses the value of the last expression."""
        return "ans" in names_in(_expressions(function.body))

    def calls_values(self, file: File) -> bool:
        """Whether functions in a file make functions values, which others may call."""
        nodes = _nodes(tuple(one.body for one in file.functions.values()))
        return any(isinstance(node, syntax.Handle | syntax.Anonymous) for node in nodes)

    def is_recursive(self, function: syntax.Function) -> bool:
        """Whether a function calls itself, as far as is known."""
        return id(function) in self._recursive

    def is_active_twice(self, function: syntax.Function) -> bool:
        """Whether a function is written for a call from itself."""
        written = [
            one for one in self._written.values() if one.function is function and one.unfinished
        ]
        return len(written) > 1 or self.is_recursive(function)

    def enter(
        self,
        t: Translation,
        function: syntax.Function,
        file: File,
        given: list[Code],
        wanted: int,
    ) -> list[Code]:
        """Write a call of a function that is written in MATLAB."""
        if _is_plain(function, len(given), wanted):
            kinds = self._generalized(function, [code.kind for code in given])
            written = self._for(function, file, kinds, wanted)
            if written.fails:
                raise FaultError("a function that fails is called")
            if not written.failed:
                return self._call(t, written, given, wanted)
        arguments = f"[{', '.join(map(t.whole, given))}]"
        piece = called("interpreted", self.held((function, file)), arguments, str(wanted))
        self.arrays = True
        if not wanted:
            t.emit(piece)
            return []
        listed = t.temporary(piece)
        return [Code(ANYTHING, (f"{listed}[{k}]",)) for k in range(wanted)]

    def _call(self, t: Translation, written: Written, given: list[Code], wanted: int) -> list[Code]:
        if written.unfinished:
            self._recursive.add(id(written.function))
        pieces = [
            part
            for code, kind in zip(given, written.inputs, strict=True)
            for part in converted(code, kind).parts
        ]
        outputs: list[Kind] = (
            [ANYTHING] * wanted if written.unfinished else written.outputs[:wanted]
        )
        names = [tuple(t.name() for _ in range(places(kind))) for kind in outputs]
        flat = [name for one in names for name in one]
        call = called(written.name, *pieces)
        if flat:
            t.emit(f"{', '.join(flat)}{',' * (len(flat) == 1)} = {call}")
        else:
            t.emit(call)
        return [Code(kind, one) for kind, one in zip(outputs, names, strict=True)]

    def _generalized(self, function: syntax.Function, kinds: list[Kind]) -> list[Kind]:
        """Forget constants of inputs where a function would be written too often."""
        written = [one for one in self._written.values() if one.function is function]
        if len(written) >= _EXACT or any(one.unfinished for one in written):
            kinds = [_loose(kind) for kind in kinds]
        if len(written) >= 2 * _EXACT or len(self._written) >= _MOST:
            kinds = [ANYTHING for _ in kinds]
        return kinds

    def _for(
        self, function: syntax.Function, file: File, kinds: list[Kind], wanted: int
    ) -> Written:
        key = (id(function), tuple(kinds), wanted)
        if key in self._written:
            return self._written[key]
        name = f"f{len(self._written)}_{function.name}"
        written = Written(name=name, function=function, inputs=kinds)
        self._written[key] = written
        try:
            self._write(written, file, wanted)
        except FaultError:
            written.failed = written.fails = True
        except UncompilableError:
            written.failed = True
        written.unfinished = False
        return written

    def _write(self, written: Written, file: File, wanted: int) -> None:
        function = written.function
        t = Translation(self, function, file, len(written.inputs), wanted)
        names: list[str] = []
        for name, kind in zip(function.inputs, written.inputs, strict=False):
            places_here = tuple(f"unused{len(names)}_{k}" for k in range(places(kind)))
            if name != "~":
                t.variables.kinds[name] = kind
                places_here = places_of(name, kind)
            names.extend(places_here)
        head = Loop(f"def {written.name}({', '.join(names)})")
        head.body.append("budget.step()")
        body, written.outputs = function_of(t)
        if self.applies and t.variables.kept:
            raise UncompilableError("it keeps values and calls functions that are values")
        head.body.append(body)
        written.lines = Lines([head])

    # --- the whole ----------------------------------------------------------------------------

    def source(
        self,
        main: syntax.Function,
        file: File,
        inputs: Mapping[str, Kind | Code],
        shapes: Mapping[str, Any],
    ) -> str:
        """Write the source of a module whose function ``entry`` takes and gives signals.

        Raises
        ------
        UncompilableError
            If the function is left to the interpreter.
        """
        entry = Loop("")
        names = [name for name, one in inputs.items() if not isinstance(one, Code)]
        t = Translation(self, main, file, len(inputs), len(main.outputs))
        codes: list[Code] = []
        with t.into(entry.body):
            for name, one in inputs.items():
                if isinstance(one, Code):
                    codes.append(one)
                else:
                    codes.append(_taken_in(t, f"u{names.index(name)}", name, one, shapes[name]))
            kinds = [code.kind for code in codes]
            written = self._for(main, file, kinds, len(main.outputs))
            if written.failed:
                raise UncompilableError("the function itself is left to the interpreter")
            results = self._call(t, written, codes, len(main.outputs))
            given = list(map(_given_out, main.outputs, results))
            t.emit(f"return {', '.join(given)}{',' * (len(given) == 1)}" if given else "return ()")
        entry.head = f"def entry({', '.join(f'u{k}' for k in range(len(names)))})"
        lines = Lines()
        for function in self._written.values():
            if not function.failed:
                lines.extend([function.lines, "", ""])
        lines.append(entry)
        return "\n".join(rendered(lines)) + "\n"

    def namespace(self) -> dict[str, Any]:
        """Return the names that the source uses."""
        return {**_NAMES, **self._constants, **self.machine.names()}


def _is_plain(function: syntax.Function, given: int, wanted: int) -> bool:
    """Tell whether a call has no list of arguments, but one that is empty and not read."""
    inputs = function.inputs
    if inputs[-1:] == ("varargin",) and "varargin" not in names_in(_expressions(function.body)):
        inputs = inputs[:-1]
    return not (
        function.arguments
        or {"varargin", "varargout"} & {*inputs, *function.outputs}
        or given > len(inputs)
        or wanted > len(function.outputs)
    )


def _loose(kind: Kind) -> Kind:
    kind = variable(kind)
    return Numbers(kind.kind, kind.shape) if isinstance(kind, Numbers) else kind


def _expressions(statements: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(node for _, located in walked(statements) for _, node in located)


def _nodes(node: Any) -> Iterator[Any]:
    if isinstance(node, tuple):
        for one in node:
            yield from _nodes(one)
    elif is_dataclass(node):
        yield node
        yield from _nodes(tuple(node.__dict__.values()))


def _taken_in(t: Translation, piece: str, name: str, kind: Kind, shape: Any) -> Code:
    """Take a signal into the places of its kind."""
    if isinstance(kind, Record):
        return record(
            {
                one: _taken_in(t, f"{piece}[{one!r}]", f"{name}.{one}", inner, shape[one])
                for one, inner in kind.fields
            }
        )
    if is_scalar(kind):
        return Code(kind, (piece if shape == () else t.temporary(f"{piece}.item()"),))
    if is_small(kind):
        ravel = "" if len(shape) == 1 else '.ravel("F")'
        return t.unpacked(f"{piece}{ravel}.tolist()", kind)
    t.module.arrays = True
    return Code(kind, (t.temporary(called("inward", repr(name), piece)),), fresh=True)


def _given_out(name: str, code: Code) -> str:
    """Write a value as a signal."""
    kind = code.kind
    if isinstance(kind, Record):
        fields = fields_of(code)
        inner = (f"{one!r}: {_given_out(f'{name}.{one}', fields[one])}" for one in fields)
        return "{" + ", ".join(inner) + "}"
    if is_scalar(kind):
        return code.parts[0]
    if isinstance(kind, Numbers) and is_small(kind) and kind.shape and kind.shape[1:] == (1,):
        return called("vector", f"({', '.join(code.parts)},)") if code.parts else one_piece(code)
    if isinstance(kind, Numbers) and is_small(kind):
        return one_piece(code)
    return called("outward", repr(name), one_piece(code))


_OF_MATH = """sin cos tan atan sinh cosh tanh asinh exp log log2 log10 log1p expm1 sqrt asin acos
acosh atanh atan2 hypot isinf isfinite pow"""
_NAMES: dict[str, Any] = {
    "__builtins__": {},
    **{one.__name__: one for one in (float, int, bool, abs)},
    **{name: math.__dict__[name] for name in _OF_MATH.split()},
    **{name: one for name, one in runtime.__dict__.items() if name in runtime.USED.split()},
    **{
        f"{name}_{n}": small_matrices.__dict__[f"{name}_{n}"]
        for name in ("det", "inv", "solve")
        for n in (2, 3)
    },
    "nan": math.nan,
    "inf": math.inf,
    "zeros": np.zeros,
    "vector": np.array,
    "Struct": Struct,
    "ALL": ALL,
    "read": read,
    "write": write,
    "columns": columns,
    "last": last,
    "removed": removed,
    "put": writing.put,
    "combined": operators.combined,
    "sign_of": operators.sign,
    "transposed": operators.transposed,
    "truth": operators.truth,
    "same": operators.same,
    "span": operators.span,
    "stacked": operators.stacked,
    "cells": operators.cells,
    "inward": inward,
    "outward": outward,
}
