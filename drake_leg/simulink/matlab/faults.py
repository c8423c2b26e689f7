"""Errors that scripts raise, look at and raise again."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from drake_leg.simulink.matlab import operators
from drake_leg.simulink.matlab.data import StopError, Struct
from drake_leg.simulink.matlab.library import KNOWN
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter


_IDENTIFIER = re.compile(r"[\w-]+(:[\w-]+)+")


def _stop(said: str, identifier: str = "") -> StopError:
    return StopError(f"it stops with the error {said!r:.80}", said=said, identifier=identifier)


def _told(self: Interpreter, arguments: Values) -> tuple[str, str]:
    """Identifier, if the first of several texts is one, and text with its numbers put in."""
    identifier = ""
    if len(arguments) > 1 and _IDENTIFIER.fullmatch(str(arguments[0])):
        identifier, arguments = str(arguments[0]), arguments[1:]
    plain = len(arguments) == 1 and not identifier  # a text alone is not a format
    text = arguments[0] if plain else KNOWN["sprintf"](self.budget, 1, *arguments)
    return identifier, str(text)


def _assert(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    if not operators.truth(arguments[0]):
        if len(arguments) == 1:
            raise _stop("Assertion failed.", "MATLAB:assertion:failed")
        identifier, said = _told(self, arguments[1:])
        raise _stop(said, identifier)
    return []


def _error(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``error``: a text, after its identifier, or what a `catch` has caught."""
    if arguments and isinstance(arguments[0], Struct):
        return _again(self, arguments, wanted, frame)
    if not (arguments and isinstance(arguments[0], str)):
        raise StopError("it stops with an error")
    identifier, said = _told(self, arguments)
    raise _stop(said, identifier)


def _again(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``rethrow``, ``throw``: the error of a structure with message and identifier."""
    fault = arguments[0] if arguments else None
    if not isinstance(fault, Struct) or "message" not in fault:
        raise MatlabError("an error that is raised again has a message")
    raise _stop(str(fault["message"]), str(fault.get("identifier", "")))


def _exception(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``MException(identifier, text, numbers...)``."""
    if len(arguments) < 2 or not _IDENTIFIER.fullmatch(str(arguments[0])):
        raise MatlabError("'MException' takes an identifier and a text")
    identifier, said = _told(self, arguments)
    return [Struct(message=said, identifier=identifier, stack=Struct())]


def _report(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """``getReport``: the message."""
    if not isinstance(arguments[0], Struct):
        raise MatlabError("'getReport' takes an error")
    return [f"Error: {arguments[0].get('message', '')}"]


FAULTS: dict[str, Any] = {
    "assert": _assert,
    "error": _error,
    "getReport": _report,
    "MException": _exception,
    "rethrow": _again,
    "throw": _again,
}
