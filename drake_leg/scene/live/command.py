"""What a page may ask for, checked."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

from drake_leg.errors import InvalidValueError

Command = Mapping[str, Any]  # an object of JSON: what to do, under "do", and its numbers

LONGEST_NAME = 40


def deed(command: Command, deeds: Collection[str]) -> str:
    """Read what a command asks for.

    Parameters
    ----------
    deeds : collection of str
        What can be asked for.

    Raises
    ------
    InvalidValueError
        If it asks for something else.
    """
    wanted = command.get("do")
    if not isinstance(wanted, str) or wanted not in deeds:
        raise InvalidValueError(f'"do" must be one of {", ".join(deeds)}')
    return wanted


def numbers_of(command: Command, name: str, count: int) -> list[float]:
    """Read a command's numbers.

    Parameters
    ----------
    name : str
        Under which they are.
    count : int
        How many there must be.

    Raises
    ------
    InvalidValueError
        If they are missing, of another count, or not finite.
    """
    values = command.get(name)
    if (
        not isinstance(values, list)
        or len(values) != count
        or not all(isinstance(value, int | float) and _finite(value) for value in values)
    ):
        raise InvalidValueError(f'"{name}" must be a list of {count} finite numbers')
    return [float(value) for value in values]


def tab_of(command: Command) -> str:
    """Read which page a command comes from.

    Returns
    -------
    str
        A name that the page has given itself.

    Raises
    ------
    InvalidValueError
        If it has none, or a long one.
    """
    tab = command.get("tab")
    if not isinstance(tab, str) or not 0 < len(tab) <= LONGEST_NAME:
        raise InvalidValueError(f'"tab" must be a name of at most {LONGEST_NAME} letters')
    return tab


def _finite(value: float) -> bool:
    try:
        return not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        return False
