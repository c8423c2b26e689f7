"""Checks arguments against their annotations, and refuses a wrong one in a sentence."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import cache, wraps
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import (
    TYPE_CHECKING,
    Literal,
    ParamSpec,
    TypeGuard,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from drake_leg.errors import InvalidValueError, did_you_mean

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = ParamSpec("P")
R = TypeVar("R")

_VOWEL = re.compile(r"(?!MATLAB)([AEIOaeio]|Up|[FHLMNRSX](?![a-z]))")
MOST_SHOWN = 60  # characters of a value
MOST_DIGITS = 20  # of an integer; a greater one is written as 1e+20
MOST_PARTS = 6  # of a list or a tuple that is written part by part
WORDS: dict[object, str] = {
    bool: "True or False",
    float: "a number",
    int: "a whole number",
    str: "text",
    NoneType: "None",
}
# By the name of a class: how to get an object of it.
BUILDERS = {
    "EllipseConfig": "build_ellipse",
    "HexabotLegConfig": "build_hexabot_leg",
    "PendulumConfig": "build_pendulum",
    "ScaraConfig": "build_scara",
}
ADVICE = {
    "Control": "make one, as Control(inverse=Inverse(method='damped')), with "
    "from drake_leg.diagrams.additions import Control and "
    "from drake_leg.singularity.inverse import Inverse",
    "Disturbance": "make one, as Disturbance(mass_error=0.2), with "
    "from drake_leg.diagrams.disturbance import Disturbance",
    "Diagram": "build one, as build_pendulum(PendulumConfig())",
    "DiagramBuilder": "make one with pydrake.systems.framework.DiagramBuilder()",
    "EllipticStep": "make one, as EllipticStep(lift=0.03)",
    "Frame": "take one from the plant, as plant.GetFrameByName('foot')",
    "IntegratorSettings": "make one, as IntegratorSettings(scheme='radau3'), with "
    "from drake_leg.simulation.integrator import IntegratorSettings",
    "Inverse": "make one, as Inverse(method='damped'), with "
    "from drake_leg.singularity.inverse import Inverse",
    "MultibodyPlant": "make one with build_plant(robot)",
    "OutputPort": "take one from a block, as block.get_output_port()",
    "Robot": "take one from drake_leg, such as LEG_B, or load one with load_robot",
    "Servo": "take one from drake_leg.robot.servos, such as XL430, or load one with load_servo of "
    "drake_leg.robot.toml.servo",
    "SineStep": "make one, as SineStep(amplitude=0.05)",
} | {
    config: f"give {config}(robot=...), as {build}({config}())"
    for config, build in BUILDERS.items()
}


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function refuse arguments that are not of the types of its annotations.

    Numbers, text, classes, tuples and choices of these are checked; other types are not.
    """
    signature = inspect.signature(function)

    @wraps(function)
    def checking(*arguments: P.args, **keywords: P.kwargs) -> R:
        try:
            given = signature.bind(*arguments, **keywords).arguments
        except TypeError as error:
            raise _unlike(function, signature, error, len(arguments), keywords) from None
        _require_types(given, _hints(function))
        return function(*arguments, **keywords)

    return checking


def require_fields(data: DataclassInstance) -> None:
    """Refuse a dataclass with a field that is not of the type of its annotation.

    A list or an array in the place of a tuple becomes a tuple.

    Raises
    ------
    InvalidValueError
        With the value.
    """
    values, hints = {f.name: getattr(data, f.name) for f in fields(data)}, _hints(type(data))
    _require_types(values, hints)
    for name, value in values.items():
        if get_origin(hints[name]) is tuple and not isinstance(value, tuple):
            object.__setattr__(data, name, tuple(value))


def require_callable(name: str, value: object) -> None:
    """Refuse an optional function that cannot be called."""
    if value is not None and not callable(value):
        raise InvalidValueError(f"{name} is {shown(value)}; it must be a function")


def require_kind(what: str, value: object, *kinds: type, advice: str | None = None) -> None:
    """Refuse what is an instance of none of these classes; by default, say how to get one."""
    if not isinstance(value, kinds):
        names = " or ".join(kind.__name__ for kind in kinds).replace("NoneType", "None")
        raise InvalidValueError(
            f"{what} is {shown(value)}; it must be {with_article(names)}",
            advice=_advice(*kinds) if advice is None else advice,
        )


def is_number(value: object) -> bool:
    """Whether a value is a real number that fits into a float, and neither True nor False."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        float(value)
    except OverflowError:
        return False
    return True


def shown(value: object) -> str:
    """Write a value in a line, or its type if that is too long to read."""
    if _is_long(value):
        return f"{float(value):g}" if is_number(value) else "an integer too large for a float"
    if isinstance(value, list | tuple) and len(value) <= MOST_PARTS and any(map(_is_long, value)):
        text = ", ".join(map(shown, value))
        return f"[{text}]" if isinstance(value, list) else f"({text})"
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # of an integer in it, with thousands of digits
        text = ""
    if text and len(text) <= MOST_SHOWN and "object at 0x" not in text:
        return text
    return with_article(type(value).__name__)


def printable(text: str) -> str:
    """Write control characters out, so that a name cannot speak to the terminal."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else f"\\x{ord(sign):02x}" for sign in text)


def counted(number: int, noun: str) -> str:
    """Write a number with what is counted: ``1 column``, ``2 columns``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def some_of(names: Sequence[str], most: int, between: str = ", ") -> str:
    """Name the first of some names, at most so many, and count the others."""
    shown = between.join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def with_article(noun: str) -> str:
    """Put the indefinite article before a noun, as it is said: ``an S-Function``, ``a Gain``."""
    return f"{'an' if _VOWEL.match(noun) else 'a'} {noun}"


def quoted(text: str) -> str:
    """Quote a text, its backslashes as they are typed."""
    return repr(text).replace("\\\\", "\\")


def _is_long(value: object) -> TypeGuard[int]:
    """Whether a value is an integer of more digits than a reader counts."""
    return isinstance(value, int) and abs(value) >= 10**MOST_DIGITS


@cache
def _hints(owner: type | Callable[..., object]) -> Mapping[str, object]:
    return get_type_hints(owner)


def _require_types(values: Mapping[str, object], hints: Mapping[str, object]) -> None:
    for name, value in values.items():
        hint = hints.get(name, object)
        if not _fits(value, hint):
            raise InvalidValueError(
                f"{name} is {shown(value)}; it must be {_words(hint)}", advice=_advice(hint)
            )


def _unlike(
    function: Callable[..., object],
    signature: inspect.Signature,
    error: TypeError,
    count: int,
    keywords: Mapping[str, object],
) -> InvalidValueError:
    """Say which arguments are missing from a call of ``count`` and keywords, or too many."""
    known = list(signature.parameters)
    missing = [
        name
        for name, parameter in list(signature.parameters.items())[count:]
        if parameter.default is parameter.empty and name not in keywords
    ]
    strange = [name for name in keywords if name not in known]
    if strange:
        problem = f"has no argument {strange[0]!r}; it takes {', '.join(known)}"
    elif missing:
        problem = f"needs {' and '.join(missing)}"
    else:
        problem = f"takes {', '.join(known)} ({error})"
    advice = _advice(_hints(function)[missing[0]]) if missing else ""
    if strange and not advice:
        advice = did_you_mean(strange[0], known)
    return InvalidValueError(f"{_called(function)} {problem}", advice=advice)


def _called(function: Callable[..., object]) -> str:
    """Name a function as drake_leg offers it: ``build`` of ``pendulum`` is ``build_pendulum``."""
    name = function.__name__
    return f"build_{function.__module__.rpartition('.')[2]}" if name == "build" else name


def _advice(*hints: object) -> str:
    """Say how to get an object of the first of these types for which that is known."""
    classes = [getattr(each, "__name__", "") for hint in hints for each in _choices(hint)]
    return next((ADVICE[each] for each in classes if each in ADVICE), "")


def _choices(hint: object) -> tuple[object, ...]:
    return get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)


def _fits(value: object, hint: object) -> bool:
    if get_origin(hint) in (Union, UnionType):
        return any(_fits(value, each) for each in get_args(hint))
    if get_origin(hint) is Literal:
        return any(value is each or value == each for each in get_args(hint))
    if get_origin(hint) is tuple:
        return _fits_tuple(value, get_args(hint))
    if hint in (int, float):
        return is_number(value) and isinstance(value, Integral if hint is int else Real)
    return isinstance(value, hint) if isinstance(hint, type) else True


def _fits_tuple(value: object, parts: tuple[object, ...]) -> bool:
    """Tell whether a sequence of any kind has these parts; lists and arrays do, too."""
    if isinstance(value, str | Mapping):
        return False
    try:
        found = list(value)  # type: ignore[call-overload]
    except TypeError:
        return False
    if parts[-1] is Ellipsis:
        return all(_fits(each, parts[0]) for each in found)
    return len(found) == len(parts) and all(map(_fits, found, parts))


def _words(hint: object) -> str:
    if get_origin(hint) in (Union, UnionType):
        return " or ".join(map(_words, get_args(hint)))
    if get_origin(hint) is Literal:
        return " or ".join(map(repr, get_args(hint)))
    if get_origin(hint) is tuple:
        parts = get_args(hint)
        return "a tuple of numbers" if parts[-1] is Ellipsis else f"{len(parts)} numbers"
    name = getattr(hint, "__name__", str(hint))
    return WORDS.get(hint) or with_article(name)
