"""Statements that choose what runs, catch errors, or say where variables live."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drake_leg.simulink.matlab import operators, syntax
from drake_leg.simulink.matlab.data import Cell, LackError, SpentError, StopError, Struct
from drake_leg.simulink.matlab.frames import Frame
from drake_leg.simulink.matlab.numeric import MatlabError

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.interpreter import Interpreter


def switched(self: Interpreter, statement: syntax.Switch, frame: Frame) -> str | None:
    """Run the first case that is the same as the value."""
    on = self.value(statement.on, frame)
    for line, case, body in statement.cases:
        frame.line = line
        value = self.value(case, frame)
        options = list(value.items.flat) if isinstance(value, Cell) else [value]
        if any(operators.same(on, option) for option in options):
            return self.block(body, frame)
    return self.block(statement.otherwise, frame)


def tried(self: Interpreter, statement: syntax.Try, frame: Frame) -> str | None:
    """Run statements, and others where they fail with an error of the text's own."""
    lenient, frame.lenient = frame.lenient, False
    try:
        return self.block(statement.body, frame)
    except (LackError, SpentError):
        raise
    except MatlabError as fault:
        frame.lenient = lenient
        if statement.error:
            said = Struct(message=str(fault), identifier="", stack=Struct())
            if isinstance(fault, StopError):
                said |= {"message": fault.said, "identifier": fault.identifier}
            self.store(statement.error, said, frame)
        return self.block(statement.handler, frame)
    finally:
        frame.lenient = lenient


def declared(self: Interpreter, statement: syntax.Declare, frame: Frame) -> None:
    """Share variables with all functions, or keep them for the next call."""
    for name in statement.names:
        home = self.globals if statement.keyword == "global" else frame.kept
        if home is None:
            continue
        if name in home:
            frame.values[name] = home[name]
        else:
            home[name] = frame.values.setdefault(name, np.zeros((0, 0)))
        frame.owned.discard(name)
        if statement.keyword == "global":
            frame.shared.add(name)
