"""Laws of networks that are not linear, as Simscape's documentation gives them."""

from __future__ import annotations

import math


def friction(
    velocity: float, breakaway: float, coulomb: float, viscous: float, threshold: float
) -> float:
    """Return the Stribeck, Coulomb and viscous friction at a velocity.

    ``threshold`` is the velocity at which it is the breakaway friction.
    """
    share = velocity / (math.sqrt(2.0) * threshold)
    stribeck = math.sqrt(2.0 * math.e) * (breakaway - coulomb) * share * math.exp(-share * share)
    return stribeck + coulomb * math.tanh(10.0 * velocity / threshold) + viscous * velocity


def hard_stop(
    place: float,
    velocity: float,
    low: float,
    high: float,
    stiff_low: float,
    stiff_high: float,
    damped_low: float,
    damped_high: float,
    width: float,
    is_free_to_leave: bool,
) -> float:
    """Return the force of a stop at two bounds.

    It grows to its full size over a ``width`` beyond a bound; damping does not hold what leaves, if
    that ``is_free_to_leave``.
    """
    if place >= high:
        depth, stiff, damped, leaves = place - high, stiff_high, damped_high, velocity < 0.0
    elif place <= low:
        depth, stiff, damped, leaves = place - low, stiff_low, damped_low, velocity > 0.0
    else:
        return 0.0
    full = stiff * depth + (0.0 if is_free_to_leave and leaves else damped * velocity)
    share = min(abs(depth) / width, 1.0) if width else 1.0
    return full * share**2 * (3.0 - 2.0 * share)


def diode(voltage: float, forward: float, on: float, off: float) -> float:
    """Return the current of a diode of a resistance ``on`` above a forward voltage.

    Below, it has the conductance ``off``.
    """
    if voltage > forward:
        return (voltage - forward * (1.0 - on * off)) / on
    return voltage * off


def drive_torque(asked: float, velocity: float, most: float, power: float) -> float:
    """Return a torque that is asked for, within a torque and a power."""
    bound = min(most, power / abs(velocity)) if velocity else most
    return min(max(asked, -bound), bound)


def battery_voltage(share: float, full: float, curvature: float) -> float:
    """Return the voltage of a battery without load, by the share of its charge that is left."""
    missing = 1.0 - share
    return full * (1.0 - (1.0 - curvature) * missing / (1.0 - curvature * missing))
