"""A parameter's text, such as ``-50/180*pi`` or ``[.025 0 0]``, as numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.arrays import Value, grid, settle
from drake_leg.simulink.matlab.calls import Scope
from drake_leg.simulink.matlab.evaluation import ready
from drake_leg.simulink.matlab.expressions import ExpressionParser
from drake_leg.simulink.matlab.frames import Frame
from drake_leg.simulink.matlab.limits import ELEMENTS, VALUE_LENGTH, Budget, MatlabError
from drake_leg.simulink.matlab.tokens import tokenize

Numbers = float | tuple[float, ...] | tuple[tuple[float, ...], ...]


def value(text: str, names: Mapping[str, ArrayLike] | None = None) -> Numbers:
    """Evaluate numeric MATLAB text.

    Parameters
    ----------
    text : str
        An expression of numbers, operators, matrices, ranges and known functions.
    names : mapping, optional
        Variables: numbers, rows or matrices.

    Returns
    -------
    float, tuple of float, or tuple of tuple of float
        A number; the elements of a row or column; the rows of a matrix. Only a number alone may
        be infinite.

    Raises
    ------
    InvalidValueError
        With a short reason, to stand behind what the text belongs to and a colon.
    """
    try:
        with np.errstate(all="ignore"):
            return _plain(_evaluated(text, names or {}))
    except MatlabError as fault:
        raise InvalidValueError(str(fault)) from None


def _evaluated(text: str, names: Mapping[str, ArrayLike]) -> Value:
    if len(text) > VALUE_LENGTH:
        raise MatlabError(f"the text is longer than {VALUE_LENGTH} characters")
    parser = ExpressionParser(tokenize(text.strip()))
    if parser.next.kind == "stop":
        raise MatlabError("the text is empty")
    node = parser.expression()
    if parser.next.kind != "stop":
        raise parser.unexpected("where the text should end")
    variables = {name: variable(name, given) for name, given in names.items()}
    run = ready(node, Scope(variables=frozenset(variables)))
    return run(Frame(variables, Budget()))


def variable(name: str, given: ArrayLike | float, *, column: bool = False) -> Value:
    """Make numbers from outside a value.

    Parameters
    ----------
    name : str
        Of the variable, for the message.
    given : array_like
        A number, a vector or a matrix.
    column : bool
        Whether a vector is a column; otherwise it is a row.

    Raises
    ------
    MatlabError
        If it is something else, or too large.
    """
    if isinstance(given, float):
        return float(given)
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise MatlabError(
            f"'{name}' is given {given!r:.60}, which is no array of numbers"
        ) from None
    if array.ndim > 2 or array.size > ELEMENTS:
        raise MatlabError(
            f"'{name}' is given an array of shape {array.shape}; it must be a small matrix"
        )
    if array.ndim < 2:
        array = array.reshape((-1, 1) if column else (1, -1))
    return settle(array)


def _plain(result: Value) -> Numbers:
    if isinstance(result, str):
        raise MatlabError(f"'{result:.40}' is a text, no number")
    if not isinstance(result, np.ndarray):
        if math.isnan(result):
            raise MatlabError("it is not a number (NaN)")
        return float(result)
    array = grid(result).astype(float)
    if not np.isfinite(array).all():
        raise MatlabError("one of its elements is not finite")
    if not array.size:
        return ()
    if 1 in array.shape:
        return tuple(array.ravel().tolist())
    return tuple(tuple(row) for row in array.tolist())
