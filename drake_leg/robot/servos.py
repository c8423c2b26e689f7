"""Servos as data: a motor with its gear, and the position controller inside of it.

The controller asks for a drive torque, at most the stall torque. The motor has that less
``back_emf_damping * speed``: at full voltage the line from the stall torque to the no-load speed.
The gear's friction and the acceleration of the rotor come off the motor's torque.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import require_line
from drake_leg.units import parse_unit, require_finite, require_non_negative, require_positive

# Of the DYNAMIXEL X series, by the vendor's manual: positions are counted in parts of a turn, the
# P gain is divided by 128, and the controller's output at full voltage is 885.
TICKS, GAIN_DIVISOR, FULL_OUTPUT = 4096, 128, 885
GREATEST_GAIN = 16_383

# A simulated gear that sticks creeps under a load: at the limit of its friction f with f over this,
# an XL430's with 40 microradians per second.
CREEP_DAMPING = 1e3  # [N*m*s/rad]

_UNITS = {
    "stall_torque": "N*m",
    "no_load_speed": "rad/s",
    "stiffness": "N*m/rad",
    "damping": "N*m*s/rad",
    "rotor_inertia": "kg*m^2",
    "friction": "N*m",
    "torque_constant": "N*m/A",
    "resistance": "Ohm",
    "voltage": "V",
}
_MAY_BE_ZERO = ("damping", "rotor_inertia", "friction")
_MAY_BE_UNKNOWN = ("torque_constant", "resistance", "voltage")


@dataclass(frozen=True, kw_only=True)
class Servo:
    """A position servo, seen at its output.

    Parameters
    ----------
    name : str
        As on the command line.
    source : str
        Where its numbers come from.
    stall_torque : float
        Of the motor at full voltage and at rest [N*m].
    no_load_speed : float
        At which the motor at full voltage has no torque [rad/s].
    stiffness : float
        Drive torque for an error of position [N*m/rad].
    damping : float
        Drive torque for an error of speed [N*m*s/rad], from the controller.
    rotor_inertia : float
        Of rotor and gears [kg*m^2].
    friction : float
        Dry friction of the gear [N*m].
    torque_constant : float, optional
        Torque for a current [N*m/A], with the gear's losses.
    resistance : float, optional
        Between the terminals [Ohm].
    voltage : float, optional
        Of the supply, to which stall torque and no-load speed belong [V].

    Raises
    ------
    InvalidValueError
        If a number is invalid, or only one of torque constant and resistance is given.

    Examples
    --------
    >>> from drake_leg.robot.servos import XL430
    >>> round(XL430.back_emf_damping, 3)  # [N*m*s/rad]
    0.235
    >>> round(XL430.with_gain(640).stiffness, 2)  # [N*m/rad]
    5.52
    """

    name: str
    source: str
    stall_torque: float  # [N*m]
    no_load_speed: float  # [rad/s]
    stiffness: float  # [N*m/rad]
    damping: float  # [N*m*s/rad]
    rotor_inertia: float  # [kg*m^2]
    friction: float = 0.0  # [N*m]
    torque_constant: float | None = None  # [N*m/A]
    resistance: float | None = None  # [Ohm]
    voltage: float | None = None  # [V]

    def __post_init__(self) -> None:
        require_kind("the name of a servo", self.name, str)
        if not self.name:
            raise InvalidValueError("the name of a servo is empty; it must be a word")
        require_line("the name of a servo", self.name)
        require_line("the source of a servo", self.source)
        for field, unit in _UNITS.items():
            value, what = getattr(self, field), f"the servo's {field}"
            if value is None and field in _MAY_BE_UNKNOWN:
                continue
            check = require_non_negative if field in _MAY_BE_ZERO else require_positive
            check(what, value, unit)
        if self.friction >= self.stall_torque:
            raise InvalidValueError(
                f"the servo's friction is {self.friction:g} N*m and its stall_torque "
                f"{self.stall_torque:g} N*m; a servo that moves has less friction than torque"
            )
        given = [f for f in ("torque_constant", "resistance") if getattr(self, f) is not None]
        if len(given) == 1:
            raise InvalidValueError(
                f"the servo has a {given[0]} alone; give torque_constant and resistance, or neither"
            )

    @property
    def back_emf_damping(self) -> float:
        """Torque that the motor loses for each speed [N*m*s/rad]: the slope of its line."""
        return self.stall_torque / self.no_load_speed

    @property
    def is_electrical(self) -> bool:
        """Whether current and electrical power are known."""
        return self.torque_constant is not None

    def with_gain(self, gain: float) -> Self:
        """Return the servo with the stiffness of a DYNAMIXEL's Position P Gain, 1 to 16383."""
        return replace(self, stiffness=dynamixel_stiffness(gain, self.stall_torque))


def dynamixel_stiffness(gain: float, stall_torque: float) -> float:
    """Stiffness [N*m/rad] of the position controller of a DYNAMIXEL, by its Position P Gain.

    A turn has 4096 counts. The controller's output is the error in counts times gain / 128; at 885
    the motor has its full voltage, and its stall torque.
    """
    require_finite("the gain", gain)
    if not 0.0 < gain <= GREATEST_GAIN:
        raise InvalidValueError(
            f"the gain is {float(gain):g}; a DYNAMIXEL's Position P Gain is more than 0 and at "
            f"most {GREATEST_GAIN}"
        )
    output = gain / GAIN_DIVISOR * TICKS / (2.0 * math.pi)  # for an error of one radian
    return output / FULL_OUTPUT * stall_torque


# The XL430-W250 by its manual: 1.5 N*m at 12 V and 1.4 A, 61 rpm.
_STALL, _STALL_CURRENT, _SUPPLY = 1.5, 1.4, 12.0  # [N*m], [A], [V]
_NO_LOAD = parse_unit("rpm").in_si(61.0)  # [rad/s]
_MANUAL = "ROBOTIS e-manual of the XL430-W250 (stall 1.5 N*m, 1.4 A and 61 rpm at 12 V)"

# The XL430's motor, with a controller that no such servo has: 40 N*m/rad hold a load of 1 N*m to
# 1.4 degrees, and 1.2 N*m*s/rad, with the motor's own 0.235, damp the rotor critically:
# 2 sqrt(40 * 0.012) = 1.39.
IDEAL = Servo(
    name="ideal",
    source=f"stiff controller, chosen; motor: {_MANUAL}; rotor as the XL430's here",
    stall_torque=_STALL,
    no_load_speed=_NO_LOAD,
    stiffness=40.0,
    damping=1.2,
    rotor_inertia=0.012,
    torque_constant=_STALL / _STALL_CURRENT,
    resistance=_SUPPLY / _STALL_CURRENT,
    voltage=_SUPPLY,
)

# The manual has neither friction nor inertia. The friction is the part of the stall torque that was
# identified for the XL330, which has plastic gears, too: 0.0128 of 0.387 N*m/A * 5 V / 4.017 Ohm.
# The rotor's inertia is that identified for the MX-64. The manual does not say over which time the
# controller's D gain takes its difference, so there is none here; the motor damps by itself.
XL430 = Servo(
    name="xl430",
    source=f"{_MANUAL}; Position P Gain 800; friction and rotor: Rhoban bam, XL330 and MX-64",
    stall_torque=_STALL,
    no_load_speed=_NO_LOAD,
    stiffness=dynamixel_stiffness(800, _STALL),
    damping=0.0,
    rotor_inertia=0.012,
    friction=0.04,
    torque_constant=_STALL / _STALL_CURRENT,
    resistance=_SUPPLY / _STALL_CURRENT,
    voltage=_SUPPLY,
)

SERVOS = {servo.name: servo for servo in (IDEAL, XL430)}
