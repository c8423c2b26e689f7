"""The equations of drives and batteries, as Simscape's documentation gives them."""

from __future__ import annotations

from drake_leg.simulink.networks.assembly import Bench, element
from drake_leg.simulink.networks.electrical import rotor

PERCENT = 100.0


@element("Motor & Drive (System Level)", "Motor & Drive")
def motor_and_drive(b: Bench) -> None:
    """Follow a torque that is asked for, within a torque and a power, and draw what that takes."""
    b.require("torque_speed_param", "torque_power", "1")
    b.require("overtorque_param", "no", "1")
    b.require("losses_param", "1", "single")
    b.require("thermal_port", "omit", "off")
    b.require("enable_fault", "off", "0")
    b.require("EnableSwitch", "off", "0")
    most, power = b.positive("torque_max", 0.1), b.positive("power_max", 30.0)
    velocity = b.between("R", "C")
    asked = b.law(f"drive_torque({{0}}, {{1}}, {most!r}, {power!r})", b.input("T"), velocity)
    torque, rate = b.state()
    b.zero(b.positive("Tc", 0.02) * rate + torque - asked)
    rotor(b, torque, velocity, b.number("lam", 0.0))
    b.output("w", velocity)
    base, iron, copper = _losses(b)
    current = b.through("p", "n")
    inside = b.between("p", "n") - b.number("Res", 0.0) * current
    of_torque = f"{{0}} * {{1}} + {copper!r} * {{0}}**2"
    drawn = b.law(
        f"({of_torque} + {iron!r} * {{1}}**2 + {base!r}) / {{2}}", torque, velocity, inside
    )
    b.zero(current - drawn)


def _losses(b: Bench) -> tuple[float, float, float]:
    """Return losses that are constant, and those per velocity squared and per torque squared."""
    velocity, torque = b.positive("w_eff", 392.7), b.positive("T_eff", 0.08)
    efficiency = b.positive("eff", PERCENT) / PERCENT
    base, iron = b.number("Pbase", 0.0), b.number("Piron", 0.0)
    lost = velocity * torque * (1.0 / efficiency - 1.0)
    copper = (lost - base - iron) / torque**2
    if copper < 0.0:
        raise b.fault(
            f"loses {lost:g} W at its measured efficiency, less than the other losses together: "
            "give a lower efficiency, or lower losses"
        )
    return base, iron / velocity**2, copper


@element("Battery")
def battery(b: Bench) -> None:
    """Hold a voltage behind a resistance, which falls with the charge where that is limited."""
    for name in ("prm_dir", "prm_R2", "prm_dyn", "prm_fade", "prm_age", "prm_age_OCV"):
        b.require(name, "1", "no", "disabled")
    b.require("thermal_port", "omit", "off")
    b.heeds("temperature", "num_cycles")
    full = b.positive("Vnom", 12.0)
    current = b.through("p", "n")
    behind = b.between("p", "n") - b.number("R1", 2.0) * current
    if b.chosen("prm_AH", "1", {"1": False, "2": True, "infinite": False, "finite": True}):
        capacity = b.positive("AH", 50.0 * 3600.0)
        charge, rate = b.state("charge", start=capacity)
        b.zero(rate - current)
        b.output("q", charge)
        share = _curvature(b, full, capacity)
        b.zero(
            behind - b.law(f"battery_voltage({{0}} / {capacity!r}, {full!r}, {share!r})", charge)
        )
    else:
        b.zero(behind - full)


def _curvature(b: Bench, full: float, capacity: float) -> float:
    """Find beta, by which the voltage falls to V1 at the charge AH1, and to 0 without charge.

    ``V = full (1 - (1 - beta) y / (1 - beta y))`` at a share y that is missing.
    """
    ratio, missing = b.positive("V1", 11.5) / full, 1.0 - b.number("AH1", 25.0 * 3600.0) / capacity
    if not (0.0 < missing < 1.0 and 1.0 - missing < ratio < 1.0):
        raise b.fault(
            f"has the voltage {ratio * full:g} V at {100 * (1 - missing):g} % of its charge, which "
            f"no curve from {full:g} V to 0 has: choose a voltage in between, above a straight line"
        )
    return (missing - 1.0 + ratio) / (missing * ratio)
