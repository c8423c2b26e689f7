"""Blocks of MATLAB code: functions and expressions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.checking import means_something
from drake_leg.simulink.matlab.compiling import CompiledFunction, compiled, compiled_expression
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import Memory
from drake_leg.simulink.running.code import Call, Operand, Writer
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.network import OF_SYSTEM, Node
from drake_leg.simulink.running.operations import real, settled
from drake_leg.simulink.running.s_functions import (
    AS_GIVEN,
    OUTPUTS,
    RATES,
    UPDATE,
    Routine,
    routine_of,
)
from drake_leg.simulink.running.settings import Settings, Signal
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


def _named(w: Writer, script: str, parameters: Mapping[str, Any]) -> tuple[CompiledFunction, str]:
    """Make the code of a function callable by a name."""
    title = w.node.block.name
    function = compiled(script, name=title, parameters=parameters, functions=w.pen.folders)
    name = w.constant(function, title)
    w.pen.written[name] = Call(
        function="compiled", arguments=(script,), named={"name": title, "parameters": parameters}
    )
    return function, name


def _call(w: Writer) -> None:
    function, name = _named(w, w.node.script, w.parameters_of_function())
    names = [each for each in function.inputs if each != NOW]
    inputs = [_argument(w, place, each) for place, each in enumerate(names)]
    if NOW in function.inputs:
        inputs.append(w.let("t", "now"))
    arguments = ", ".join(one.code for one in inputs)
    keeps = function.keeps
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


# --- S-functions ---------------------------------------------------------------------------------


def _routine_inputs(node: Node, _: Settings) -> Iterable[int]:
    """Say whether an S-function needs its input for its outputs."""
    return range(len(node.inputs)) if node.routine is not None and node.routine.is_direct else ()


def _routine_after(w: Writer) -> None:
    routine = w.node.routine
    if routine is None or not w.node.read:
        return
    u = _routine_input(w, routine).code
    if routine.continuous:
        w.derivative(f"flat(real({_routine_call(w, RATES, u)}))")
    if routine.discrete:
        w.remember(f"flat(real({_routine_call(w, UPDATE, u)}))", number=0)
    if "kept" in w.kept:
        w.remember(w.kept["kept"], number=1)


def _routine_input(w: Writer, routine: Routine) -> Operand:
    if not w.count:
        return Operand(code="zeros(0)", value=np.zeros(0))
    u = w.vector(0)
    if routine.inputs not in (AS_GIVEN, u.size):
        raise w.fault(f"takes {routine.inputs} numbers, but is given {u.size}")
    return u


def _routine_states(w: Writer, routine: Routine) -> str:
    states = []
    if routine.continuous:
        states.append(w.state(routine.start[: routine.continuous]).code)
    if routine.discrete:
        states.append(w.remembered(routine.start[routine.continuous :]).code)
    return (
        states[0] if len(states) == 1 else f"joined({', '.join(states)})" if states else "zeros(0)"
    )


def _routine_call(w: Writer, flag: int, u: str) -> str:
    """Call an S-function with a flag."""
    routine: Routine = w.kept["routine"]
    _, name = _named(w, routine.script(flag), routine.parameters)
    kept = w.kept.get("kept", "{}")
    return f"{name}.call({kept}, t, {w.kept['x']}, {u})[0]"


@kind("S-Function", finish=_routine_after, direct=_routine_inputs, sample_time="")
def s_function(w: Writer) -> None:
    """Call a MATLAB S-function of level 1 that lies in a file beside the model."""
    if not w.node.read:  # it draws, or writes files
        return
    routine = w.node.routine or routine_of(w.node.block, w.pen.folders, w.pen.shared)
    w.kept["routine"] = routine
    w.kept["x"] = _routine_states(w, routine)
    if routine.function(OUTPUTS, w.pen.folders).keeps:
        before = w.remembered(routine.kept, number=1).code
        w.kept["kept"] = w.let(f"copied({before})", "kept").code
    if routine.is_direct:
        u = _routine_input(w, routine).code
    else:  # what it may not read is no number, as in Simulink
        u = w.constant(np.full(max(routine.inputs, 0), np.nan), "unread")
    found = w.let(f"flat(real({_routine_call(w, OUTPUTS, u)}))")
    count = found.size if routine.outputs == AS_GIVEN else routine.outputs
    if found.size != count:
        raise w.fault(
            f"puts out {found.size} numbers where {routine.name} has {count} outputs: make them "
            "alike"
        )
    if not routine.is_direct and np.isnan(found.value).any():
        raise w.fault(
            f"reads its input for its outputs, but {routine.name} says that DirFeedthrough is 0: "
            "set it to 1"
        )
    w.out(f"{found.code}.item()" if count == 1 else found.code)
