"""From the text of a number to its value in SI."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import value
from drake_leg.simulink.model import Value
from drake_leg.simulink.scopes import NO_NAMES, Scope, Used, says_infinite
from drake_leg.simulink.units import parse_unit


def evaluate(text: str, unit: str, quantity: str, scope: Scope = NO_NAMES) -> Value:
    """Evaluate the text of a number and convert it to SI.

    Parameters
    ----------
    text : str
        ``-50/180*pi``, ``[.025 0 0]``; ``auto`` stays text.
    unit : str
        Its unit, as the file says; "" where it has none.
    quantity : str
        Any unit of the same quantity, which `unit` must fit; "" where there is none.
    scope : Scope
        Names that the text may use.

    Raises
    ------
    InvalidValueError
        If it cannot be evaluated, or the unit does not fit.
    """
    try:
        used = scope.used_in(text)
    except InvalidValueError as error:
        raise _senseless(text, error) from None
    return _evaluated(text, unit, quantity, used)


def require_finite(
    number: Value, text: str, *, unbounded: bool = False, scope: Scope = NO_NAMES
) -> None:
    """Refuse an infinite number where none makes sense.

    Parameters
    ----------
    unbounded : bool
        Whether it may be infinite, if the text, or a name that it uses, says so.
    scope : Scope
        Names that the text may use.

    Raises
    ------
    InvalidValueError
        If it is infinite, by a word or by an overflow.
    """
    if _is_finite(number):
        return
    said = says_infinite(text) or any(not _is_finite(given) for _, given in scope.used_in(text))
    if not (unbounded and said):
        raise InvalidValueError(
            f"is {_shortened(text)}, which is infinite: put a finite number there"
        )


def _is_finite(number: Value) -> bool:
    if isinstance(number, tuple):
        return all(_is_finite(entry) for entry in number)
    return isinstance(number, str) or math.isfinite(number)


@lru_cache(maxsize=4096)
def _evaluated(text: str, unit: str, quantity: str, used: Used) -> Value:
    if text.strip() == "auto":
        return "auto"
    try:
        number = value(text, dict(used))
    except InvalidValueError as error:
        raise _senseless(text, error) from None
    if not quantity:
        return number
    try:
        scale = parse_unit(unit)
    except InvalidValueError:
        raise InvalidValueError(
            f"has the unit {_shortened(unit)}, which is not known here: choose one like {quantity}"
        ) from None
    if not scale.is_like(parse_unit(quantity)):
        raise InvalidValueError(
            f"has the unit {unit!r}, which measures something else: choose one like {quantity}"
        )
    return _mapped(number, scale.in_si)


def _mapped(number: Value, convert: Callable[[float], float]) -> Value:
    if isinstance(number, tuple):
        return tuple(_mapped(entry, convert) for entry in number)  # type: ignore[return-value]
    return convert(float(number))


def _senseless(text: str, error: InvalidValueError) -> InvalidValueError:
    return InvalidValueError(
        f"is {_shortened(text)}, which cannot be evaluated ({error}): put the number itself there"
    )


def _shortened(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")
