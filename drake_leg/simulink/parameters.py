"""From a block's texts to its values: numbers in SI, with the names of the masks around it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache, partial

from drake_leg.errors import GIVE_A_VALUE, InvalidValueError, UnknownValueError
from drake_leg.simulink.catalogue import Parameter, known_parameters
from drake_leg.simulink.diagram import DrawnBlock
from drake_leg.simulink.linking import NO_FILE
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.program import in_shape, value
from drake_leg.simulink.model import Parameters, Value
from drake_leg.simulink.scopes import Scope, says_infinite
from drake_leg.units import parse_unit

_NAMED = re.compile(r"[A-Za-z]")
_ENUMERATION = re.compile(r"[a-z]+\.enum\.")  # a choice of Simscape: foundation.enum.numPorts2.one


def evaluate(text: str, unit: str, quantity: str, scope: Scope | None = None) -> Value:
    """Evaluate the text of a number, such as ``[.025 0 0]``, and convert it to SI.

    The unit must fit ``quantity``, any unit of the same quantity; both are "" where there is none.
    ``auto`` stays text.
    """
    if text.strip() == "auto":
        return "auto"
    if scope is None or not _NAMED.search(text):
        return _evaluated(text, unit, quantity)
    try:
        number = scope.numbers(text)
    except InvalidValueError as error:
        raise _not_evaluated(text, error) from None
    return _in_si(number, unit, quantity)


def require_finite(
    number: Value, text: str, *, unbounded: bool = False, scope: Scope | None = None
) -> None:
    """Refuse an infinite number, unless it may be so and the text, or a name in it, says so."""
    if _is_finite(number):
        return
    said = scope.says_infinite(text) if scope else says_infinite(text)
    if not (unbounded and said):
        raise InvalidValueError(
            f"is {_shortened(text)}, which is infinite: put a finite number there"
        )


def _is_finite(number: Value) -> bool:
    if isinstance(number, tuple):
        return all(_is_finite(entry) for entry in number)
    return isinstance(number, str) or math.isfinite(number)


@lru_cache(maxsize=4096)
def _evaluated(text: str, unit: str, quantity: str) -> Value:
    try:
        number = value(text, unbounded=True)
    except InvalidValueError as error:
        raise _not_evaluated(text, error) from None
    return _in_si(number, unit, quantity)


def _in_si(number: Value, unit: str, quantity: str) -> Value:
    if not quantity:
        return number
    try:
        scale = parse_unit(unit)
    except InvalidValueError:
        raise InvalidValueError(
            f"has the unit {_shortened(unit)}, which is not supported: choose one like {quantity}"
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


def _not_evaluated(text: str, error: InvalidValueError) -> InvalidValueError:
    names: tuple[str, ...] = getattr(error, "names", ())
    problem = f"is {_shortened(text)}, which cannot be evaluated ({error})"
    if not names:
        return InvalidValueError(f"{problem}: put the number itself there")
    listed = ", ".join(names)
    return UnknownValueError(problem, names=names, advice=GIVE_A_VALUE + listed)


def _shortened(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")


# --- values of parameters --------------------------------------------------------------------

_UNIT_SUFFIXES = ("Units", "_unit")


def values_of(block: DrawnBlock, scope: Scope) -> Parameters:
    """Read a block's parameters, those included that its mask adds.

    Those that the file leaves out have their defaults; what is not a number is text. ``Inputs`` of
    a Sum are its signs alone: ``+-``. Of a block of no known kind, what has no unit is text.
    """
    known = known_parameters(block.type, block.source) or ()
    texts = block.texts
    found = Parameters(scope.evaluate)
    found.texts = {parameter.name: parameter.default for parameter in known} | texts
    found.texts |= block.mask.values
    others = dict(texts)
    for parameter in known:
        others.pop(parameter.name, None)
        name = next((name for name in parameter.names if name in texts), parameter.name)
        text = texts.get(name)
        if text is None:
            text = _counted(block, parameter.name) or parameter.default
        if not parameter.numeric:
            found.add(parameter.name, text)
            continue
        found.add(parameter.name, partial(_number, block, parameter, name, text, scope))
        if parameter.unit:
            found.add(f"{parameter.name}Units", parse_unit(parameter.unit).si)
        for spelled in parameter.names:
            others.pop(spelled, None)
            others.pop(f"{spelled}Units", None)
    for name, text in others.items():
        if name not in found and not name.endswith("_conf"):
            found.add(name, text)
    _add_others(block, others, found, scope)
    for name, text in block.mask.values.items():
        if name not in {parameter.name for parameter in known}:
            found.add(name, partial(_of_mask, name, text, scope))
    if block.type == "Sum":
        found.add("Inputs", _signs(str(found["Inputs"])))
    return found


def _of_mask(name: str, text: str, scope: Scope) -> Value:
    """Value of a mask's parameter, or its text where it is no numbers."""
    if name not in scope.values:
        return text
    try:
        return in_shape(scope.values[name])
    except MatlabError:
        return text


def _number(block: DrawnBlock, parameter: Parameter, name: str, text: str, scope: Scope) -> Value:
    unit = block.texts.get(f"{name}Units", parameter.unit)
    with complaining(f"{block}: parameter {name}", text):
        number = evaluate(text, unit, parameter.unit, scope)
        require_finite(number, text, unbounded=parameter.unbounded, scope=scope)
    return number


@contextmanager
def complaining(about: str, text: str) -> Iterator[None]:
    """Say of what an error complains."""
    try:
        yield
    except InvalidValueError as error:
        names = getattr(error, "names", ())
        raise UnknownValueError(
            f"{about} {error.problem}", names=names, text=text, advice=error.advice
        ) from None


def default_values(block_type: str, source: str) -> Mapping[str, Value]:
    """Return a kind's defaults by name, in SI; a kind that is not known has none."""
    return {
        parameter.name: evaluate(parameter.default, parameter.unit, parameter.unit)
        if parameter.numeric
        else parameter.default
        for parameter in known_parameters(block_type, source) or ()
    }


def _add_others(
    block: DrawnBlock, others: Mapping[str, str], found: Parameters, scope: Scope
) -> None:
    """Add parameters that are not in the catalogue but have a unit."""
    for suffix in _UNIT_SUFFIXES:
        for key in [key for key in others if key.endswith(suffix)]:
            name = key.removesuffix(suffix)
            unit = others[key].strip()
            try:
                si = parse_unit(unit).si
            except InvalidValueError:
                continue
            if name in others and not _ENUMERATION.match(others[name]):
                parameter = Parameter(
                    name=name, default="", numeric=True, unit=unit, unbounded=True
                )
                evaluated = partial(_number, block, parameter, name, others[name], scope)
                found.add(name, evaluated)
                found.add(key, si)


def _counted(block: DrawnBlock, parameter: str) -> str | None:
    """Return what the file states only by the number of drawn ports."""
    ports = {("Mux", "Inputs"): "in", ("Demux", "Outputs"): "out", ("Names", "NumInputPorts"): "in"}
    count = block.ports.get(ports.get((block.type, parameter), ""))
    return str(count) if count else None


def _signs(inputs: str) -> str:
    """Return the signs of a Sum, without the bars that move its ports."""
    if re.fullmatch(r"\s*\d{1,3}\s*", inputs):
        return "+" * int(inputs)
    signs = re.sub(r"[\s|]", "", inputs)
    return signs if re.fullmatch(r"[+-]+", signs) else inputs


_LIBRARIES = "Simulink, Simscape and Simscape Multibody"
_OF_SIGNALS = (  # libraries of products that are in no model's folder, in small letters
    "simulink", "simulink_extras", "signaleditorblocklib", "robotmaniplib", "robotmobilelib",
    "robotroslib", "uavalgslib", "mpclib", "visionlib", "fuzblock", "vrlib", "slcontrollib",
    "dspsigops", "dspsrcs4", "dspstat3", "dsparch4", "arduinolib",
)  # fmt: skip
_OF_PHYSICS = ("fl_lib", "sm_lib", "ee_lib", "sdl_lib", "sh_lib", "powerlib", "elec_lib")


def why_unknown(block: DrawnBlock) -> str:
    """Say why a block is of no known kind; "" where it is known."""
    if block.type == "Reference" and not block.source:
        return f"{block} names no library block: restore its library link in Simulink"
    if block.type == "ModelReference" or (block.unlinked and block.type != "Reference"):
        return (
            f"{block} is a diagram in a file of its own ({block.unlinked or 'it names none'}): put "
            "the file beside the model, or give the folder where it lies"
        )
    if block.undecided:
        return (
            f"{block} is a variant subsystem, and {block.undecided}: choose one of its variants by "
            "name"
        )
    if known_parameters(block.type, block.source) is not None:
        return ""
    library = block.source.partition("/")[0].lower()
    if block.unlinked.startswith(NO_FILE) and library in (*_OF_SIGNALS, *_OF_PHYSICS):
        signals = "let `replace` say what it puts out instead"
        return (
            f"{block} is {block.source!r} of a product, which is not computed here: "
            f"{signals if library in _OF_SIGNALS else 'comment it out'}"
        )
    if block.type == "Reference":
        return (
            f"{block} comes from {block.source!r}, which is not a known block of {_LIBRARIES}, "
            f"and {block.unlinked}: put its library beside the model, or give the folder "
            "where it lies"
        )
    return (
        f"{block} is of type {block.type!r}, which is not a known block of {_LIBRARIES}: "
        "let `replace` say what it puts out instead"
    )
