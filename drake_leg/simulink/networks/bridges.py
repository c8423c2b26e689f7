"""The equations of bridges and pulse-width modulators, averaged over their pulses.

They are as Simscape's documentation gives them: what a port for control senses draws no current.
"""

from __future__ import annotations

from drake_leg.simulink.networks.assembly import Bench, element

AVERAGED = ("averaged", "2")


@element("Controlled PWM Voltage")
def controlled_pwm(b: Bench) -> None:
    """Hold the mean of pulses, whose width follows a voltage."""
    b.require("ComponentPath", "controlled_pwm")
    b.require("pwm_or_av", *AVERAGED)
    b.require("pulse_width_offset", "0")
    b.require("pulse_min", "0")
    low, high = b.number("Vmin", 0.0), b.number("Vmax", 5.0)
    if not high > low:
        raise b.fault(f"has the Vmax {high:g} V, not more than its Vmin {low:g} V: raise Vmax")
    share = f"min(max(({{0}} - {low!r}) / {high - low!r}, 0.0), 1.0)"
    b.through("p2", "n2")
    b.zero(
        b.between("p2", "n2") - b.law(f"{b.number('Vm', 5.0)!r} * {share}", b.sensed("p1", "n1"))
    )


@element("H-Bridge")
def h_bridge(b: Bench) -> None:
    """Hold a voltage by pulses, of either sign, behind a resistance."""
    b.require("ComponentPath", "h_bridge")
    b.require("supply_ports", "hidesupply", "1")
    b.require("pwm_or_av", *AVERAGED)
    b.require("discontinuous", "continuous", "0")
    if not b.are_one("BRK", "REF"):
        raise b.fault("brakes by a voltage at BRK, which is not computed: connect BRK to REF")
    full = b.number("Vm", 12.0) / b.positive("Vmax", 5.0)
    reverse = b.number("Vreverse", 2.5)
    given = b.law(
        f"{full!r} * {{0}} * (1.0 if {{1}} < {reverse!r} else -1.0)",
        b.sensed("ENA", "REF"),
        b.sensed("REV", "REF"),
    )
    current = b.through("n2", "p2")
    b.zero(b.between("p2", "n2") - given + b.number("Ron", 0.1) * current)
