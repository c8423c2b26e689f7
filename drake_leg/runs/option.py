"""One option of a run: its declaration, and the check of what is given for it.

What an option takes follows from the annotation of its field, which must therefore not be postponed
to a string; values from Python, from the command line and from a YAML file go through the same
check.
"""

import dataclasses
import math
import reprlib
from collections.abc import Collection, Mapping, Set
from contextlib import suppress
from dataclasses import dataclass, field
from numbers import Real
from types import NoneType, UnionType
from typing import Any, get_args, get_origin

from drake_leg.errors import InvalidValueError


@dataclass(frozen=True)
class Numbers:
    """A list of numbers that an option takes."""

    count: int
    words: str  # what they are, with an example


def option(
    default: Any,  # noqa: ANN401
    help_text: str,
    unit: str = "",
    *,
    shown: str = "",
    takes: Numbers | None = None,
    joined: str = "",
) -> Any:  # noqa: ANN401
    """Declare an option: a dataclass field with the text of its help.

    ``shown`` is the default in the help, where the value does not say it; ``takes`` is how many
    numbers a list must have, unless that depends on the robot. A text with ``joined`` may be given
    several times on the command line; its parts are joined by that.
    """
    metadata = {
        "help": help_text,
        "unit": unit,
        "shown": shown,
        "takes": takes,
        "joined": joined,
    }
    if isinstance(default, list):
        return field(default_factory=lambda: list(default), metadata=metadata)
    return field(default=default, metadata=metadata)


def default_of(option: "dataclasses.Field[Any]") -> Any:  # noqa: ANN401
    """Return the default of an option."""
    if option.default_factory is dataclasses.MISSING:
        return option.default
    return option.default_factory()


def type_of(option: "dataclasses.Field[Any]") -> type:
    """Return what an option takes other than None: float, list (of numbers), str or bool."""
    kind: Any = next(kind for kind in _types(option) if kind is not NoneType)
    origin: type = get_origin(kind) or kind
    return origin


def _types(option: "dataclasses.Field[Any]") -> tuple[Any, ...]:
    return get_args(option.type) if isinstance(option.type, UnionType) else (option.type,)


def converted(option: "dataclasses.Field[Any]", value: object) -> object:
    """Convert a value to the type of an option.

    Raises
    ------
    InvalidValueError
        If the option does not take such a value.
    """
    kind = type_of(option)
    if value is None and NoneType in _types(option):
        return None
    if kind is list:
        return _numbers(option, value)
    if kind is float:
        return finite_number(option.name, value)
    if not isinstance(value, kind):
        wanted = "true or false" if kind is bool else "a string"
        raise InvalidValueError(f"{option.name} is {reprlib.repr(value)}; it must be {wanted}")
    return value


def _numbers(option: "dataclasses.Field[Any]", value: object) -> list[float]:
    """Read a list; a single number is a list of one."""
    takes: Numbers | None = option.metadata["takes"]
    words = takes.words if takes else "a list of finite numbers, as [90, -50, -90]"
    items = [value] if isinstance(value, Real) else value
    if isinstance(items, str | bytes | Mapping | Set) or not isinstance(items, Collection):
        raise InvalidValueError(f"{option.name} is {reprlib.repr(value)}; it must be {words}")
    numbers = [_number(option.name, item) for item in items]
    if not all(map(math.isfinite, numbers)) or (takes and len(numbers) != takes.count):
        raise InvalidValueError(f"{option.name} is {numbers}; it must be {words}")
    return numbers


def finite_number(name: str, value: object) -> float:
    """Take a finite number.

    Raises
    ------
    InvalidValueError
        If it is none.
    """
    number = _number(name, value)
    if not math.isfinite(number):
        raise InvalidValueError(f"{name} is {number!r}; it must be a finite number")
    return number


def _number(name: str, value: object) -> float:
    """Refuse texts, though Python would read numbers out of some of them."""
    if not isinstance(value, bool) and isinstance(value, Real):
        with suppress(OverflowError):
            return float(value)
    raise InvalidValueError(f"{name} is {reprlib.repr(value)}; it must be a finite number")
