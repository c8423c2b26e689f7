"""``arguments`` blocks: a value is converted to its class and size, and checked."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import (
    Cell,
    Function,
    StopError,
    Struct,
    Structs,
    Text,
    array_of,
    extent,
    items_of,
    kind_of,
    like,
    numbers_of,
    settled,
)
from drake_leg.simulink.matlab.frames import Frame
from drake_leg.simulink.matlab.library import KNOWN
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script
_UNLIKE: dict[str, tuple[type, ...]] = {
    "cell": (Cell,),
    "struct": (Struct, Structs),
    "function_handle": (Function,),
}


def validated(interpreter: Interpreter, entry: syntax.Validated, value: Any, frame: Frame) -> None:
    """Convert a value to the class and the size of its entry, and store and check it.

    Raises
    ------
    StopError
        If it cannot be converted, or a check refuses it.
    """
    frame.line = entry.line
    try:
        value = _sized(interpreter, entry, _converted(interpreter, entry.kind, value), frame)
        _store(entry, value, frame)
        for check in entry.checks:
            interpreter.several(check, 0, frame)
    except StopError as fault:
        name = f"{entry.name}.{entry.option}" if entry.option else entry.name
        role = "output" if entry.output else "input"
        said = f"Invalid {role} '{name}'. {fault.said}"
        problem = fault.said[:1].lower() + fault.said[1:].rstrip(".")
        refusal = StopError(
            f"the {role} '{name}' is refused: {problem}", said=said, identifier=fault.identifier
        )
        refusal.line = entry.line
        refusal.function = frame.function.name if frame.function else ""
        raise refusal from None


def _store(entry: syntax.Validated, value: Any, frame: Frame) -> None:
    if entry.option:
        frame.values[entry.name][entry.option] = value
    else:
        frame.values[entry.name] = value


def _refused(said: str, identifier: str) -> StopError:
    return StopError(said, said=said, identifier=f"MATLAB:validation:{identifier}")


def _converted(interpreter: Interpreter, kind: str, value: Any) -> Any:
    """Convert a value to a class; those that are not known here are left as they are."""
    text = isinstance(value, str)
    convert: dict[str, Callable[[], Any]] = {
        "double": lambda: _number(value),
        "single": lambda: _number(value),
        "logical": lambda: interpreter.library("logical", [value], 1)[0],
        "char": lambda: str(value) if text else interpreter.library("char", [value], 1)[0],
        "string": lambda: value if isinstance(value, Text) else _string(value),
    }
    if kind in _UNLIKE:
        if not isinstance(value, _UNLIKE[kind]):
            raise _refused(f"Value must be of the class {kind}.", "UnableToConvert")
        return value
    if kind.startswith(("int", "uint")) and kind in KNOWN:
        convert[kind] = lambda: interpreter.library(kind, [value], 1)[0]
    if kind not in convert or kind == kind_of(value):
        return value
    try:
        return convert[kind]()
    except MatlabError:
        said = f"Value of the class {kind_of(value)} cannot be converted to {kind}."
        raise _refused(said, "UnableToConvert") from None


def _number(value: Any) -> Any:
    if isinstance(value, Text):
        return KNOWN["str2double"](None, 1, value)
    return settled(numbers_of(value))


def _string(value: Any) -> Text:
    if isinstance(value, Cell) or (not isinstance(value, str) and array_of(value).size != 1):
        raise MatlabError("there are no arrays of strings here")
    return Text(KNOWN["num2str"](None, 1, value))


def _sized(interpreter: Interpreter, entry: syntax.Validated, value: Any, frame: Frame) -> Any:
    """Give a value the size of its entry: a number fills it, a line is turned."""
    if not entry.size:
        return value
    wanted = [
        None
        if isinstance(one, syntax.Colon)
        else int(array_of(interpreter.value(one, frame)).flat[0])
        for one in entry.size
    ]
    found = extent(value)
    if _fits(found, wanted):
        return value
    items = items_of(value)
    if items.size == 1 and not isinstance(value, str):
        return like(value, np.full([n or 1 for n in wanted], items.flat[0], items.dtype))
    line = len(found) == len(wanted) == 2 and (1 in found or not items.size)
    if line and not isinstance(value, Text) and _fits(found[::-1], wanted):
        return like(value, items.T)
    if line and not items.size and 1 in wanted and None in wanted:
        return like(value, items.reshape([n or 0 for n in wanted]))
    said = "-by-".join("any" if n is None else str(n) for n in wanted)
    raise _refused(f"Value must be {said}, not {'-by-'.join(map(str, found))}.", "IncompatibleSize")


def _fits(found: tuple[int, ...], wanted: list[int | None]) -> bool:
    return len(found) == len(wanted) and all(
        want in (None, have) for have, want in zip(found, wanted, strict=True)
    )
