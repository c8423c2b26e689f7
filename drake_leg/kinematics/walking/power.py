"""What servos draw: current, electrical and mechanical power, and the cost of transport.

Everything follows from the drive torque, which a plant reports as actuation and ``planned_loads``
plans, and the speed of the joint. The motor's torque is ``drive - back_emf_damping * speed``; its
current is that over the torque constant. Because the drive is all of the stall torque at the full
voltage U, the voltage at the terminals is ``R drive / kt = R i + ke speed`` with
``ke = back_emf_damping R / kt``. Of the XL430, stall torque, stall current, voltage and no-load
speed of the manual come out exactly; ke is 1.75 times kt, since the torque constant is at the
output and the gear loses 43 % of the motor's torque.

What a joint gives back when it brakes counts as zero: the gear and the winding take it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, real_numbers
from drake_leg.robot.servos import CREEP_DAMPING, Servo
from drake_leg.units import require_positive


def motor_torque(servo: Servo, drive: ArrayLike, speed: ArrayLike) -> Array:
    """Torque of the motors at the output, before friction and the rotors' inertia, (...) [N*m]."""
    require_kind("the servo", servo, Servo)
    torque, rate = _alike(drive, speed)
    return torque - servo.back_emf_damping * rate


def gear_friction(servo: Servo, speed: ArrayLike) -> Array:
    """Torque of the gears' dry friction on joints in a simulation, (...) [N*m].

    A gear that sticks creeps as slowly as its load asks for.
    """
    require_kind("the servo", servo, Servo)
    resisted = -CREEP_DAMPING * real_numbers("the speed", speed)
    return np.clip(resisted, -servo.friction, servo.friction)


def motor_current(servo: Servo, drive: ArrayLike, speed: ArrayLike) -> Array:
    """Current in the windings, (...) [A], with the sign of the motor's torque."""
    torque_constant, _ = _constants(servo)
    return motor_torque(servo, drive, speed) / torque_constant


def electrical_power(servo: Servo, drive: ArrayLike, speed: ArrayLike) -> Array:
    """Power that the motors draw, (...) [W]: ``R i^2``, and ``ke i speed`` where it is positive."""
    torque_constant, resistance = _constants(servo)
    current = motor_current(servo, drive, speed)
    back_emf = servo.back_emf_damping * resistance / torque_constant  # ke [V*s/rad]
    moving = back_emf * current * np.asarray(speed)
    return np.asarray(resistance * current**2 + np.maximum(moving, 0.0))


def mechanical_power(servo: Servo, drive: ArrayLike, speed: ArrayLike) -> Array:
    """Power of the motors' torques, (...) [W], where it is positive."""
    power = motor_torque(servo, drive, speed) * np.asarray(speed)
    return np.asarray(np.maximum(power, 0.0))


def supply_current(servo: Servo, power: ArrayLike) -> Array:
    """Current from the supply for an electrical power, (...) [A]."""
    require_kind("the servo", servo, Servo)
    if servo.voltage is None:
        raise InvalidValueError(
            f"the servo {servo.name!r} has no voltage, so that the current from its supply is not "
            "known; give `voltage`"
        )
    return real_numbers("the power", power) / servo.voltage


def work(times: ArrayLike, power: ArrayLike) -> float:
    """Sum of the work of all powers (rows, ...) [W] over times (rows,) [s], in J."""
    t, watts = real_numbers("the times", times), real_numbers("the power", power)
    if t.ndim != 1 or watts.shape[:1] != t.shape:
        raise InvalidValueError(
            f"the power has shape {watts.shape} and the times {t.shape}; there must be a row of "
            "powers for every time"
        )
    total = watts.reshape(len(t), -1).sum(axis=1) if len(t) else t
    return float(np.sum(0.5 * (total[1:] + total[:-1]) * np.diff(t)))


def cost_of_transport(energy: float, mass: float, distance: float, gravity: float) -> float:
    """Work [J] for each unit of weight and distance, ``E / (m g d)``.

    Raises
    ------
    InvalidValueError
        If mass [kg], distance [m] or gravity [m/s^2] is not positive.
    """
    require_positive("the mass", mass, "kg")
    require_positive("the distance", distance, "m")
    require_positive("gravity", gravity, "m/s^2")
    return energy / (mass * gravity * distance)


def _alike(drive: ArrayLike, speed: ArrayLike) -> tuple[Array, Array]:
    torque, rate = real_numbers("the drive torque", drive), real_numbers("the speed", speed)
    try:
        np.broadcast_shapes(torque.shape, rate.shape)
    except ValueError:
        raise InvalidValueError(
            f"the drive torque has shape {torque.shape} and the speed {rate.shape}; they must be "
            "alike"
        ) from None
    return torque, rate


def _constants(servo: Servo) -> tuple[float, float]:
    """Torque constant [N*m/A] and resistance [Ohm]."""
    require_kind("the servo", servo, Servo)
    if servo.torque_constant is None or servo.resistance is None:
        raise InvalidValueError(
            f"the servo {servo.name!r} has neither torque constant nor resistance, so that its "
            "current is not known; give `torque_constant` and `resistance`"
        )
    return servo.torque_constant, servo.resistance
