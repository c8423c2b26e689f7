"""Values as a model's signals have them, and as MATLAB code has them.

A signal is a number, a vector of one dimension, which is a column in MATLAB, an array of more, or
a bus: a dict of signals by name.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import Cell, Function, Struct, Structs, kind_of, settled
from drake_leg.simulink.matlab.numeric import ELEMENTS, MatlabError, measure

# ruff: noqa: ANN401 - any value of a signal, or of a script


def inward(name: str, given: Any) -> Any:
    """Make a signal a value of MATLAB's; arrays are copied.

    Raises
    ------
    MatlabError
        If it is none.
    """
    if isinstance(given, bool | float | complex | str | Cell | Structs | Function):
        return given
    if isinstance(given, Mapping):
        return Struct({field: inward(f"{name}.{field}", one) for field, one in given.items()})
    try:
        array = np.array(given)
        if array.dtype.kind not in "biufc":
            raise TypeError
    except (TypeError, ValueError, OverflowError):
        raise MatlabError(
            f"'{name}' is given {given!r:.60}, which is not an array of numbers"
        ) from None
    if array.size > ELEMENTS:
        raise MatlabError(
            f"'{name}' is given an array of {measure(array)}; it may have {ELEMENTS:,} elements"
        )
    return settled(array[:, np.newaxis] if array.ndim == 1 else array)


def outward(name: str, value: Any) -> Any:
    """Make a value of MATLAB's a signal.

    Raises
    ------
    MatlabError
        If it is none.
    """
    if isinstance(value, float | bool | complex):
        return value
    if isinstance(value, np.ndarray):
        return value.ravel() if value.shape[1:] == (1,) else value
    if isinstance(value, Struct):
        return {field: outward(f"{name}.{field}", one) for field, one in value.items()}
    if isinstance(value, str):
        raise MatlabError(f"the text '{value!s:.40}' is not a number")
    raise MatlabError(f"the output '{name}' is a {kind_of(value)}, which no signal can be")
