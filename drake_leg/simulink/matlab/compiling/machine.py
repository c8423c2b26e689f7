"""What runs beside compiled code: the budget, the persistent variables, the interpreter."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.compiling.runtime import DepartureError
from drake_leg.simulink.matlab.data import Allowance, Function
from drake_leg.simulink.matlab.frames import Alone, File, Frame, Memory, Values
from drake_leg.simulink.matlab.indexing import read
from drake_leg.simulink.matlab.interpreter import Interpreter
from drake_leg.simulink.matlab.specials import SPECIAL

# ruff: noqa: ANN401 - any value of a script


class Machine:
    """The interpreter of a block, and what compiled code asks of it."""

    def __init__(self, host: Alone, budget: Allowance) -> None:
        self.host, self.budget = host, budget
        self.memory: Memory = {}
        self._interpreter = Interpreter(host, budget)
        self._frame = Frame(values={}, file=File(name=""))

    def begin(self, memory: Memory) -> None:
        """Prepare for a call with copies of the persistent variables."""
        self.memory = dict(memory)
        self._interpreter.remember(self.memory)
        self.budget.taken = self.budget.made = 0

    def main(self, function: syntax.Function, file: File, arguments: Values, wanted: int) -> Values:
        """Interpret a function."""
        return self._interpreter.main(function, file, arguments, wanted)

    def names(self) -> dict[str, Any]:
        """Return the names by which compiled code asks."""
        return {
            "budget": self.budget,
            "library": self._library,
            "special": self._special,
            "interpreted": self._interpreted,
            "applied": self._applied,
            "part": self._part,
            "closed": self._closed,
            "kept": self._kept,
            "keep": self._keep,
            "expect_empty": self._expect_empty,
        }

    def _library(self, name: str, arguments: Values, wanted: int) -> Values:
        return self._interpreter.library(name, arguments, wanted)

    def _special(self, name: str, arguments: Values, wanted: int) -> Values:
        return SPECIAL[name](self._interpreter, arguments, wanted, self._frame)

    def _interpreted(
        self, place: tuple[syntax.Function, File], arguments: Values, wanted: int
    ) -> Values:
        return self._interpreter.main(*place, arguments, wanted)

    def _applied(self, function: Any, arguments: Values, wanted: int) -> Values:
        return self._interpreter.apply(function, arguments, wanted, self._frame)

    def _part(self, owner: Any, arguments: Values, name: str) -> Any:
        if not isinstance(owner, Function):
            return read(owner, arguments, self.budget, name)
        found = self._applied(owner, arguments, 1)
        if not found:
            raise DepartureError
        return found[0]

    @staticmethod
    def _closed(function: Function, seen: dict[str, Any]) -> Function:
        return Function(inputs=function.inputs, body=function.body, seen=seen, home=function.home)

    def _kept(self, key: str) -> Any:
        return self.memory[key]

    def _keep(self, key: str, value: Any) -> None:
        self.memory[key] = value

    def _expect_empty(self, key: str, shape: tuple[int, ...], kind: type) -> None:
        value = self.memory.get(key)
        if value is None:
            return
        if not isinstance(value, np.ndarray) or value.shape != shape or value.dtype != kind:
            raise DepartureError
