"""From a block's texts to its values: numbers in SI, options as they stand."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import lru_cache

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import Parameter, known_parameters
from drake_leg.simulink.diagram import DrawnBlock
from drake_leg.simulink.matlab import value
from drake_leg.simulink.model import Value
from drake_leg.simulink.units import parse_unit

_UNIT_SUFFIXES = ("Units", "_unit")
_LIBRARIES = "Simulink, Simscape and Simscape Multibody"


def values_of(block: DrawnBlock) -> dict[str, Value]:
    """Evaluate a block's parameters.

    Parameters
    ----------
    block : DrawnBlock
        With the texts of the file.

    Returns
    -------
    dict
        Name to value. Those that the file leaves out have their defaults; a value with a unit is in
        SI, and so is the unit beside it; what is no number is text. ``Inputs`` of a Sum are its
        signs alone: ``+-``.

    Raises
    ------
    InvalidValueError
        If the block is of no known kind, or a number cannot be evaluated.
    """
    known = known_parameters(block.type, block.source)
    if known is None:
        raise InvalidValueError(_unknown(block))
    texts = block.texts
    if texts.get("Variant") == "on":
        raise InvalidValueError(
            f"{block} is a variant subsystem, whose active choice the file alone does not tell: "
            "put the active choice in its place"
        )
    found: dict[str, Value] = {}
    for parameter in known:
        text = texts.get(parameter.name)
        if text is None:
            text = _counted(block, parameter.name) or parameter.default
        if not parameter.numeric:
            found[parameter.name] = text
            continue
        unit = texts.get(f"{parameter.name}Units", parameter.unit)
        try:
            found[parameter.name] = evaluate(text, unit, parameter.unit)
        except InvalidValueError as error:
            raise InvalidValueError(f"{block}: parameter {parameter.name} {error}") from None
        if parameter.unit:
            found[f"{parameter.name}Units"] = parse_unit(parameter.unit).si
    for name, text in texts.items():
        if name not in found and not name.endswith("_conf"):
            found[name] = text
    _convert_others(block, found, known)
    if block.type == "Sum":
        found["Inputs"] = _signs(str(found["Inputs"]))
    return found


def default_values(block_type: str, source: str) -> Mapping[str, Value]:
    """Return what a block of a kind has before anybody touches it.

    Parameters
    ----------
    block_type : str
        ``BlockType`` in the file.
    source : str
        Library path of a ``Reference``; otherwise "".

    Returns
    -------
    mapping
        Name to value, in SI; empty for a kind that is not known.
    """
    return {
        parameter.name: evaluate(parameter.default, parameter.unit, parameter.unit)
        if parameter.numeric
        else parameter.default
        for parameter in known_parameters(block_type, source) or ()
    }


@lru_cache(maxsize=4096)
def evaluate(text: str, unit: str, quantity: str) -> Value:
    """Evaluate the text of a number and convert it to SI.

    Parameters
    ----------
    text : str
        ``-50/180*pi``, ``[.025 0 0]``; ``auto`` stays text.
    unit : str
        Its unit, as the file says; "" where it has none.
    quantity : str
        Any unit of the same quantity, which `unit` must fit; "" where there is none.

    Returns
    -------
    float, tuple of float, tuple of rows, or str
        In SI.

    Raises
    ------
    InvalidValueError
        If it cannot be evaluated, or the unit does not fit.
    """
    if text.strip() == "auto":
        return "auto"
    try:
        number = value(text)
    except InvalidValueError as error:
        raise InvalidValueError(
            f"is {_shortened(text)}, which cannot be evaluated ({error}): put the number itself "
            "there"
        ) from None
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


def _convert_others(
    block: DrawnBlock, found: dict[str, Value], known: tuple[Parameter, ...]
) -> None:
    """Convert what is in no table but has its unit beside it."""
    done = {parameter.name for parameter in known}
    for suffix in _UNIT_SUFFIXES:
        for key in [key for key in block.texts if key.endswith(suffix)]:
            name = key.removesuffix(suffix)
            if name in done or name not in block.texts:
                continue
            unit = block.texts[key].strip()
            try:
                si = parse_unit(unit).si
            except InvalidValueError:
                continue
            try:
                found[name] = evaluate(block.texts[name], unit, unit)
            except InvalidValueError as error:
                raise InvalidValueError(f"{block}: parameter {name} {error}") from None
            found[key] = si


def _counted(block: DrawnBlock, parameter: str) -> str | None:
    """Return what the file says only by the number of drawn ports."""
    ports = {("Mux", "Inputs"): "in", ("Demux", "Outputs"): "out", ("Scope", "NumInputPorts"): "in"}
    count = block.ports.get(ports.get((block.type, parameter), ""))
    return str(count) if count else None


def _signs(inputs: str) -> str:
    """Return the signs of a Sum, without the bars that move its ports."""
    if re.fullmatch(r"\s*\d{1,3}\s*", inputs):
        return "+" * int(inputs)
    signs = re.sub(r"[\s|]", "", inputs)
    return signs if re.fullmatch(r"[+-]+", signs) else inputs


def _unknown(block: DrawnBlock) -> str:
    if block.type == "Reference" and not block.source:
        return f"{block} names no library block: restore its library link in Simulink"
    if block.type == "Reference":
        return (
            f"{block} comes from {block.source!r}, which is no block of {_LIBRARIES} that is known "
            "here: break its library link (Library Link > Break Link), or replace it"
        )
    if block.type == "ModelReference":
        return f"{block} is another model in a file of its own: copy that model into a subsystem"
    return (
        f"{block} is of type {block.type!r}, which is no block of {_LIBRARIES} that is known here: "
        "replace it, or comment it out"
    )


def _shortened(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")
