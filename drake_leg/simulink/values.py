"""Numbers out of a block's parameters, and the complaint about those that make no sense."""

from __future__ import annotations

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, Value


def vector(value: Value | None) -> tuple[float, ...]:
    """Read numbers as a vector.

    Parameters
    ----------
    value : Value or None
        A parameter.

    Returns
    -------
    tuple of float
        Empty where it is no vector of numbers.
    """
    if isinstance(value, int | float):
        return (float(value),)
    if isinstance(value, tuple):
        return tuple(float(one) for one in np.array(value, dtype=float).ravel())
    return ()


def number(value: Value | None, default: float = 0.0) -> float:
    """Read a parameter as one number.

    Parameters
    ----------
    value : Value or None
        A parameter.
    default : float
        Where it is none.
    """
    numbers = vector(value)
    return numbers[0] if len(numbers) == 1 else default


def senseless(block: Block, name: str, why: str) -> InvalidValueError:
    """Make the error of a parameter that makes no sense.

    Parameters
    ----------
    why : str
        What it must be.

    Returns
    -------
    InvalidValueError
        To be raised; it says which block it is, and what the parameter is now.
    """
    return InvalidValueError(
        f"the block {block.name!r} (SID {block.sid}) has {name} "
        f"{block.parameters.get(name)!r}; {why}"
    )


def is_on(block: Block, switch: str) -> bool:
    """Tell whether a switch of a block is on."""
    return block.parameters.get(switch) == "on"
