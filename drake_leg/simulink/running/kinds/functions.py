"""Blocks of MATLAB code: functions and expressions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.checking import means_something
from drake_leg.simulink.matlab.compiling import compiled, compiled_expression
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import Memory
from drake_leg.simulink.running.code import Call, Operand, Writer
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.network import OF_SYSTEM
from drake_leg.simulink.running.operations import real, settled
from drake_leg.simulink.running.settings import Signal
from drake_leg.simulink.stateflow.actions import NOW


class Expression:
    """A MATLAB expression of some names, to be called with their values."""

    def __init__(self, text: str, names: tuple[str, ...], functions: Folders | None = None) -> None:
        self.text = text
        self._function = compiled_expression(text, names, functions=functions)

    @property
    def keeps(self) -> bool:
        """Whether a function that it calls leaves something for the next call."""
        return self._function.keeps

    def start(self, shared: Mapping[str, Any] | None = None) -> Memory:
        """Return what is kept before the first call, with the global variables of scripts."""
        return self._function.start(shared)

    def __call__(self, *values: Signal, kept: Memory | None = None) -> Signal:
        """Evaluate it."""
        return settled(real(self._function(*values, kept=kept)))


def expression_code(w: Writer, text: str, names: Mapping[str, Operand]) -> str:
    """Write the value of a MATLAB expression of some names.

    What functions keep that it calls changes at major steps, or at the block's samples.
    """
    given = {name: w.settings.evaluate(name, name) for name in _free_names(w, text, names)}
    function = Expression(text, (*names, *given), w.pen.folders)
    constants = (w.constant(value, name) for name, value in given.items())
    arguments = ", ".join((*(one.code for one in names.values()), *constants))
    if function.keeps:
        before = w.remembered(function.start(w.pen.shared)).code
        w.kept["kept"] = w.let(f"copied({before})", "kept").code
        arguments += f", kept={w.kept['kept']}"
    name = w.constant(function, "expression")
    w.pen.written[name] = Call(function="Expression", arguments=(text, (*names, *given)))
    return f"{name}({arguments})"


def _free_names(w: Writer, text: str, names: Mapping[str, Operand]) -> list[str]:
    """Names in an expression that are variables, neither inputs nor functions."""
    found = []
    for name in dict.fromkeys(re.findall(r"(?<![\w.])[A-Za-z]\w*", text)):
        if name in names or means_something(name):
            continue
        if w.pen.folders is not None and w.pen.folders.code(name) is not None:
            continue
        found.append(name)
    return found


def _after(w: Writer) -> None:
    if "kept" in w.kept:
        w.remember(w.kept["kept"])


@kind("Fcn")
def fcn(w: Writer) -> None:
    """Evaluate an expression of u."""
    w.out(f"float({expression_code(w, w.settings.text('Expr', 'u'), {'u': w.numeric()})})")


@kind("MATLABFcn", finish=_after)
def matlab_fcn(w: Writer) -> None:
    """Call a function by its name, or evaluate an expression of u."""
    text = w.settings.text("MATLABFcn", "sin")
    if "(" not in text:
        text = f"{text}(u)"
    w.out(f"settled({expression_code(w, text, {'u': w.numeric()})})")


def _argument(w: Writer, place: int, name: str) -> Operand:
    """Return an input; a bus of which the code reads no field is a vector to it."""
    found = w.input(place)
    if isinstance(found.value, dict) and not re.search(rf"\b{name}\.", w.node.script):
        return w.let(f"flat({found.code})", name)
    return found


@kind("Chart", finish=_after, sample_time=OF_SYSTEM, stepwise=True)
def chart(w: Writer) -> None:
    """Make a step of a chart."""
    if w.node.problem:
        raise w.fault(f"{w.node.problem}; `replace` can say what it puts out instead")
    _call(w)


@kind("MATLAB Function", finish=_after, sample_time=OF_SYSTEM)
def matlab_function(w: Writer) -> None:
    """Call the code of a MATLAB Function block."""
    if not w.node.script.strip():
        raise w.fault("has no code in the file: save the model again in Simulink")
    _call(w)


def _call(w: Writer) -> None:
    script = w.node.script
    function = compiled(
        script,
        name=w.node.block.name,
        parameters=w.parameters_of_function(),
        functions=w.pen.folders,
    )
    name = w.constant(function, w.node.block.name)
    names = [each for each in function.inputs if each != NOW]
    inputs = [_argument(w, place, each) for place, each in enumerate(names)]
    if NOW in function.inputs:
        inputs.append(w.let("t", "now"))
    arguments = ", ".join(one.code for one in inputs)
    keeps = function.keeps
    w.pen.written[name] = Call(
        function="compiled",
        arguments=(script,),
        named={"name": w.node.block.name, "parameters": w.parameters_of_function()},
    )
    before = "{}"
    if keeps:
        before = f"copied({w.remembered(function.start()).code})"
    kept = w.let(before, "kept")
    made = w.let(f"{name}.call({', '.join(filter(None, (kept.code, arguments)))})", "results")
    if keeps:
        w.kept["kept"] = kept.code
    for place, value in enumerate(made.value):
        code = f"real({made.code}[{place}])"
        if isinstance(value, bool | np.bool_ | int):
            code = f"float({code})"
        elif isinstance(value, np.ndarray) and value.dtype == np.bool_:
            code = f"{code}.astype(float)"
        w.out(code, place, wish=function.outputs[place])
