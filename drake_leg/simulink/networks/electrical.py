"""The equations of electrical blocks, as Simscape's documentation gives them.

A current is positive where it flows from + to - through its block.
"""

from __future__ import annotations

import math

from drake_leg.simulink.networks.assembly import Bench, element
from drake_leg.simulink.networks.linear import Linear
from drake_leg.simulink.networks.mechanical import free_end, reference

element("Electrical Reference")(reference)
element("Open Circuit")(free_end)


@element("Resistor")
def resistor(b: Bench) -> None:
    """Let a current flow that grows with the voltage."""
    b.zero(b.between("p", "n") - b.number("R", 1.0) * b.through("p", "n"))


@element("Capacitor")
def capacitor(b: Bench) -> None:
    """Hold a voltage, which the current changes."""
    voltage, rate = b.state("vc", start=b.number("v0", 0.0))
    current = b.through("p", "n")
    b.zero(current - b.positive("c", 1e-6) * rate - b.number("g", 0.0) * voltage)
    b.zero(b.between("p", "n") - voltage - b.number("r", 1e-6) * current)


@element("Inductor")
def inductor(b: Bench) -> None:
    """Hold a current, which the voltage changes."""
    held, rate = b.state("i_L", start=b.number("i0", 0.0))
    voltage = b.between("p", "n")
    b.zero(voltage - b.positive("l", 1e-6) * rate - b.number("r", 0.0) * held)
    b.zero(b.through("p", "n") - held - b.number("g", 1e-9) * voltage)


@element("Diode")
def diode(b: Bench) -> None:
    """Let a current through from + to - above a voltage, along two straight lines."""
    b.require("diode_param", "piecewise", "1", "pwl")
    forward, on, off = b.number("Vf", 0.6), b.positive("Ron", 0.3), b.positive("Goff", 1e-8)
    current = b.law(f"diode({{0}}, {forward!r}, {on!r}, {off!r})", b.between("p", "n"))
    b.flow("p", current)
    b.flow("n", -current)


# --- sources ---------------------------------------------------------------------------------


def _hold(b: Bench, voltage: Linear) -> None:
    b.through("p", "n")
    b.zero(b.between("p", "n") - voltage)


def _supply(b: Bench, current: Linear) -> None:
    """Let a current come out at +."""
    b.flow("p", -current)
    b.flow("n", current)


def _wave(b: Bench) -> Linear:
    amplitude, shift = b.number("amp", 10.0), b.number("shift", 0.0)
    frequency = 2.0 * math.pi * b.number("frequency", 60.0)
    return b.law(f"{amplitude!r} * sin({frequency!r} * t + {shift!r})")


@element("DC Voltage Source")
def dc_voltage(b: Bench) -> None:
    """Hold a constant voltage."""
    _hold(b, Linear(b.number("v0", 1.0)))


@element("AC Voltage Source")
def ac_voltage(b: Bench) -> None:
    """Hold a voltage that is a sine of time."""
    _hold(b, _wave(b))


@element("Controlled Voltage Source")
def controlled_voltage(b: Bench) -> None:
    """Hold the voltage that is given."""
    _hold(b, b.input("s"))


@element("DC Current Source")
def dc_current(b: Bench) -> None:
    """Let a constant current come out at +."""
    _supply(b, Linear(b.number("i0", 1.0)))


@element("AC Current Source")
def ac_current(b: Bench) -> None:
    """Let a current come out at + that is a sine of time."""
    _supply(b, _wave(b))


@element("Controlled Current Source")
def controlled_current(b: Bench) -> None:
    """Let the current come out at + that is given."""
    _supply(b, b.input("s"))


@element("Voltage Source")
def voltage_source(b: Bench) -> None:
    """Hold a constant voltage and a sine of time."""
    b.require("noise_flag", "no", "0", "off")
    amplitude, phase = b.number("ac_voltage", 0.0), b.number("ac_shift", 0.0)
    constant = Linear(b.number("dc_voltage", 0.0))
    if amplitude:
        frequency = 2.0 * math.pi * b.number("ac_frequency", 60.0)
        constant += b.law(f"{amplitude!r} * sin({frequency!r} * t + {phase!r})")
    _hold(b, constant)


# --- sensors ---------------------------------------------------------------------------------


@element("Voltage Sensor")
def voltage_sensor(b: Bench) -> None:
    """Put out the voltage between + and -."""
    b.output("V", b.between("p", "n"))


@element("Current Sensor")
def current_sensor(b: Bench) -> None:
    """Put out the current from + to -."""
    b.output("I", b.through("p", "n"))
    b.zero(b.between("p", "n"))


# --- converters ------------------------------------------------------------------------------


@element("Ideal Transformer")
def transformer(b: Bench) -> None:
    """Divide a voltage, and multiply a current, by a ratio."""
    ratio, current = b.number("n", 1.0), b.through("p", "n")
    b.zero(b.between("p", "n") - ratio * b.between("q", "m"))
    b.flow("q", -ratio * current)
    b.flow("m", ratio * current)


@element("Gyrator")
def gyrator(b: Bench) -> None:
    """Make a current of each voltage at the other side."""
    conductance, first, second = b.number("G", 1.0), b.through("p", "n"), b.through("q", "m")
    b.zero(first - conductance * b.between("q", "m"))
    b.zero(second + conductance * b.between("p", "n"))


@element("Rotational Electromechanical Converter", "Translational Electromechanical Converter")
def converter(b: Bench) -> None:
    """Make a torque of a current, and a voltage of a velocity, by one constant."""
    constant, current = b.number("K", 0.1), b.through("p", "n")
    b.zero(b.between("p", "n") - constant * b.between("R", "C"))
    b.flow("R", -constant * current)
    b.flow("C", constant * current)


@element("DC Motor")
def motor(b: Bench) -> None:
    """Turn R by a current through a winding with back-emf, against inertia and damping."""
    b.require("field_option", "pm", "1")
    b.require("enable_fault_armature", "off", "0")
    constant, resistance = _of_winding(b)
    current, rate = b.state("i_L")
    b.zero(b.through("p", "n") - current)
    velocity = b.between("R", "C")
    inductance = b.positive("La", 12e-6)
    b.zero(b.between("p", "n") - resistance * current - inductance * rate - constant * velocity)
    rotor(b, constant * current, velocity, _damping(b, constant, resistance))


def _damping(b: Bench, constant: float, resistance: float) -> float:
    """Return the damping of a motor, or that which a current without load makes up for."""
    ways = {"1": "damping", "damping": "damping", "2": "current", "current": "current"}
    if b.chosen("lam_param", "damping", ways) == "damping":
        return b.number("lam", 0.0)
    current = b.number("i_noload", 0.0)
    back = b.positive("V_i_noload", 1.5) - resistance * current
    if not back > 0.0:
        raise b.fault(f"has the current {current:g} A without load, which its voltage cannot drive")
    return constant**2 * current / back


def _of_winding(b: Bench) -> tuple[float, float]:
    """Return torque constant and resistance, however they are given."""
    ways = {"1": "circuit", "circuit_param": "circuit", "2": "stall", "stalltorque": "stall"}
    how = b.chosen("parameterization", "circuit_param", ways)
    if how == "circuit":
        of_torque = b.text("emf_or_torque", "1") in ("2", "ki")
        constant = b.number("Ki", 6.876e-4) if of_torque else b.number("Kv", 6.876e-4)
        return constant, b.number("Ra", 3.9)
    voltage = b.positive("V_rated", 1.5)
    constant = voltage / b.positive("w_max", 2000.0)
    return constant, constant * voltage / b.positive("T_stall", 2.4e-4)


def rotor(b: Bench, torque: Linear, velocity: Linear, damping: float) -> None:
    """Let a torque turn R relative to C against a rotor's inertia and damping."""
    effort, inertia = b.through("R", "C"), b.number("J", 1e-9)
    effort_of_rotor = damping * velocity - torque
    if inertia:
        turning, rate = b.state("w", start=b.number("speed0", 0.0))
        b.zero(turning - velocity)
        effort_of_rotor += inertia * rate
    b.zero(effort - effort_of_rotor)
