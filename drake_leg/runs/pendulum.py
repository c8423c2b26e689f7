"""The pendulum's runs: their time steps, their findings and their exact motion."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydrake.systems.framework import Diagram

from drake_leg.diagrams.mechanism import start_at_targets
from drake_leg.diagrams.pendulum import PendulumConfig, build
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.pendulum import (
    PendulumModel,
    error_growth,
    exact_motion,
    exact_period,
    instability,
    rest_angle,
)
from drake_leg.kinematics.roots import sign_change
from drake_leg.robot.robot import Robot
from drake_leg.runs.outcome import SHOWN, Outcome, finer, inaccuracy, outcome_of, shows
from drake_leg.runs.pendulum_options import PendulumOptions
from drake_leg.simulation.integrator import IMPLICIT, IntegratorSettings
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import LongestStep, Progress, Start, simulate
from drake_leg.units import require_positive

LONGEST = 0.002  # [s]
OF_SWING = 0.015  # greatest step times natural frequency
OF_STIFFNESS = 0.1  # greatest first step times the fastest rate of spring and damper
# Greatest step times that rate, once the fast motion is gone: inside Runge-Kutta's stability.
OF_OSCILLATION, OF_DECAY = 0.7, 1.5
ERROR = 2e-8  # [rad], of an oscillation of the spring
ERROR_OF_STEPS = 3e-4  # measured: error = this (w h)^5 w t times the amplitude
ORDER = 5
MOST = 500_000  # steps: about a minute
MOST_IMPLICIT = 20_000
LONGEST_OSCILLATION = 3e4  # [rad]: compared with the exact motion within minutes
# Relative accuracy of the error control that each integrator reaches at a limit in bounded time.
ACCURACY_AT_LIMITS = {
    "runge_kutta5": 1e-9,
    "runge_kutta3": 1e-7,
    "bogacki_shampine3": 1e-7,
    "radau3": 1e-7,
    "radau1": 1e-4,
    "implicit_euler": 1e-4,
}
GROWING = "runge_kutta5"  # whose stable steps are known, so that they may grow
# Growth of an error of the start from which a rounding to 1e-6 degrees shows in the figures.
ILL_CONDITIONED = 1e6
AT_REST = 1e-3  # [rad/s], [rad/s^2], below which the last tenth of a run counts as rest


@dataclass(frozen=True, kw_only=True)
class Steps:
    """Steps that grow while a fast motion dies out: ``first exp(growth t)``, up to ``longest``."""

    first: float  # [s]
    longest: float  # [s]
    growth: float  # [1/s]

    def at(self, time: float) -> float:
        """Return the longest step from an instant on [s]."""
        grown = self.growth * time
        return self.longest if grown > 100.0 else min(self.longest, self.first * math.exp(grown))

    def count(self, duration: float) -> float:
        """Estimate the number of steps of a run."""
        if self.growth == 0.0:
            return duration / self.first
        end = min(duration, math.log(self.longest / self.first) / self.growth)
        growing = -math.expm1(-self.growth * end) / (self.growth * self.first)
        return growing + (duration - end) / self.longest


def steps_of(model: PendulumModel, duration: float, away: float) -> Steps:
    """Choose steps that keep the energy of the swing and a spring's oscillation accurate.

    ``away`` is the amplitude of a spring's oscillation at the start [rad].

    Raises
    ------
    InvalidValueError
        If the joint is so stiff that an explicit integrator would need more than ``MOST`` steps.
    """
    swing = OF_SWING / model.natural_frequency if model.natural_frequency > 0.0 else math.inf
    longest = min(LONGEST, swing)
    decay, frequency = model.damping / (2.0 * model.inertia), _spring_frequency(model)
    if frequency > decay:
        lasting = min(duration, 1.0 / decay if decay > 0.0 else math.inf)
        share = ERROR / max(ERROR_OF_STEPS * frequency * lasting * away, ERROR)
        fastest, stable, rate = frequency, OF_OSCILLATION, decay
        fine = min(OF_STIFFNESS, share ** (1.0 / ORDER))
    else:
        fastest = rate = decay + math.sqrt(decay**2 - frequency**2)
        stable, fine = OF_DECAY, OF_STIFFNESS
    if fastest == 0.0:
        return Steps(first=longest, longest=longest, growth=0.0)
    steps = Steps(
        first=min(longest, fine / fastest),
        longest=min(longest, stable / fastest),
        growth=rate / ORDER,
    )
    steps = _coarser(replace(steps, longest=max(steps.first, steps.longest)), duration)
    endless = frequency > decay and frequency * duration > LONGEST_OSCILLATION
    if endless or (steps.longest < longest and steps.count(duration) > MOST):
        raise _too_stiff(steps, duration, overdamped=frequency <= decay)
    return steps


def _coarser(steps: Steps, duration: float) -> Steps:
    """Make the first steps coarser if there would be too many."""
    while steps.count(duration) > MOST and steps.first < steps.longest:
        steps = replace(steps, first=min(1.2 * steps.first, steps.longest))
    return steps


def _too_stiff(steps: Steps, duration: float, *, overdamped: bool) -> InvalidValueError:
    what, remedy = (
        ("damping", "choose `integrator='radau3'`, which is not bound to such steps")
        if overdamped
        else ("spring", "choose a softer one")
    )
    return InvalidValueError(
        f"the {what} is so stiff that {duration:g} s take {steps.count(duration):.2g} steps of "
        f"{steps.longest:.2g} s",
        advice=f"{remedy}, a shorter `duration`, or your own `max_step`",
    )


def implicit_step(model: PendulumModel, duration: float) -> float:
    """Choose the step of an implicit integrator [s], which no damper makes unstable."""
    swing = OF_SWING / model.natural_frequency if model.natural_frequency > 0.0 else math.inf
    fastest = max(_spring_frequency(model), model.damping / model.inertia)
    fine = OF_STIFFNESS / fastest if fastest > 0.0 else math.inf
    return min(LONGEST, swing, max(fine, duration / MOST_IMPLICIT))


def _spring_frequency(model: PendulumModel) -> float:
    return math.sqrt(model.spring_stiffness / model.inertia)


def run(robot: Robot, options: PendulumOptions, progress: Progress | None = None) -> Outcome:
    """Release the pendulum, with whatever acts at its joint.

    ``progress`` is called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    """
    config = config_of(robot, options)
    model = PendulumModel.from_robot(config.robot, options.gravity)
    rate = math.radians(options.velocity_target)
    settings, longest_step = _settings(options, model, _away(model, config.start, rate))
    done = simulate(
        build(config),
        start=start_at_targets(config.robot),
        duration=options.duration,
        settings=settings,
        longest_step=longest_step,
        progress=progress,
    )
    recording = Recording(
        {
            "time[s]": done.time,
            "q[rad]": done.scopes["q"][:, 0],
            "qdot[rad/s]": done.scopes["w"][:, 0],
            "qddot[rad/s^2]": done.scopes["acceleration"][:, 0],
            "energy[J]": done.scopes["energy"][:, 0],
        }
    )
    q, qdot = exact_motion(model, config.start, done.time, rate)
    return outcome_of(
        config.robot,
        done,
        settings,
        options.duration,
        recording,
        {"q": q, "qdot": qdot},
        _findings(model, config.start, recording, (q, qdot), settings),
        "swing",
    )


def diagram(robot: Robot, options: PendulumOptions) -> tuple[Diagram, Start]:
    """Build the diagram that ``run`` simulates; return it with its start."""
    config = config_of(robot, options)
    return build(config), start_at_targets(config.robot)


def config_of(robot: Robot, options: PendulumOptions) -> PendulumConfig:
    """Return the config of the pendulum's diagram."""
    return PendulumConfig(robot=robot, q0=options.start(), gravity=options.gravity)


def _settings(
    options: PendulumOptions, model: PendulumModel, away: float
) -> tuple[IntegratorSettings, LongestStep | None]:
    """Choose the integrator's settings, and the longest step over time.

    Error control is used where a limit may be met: the contact is short and stiff.
    """
    settings = options.integrator_settings(LONGEST)
    limited = model.limits is not None and settings.scheme in ACCURACY_AT_LIMITS
    if limited and settings.accuracy is None:
        settings = replace(settings, accuracy=ACCURACY_AT_LIMITS[settings.scheme])
    if options.max_step is not None or settings.accuracy is not None:
        return settings, None
    require_positive("the duration", options.duration, "s")
    if settings.scheme in IMPLICIT:
        return replace(settings, max_step=implicit_step(model, options.duration)), None
    steps = steps_of(model, options.duration, away)
    if settings.scheme != GROWING:
        return replace(settings, max_step=steps.first), None
    return replace(settings, max_step=steps.longest), steps.at


def _away(model: PendulumModel, q0: float, rate: float) -> float:
    """Upper bound of the spring's deflection from its rest [rad]."""
    if model.spring_stiffness == 0.0:
        return 0.0
    sag = model.gravity_torque / model.spring_stiffness
    return abs(q0 - model.equilibrium_position) + sag + abs(rate) / _spring_frequency(model)


def measured_period(recording: Recording) -> float | None:
    """Period of the swing [s], from the instants at which the link passes the vertical.

    Between two rows the angle is the quintic that agrees with their angles, rates and
    accelerations. The period is the mean over all whole swings; None if there is none.
    """
    time = recording["time"]
    states = recording.stack("q", "qdot", "qddot")
    swing = states[:, 0] - math.pi / 2
    swing -= 2 * math.pi * np.round(swing.mean() / (2 * math.pi))
    falls = np.flatnonzero((swing[:-1] > 0.0) & (swing[1:] <= 0.0))
    if len(falls) < 2:
        return None
    first, last = (_crossing(time, swing, states, row) for row in falls[[0, -1]])
    return (last - first) / (len(falls) - 1)


def _crossing(time: Array, swing: Array, states: Array, row: int) -> float:
    from scipy.interpolate import BPoly

    ends = [[swing[i], states[i, 1], states[i, 2]] for i in (row, row + 1)]
    width = time[row + 1] - time[row]
    curve = BPoly.from_derivatives([0.0, width], ends)
    return float(time[row] + sign_change(curve, 0.0, width))


def _findings(
    model: PendulumModel,
    q0: float,
    recording: Recording,
    exact: tuple[Array, Array],
    settings: IntegratorSettings,
) -> dict[str, Any]:
    exact_q, exact_qdot = exact
    time, q, qdot = recording["time"], recording["q"], recording["qdot"]
    energy = recording["energy"]
    tail = time >= 0.9 * time[-1]
    moves = max(np.abs(qdot[tail]).max(), np.abs(recording["qddot"][tail]).max())
    rested = (model.damping > 0.0 or model.limits is not None) and moves < AT_REST
    period = exact_period(model, q0) if qdot[0] == 0.0 else None
    conservative = model.damping == 0.0 and model.limits is None
    scale = model.gravity_torque or 1.0
    drift = float(np.abs(energy - energy[0]).max() / scale)
    growth = error_growth(model, time, exact_q, exact_qdot)
    rate = instability(model, exact_q, exact_qdot)
    error = float(np.abs(q - exact_q).max())
    return {
        "q0_rad": q0,
        "period_s": None if period is None else measured_period(recording),
        "exact_period_s": period,
        "energy_drift": drift if conservative else None,
        "rest_angle_rad": float(q[-1]) if rested else None,
        "exact_rest_angle_rad": rest_angle(model, float(q[-1])) if rested else None,
        "max_angle_error_rad": error,
        "error_growth": growth,
        "instability_1_s": rate,
        "ill_conditioned": _ill_conditioned(growth, rate),
        "inaccuracy": _inaccuracy(error, growth, exact_q, settings),
    }


def _ill_conditioned(growth: float, rate: float) -> str | None:
    """Explain that the last digits of the start decide what the pendulum does."""
    if growth < ILL_CONDITIONED:
        return None
    return (
        f"the motion is ill-conditioned: near upright every tiny error grows as exp({rate:.3g} t), "
        f"over the run by a factor of {growth:.1g}"
    )


def _inaccuracy(
    error: float, growth: float, exact_q: Array, settings: IntegratorSettings
) -> str | None:
    """Explain that the recorded motion is another one, or that it cannot be predicted."""
    span = min(float(np.ptp(exact_q)), 2.0 * math.pi)
    if growth >= ILL_CONDITIONED and shows(error, span):
        return inaccuracy(error, span, "angle", "rad", "start farther from upright")
    if growth * float(np.finfo(float).eps) > SHOWN:
        return (
            "the rounding of the start alone grows to an error that can be seen: no computation "
            "can predict this motion; start farther from upright"
        )
    return inaccuracy(error, span, "angle", "rad", finer(settings))
