"""The ports of blocks of one dimension: which connect them, and which carry signals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

from drake_leg.simulink.model import Block

LIBRARIES = (
    "fl_lib",
    "ee_lib",
    "elec_lib",
    "batteryecm_lib",
    "sdl_lib",
)  # of the foundation and its add-ons
ROTOR, TWO = "p R | n C", "R | C"

# Names of the ports at the left | at the right, in the file's order; < takes a signal, > gives one.
_PORTS: Mapping[str, str] = {
    "Mechanical Translational Reference": "V",
    "Mechanical Rotational Reference": "V",
    "Electrical Reference": "V",
    "Translational Free End": "V",
    "Rotational Free End": "V",
    "Open Circuit": "V",
    "Mass": "M | N",
    "Inertia": "M | N",
    "Translational Spring": TWO,
    "Rotational Spring": TWO,
    "Translational Damper": TWO,
    "Rotational Damper": TWO,
    "Translational Friction": TWO,
    "Rotational Friction": TWO,
    "Translational Hard Stop": TWO,
    "Rotational Hard Stop": TWO,
    "Ideal Force Source": "R | S< C",
    "Ideal Torque Source": "R | S< C",
    "Ideal Translational Velocity Source": "R | S< C",
    "Ideal Angular Velocity Source": "R | S< C",
    "Ideal Force Sensor": "R | C F>",
    "Ideal Torque Sensor": "R | C F>",
    "Ideal Translational Motion Sensor": "R | C V> P>",
    "Ideal Rotational Motion Sensor": "R | C V> P>",
    "Gear Box": "S | O",
    "Simple Gear": "S | O",
    "Wheel and Axle": "A | P",
    "Rotational Multibody Interface": "t> C | w< R",
    "Translational Multibody Interface": "t> C | w< R",
    "Resistor": "p | n",
    "Capacitor": "p | n",
    "Inductor": "p | n",
    "Diode": "p | n",
    "DC Voltage Source": "p | n",
    "DC Current Source": "p | n",
    "AC Voltage Source": "p | n",
    "AC Current Source": "p | n",
    "Controlled Voltage Source": "p | s< n",
    "Controlled Current Source": "p | s< n",
    "Voltage Sensor": "p | V> n",
    "Current Sensor": "p | I> n",
    "Ideal Transformer": "p n | q m",
    "Gyrator": "p n | q m",
    "Rotational Electromechanical Converter": ROTOR,
    "Translational Electromechanical Converter": ROTOR,
    "DC Motor": ROTOR,
    "Voltage Source": "p | n",
    "Battery": "p | n",
    "Motor & Drive (System Level)": "p T< R | n w> C",
    "Controlled PWM Voltage": "p1 n1 | p2 n2",
    "H-Bridge": "ENA REF REV BRK | p2 n2",
    "Motor & Drive": "p T< R | n w> C",
}  # fmt: skip
KINDS = tuple(_PORTS)
MOTION_SENSORS = ("Ideal Translational Motion Sensor", "Ideal Rotational Motion Sensor")
_MEASURES = {
    "acceleration_port": "B",
    "velocity_port": "V",
    "position_port": "P",
    "angle_port": "P",
}


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Where the ports of a block are, by their names: ``{"R": "lconn:1"}``."""

    ends: Mapping[str, str]  # connections
    inputs: Mapping[str, str]
    outputs: Mapping[str, str]

    @cached_property
    def signals(self) -> frozenset[str]:
        """Return the ports of signals."""
        return frozenset((*self.inputs.values(), *self.outputs.values()))


def layout_of(block: Block) -> Layout | None:
    """Find the ports of a block; None where it is none of a network of one dimension."""
    if block.source.split("/", 1)[0] not in LIBRARIES or block.kind not in _PORTS:
        return None
    if block.kind in MOTION_SENSORS:
        return _layout(_of_motion_sensor(block))
    texts: Mapping[str, str] = getattr(block.parameters, "texts", {})
    if block.kind == "Battery" and texts.get("charge_measurement_port", "").endswith("yes"):
        return _layout("p q> | n")
    return _layout(_PORTS[block.kind])


def _of_motion_sensor(block: Block) -> str:
    """Find the ports of a sensor, which its options show."""
    texts: Mapping[str, str] = getattr(block.parameters, "texts", {})
    end = "" if texts.get("reference", "").endswith("absolute") else "C "
    if not any(name in texts for name in _MEASURES):
        return f"R | {end}V> P>"
    shown = [f"{letter}>" for name, letter in _MEASURES.items() if texts.get(name) == "true"]
    return f"R | {end}{' '.join(shown)}"


@lru_cache
def _layout(text: str) -> Layout:
    found: dict[str, dict[str, str]] = {"": {}, "<": {}, ">": {}}
    for side, names in zip(("lconn", "rconn"), (*text.split("|"), ""), strict=False):
        for number, name in enumerate(names.split(), 1):
            letter = name.rstrip("<>")
            found[name[len(letter) :]][letter] = f"{side}:{number}"
    return Layout(ends=found[""], inputs=found["<"], outputs=found[">"])
