"""The pendulum's closed forms: inertia, energy, exact undamped motion, rest angles, stability."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.joint_stop import limit_energy, limit_force
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.roots import sign_change
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Robot, Row
from drake_leg.robot.solids import Brick, Solid, mass_properties
from drake_leg.units import STANDARD_GRAVITY, require_non_negative, require_positive

NEARLY_UPRIGHT = 1e-3  # [rad] from upright
IN_AND_OUT = 0.002  # [s], greatest step of a motion with limits, so that none is stepped over
STIFF = 1e5  # time constants of the damper in a run beyond which an implicit method is used

STEP = 1e-6  # [rad], [rad/s], of the differences
MOST = 1e300  # greatest growth that is reported
GAUSS = (0.5 - math.sqrt(3.0) / 6.0, 0.5 + math.sqrt(3.0) / 6.0)  # points of a step
WEIGHTS = (0.25 - math.sqrt(3.0) / 6.0, 0.25 + math.sqrt(3.0) / 6.0)  # of the slopes there


@dataclass(frozen=True, kw_only=True)
class PendulumModel:
    """Parameters of the equation ``I qddot = m g (L/2) cos q - c qdot - k (q - q_ref)``.

    The force of the joint's limits that push back is added on its right side. q = 0 is
    horizontal and positive q turns the link downwards, so that the link hangs at q = pi/2; the
    swing angle from there is ``phi = q - pi/2``.
    """

    mass: float  # [kg]
    length: float  # [m]
    inertia: float  # [kg*m^2], about the pivot
    damping: float = 0.0  # [N*m*s/rad]
    spring_stiffness: float = 0.0  # [N*m/rad]
    equilibrium_position: float = 0.0  # [rad]
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    limits: JointMechanics | None = None  # where it has limits that push back

    def __post_init__(self) -> None:
        for name, unit in (("mass", "kg"), ("length", "m")):
            require_positive(f"the pendulum's {name}", getattr(self, name), unit)
        require_non_negative("the damping", self.damping, "N*m*s/rad")
        require_non_negative("the spring stiffness", self.spring_stiffness, "N*m/rad")
        require_non_negative("gravity", self.gravity, "m/s^2")

    @classmethod
    def from_robot(cls, robot: Robot, gravity: float = STANDARD_GRAVITY) -> Self:
        """Read the model off the data of a pendulum such as ``robots.pendulum()``.

        ``I = m (L^2 + w^2) / 12 + m (L/2)^2``; gravity in m/s^2.
        """
        segment, body = robot.segments[0], _body(robot)
        if body is None:
            raise InvalidValueError(
                f"{robot.name!r} is not a one-brick pendulum", advice="use PENDULUM"
            )
        solid, brick = body
        own = mass_properties(solid)
        return cls(
            mass=own.mass,
            length=brick.length,
            inertia=own.moments[2] + own.mass * (brick.length / 2) ** 2,
            damping=segment.mechanics.damping,
            spring_stiffness=segment.mechanics.spring_stiffness,
            equilibrium_position=segment.mechanics.equilibrium_position,
            gravity=gravity,
            limits=segment.mechanics if segment.mechanics.stops else None,
        )

    @property
    def gravity_torque(self) -> float:
        """``m g L / 2`` [N*m]: the torque of gravity on the horizontal link."""
        return self.mass * self.gravity * self.length / 2

    @property
    def natural_frequency(self) -> float:
        """Frequency of small swings ``sqrt(m g (L/2) / I)`` [rad/s]."""
        return math.sqrt(self.gravity_torque / self.inertia)


def is_pendulum(robot: Robot) -> bool:
    """Whether a robot is one brick, of any size, that turns about the base's y axis."""
    return robot.is_plain and _body(robot) is not None


def _body(robot: Robot) -> tuple[Solid, Brick] | None:
    """Return the only body of a pendulum; None if the robot is not a pendulum."""
    first, *others = robot.segments
    link = first.link
    if link is None or link.solid is None or link.inertial is not None:
        return None
    solid, brick = link.solid, link.solid.shape
    if not isinstance(brick, Brick):
        return None
    centre = (brick.length / 2, 0.0, 0.0)
    turns = first.row == Row(joint="revolute", alpha=-math.pi / 2) and solid.centre == centre
    ends = [segment.row for segment in others] == [Row(joint="fixed", d=brick.length / 2)]
    return (solid, brick) if turns and ends and not any(s.link for s in others) else None


def energy(model: PendulumModel, q: ArrayLike, qdot: ArrayLike) -> Array:
    """Kinetic plus potential energy [J] at angles [rad] and rates [rad/s] (...).

    ``I qdot^2 / 2 - m g (L/2) sin q + k (q - q_ref)^2 / 2``, gravity from the pivot's height.
    """
    angle, rate = np.asarray(q, dtype=np.float64), np.asarray(qdot, dtype=np.float64)
    stretch = angle - model.equilibrium_position
    total: Array = (
        model.inertia * rate**2 / 2
        - model.gravity_torque * np.sin(angle)
        + model.spring_stiffness * stretch**2 / 2
    )
    return total if model.limits is None else total + limit_energy(model.limits, angle)


def acceleration(model: PendulumModel, q: ArrayLike, qdot: ArrayLike) -> Array:
    """Angular acceleration [rad/s^2] of the free, damped or sprung pendulum at q, qdot (...)."""
    angle, rate = np.asarray(q, dtype=np.float64), np.asarray(qdot, dtype=np.float64)
    spring = model.spring_stiffness * (angle - model.equilibrium_position)
    torque = model.gravity_torque * np.cos(angle) - model.damping * rate - spring
    if model.limits is not None:
        torque = torque + limit_force(model.limits, angle, rate)
    return torque / model.inertia


def _swing(q0: float) -> float:
    """Angle from hanging, wrapped to [-pi, pi]."""
    return math.remainder(q0 - math.pi / 2, 2 * math.pi)


def _oscillates(model: PendulumModel, q0: float) -> bool:
    """Whether the undamped pendulum, released at rest at q0, swings with a finite period."""
    return (
        model.damping == 0.0
        and model.spring_stiffness == 0.0
        and model.limits is None
        and model.gravity > 0.0
        and abs(_swing(q0)) > 1e-9
        and abs(_swing(q0)) < math.pi - 1e-9
    )


def exact_period(model: PendulumModel, q0: float) -> float | None:
    """Period [s] of the free swing released at rest at q0 [rad]: ``4 K(sin(phi0/2)) / omega0``.

    None where there is no period: with damping, a spring or limits, hanging or upright.
    """
    if not _oscillates(model, q0):
        return None
    from scipy.special import ellipkm1

    k_prime = math.cos(_swing(q0) / 2)
    return 4.0 * float(ellipkm1(k_prime**2)) / model.natural_frequency


def exact_motion(
    model: PendulumModel, q0: float, time: ArrayLike, qdot0: float = 0.0
) -> tuple[Array, Array]:
    """Angle and rate of the pendulum released at q0 [rad] at rest, or at a rate [rad/s].

    Released at rest without damping, spring and limits by Jacobi's elliptic functions,
    ``sin(phi/2) = k cd(omega0 t, k)``; otherwise, and where it starts so nearly upright that the
    elliptic functions lose their digits, by an eighth-order integration of the closed
    equation of motion at a relative tolerance of 1e-12 (of fifth order at 1e-9 where the damper
    makes it stiff). The instants (n,) [s] increase from 0.
    """
    instants = np.asarray(time, dtype=np.float64)
    phi0 = _swing(q0)
    if qdot0 != 0.0 or not _oscillates(model, q0):
        return _integrated_motion(model, q0, qdot0, instants)
    if math.pi - abs(phi0) < NEARLY_UPRIGHT:
        return _motion_from_upright(model, q0, instants)
    from scipy.special import ellipj

    k, k_prime = math.sin(phi0 / 2), math.cos(phi0 / 2)
    sn, cn, dn, _ = ellipj(model.natural_frequency * instants, k**2)
    phi = 2.0 * np.arctan2(k * cn, k_prime)
    rate = -2.0 * k * k_prime * model.natural_frequency * sn / dn
    return q0 + (phi - phi0), rate


def _integrated_motion(
    model: PendulumModel, q0: float, qdot0: float, instants: Array
) -> tuple[Array, Array]:
    solution = _solution(model, q0, float(instants[-1]), tolerance=1e-13, qdot0=qdot0)
    return solution(instants)


def _motion_from_upright(model: PendulumModel, q0: float, instants: Array) -> tuple[Array, Array]:
    """Integrate the first quarter of the swing alone, and mirror it."""
    quarter = (exact_period(model, q0) or 0.0) / 4
    phase = np.mod(instants, 4 * quarter)
    back = np.where(phase > 2 * quarter, 4 * quarter - phase, phase)
    folded = np.where(back > quarter, 2 * quarter - back, back)
    phi0 = _swing(q0)
    q, qdot = _solution(model, q0, quarter, tolerance=1e-9 * (math.pi - abs(phi0)))(folded)
    phi = np.where(back > quarter, -1.0, 1.0) * (phi0 + (q - q0))
    return q0 + (phi - phi0), np.where(phase > 2 * quarter, -1.0, 1.0) * qdot


def _solution(
    model: PendulumModel, q0: float, duration: float, tolerance: float, qdot0: float = 0.0
) -> Callable[[Array], tuple[Array, Array]]:
    def derivatives(_time: float, state: Array) -> list[float]:
        return [state[1], float(acceleration(model, state[0], state[1]))]

    if duration <= 0.0:
        return lambda time: (np.full_like(time, q0), np.full_like(time, qdot0))
    from scipy.integrate import solve_ivp

    if model.limits is not None:
        solved = solve_ivp(
            derivatives,
            (0.0, duration),
            [q0, qdot0],
            method="LSODA",
            dense_output=True,
            rtol=1e-11,
            atol=1e-13,
            max_step=IN_AND_OUT,
        )
        return lambda time: tuple(solved.sol(time))
    stiff = model.damping / model.inertia * duration > STIFF
    solved = solve_ivp(
        derivatives,
        (0.0, duration),
        [q0, qdot0],
        method="Radau" if stiff else "DOP853",
        dense_output=True,
        rtol=1e-9 if stiff else 1e-12,
        atol=tolerance,
    )
    return lambda time: tuple(solved.sol(time))


def rest_angle(model: PendulumModel, q_end: float) -> float | None:
    """Angle [rad] at which the damped pendulum rests, the one nearest to where it ended.

    It solves ``k (q - q_ref) = m g (L/2) cos q``; without a spring it is where the link hangs. None
    without damping and limits, since then it never rests, and if there is no equilibrium within
    half a turn of ``q_end``.
    """
    if model.damping == 0.0 and model.limits is None:
        return None
    if model.spring_stiffness == 0.0 and model.limits is None:
        return q_end - _swing(q_end) if model.gravity_torque > 0.0 else q_end

    def torque(q: float) -> float:
        spring = model.spring_stiffness * (q - model.equilibrium_position)
        limits = 0.0 if model.limits is None else float(limit_force(model.limits, q, 0.0))
        return model.gravity_torque * math.cos(q) - spring + limits

    grid = np.linspace(q_end - math.pi, q_end + math.pi, 721)
    stable = [
        sign_change(torque, left, right)
        for left, right in pairwise(grid)
        if torque(left) >= 0.0 > torque(right)
    ]
    return float(min(stable, key=lambda angle: abs(angle - q_end))) if stable else None


def instability(model: PendulumModel, q: Array, qdot: Array) -> float:
    """Greatest rate at which neighboring motions diverge on a motion q, qdot (n,) [1/s].

    Upright it is the positive root of ``s^2 + (c / I) s = m g (L/2) / I``; it is 0 where the motion
    is stable everywhere.
    """
    stiffness, damping = _slopes(model, q, qdot)
    roots = damping / 2.0 + np.sqrt(np.maximum(damping**2 / 4.0 + stiffness, 0.0))
    return float(max(np.max(np.where(stiffness > 0.0, roots, 0.0)), 0.0))


def error_growth(model: PendulumModel, time: Array, q: Array, qdot: Array) -> float:
    """Greatest factor, from 1 to ``MOST``, by which an initial error grows in the angle.

    The motion q, qdot (n,) at times (n,) [s] is linearized, by two exponentials from row to row
    (Magnus, fourth order); a rate counts as the angle that it is at the frequency of small swings.
    """
    if len(time) < 2:
        return 1.0
    rate = model.natural_frequency or 1.0
    steps = _steps(model, rate, time, q, qdot)
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    size, greatest = 0.0, 0.0  # logarithms
    for e, f, g, h in steps.tolist():
        a, b, c, d = e * a + f * c, e * b + f * d, g * a + h * c, g * b + h * d
        length = math.hypot(a, b)
        if length > 0.0:
            greatest = max(greatest, size + math.log(length))
        if max(length, abs(c), abs(d)) > 1e100:
            a, b, c, d, size = a / 1e100, b / 1e100, c / 1e100, d / 1e100, size + math.log(1e100)
    return math.exp(min(greatest, math.log(MOST)))


def _steps(model: PendulumModel, rate: float, time: Array, q: Array, qdot: Array) -> Array:
    """Return two exponentials for each step, from the slopes at its two Gauss points, (2 n, 4)."""
    step = np.diff(time)
    (stiff, damp), (stiffer, damper) = (
        _slopes(model, *_between(time, q, qdot, at)) for at in GAUSS
    )
    halves = [
        _exponentials(
            2.0 * (a * stiff + b * stiffer) / rate, 2.0 * (a * damp + b * damper), rate, step / 2.0
        )
        for a, b in (WEIGHTS[::-1], WEIGHTS)
    ]
    return np.stack(halves, axis=1).reshape(-1, 4)


def _between(time: Array, q: Array, qdot: Array, at: float) -> tuple[Array, Array]:
    """Interpolate a motion at a part of every step, by cubics."""
    from scipy.interpolate import CubicHermiteSpline

    motion = CubicHermiteSpline(time, q, qdot)
    there = time[:-1] + at * np.diff(time)
    return motion(there), motion(there, 1)


def _slopes(model: PendulumModel, q: Array, qdot: Array) -> tuple[Array, Array]:
    """Differentiate the acceleration by the angle [1/s^2] and by the rate [1/s]."""
    by_angle = acceleration(model, q + STEP, qdot) - acceleration(model, q - STEP, qdot)
    by_rate = acceleration(model, q, qdot + STEP) - acceleration(model, q, qdot - STEP)
    return by_angle / (2.0 * STEP), by_rate / (2.0 * STEP)


def _exponentials(stiffness: Array, damping: Array, rate: float, step: Array) -> Array:
    """Return ``exp([[0, rate], [stiffness, damping]] step)``, row by row, (n, 4)."""
    middle = damping / 2.0
    root = np.sqrt(middle**2 + stiffness * rate + 0j)
    plus, minus = np.exp((middle + root) * step), np.exp((middle - root) * step)
    even = ((plus + minus) / 2.0).real
    apart = np.abs(root * step) > 1e-6
    odd = np.where(
        apart,
        ((plus - minus) / np.where(apart, 2.0 * root, 1.0)).real,
        step * np.exp(middle * step),
    )
    return np.stack(
        [even - middle * odd, rate * odd, stiffness * odd, even + middle * odd], axis=-1
    )
