"""The errata of report A's pendulum."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from drake_leg.errata.erratum import Erratum
from drake_leg.kinematics.pendulum import (
    PendulumModel,
    energy,
    exact_motion,
    exact_period,
    rest_angle,
)
from drake_leg.robots import PENDULUM
from drake_leg.runs.options import STATE_TARGET, DampedPendulumOptions, SpringPendulumOptions

SOURCE = "Report A"
RELEASE = 0.0  # [rad], where the free pendulum is let go: horizontal
HANGING = math.pi / 2  # [rad]


def pendulum_errata() -> tuple[Erratum, ...]:
    """List the errata of the pendulum.

    Returns
    -------
    tuple of Erratum
        Numbers 1 to 5, and 26.

    References
    ----------
    Report A, chapter 1.
    """
    return (
        Erratum(
            number=1,
            source=SOURCE,
            where="section 1.2",
            printed="“Damping Co-efficient of 0.01 Nm/s²”",
            right="0.01 N·m·s/rad, or 0.01 N·m/(deg/s), which is Simscape's default unit",
            effect=_damping_unit(),
        ),
        Erratum(
            number=2,
            source=SOURCE,
            where="sections 1.2 and 1.3",
            printed="“a state target of 30⁰ is also included”; “the velocities are such as to "
            "obtain the targeted state”",
            right="A state target is where the simulation starts and does not attract; a spring "
            "with its equilibrium position there does",
            effect=_state_target(),
        ),
        Erratum(
            number=3,
            source=SOURCE,
            where="section 1.3, figure 7",
            printed="“the velocities are maximum where the positions are zero and the velocities "
            "are zeros and the maximum position”",
            right="The speed is greatest where the link is vertical, at q = 90° in the report's "
            "own frames, and zero where it turns back, at q = 0 and at q = 180°",
            effect=_greatest_speed(),
        ),
        Erratum(
            number=4,
            source=SOURCE,
            where="section 1.3, figure 5",
            printed="“a sinusoidal motion of the pendulum”",
            right="A periodic motion, given by an elliptic function; sinusoidal only for small "
            "swings",
            effect=_sinusoid(),
        ),
        Erratum(
            number=5,
            source=SOURCE,
            where="section 1.3",
            printed="“the motion was greatly damped […] (as shown in Figure 7)”; “the angular "
            "velocity of the revolute joints (as shown in Figure 6 and Figure 8)”",
            right="The damped motion is in figure 6, the angular velocities are in figures 7 and 8",
            effect="No number is wrong, but a reader is sent to the undamped motion for the damped "
            "one.",
        ),
        Erratum(
            number=26,
            source=SOURCE,
            where="figures 2 and 3",
            printed="“Figure 2: Simulink Multibody Model of a Simple Pundulum”, and the same under "
            "figure 3",
            right="Figure 2: Frames on the link of the pendulum; figure 3: Simulink Multibody "
            "model of a simple pendulum",
            effect="No number is wrong, but section 1.2 sends a reader to figure 2 for the frames "
            "and to figure 3 for the model, and the captions do not tell which is which.",
        ),
    )


def _model() -> PendulumModel:
    return PendulumModel.from_robot(PENDULUM)


def _damping_unit() -> str:
    model = _model()
    critical = 2.0 * model.inertia * model.natural_frequency
    radians, degrees = (
        DampedPendulumOptions(damping_unit=unit).si_damping() / critical
        for unit in ("N*m*s/rad", "N*m/(deg/s)")
    )
    return (
        "N·m/s² is no unit of damping, and the two that it may stand for are "
        f"{degrees / radians:.1f} times apart: the link of {1000 * model.length:.0f} mm has "
        f"{radians:.2f} of its critical damping and swings, or {degrees:.2f} times as much as "
        "critical and creeps."
    )


def _state_target() -> str:
    target, options = math.radians(STATE_TARGET), SpringPendulumOptions()
    damped = dataclasses.replace(_model(), damping=options.damping)
    sprung = dataclasses.replace(
        damped, spring_stiffness=options.spring_stiffness, equilibrium_position=target
    )
    rests = [rest_angle(model, target) for model in (damped, sprung)]
    hanging, held = (math.degrees(rest) for rest in rests if rest is not None)
    return (
        f"Started at a state target of {STATE_TARGET:g}°, the damped link comes to rest at "
        f"{hanging:.1f}°, hanging. A spring of {options.spring_stiffness:g} N·m/rad to "
        f"{STATE_TARGET:g}° holds it at {held:.1f}°."
    )


def _greatest_speed() -> str:
    model = _model()
    released = energy(model, RELEASE, 0.0)
    at_zero, at_bottom = (
        math.sqrt(2.0 * float(released - energy(model, angle, 0.0)) / model.inertia)
        for angle in (0.0, HANGING)
    )
    return (
        f"Released at q = 0, the link has {at_zero:.2f} rad/s there and {at_bottom:.2f} rad/s at "
        f"q = {math.degrees(HANGING):.0f}°."
    )


def _sinusoid() -> str:
    model = _model()
    period = exact_period(model, RELEASE) or math.inf
    small = 2.0 * math.pi / model.natural_frequency
    time = np.linspace(0.0, period, 2001)
    sinusoid = HANGING + (RELEASE - HANGING) * np.cos(2.0 * math.pi * time / period)
    away = np.degrees(np.abs(exact_motion(model, RELEASE, time)[0] - sinusoid).max())
    return (
        f"At this amplitude of {math.degrees(HANGING - RELEASE):.0f}° the period is {period:.4f} "
        f"s, {period / small:.4f} times the {small:.4f} s of small swings, and even a sinusoid of "
        f"the right period is up to {away:.1f}° away."
    )
