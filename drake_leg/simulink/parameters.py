"""From a block's texts to its values: numbers in SI, options as they stand."""

from __future__ import annotations

import re
from collections.abc import Mapping

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue.blocks import known_parameters
from drake_leg.simulink.diagram import DrawnBlock
from drake_leg.simulink.evaluation import Names, evaluate, require_finite
from drake_leg.simulink.model import Value
from drake_leg.units import parse_unit

_UNIT_SUFFIXES = ("Units", "_unit")
_LIBRARIES = "Simulink, Simscape and Simscape Multibody"


def values_of(block: DrawnBlock, names: Names) -> dict[str, Value]:
    """Evaluate a block's parameters, those included that its mask adds.

    Those that the file leaves out have their defaults; a value with a unit is in SI, and so is the
    unit beside it; what is not a number is text. ``Inputs`` of a Sum are its signs alone: ``+-``.

    Raises
    ------
    InvalidValueError
        If the block is of no known kind, or a number cannot be evaluated, or is infinite where
        none can be.
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
    others = dict(texts)
    for parameter in known:
        others.pop(parameter.name, None)
        name = next((name for name in parameter.names if name in texts), parameter.name)
        text = texts.get(name)
        if text is None:
            text = _counted(block, parameter.name) or parameter.default
        if not parameter.numeric:
            found[parameter.name] = text
            continue
        unit = texts.get(f"{name}Units", parameter.unit)
        try:
            number = evaluate(text, unit, parameter.unit, names)
            require_finite(number, text, unbounded=parameter.unbounded, names=names)
        except InvalidValueError as error:
            raise InvalidValueError(f"{block}: parameter {name} {error}") from None
        found[parameter.name] = number
        if parameter.unit:
            found[f"{parameter.name}Units"] = parse_unit(parameter.unit).si
        for spelled in parameter.names:
            others.pop(spelled, None)
            others.pop(f"{spelled}Units", None)
    for name, text in others.items():
        if name not in found and not name.endswith("_conf"):
            found[name] = text
    _convert_others(block, others, found, names)
    for name, text in block.mask.values.items():
        if name not in {parameter.name for parameter in known}:
            found[name] = names.numbers.get(name, text)
    if block.type == "Sum":
        found["Inputs"] = _signs(str(found["Inputs"]))
    return found


def default_values(block_type: str, source: str) -> Mapping[str, Value]:
    """Return a kind's defaults by name, in SI; a kind that is not known has none."""
    return {
        parameter.name: evaluate(parameter.default, parameter.unit, parameter.unit)
        if parameter.numeric
        else parameter.default
        for parameter in known_parameters(block_type, source) or ()
    }


def _convert_others(
    block: DrawnBlock, others: Mapping[str, str], found: dict[str, Value], names: Names
) -> None:
    """Convert parameters that are not in the catalogue but have a unit."""
    for suffix in _UNIT_SUFFIXES:
        for key in [key for key in others if key.endswith(suffix)]:
            name = key.removesuffix(suffix)
            if name not in others:
                continue
            unit = others[key].strip()
            try:
                si = parse_unit(unit).si
            except InvalidValueError:
                continue
            try:
                found[name] = evaluate(others[name], unit, unit, names)
                require_finite(found[name], others[name], unbounded=True, names=names)
            except InvalidValueError as error:
                raise InvalidValueError(f"{block}: parameter {name} {error}") from None
            found[key] = si


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


def _unknown(block: DrawnBlock) -> str:
    if block.type == "Reference" and not block.source:
        return f"{block} names no library block: restore its library link in Simulink"
    if block.type == "Reference":
        return (
            f"{block} comes from {block.source!r}, which is not a known block of {_LIBRARIES}: "
            "break its library link (Library Link > Break Link), or replace it"
        )
    if block.type == "ModelReference":
        return f"{block} is another model in a file of its own: copy that model into a subsystem"
    return (
        f"{block} is of type {block.type!r}, which is not a known block of {_LIBRARIES}: "
        "replace it, or comment it out"
    )
