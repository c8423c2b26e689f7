"""The time steps of a pendulum where none is asked for: as short as its stiffness needs."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.pendulum import PendulumModel

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
LONGEST_OSCILLATION = 3e4  # [rad]: what the exact motion is compared with in minutes


@dataclass(frozen=True, kw_only=True)
class Steps:
    """Steps that grow while a fast motion dies out: ``first exp(growth t)``, up to ``longest``."""

    first: float  # [s]
    longest: float  # [s]
    growth: float  # [1/s]

    def at(self, time: float) -> float:
        """Return the greatest step from an instant on [s]."""
        grown = self.growth * time
        return self.longest if grown > 100.0 else min(self.longest, self.first * math.exp(grown))

    def count(self, duration: float) -> float:
        """Estimate how many a run takes."""
        if self.growth == 0.0:
            return duration / self.first
        end = min(duration, math.log(self.longest / self.first) / self.growth)
        growing = -math.expm1(-self.growth * end) / (self.growth * self.first)
        return growing + (duration - end) / self.longest


def steps_of(model: PendulumModel, duration: float, away: float) -> Steps:
    """Choose steps that keep the energy of the swing and a spring's oscillation accurate.

    Parameters
    ----------
    duration : float
        Of the run [s].
    away : float
        How far the oscillation of a spring is from its rest at the start [rad].

    Raises
    ------
    InvalidValueError
        If it is so stiff that an explicit integrator would need more than ``MOST`` steps.
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
    """Take coarser first steps where there would be too many."""
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
    """Choose the step of an implicit integrator, which no damper makes unstable.

    Parameters
    ----------
    duration : float
        Of the run [s].

    Returns
    -------
    float
        [s].
    """
    swing = OF_SWING / model.natural_frequency if model.natural_frequency > 0.0 else math.inf
    fastest = max(_spring_frequency(model), model.damping / model.inertia)
    fine = OF_STIFFNESS / fastest if fastest > 0.0 else math.inf
    return min(LONGEST, swing, max(fine, duration / MOST_IMPLICIT))


def _spring_frequency(model: PendulumModel) -> float:
    return math.sqrt(model.spring_stiffness / model.inertia)
