"""Calls of functions: their inputs, their outputs, and what is said of their faults."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import Cell, LackError, SpentError, Struct, boxed
from drake_leg.simulink.matlab.frames import Frame, Values
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script


def bind(
    interpreter: Interpreter, function: syntax.Function, arguments: Values, frame: Frame
) -> None:
    """Give the arguments of a call to the inputs of a function."""
    inputs = function.inputs
    options = [entry for entry in function.arguments if entry.option]
    if inputs and inputs[-1] == "varargin":
        rest = arguments[len(inputs) - 1 :]
        frame.values["varargin"] = Cell(boxed([rest]) if rest else boxed([]))
        inputs = inputs[:-1]
    elif options:
        inputs = inputs[:-1]
        frame.values[options[0].name] = Struct()
    elif len(arguments) > len(inputs):
        raise MatlabError(
            f"{function.name} is given {len(arguments)} values; its inputs are {len(inputs)}"
        )
    frame.values.update(zip(inputs, arguments, strict=False))
    frame.values.pop("~", None)
    given = arguments[len(inputs) :] if options else []
    named = {str(key): value for key, value in zip(given[::2], given[1::2], strict=False)}
    for entry in function.arguments:
        if entry.option and entry.option in named:
            frame.values[entry.name][entry.option] = named[entry.option]
        elif entry.default is not None and (entry.option or entry.name not in frame.values):
            value = interpreter.value(entry.default, frame)
            if entry.option:
                frame.values[entry.name][entry.option] = value
            else:
                frame.values[entry.name] = value


def results(function: syntax.Function, frame: Frame, wanted: int) -> Values:
    """Take the outputs of a function from its variables."""
    outputs = list(function.outputs)
    found: Values = []
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
