"""Calls of functions: their inputs, their outputs, and what is said of their faults."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import Cell, LackError, SpentError, Struct, boxed
from drake_leg.simulink.matlab.frames import Frame, Values
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.validating import validated

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script


def bind(
    interpreter: Interpreter, function: syntax.Function, arguments: Values, frame: Frame
) -> None:
    """Give the arguments of a call to the inputs of a function."""
    inputs = function.inputs
    entries = [entry for entry in function.arguments if not entry.output]
    options = {(entry.name, entry.option): entry for entry in entries if entry.option}
    records = {name for name, _ in options}
    given: Values = []
    if inputs and inputs[-1] == "varargin":
        rest = arguments[len(inputs) - 1 :]
        frame.values["varargin"] = Cell(boxed([rest]) if rest else boxed([]))
        inputs = inputs[:-1]
    elif records:
        inputs = tuple(name for name in inputs if name not in records)
        frame.values.update({name: Struct() for name in records})
        at = _first_option(arguments, len(inputs), options)
        arguments, given = arguments[:at], arguments[at:]
        frame.given = at
    elif len(arguments) > len(inputs):
        raise MatlabError(
            f"{function.name} is given {len(arguments)} values; its inputs are {len(inputs)}"
        )
    frame.values.update(zip(inputs, arguments, strict=False))
    frame.values.pop("~", None)
    named = _named_options(function.name, given, {option for _, option in options})
    for entry in entries:
        _bind_entry(interpreter, function.name, entry, named, frame)


def _first_option(arguments: Values, count: int, options: Iterable[tuple[str, str]]) -> int:
    """Count the inputs before the first option, which may leave some inputs out."""
    names = {option for _, option in options}
    for k, one in enumerate(arguments[:count]):
        if isinstance(one, str) and str(one) in names and (len(arguments) - k) % 2 == 0:
            return k
    return min(count, len(arguments))


def _named_options(name: str, given: Values, known: set[str]) -> dict[str, Any]:
    keys = [str(key) for key in given[::2]]
    for key in keys:
        if key not in known:
            raise MatlabError(f"{name} has no option {key[:40]!r}: give {', '.join(sorted(known))}")
    if len(given) % 2:
        raise MatlabError(f"the option '{keys[-1]}' of {name} has no value")
    return dict(zip(keys, given[1::2], strict=True))


def _bind_entry(
    interpreter: Interpreter,
    name: str,
    entry: syntax.Validated,
    named: dict[str, Any],
    frame: Frame,
) -> None:
    """Give an input or an option its value or its default; an option without both stays away."""
    if entry.option in named:
        value = named[entry.option]
    elif not entry.option and entry.name in frame.values:
        value = frame.values[entry.name]
    elif entry.default is not None:
        value = interpreter.value(entry.default, frame)
    elif entry.option:
        return
    else:
        raise MatlabError(f"{name} needs its input '{entry.name}'")
    validated(interpreter, entry, value, frame)


def results(
    interpreter: Interpreter, function: syntax.Function, frame: Frame, wanted: int
) -> Values:
    """Take the outputs of a function from its variables."""
    outputs = list(function.outputs)
    found: Values = []
    for entry in function.arguments:
        if entry.output and entry.name in frame.values:
            validated(interpreter, entry, frame.values[entry.name], frame)
    for name in outputs[: max(1, wanted)]:
        if name == "varargout" and name == outputs[-1]:
            more = frame.values.get(name)
            found.extend(more.items.ravel(order="F") if isinstance(more, Cell) else [])
        elif name in frame.values:
            found.append(frame.values[name])
        elif wanted:
            fault = MatlabError(f"the output '{name}' never gets a value", function.line)
            fault.function = function.name
            raise fault
    if len(found) < wanted:
        raise MatlabError(
            f"{function.name} is asked for {wanted} values; its outputs are {len(outputs)}"
        )
    return found


def locate(fault: MatlabError, frame: Frame) -> None:
    """Say in which line and function a fault is, if it is not known yet."""
    if fault.line is None:
        fault.line = frame.line
    if not fault.function and frame.function is not None:
        fault.function = frame.function.name


def guarded(name: str, count: int, act: Callable[[], Any]) -> Any:
    """Call a function of the library; what it cannot take is said in one sentence."""
    try:
        return act()
    except MatlabError:
        raise
    except MemoryError:
        raise SpentError(f"'{name}' needs more memory than there is") from None
    except (TypeError, IndexError) as error:
        if not count:  # the name may stand for a variable that nothing gives
            raise LackError(f"'{name}' needs arguments", names=(name,)) from None
        many = "this argument" if count == 1 else f"these {count} arguments"
        problem = "does not take" if isinstance(error, TypeError) else "cannot take"
        raise MatlabError(f"'{name}' {problem} {many}") from None
    except (ValueError, ArithmeticError, AttributeError, KeyError) as error:
        raise MatlabError(f"'{name}': {str(error)[:120]}") from None
    except np.linalg.LinAlgError as error:
        raise MatlabError(f"'{name}': {error}") from None
