"""Random numbers as MATLAB's default generator draws them: the Mersenne Twister."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.simulink.matlab.data import LackError, numbers_of, settled
from drake_leg.simulink.matlab.inputs import sizes_of, whole

if TYPE_CHECKING:
    from drake_leg.simulink.matlab.frames import Frame, Memory, Values
    from drake_leg.simulink.matlab.interpreter import Interpreter

# ruff: noqa: ANN401 - any value of a script
_PLACE = "random numbers"  # in the memory of persistent variables: seed, and numbers drawn
_DEFAULT = 5489  # the seed that 0 stands for
_MOST = 2**32


class Generator:
    """Draws numbers; where it stands is kept in a memory, so that it can be set back."""

    def __init__(self) -> None:
        self._stands = (_DEFAULT, 0)
        self._twister = np.random.RandomState(_DEFAULT)

    def draw(self, count: int, memory: Memory) -> Any:
        """Draw numbers between 0 and 1."""
        seed, drawn = memory.get(_PLACE, (_DEFAULT, 0))
        if seed is None:
            raise LackError(
                "random numbers that differ from run to run have no value here: write a seed "
                "instead of 'shuffle'"
            )
        if (seed, drawn) != self._stands:
            self._twister = np.random.RandomState(seed)
            self._twister.random_sample(drawn)
        memory[_PLACE] = self._stands = seed, drawn + count
        return self._twister.random_sample(count)


def rand(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """Draw an array, column by column."""
    if any(isinstance(one, str) and one not in ("double", "single") for one in arguments):
        raise LackError("rand takes sizes only: choose a seed by rng")
    shape = sizes_of(tuple(arguments), self.budget)
    drawn = self.random.draw(int(np.prod(shape)), self.memory)
    return [settled(drawn.reshape(shape, order="F"))]


def randi(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """Draw whole numbers up to a limit, or between two."""
    limits = numbers_of(arguments[0]).ravel()
    low, high = map(whole, (1.0, limits[0]) if limits.size == 1 else limits[:2])
    shape = sizes_of(tuple(arguments[1:]), self.budget)
    drawn = self.random.draw(int(np.prod(shape)), self.memory)
    return [settled(np.floor(low + (high - low + 1.0) * drawn).reshape(shape, order="F"))]


def rng(self: Interpreter, arguments: Values, wanted: int, frame: Frame) -> Values:
    """Choose where the generator begins."""
    first = arguments[0] if arguments else None
    kinds = {str(one) for one in arguments[1:]}
    if wanted or not arguments or kinds - {"twister"}:
        raise LackError("rng takes 'default' or a seed, and knows the Mersenne Twister only")
    if isinstance(first, str):
        words = {"default": _DEFAULT, "shuffle": None}
        if str(first) not in words and not str(first).isdigit():
            raise LackError(f"rng does not know {str(first)!r}: write 'default' or a seed")
        seed = words[str(first)] if str(first) in words else int(str(first))
    else:
        seed = whole(first)
    if seed is not None and not 0 <= seed < _MOST:
        raise LackError(f"the seed {seed} is not between 0 and {_MOST - 1}")
    self.memory[_PLACE] = (_DEFAULT if seed == 0 else seed, 0)
    return []
