"""How six legs walk: gaits, and the paths of body and feet as functions of time alone.

The body moves in the world along ``X(t) = Exp(xi_1 sigma_1(t)) Exp(xi_2 sigma_2(t)) ...``, a screw
for each command with a smooth beginning and end. A foot stands where the body's motion puts its
neutral place in the middle of its stance; between two footholds it swings in the world and is at
rest at both. So stance feet never slip, and every derivative has a closed form.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, finite_vectors, real_numbers
from drake_leg.kinematics.walking.gait import Gait
from drake_leg.units import (
    require_finite,
    require_non_negative,
    require_positive,
    require_three,
)

ON_TIME = 1e-9  # of a period: a foot that is to stand is this early or late by rounding
# Of a swing, after which a foot is over its place: it comes down from above. A body that sinks into
# its contacts, or ground that is higher than planned, would else let it touch while it moves on,
# and push the body back.
OVER_PLACE = 0.93


class Motion(NamedTuple):
    """Values at times, and their first and second derivatives, alike in shape."""

    value: Array
    rate: Array
    acceleration: Array


@dataclass(frozen=True, kw_only=True)
class Command:
    """A constant velocity of the body, in its own level frame, with a smooth beginning and end.

    The velocity grows over ``ramp`` from ``start`` on, and falls over ``ramp`` from ``end`` on; its
    integral over all time is the velocity times ``end - start``.
    """

    forward: float = 0.0  # [m/s], along x
    sideways: float = 0.0  # [m/s], along y, to the left
    turning: float = 0.0  # [rad/s], about z, to the left
    start: float = 0.0  # [s]
    end: float = math.inf  # [s]
    ramp: float = 1.0  # [s]

    def __post_init__(self) -> None:
        for name in ("forward", "sideways", "turning", "start"):
            require_finite(f"the command's {name}", getattr(self, name))
        require_positive("the command's ramp", self.ramp, "s")
        if not self.end > self.start:
            raise InvalidValueError(
                f"the command ends at {self.end!r} s and starts at {self.start!r} s; it must end "
                "later"
            )

    @property
    def twist(self) -> Array:
        """Twist (6,), rotation first [rad/s, m/s]."""
        return np.array([0.0, 0.0, self.turning, self.forward, self.sideways, 0.0])

    def progress(self, time: Array) -> Motion:
        """Equivalent time at full velocity, (...) [s], and its derivatives."""
        rising = _ramped((time - self.start) / self.ramp)
        if math.isinf(self.end):
            part, share, bend = rising
        else:
            falling = _ramped((time - self.end) / self.ramp)
            part, share, bend = (up - down for up, down in zip(rising, falling, strict=True))
            # Without rounding afterwards, so that feet stay below a body that rests.
            over = time >= self.end + self.ramp
            part = np.where(over, (self.end - self.start) / self.ramp, part)
        return Motion(self.ramp * part, share, bend / self.ramp)


@dataclass(frozen=True, kw_only=True)
class Attitude:
    """A change of the body's pose over its level frame: a screw, smooth at both ends."""

    roll: float = 0.0  # [rad], rotation vector's part about x
    pitch: float = 0.0  # [rad], about y
    yaw: float = 0.0  # [rad], about z
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m]
    start: float = 0.0  # [s]
    lasting: float = 1.0  # [s]

    def __post_init__(self) -> None:
        for name in ("roll", "pitch", "yaw", "start"):
            require_finite(f"the attitude's {name}", getattr(self, name))
        require_three("the attitude's shift", self.shift)
        angle = math.hypot(self.roll, self.pitch, self.yaw)
        if angle > math.pi:
            raise InvalidValueError(
                f"the attitude turns the body by {angle:.6g} rad; it must be half a turn at most"
            )
        require_positive("how long the attitude changes", self.lasting, "s")

    @property
    def twist(self) -> Array:
        """Logarithm of the pose, (6,), rotation first [rad, m]."""
        w = np.array([self.roll, self.pitch, self.yaw])
        angle = float(np.linalg.norm(w))
        p = np.array(self.shift)
        if angle == 0.0:
            return np.concatenate([w, p])
        K = _skew(w)
        half = angle / 2.0
        last = (1.0 - half / math.tan(half)) / angle**2
        return np.concatenate([w, (np.eye(3) - 0.5 * K + last * K @ K) @ p])

    def progress(self, time: Array) -> Motion:
        """Part of the change that is done, (...), 0 to 1, and its derivatives."""
        part, rate, bend = smoothstep((time - self.start) / self.lasting)
        return Motion(part, rate / self.lasting, bend / self.lasting**2)


@dataclass(frozen=True, kw_only=True)
class Walk:
    """The paths of a body and its feet.

    Parameters
    ----------
    gait : Gait
        With as many legs as there are feet.
    period : float
        Of the gait [s].
    neutral : (n, 3) array_like
        Feet in the level frame of the body when it stands [m].
    commands : sequence of Command
        One after the other; where two overlap, the later one acts in the frame that the earlier one
        moves.
    attitudes : sequence of Attitude
        Changes of height, roll, pitch, yaw and place of the body over its feet.
    lift : float
        Height of a swing [m].
    begins : float
        When the gait's first period begins [s]; until then the feet stand.
    place : (4, 4) array_like, optional
        Pose of the body's level frame in the world until then; by default they are the same.

    Raises
    ------
    InvalidValueError
        If a number is invalid, there are not as many feet as the gait has legs, or a command starts
        before ``earliest_start``.
    """

    gait: Gait
    period: float
    neutral: ArrayLike
    commands: Sequence[Command] = ()
    attitudes: Sequence[Attitude] = ()
    lift: float = 0.03
    begins: float = 0.0
    place: ArrayLike | None = None

    def __post_init__(self) -> None:
        require_kind("the gait", self.gait, Gait)
        for what, parts, kind in (
            ("commands", self.commands, Command),
            ("attitudes", self.attitudes, Attitude),
        ):
            require_kind(f"the {what} of a walk", parts, tuple, list)
            for part in parts:
                require_kind(f"one of the {what} of a walk", part, kind)
        require_positive("the period", self.period, "s")
        require_non_negative("the lift", self.lift, "m")
        feet = finite_vectors("the neutral places of the feet", self.neutral, 3)
        if feet.shape != (len(self.gait.phases), 3):
            raise InvalidValueError(
                f"the neutral places of the feet have shape {feet.shape}; the gait "
                f"{self.gait.name!r} has {len(self.gait.phases)} legs"
            )
        object.__setattr__(self, "neutral", feet)
        require_finite("when the walk begins", self.begins)
        if self.place is not None:
            place = finite_vectors("the place of the walk", self.place, 4)
            if place.shape != (4, 4):
                raise InvalidValueError(
                    f"the place of the walk has shape {place.shape}; it must be a pose, (4, 4)"
                )
            object.__setattr__(self, "place", place)
        least = self.earliest_start
        for command in self.commands:
            if command.start < least:
                raise InvalidValueError(
                    f"a command starts at {command.start:g} s, when a leg would already swing at "
                    f"time {self.begins:g}; start it at {least:.6g} s at the earliest"
                )

    @property
    def earliest_start(self) -> float:
        """When a command may start [s]: all feet stand at the beginning, whatever their phases."""
        return self.begins + self.period * (1.0 - self.gait.duty / 2.0)

    @property
    def stands_from(self) -> float:
        """From when on body and feet rest [s]; infinite if they never do."""
        rest = max([self.begins, *(command.end + command.ramp for command in self.commands)])
        if math.isinf(rest):
            return rest
        middle = self.gait.duty / 2.0
        periods = [
            math.ceil((rest - self.begins) / self.period - phase - middle - ON_TIME) + phase
            for phase in self.gait.phases
        ]
        return max(rest, self.begins + self.period * max(periods))

    def level(self, time: ArrayLike) -> Motion:
        """Pose of the body's level frame in the world, (..., 4, 4) [-, m], with derivatives."""
        X = _screws(self.commands, real_numbers("the time", time))
        if self.place is None:
            return X
        return Motion(*(np.asarray(self.place) @ part for part in X))

    def body(self, time: ArrayLike) -> Motion:
        """Pose X_WB of the body, (..., 4, 4) [-, m], with derivatives."""
        times = real_numbers("the time", time)
        return product(self.level(times), _screws(self.attitudes, times))

    def feet_in_world(self, time: ArrayLike) -> Motion:
        """Feet p_WF, (..., n, 3) [m], with velocities and accelerations in the world."""
        here, u, _ = self._swing(time)
        there = self._foothold(self._cycle(time)[0] + 1.0)
        way = there - here
        part, rate, bend = advance(u)
        moves = (way != 0.0).any(axis=-1)
        rise, climb, arch = (self.lift * moves * one for one in bump(u))
        per = 1.0 / (self.period * (1.0 - self.gait.duty))

        def along(share: Array, height: Array) -> Array:
            found: Array = share[..., np.newaxis] * way
            found[..., 2] += height
            return found

        return Motion(
            here + along(part, rise), per * along(rate, climb), per**2 * along(bend, arch)
        )

    def feet(self, time: ArrayLike) -> Motion:
        """Feet p_BF in the body's frame, (..., n, 3) [m], with derivatives there."""
        return in_body(self.body(time), self.feet_in_world(time))

    def down(self, time: ArrayLike) -> NDArray[np.bool_]:
        """Whether each foot stands, (..., n) of bool; it does between two equal footholds, too."""
        here, _, swings = self._swing(time)
        there = self._foothold(self._cycle(time)[0] + 1.0)
        found: NDArray[np.bool_] = np.logical_not(swings) | (here == there).all(axis=-1)
        return found

    def swung(self, time: ArrayLike) -> Array:
        """How much of its swing each foot has done, (..., n), 0 to 1; 0 in its stance."""
        return self._swing(time)[1]

    def firmness(self, time: ArrayLike, fading: float) -> Array:
        """How firmly each foot stands, (..., n): 0 in the air, 1 on the ground, smooth in time.

        It rises during ``fading`` [s] after a touch-down, and falls before a lift-off. A foot that
        stays where it is stands firmly all the time.
        """
        require_positive("how long a foot's firmness fades", fading, "s")
        number, done = self._cycle(time)
        before, here, after = (self._foothold(number + step) for step in (-1.0, 0.0, 1.0))
        since, until = self.period * done, self.period * (self.gait.duty - done)
        stays = (here == after).all(axis=-1)
        rise = np.where((before == here).all(axis=-1), 1.0, smoothstep(since / fading).value)
        fall = np.where(stays, 1.0, smoothstep(until / fading).value)
        return np.where(done < self.gait.duty, rise * fall, np.where(stays, 1.0, 0.0))

    def _cycle(self, time: ArrayLike) -> tuple[Array, Array]:
        """Number of each leg's cycle, and how much of it is done, (..., n)."""
        times = real_numbers("the time", time)[..., np.newaxis]
        s = (times - self.begins) / self.period - np.array(self.gait.phases)
        number = np.floor(s)
        return number, s - number

    def _swing(self, time: ArrayLike) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Foothold of each leg, how much of its swing is done, and whether it swings."""
        number, done = self._cycle(time)
        u = np.clip((done - self.gait.duty) / (1.0 - self.gait.duty), 0.0, 1.0)
        return self._foothold(number), u, done >= self.gait.duty

    def _foothold(self, number: Array) -> Array:
        """Where each foot stands in a cycle, (..., n, 3) [m]."""
        if not number.size:
            return np.empty((*number.shape, 3))
        first = number.min()
        cycles = np.arange(first, number.max() + 1.0)  # few, in many times
        begun = cycles[:, np.newaxis] + np.array(self.gait.phases)
        X = self.level(self.begins + self.period * (begun + self.gait.duty / 2.0)).value
        feet = np.asarray(self.neutral)
        places: Array = np.einsum("...nij,nj->...ni", X[..., :3, :3], feet) + X[..., :3, 3]
        found: Array = places[(number - first).astype(np.intp), np.arange(len(feet))]
        return found


def smoothstep(u: Array) -> Motion:
    """Quintic from 0 at 0 to 1 at 1, constant outside, and its derivatives by u."""
    x = np.clip(u, 0.0, 1.0)
    inside = (u > 0.0) & (u < 1.0)
    return Motion(
        risen(x),
        inside * 30.0 * x**2 * (1.0 - x) ** 2,
        inside * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )


def advance(u: Array) -> Motion:
    """How far a foot is on its way when u of its swing is done, and the derivatives by u."""
    part, rate, bend = smoothstep(u / OVER_PLACE)
    return Motion(part, rate / OVER_PLACE, bend / OVER_PLACE**2)


def risen(x: Array) -> Array:
    """Value of ``smoothstep`` between 0 and 1."""
    return np.asarray(x * x * x * (10.0 + x * (6.0 * x - 15.0)))


def arched(u: Array) -> Array:
    """Value of ``bump``."""
    w = u * (1.0 - u)
    return np.asarray(64.0 * w * w * w)


def in_body(body: Motion, points: Motion) -> Motion:
    """Points (..., n, 3), given in the world, in the frame of a body X_WB, with derivatives."""
    X, dX, ddX = body
    R, dR, ddR = (part[..., :3, :3] for part in (X, dX, ddX))
    p, v, a = (
        in_world - part[..., np.newaxis, :3, 3]
        for in_world, part in zip(points, (X, dX, ddX), strict=True)
    )  # rows, so that p @ R turns them by R^T
    return Motion(p @ R, v @ R + p @ dR, a @ R + 2.0 * v @ dR + p @ ddR)


def _ramped(u: Array) -> Motion:
    """Integral of ``smoothstep`` from 0, and its derivatives by u."""
    x = np.clip(u, 0.0, 1.0)
    share, bend, _ = smoothstep(u)
    return Motion(x**4 * (2.5 + x * (x - 3.0)) + np.maximum(u - 1.0, 0.0), share, bend)


def bump(u: Array) -> Motion:
    """``64 u^3 (1 - u)^3``, 1 in the middle, and its derivatives by u."""
    w = u * (1.0 - u)
    slope = 1.0 - 2.0 * u
    return Motion(arched(u), 192.0 * w**2 * slope, 384.0 * w * (slope**2 - w))


def _skew(w: Array) -> Array:
    x, y, z = w
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _screws(parts: Sequence[Command | Attitude], time: Array) -> Motion:
    """Product of the screws of all parts, (..., 4, 4), with derivatives in time."""
    if not parts:
        still = np.zeros((*time.shape, 4, 4))
        return Motion(still + np.eye(4), still, still)
    return reduce(product, (_screw(part.twist, part.progress(time)) for part in parts))


def _screw(twist: Array, progress: Motion) -> Motion:
    """``Exp(twist s)``, (..., 4, 4), with its derivatives where s has some."""
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = _skew(twist[:3]), twist[3:]
    rate, bend = (one[..., np.newaxis, np.newaxis] for one in progress[1:])
    X = _exponential(twist, progress.value)
    dX = X @ generator
    return Motion(X, dX * rate, dX @ generator * rate**2 + dX * bend)


def _exponential(twist: Array, s: Array) -> Array:
    size = float(np.linalg.norm(twist[:3]))
    X = np.zeros((*s.shape, 4, 4))
    X[..., 3, 3] = 1.0
    if size == 0.0:
        X[..., :3, :3] = np.eye(3)
        X[..., :3, 3] = s[..., np.newaxis] * twist[3:]
        return X
    K = _skew(twist[:3] / size)
    angle = (size * s)[..., np.newaxis, np.newaxis]
    sine, versine = np.sin(angle), 2.0 * np.sin(angle / 2.0) ** 2
    X[..., :3, :3] = np.eye(3) + sine * K + versine * (K @ K)
    V = angle * np.eye(3) + versine * K + (angle - sine) * (K @ K)
    X[..., :3, 3] = V @ (twist[3:] / size)
    return X


def product(first: Motion, second: Motion) -> Motion:
    """Product of two matrices that depend on time, with its derivatives."""
    (A, dA, ddA), (B, dB, ddB) = first, second
    return Motion(A @ B, dA @ B + A @ dB, ddA @ B + 2.0 * dA @ dB + A @ ddB)
