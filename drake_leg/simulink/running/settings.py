"""What the parameters of a block come to when it runs: numbers, arrays, choices."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import GIVE_A_VALUE, InvalidValueError, UnknownValueError
from drake_leg.simulink.matlab.data import numbers_of
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.model import Block, Parameters

Signal = Any  # a float, a 1-D or 2-D array, or a dict of them: a bus


class Settings:
    """The parameters of a block."""

    def __init__(self, block: Block) -> None:
        self.block = block
        self._parameters = block.parameters

    def text(self, name: str, default: str = "") -> str:
        """Return a parameter as it stands in the file."""
        return self.texts.get(name, default).strip()

    @property
    def texts(self) -> Mapping[str, str]:
        """Return all parameters as they stand in the file."""
        return self._parameters.texts if isinstance(self._parameters, Parameters) else {}

    def has(self, name: str) -> bool:
        """Tell whether the file, or Simulink's table of defaults, gives a parameter."""
        return bool(self.text(name))

    def is_on(self, name: str) -> bool:
        """Tell whether a switch is on."""
        return self.text(name) == "on"

    def value(self, name: str, default: str | None = None) -> Any:  # noqa: ANN401
        """Evaluate a parameter to a value of MATLAB's.

        Raises
        ------
        InvalidValueError
            With the block and the parameter, if that is not possible.
        """
        text = self.text(name) or (default or "")
        if not text:
            raise InvalidValueError(f"{self.about(name)} is not in the file")
        return self.evaluate(text, name)

    def evaluate(self, text: str, name: str) -> Any:  # noqa: ANN401
        """Evaluate a text with the names that the block may use."""
        try:
            assert isinstance(self._parameters, Parameters)
            return self._parameters.evaluate(text)
        except (InvalidValueError, MatlabError) as error:
            names = getattr(error, "names", ())
            problem = f"{self.about(name)} is {text[:60]!r}, which cannot be evaluated ({error})"
            advice = GIVE_A_VALUE + ", ".join(names) if names else ""
            raise UnknownValueError(problem, names=names, text=text, advice=advice) from None

    def matrix(self, name: str, default: str | None = None) -> NDArray[np.float64]:
        """Evaluate a parameter to an array of two dimensions."""
        return self._real(self.value(name, default), name)

    def array(self, name: str, default: str | None = None) -> Signal:
        """Evaluate a parameter to a float, a 1-D array for a row or column, or a matrix."""
        return as_signal(self.matrix(name, default))

    def number(self, name: str, default: str | None = None) -> float:
        """Evaluate a parameter to one number."""
        found = self.matrix(name, default)
        if not found.size and default is not None:
            found = np.array([[float(default)]])
        if found.size != 1:
            raise InvalidValueError(
                f"{self.about(name)} has {found.size} elements; it must be one number"
            )
        return float(found.item())

    def numbers(self, name: str, default: str | None = None) -> NDArray[np.float64]:
        """Evaluate a parameter to a 1-D array."""
        return self.matrix(name, default).ravel(order="F")

    def about(self, name: str) -> str:
        """Name a parameter and its block."""
        return f"block {self.block.name!r} (SID {self.block.sid}): parameter {name}"

    def _real(self, value: Any, name: str) -> NDArray[np.float64]:  # noqa: ANN401
        try:
            found = numbers_of(value)
        except MatlabError as error:
            raise InvalidValueError(f"{self.about(name)}: {error}") from None
        if np.iscomplexobj(found):
            raise InvalidValueError(f"{self.about(name)} is complex; only real signals run here")
        return np.asarray(found, dtype=np.float64)


def as_signal(matrix: NDArray[np.float64]) -> Signal:
    """Make a matrix a signal: one element a float, a row or a column a 1-D array."""
    if matrix.size == 1:
        return float(matrix.item())
    if matrix.ndim == 2 and 1 in matrix.shape:
        return matrix.ravel()
    return matrix


def shape_of(value: Signal) -> tuple[int, ...]:
    """Shape of a signal; of a scalar, and of a bus, ()."""
    return value.shape if isinstance(value, np.ndarray) else ()


def zero_like(value: Signal) -> Signal:
    """Return zeros of the shape of a number or an array, whether or not it is finite."""
    return np.zeros_like(value) if isinstance(value, np.ndarray) else 0.0


def flat(value: Signal) -> NDArray[np.float64]:
    """All numbers of a signal, a matrix by columns, a bus by its elements."""
    if isinstance(value, dict):
        parts = [flat(each) for each in value.values()]
        return np.concatenate(parts) if parts else np.zeros(0)
    return np.asarray(value, dtype=np.float64).ravel(order="F")
