"""Solids whose sizes and mass may change, as far as their inputs are constant."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.mechanism import TO_PHYSICAL
from drake_leg.simulink.model import Block, Model, invalid_parameter, vector
from drake_leg.simulink.wiring import flatten
from drake_leg.units import parse_unit

VARIABLE = ("Variable Spherical Solid", "Variable Cylindrical Solid")
BY_INPUT, OF_MASS, OF_SHAPE = "ProvidedByInput", "CalculateFromMass", "CalculateFromGeometry"
Input = Callable[[str], float]  # value in SI of the physical signal that enters at a port


def constant_inputs(model: Model) -> Input:
    """Return a function that finds the constants which enter physical ports through converters."""
    found: list[_Wiring] = []

    def value(port: str) -> float:
        if not found:
            found.append(_wiring(model))
        blocks, drivers, ends = found[0]
        for end in ends.get(port, ()):
            converter = blocks[end.partition("#")[0]]
            driver = drivers.get(f"{converter.sid}#in:1", "").partition("#")[0]
            if converter.kind == TO_PHYSICAL and driver and blocks[driver].type == "Constant":
                numbers = vector(blocks[driver].parameters.get("Value"))
                if len(numbers) == 1:
                    text = str(converter.parameters.get("Unit", "1"))
                    unit = parse_unit(text) if text not in ("", "1", "inherit") else None
                    return unit.in_si(numbers[0]) if unit else numbers[0]
        return no_inputs(port)

    return value


_Wiring = tuple[dict[str, Block], dict[str, str], dict[str, tuple[str, ...]]]


def _wiring(model: Model) -> _Wiring:
    """Return the blocks by SID, what drives each input, and the connection at each port."""
    flat = flatten(model)
    blocks = {block.sid: block for block in flat.blocks}
    drivers = {wire.target: wire.source for wire in flat.wires}
    return blocks, drivers, {port: node for node in flat.nodes for port in node}


def with_constants(block: Block, given: Input) -> Block:
    """Return a block whose sizes and mass are parameters, where it is a variable solid."""
    if block.kind not in VARIABLE:
        return block
    sizes, mass = sizes_of(block, given)
    values = {**sizes, "Mass": mass}
    constant = {f"{name}Type": "Constant" for name in values}
    return replace(block, parameters={**block.parameters, **values, **constant})


def no_inputs(port: str) -> float:
    """Refuse an input that is no constant."""
    raise InvalidValueError(
        f"it takes a size or its mass from an input, at {port.partition('#')[2]}, that is no "
        "Constant: a body that changes is not built, so make the input constant"
    )


def sizes_of(block: Block, given: Input) -> tuple[Mapping[str, float], float]:
    """Return the sizes [m] and the mass [kg] of a variable solid.

    Raises
    ------
    InvalidValueError
        If an input changes, a value makes no body, or a setting is not known.
    """
    names = ("Radius",) if block.kind == VARIABLE[0] else ("Length", "Radius")
    kinds = {name: str(block.parameters.get(f"{name}Type", "")) for name in (*names, "Mass")}
    inputs = [name for name, kind in kinds.items() if kind == BY_INPUT]
    if {"Length", "Radius"} <= set(inputs):
        raise InvalidValueError(
            f"the block {block.name!r} (SID {block.sid}) takes its length and its radius from "
            "inputs, whose order is not known: make one of them a parameter"
        )
    try:
        values = {
            name: given(f"{block.sid}#lconn:{place}") for place, name in enumerate(inputs, start=1)
        }
    except UnknownValueError:
        raise
    except InvalidValueError as error:
        about = f"the block {block.name!r} (SID {block.sid})"
        raise InvalidValueError(f"{about}: {error}") from None
    for name, kind in kinds.items():
        if kind == "Constant":
            values[name] = _number(block, name)
        elif kind not in (BY_INPUT, OF_SHAPE if name == "Mass" else OF_MASS):
            raise invalid_parameter(block, f"{name}Type", "which is not known: make it constant")
    for name, value in values.items():
        if not 0.0 < value < math.inf:
            raise InvalidValueError(
                f"the block {block.name!r} (SID {block.sid}) has the {name.lower()} {value:g}; it "
                "must be a positive number"
            )
    return _completed(block, names, values)


def _completed(
    block: Block, names: tuple[str, ...], values: dict[str, float]
) -> tuple[Mapping[str, float], float]:
    """Compute the one size, or the mass, that follows from the others and the density."""
    missing = [name for name in (*names, "Mass") if name not in values]
    if not missing:
        return values, values["Mass"]
    if len(missing) > 1:
        raise InvalidValueError(
            f"the block {block.name!r} (SID {block.sid}) calculates more than one of its "
            "sizes and its mass from the others: make one constant"
        )
    density = _number(block, "Density")
    if missing == ["Mass"]:
        return values, density * _volume(values)
    volume = values["Mass"] / density
    if block.kind == VARIABLE[0]:
        values["Radius"] = (3.0 * volume / (4.0 * math.pi)) ** (1.0 / 3.0)
    elif missing == ["Radius"]:
        values["Radius"] = math.sqrt(volume / (math.pi * values["Length"]))
    else:
        values["Length"] = volume / (math.pi * values["Radius"] ** 2)
    return values, values["Mass"]


def _volume(sizes: Mapping[str, float]) -> float:
    """Return the volume of a cylinder, or of a sphere without a length [m^3]."""
    radius = sizes["Radius"]
    if "Length" in sizes:
        return math.pi * radius**2 * sizes["Length"]
    return 4.0 / 3.0 * math.pi * radius**3


def _number(block: Block, name: str) -> float:
    numbers = vector(block.parameters.get(name))
    if len(numbers) != 1 or not numbers[0] > 0.0:
        raise invalid_parameter(block, name, "it must be a positive number")
    return numbers[0]
