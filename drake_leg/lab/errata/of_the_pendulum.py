"""What the errors about the pendulum do, by number."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping

import numpy as np

from drake_leg.kinematics.pendulum import (
    PendulumModel,
    energy,
    exact_motion,
    exact_period,
    rest_angle,
)
from drake_leg.lab.errata.wording import Values
from drake_leg.robot.robots import PENDULUM
from drake_leg.runs.pendulum_options import (
    STATE_TARGET,
    DampedPendulumOptions,
    SpringPendulumOptions,
)

MODEL = PendulumModel.from_robot(PENDULUM)
RELEASE = 0.0  # [rad], where the free pendulum is released: horizontal
HANGING = math.pi / 2  # [rad]


def _damping_unit() -> Values:
    critical = 2.0 * MODEL.inertia * MODEL.natural_frequency
    radians, degrees = (
        DampedPendulumOptions(damping_unit=unit).si_damping() / critical
        for unit in ("N*m*s/rad", "N*m/(deg/s)")
    )
    factor, length = degrees / radians, 1000 * MODEL.length
    return {"factor": factor, "length": length, "radians": radians, "degrees": degrees}


def _state_target() -> Values:
    target, options = math.radians(STATE_TARGET), SpringPendulumOptions()
    damped = dataclasses.replace(MODEL, damping=options.damping)
    sprung = dataclasses.replace(
        damped, spring_stiffness=options.spring_stiffness, equilibrium_position=target
    )
    rests = [rest_angle(model, target) for model in (damped, sprung)]
    hanging, held = (math.degrees(rest) for rest in rests if rest is not None)
    return {
        "target": STATE_TARGET,
        "hanging": hanging,
        "stiffness": options.spring_stiffness,
        "held": held,
    }


def _greatest_speed() -> Values:
    released = energy(MODEL, RELEASE, 0.0)
    at_zero, at_bottom = (
        math.sqrt(2.0 * float(released - energy(MODEL, angle, 0.0)) / MODEL.inertia)
        for angle in (0.0, HANGING)
    )
    return {"at_zero": at_zero, "at_bottom": at_bottom, "hanging": math.degrees(HANGING)}


def _sinusoid() -> Values:
    period = exact_period(MODEL, RELEASE) or math.inf
    small = 2.0 * math.pi / MODEL.natural_frequency
    time = np.linspace(0.0, period, 2001)
    sinusoid = HANGING + (RELEASE - HANGING) * np.cos(2.0 * math.pi * time / period)
    away = np.degrees(np.abs(exact_motion(MODEL, RELEASE, time)[0] - sinusoid).max())
    amplitude = math.degrees(HANGING - RELEASE)
    factor = period / small
    return {
        "amplitude": amplitude,
        "period": period,
        "factor": factor,
        "small": small,
        "away": away,
    }


OF_THE_PENDULUM: Mapping[int, Callable[[], Values]] = {  # by the errata's numbers
    1: _damping_unit,
    2: _state_target,
    3: _greatest_speed,
    4: _sinusoid,
}
