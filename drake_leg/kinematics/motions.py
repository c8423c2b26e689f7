"""Commanded motions of a foot: the straight sine step, the ellipse, a push, a speed limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.movable import Floats
from drake_leg.units import (
    MOST,
    require_finite,
    require_non_negative,
    require_positive,
    require_three,
)

UP = np.array([0.0, 0.0, 1.0])
UP.setflags(write=False)


class SineWave(NamedTuple):
    """A velocity ``amplitude sin(frequency t + phase)``: the parameters of a Sine block."""

    amplitude: float  # [m/s]
    frequency: float  # [rad/s]
    phase: float = 0.0  # [rad]


@dataclass(frozen=True, kw_only=True)
class SineStep:
    """The command ``v = A sin(w t) d``: a line of length ``2 A / w`` along d, and back.

    ``p = (A / w) (1 - cos w t) d``. All vectors are in the frame of d.

    Parameters
    ----------
    amplitude : float
        A, the greatest speed; of either sign [m/s].
    frequency : float
        w [rad/s].
    direction : (3,) tuple of float
        d, a unit vector.

    Raises
    ------
    InvalidValueError
        If a number is invalid.

    Examples
    --------
    >>> from drake_leg import SineStep
    >>> step = SineStep(amplitude=0.05, frequency=2.0)
    >>> step.length, step.displacement([step.period / 2.0]).tolist()  # there and back [m]
    (0.05, [[0.05, 0.0, 0.0]])

    References
    ----------
    Report A, section 2.4; report B, section 3.4.
    """

    amplitude: float = 0.070  # A, of either sign [m/s]
    frequency: float = 1.0  # w [rad/s]
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)  # d, unit vector

    def __post_init__(self) -> None:
        require_finite("the amplitude", self.amplitude)
        require_positive("the size of the amplitude", abs(self.amplitude) or 1.0, "m/s")
        require_positive("the frequency", self.frequency, "rad/s")
        require_three("the direction", self.direction)
        object.__setattr__(self, "direction", tuple(self.direction))
        if not math.isclose(math.hypot(*self.direction), 1.0, rel_tol=1e-12):
            raise InvalidValueError(f"the direction is {self.direction!r}; it must have length 1")

    @property
    def is_straight(self) -> bool:
        """Whether the foot moves on a line."""
        return True

    @property
    def wave(self) -> SineWave:
        """Velocity along the direction."""
        return SineWave(self.amplitude, self.frequency)

    @property
    def parts(self) -> tuple[tuple[SineWave, Sequence[float]], ...]:
        """The velocity as a sum of waves along directions (3,)."""
        return ((self.wave, self.direction),)

    @property
    def greatest_speed(self) -> float:
        """Greatest speed of the foot [m/s]."""
        return abs(self.amplitude)

    @property
    def period(self) -> float:
        """Time in which the foot moves there and back [s]."""
        return 2.0 * math.pi / self.frequency

    @property
    def across(self) -> Array:
        """Directions in which the foot does not move, as columns (3, k)."""
        return np.eye(3) - np.outer(self.direction, self.direction)

    def displacement(self, time: ArrayLike) -> Array:
        """Displacement of the foot from its start at times (n,) [s], (n, 3) [m]."""
        advance = self.amplitude / self.frequency * (1.0 - np.cos(self._phase(time)))
        return np.outer(advance, self.direction)

    def velocity(self, time: ArrayLike) -> Array:
        """Velocity of the foot at times (n,) [s], (n, 3) [m/s]."""
        return np.outer(self.amplitude * np.sin(self._phase(time)), self.direction)

    def acceleration(self, time: ArrayLike) -> Array:
        """Acceleration of the foot at times (n,) [s], (n, 3) [m/s^2]."""
        rate = self.amplitude * self.frequency
        return np.outer(rate * np.cos(self._phase(time)), self.direction)

    @property
    def heading(self) -> Array:
        """Unit vector of the foot's first motion along the line, (3,)."""
        return math.copysign(1.0, self.amplitude) * np.array(self.direction)

    @property
    def length(self) -> float:
        """Length of the line [m]."""
        return 2.0 * abs(self.amplitude) / self.frequency

    def way(self, time: float) -> float:
        """Distance along the line at a time [s] of the first way forward [m]."""
        half = min(self.frequency * time, math.pi) / 2.0
        return self.length * math.sin(half) ** 2

    def time(self, way: float) -> float:
        """Time at which the foot first reaches a distance on the line [s]."""
        return 2.0 / self.frequency * math.asin(min(math.sqrt(way / self.length), 1.0))

    def _phase(self, time: ArrayLike) -> Array:
        return self.frequency * np.asarray(time, dtype=np.float64)


@dataclass(frozen=True, kw_only=True)
class EllipticStep(SineStep):
    """A step that also rises by ``(h / 2) sin(w t)``: an ellipse ``2 A / w`` wide and h high.

    The plane of the ellipse is vertical. The foot starts at the rear end and rises first.

    Parameters
    ----------
    amplitude, frequency : float
        As in ``SineStep``.
    direction : (3,) tuple of float
        A horizontal unit vector.
    lift : float
        h, from the lowest point of the ellipse to the highest [m].

    Raises
    ------
    InvalidValueError
        If a number is invalid, or the direction is not horizontal.

    Examples
    --------
    >>> from drake_leg import EllipticStep
    >>> round_trip = EllipticStep(amplitude=0.07, lift=0.04)
    >>> round_trip.displacement([round_trip.period / 4.0]).round(3).tolist()  # half way, on top
    [[0.07, 0.0, 0.02]]

    References
    ----------
    Report A, section 2.1.
    """

    lift: float = 0.040  # h, from the lowest point of the ellipse to the highest [m]

    def __post_init__(self) -> None:
        super().__post_init__()
        require_finite("the lift", self.lift)
        require_non_negative("the size of the lift", abs(self.lift), "m")
        if self.direction[2] != 0.0:
            raise InvalidValueError(
                f"the direction is {self.direction!r}; the ellipse's plane is vertical, "
                "so that its direction must be horizontal (third number 0)"
            )

    @property
    def is_straight(self) -> bool:
        """Whether the foot moves on a line."""
        return False

    @property
    def rise(self) -> SineWave:
        """Velocity upwards."""
        return SineWave(self.lift / 2.0 * self.frequency, self.frequency, math.pi / 2)

    @property
    def parts(self) -> tuple[tuple[SineWave, Sequence[float]], ...]:
        """The velocity as a sum of waves along directions (3,)."""
        return (*super().parts, (self.rise, (0.0, 0.0, 1.0)))

    @property
    def greatest_speed(self) -> float:
        """Greatest speed of the foot [m/s]."""
        return max(abs(self.amplitude), abs(self.lift) / 2.0 * self.frequency)

    @property
    def across(self) -> Array:
        """The direction in which the foot does not move, as a column (3, 1)."""
        return np.cross(self.direction, UP)[:, np.newaxis]

    def displacement(self, time: ArrayLike) -> Array:
        """Displacement of the foot from its start at times (n,) [s], (n, 3) [m]."""
        rise = self.lift / 2.0 * np.sin(self._phase(time))
        return super().displacement(time) + np.outer(rise, UP)

    def velocity(self, time: ArrayLike) -> Array:
        """Velocity of the foot at times (n,) [s], (n, 3) [m/s]."""
        climb = self.lift / 2.0 * self.frequency * np.cos(self._phase(time))
        return super().velocity(time) + np.outer(climb, UP)

    def acceleration(self, time: ArrayLike) -> Array:
        """Acceleration of the foot at times (n,) [s], (n, 3) [m/s^2]."""
        slowing = -self.lift / 2.0 * self.frequency**2 * np.sin(self._phase(time))
        return super().acceleration(time) + np.outer(slowing, UP)


@dataclass(frozen=True, kw_only=True)
class Push:
    """The force ``F sin(pi (t - at) / lasting)`` from ``at`` to ``at + lasting``, otherwise 0."""

    force: tuple[float, float, float]  # F, its greatest value, base frame [N]
    at: float  # [s]
    lasting: float  # [s]

    def __post_init__(self) -> None:
        require_three("the push", self.force)
        if not all(abs(part) <= MOST for part in self.force):
            raise InvalidValueError(
                f"the push is {list(self.force)}; it must be three finite numbers in N, "
                "as (0, 0, 0.1)"
            )
        require_non_negative("the instant of the push", self.at, "s")
        require_positive("the time that the push lasts", self.lasting, "s")

    @property
    def end(self) -> float:
        """Time at which the push ends [s]."""
        return self.at + self.lasting

    @property
    def impulse(self) -> Array:
        """Integral of the force over time, ``2 F lasting / pi`` (3,) [N*s]."""
        impulse: Array = 2.0 * self.lasting / math.pi * np.array(self.force)
        return impulse

    def at_time(self, time: ArrayLike) -> Array:
        """Force (..., 3) in the base frame [N] at times (...) [s]."""
        part = np.clip((np.asarray(time) - self.at) / self.lasting, 0.0, 1.0)
        force: Array = np.multiply.outer(np.sin(np.pi * part), np.array(self.force))
        return force


def limited_speed(
    v: Floats, a: Floats, top: float, lengths: Floats
) -> tuple[list[float], list[float]]:
    """Shorten a velocity v and its derivative a to a greatest speed [m/s], the direction kept.

    Where ``|v| > top``, the velocity is ``top v / |v|`` and its derivative
    ``(top / |v|) (a - n (n . a))`` with ``n = v / |v|``; elsewhere both are unchanged.
    ``lengths`` scale each component of the velocity to a length [m/unit].
    """
    weights = [length * length for length in lengths]
    square = sum(w * part * part for w, part in zip(weights, v, strict=True))
    if square <= top * top:
        return list(v), list(a)
    along = sum(w * x * y for w, x, y in zip(weights, v, a, strict=True)) / square
    factor = top / square**0.5
    return [factor * x for x in v], [factor * (y - along * x) for x, y in zip(v, a, strict=True)]
