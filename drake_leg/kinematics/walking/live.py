"""A walk that is driven while it goes: the twin, with a state, of the walk that is planned."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, finite_vectors
from drake_leg.kinematics.walking.gait import Gait
from drake_leg.kinematics.walking.gaits import advance, bump, smoothstep
from drake_leg.kinematics.walking.plan import PlanRow
from drake_leg.units import require_non_negative, require_positive

RESPONSE = 4.0  # [1/s], at which the body's velocity approaches what is commanded
GREATEST = np.array([0.4, 0.4, 1.5])  # [m/s^2, m/s^2, rad/s^2], of the body
RISE = 0.05  # [m/s], greatest speed of a change of height
AIMED = 0.8  # of a swing: until then it is aimed at where the body will be
NEAR = 1e-4  # [m]: a foot that is so near to where it would go stays
HELD = 4  # time steps for which a feed-forward is held: to compute it takes as long as a step
STILL = 1e-4  # [m/s, rad/s]: a body that is slower is at rest


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """A driven walk at a time; G is the frame of the ground."""

    number: int  # of the time step
    course: Array  # (3,), x, y and heading of the body's level frame [m, rad]
    velocity: Array  # (3,), forward, sideways, turning [m/s, rad/s], in the level frame
    acceleration: Array  # (3,), of these
    height: float  # of the body [m]
    climb: float  # [m/s]
    climbing: float  # [m/s^2]
    phase: float  # of the gait, 0 to 1
    places: Array  # (n, 3), footholds that feet stand on or left [m]
    aims: Array  # (n, 3), where swings end [m]
    swung: Array  # (n,), how much of its swing each foot has done, 0 to 1; 0 where it stands
    feet: Array  # (n, 3) p_GF [m]
    speeds: Array  # (n, 3), their velocities [m/s]
    landed: NDArray[np.bool_]  # (n,), whether each foot's stance began with a touch-down

    @property
    def down(self) -> NDArray[np.bool_]:
        """Whether each foot stands, (n,)."""
        return np.asarray(self.swung == 0.0)

    @property
    def X_GB(self) -> Array:
        """Pose of the body, (4, 4)."""
        return _pose(self.course, self.height)

    @property
    def twist(self) -> Array:
        """Twist of the body in B, (6,), rotation first [rad/s, m/s]."""
        forward, sideways, turning = self.velocity
        return np.array([0.0, 0.0, turning, forward, sideways, self.climb])


LiveTorques = Callable[["LiveWalk", Moment, Moment], Array]


class LiveWalk:
    """The rows of a walk whose commands come while it goes, in place of a ``WalkPlan``.

    The body follows ``command`` with a bounded acceleration. A foot stands where it is until its
    gait lifts it; then it swings to where the body, if it went on as it does, would be in the
    middle of the next stance. Gaits change where all feet stand and the body rests. With a constant
    command it walks as ``Walk`` does.

    Parameters
    ----------
    gait : Gait
        The first one.
    period : float
        Of the gait [s].
    neutral : (n, 3) array_like
        Feet in the level frame of the body when it stands [m].
    height : float
        Of the body over the ground [m].
    step : float
        Between two rows [s].
    lift : float
        Height of a swing [m].
    torques : callable, optional
        The feed-forward (3 n,) [N*m] at the end of a time step, of this walk and of the moments at
        its beginning and end; by default there is none.
    """

    def __init__(
        self,
        gait: Gait,
        *,
        period: float,
        neutral: Array,
        height: float,
        step: float,
        lift: float = 0.03,
        torques: LiveTorques | None = None,
    ) -> None:
        require_positive("the period", period, "s")
        require_positive("the time step", step, "s")
        require_positive("the height", height, "m")
        require_non_negative("the lift", lift, "m")
        self.neutral = finite_vectors("the neutral places of the feet", neutral, 3)
        if self.neutral.shape != (len(gait.phases), 3):
            raise InvalidValueError(
                f"the neutral places of the feet have shape {self.neutral.shape}; the gait "
                f"{gait.name!r} has {len(gait.phases)} legs"
            )
        self.gait, self.period, self.step, self.lift = gait, period, step, lift
        self._first_height, self._torques = height, torques
        self.reset()

    def reset(self) -> None:
        """Stand again where the walk began, at time 0."""
        self.command, self.height = np.zeros(3), self._first_height
        self._next_gait: tuple[Gait, float] | None = None
        still, feet = np.zeros(3), self.neutral
        self.now = Moment(
            number=0,
            course=still,
            velocity=still,
            acceleration=still,
            height=self.height,
            climb=0.0,
            climbing=0.0,
            phase=0.0,
            places=feet,
            aims=feet,
            swung=np.zeros(len(feet)),
            feet=feet,
            speeds=np.zeros_like(feet),
            landed=np.zeros(len(feet), dtype=bool),
        )
        self._row: PlanRow | None = None
        self._held = np.zeros(3 * len(feet))  # torques [N*m]
        self._then = self.now

    def change_gait(self, gait: Gait, period: float) -> None:
        """Stop, and go on with another gait."""
        if len(gait.phases) != len(self.neutral):
            raise InvalidValueError(
                f"the gait {gait.name!r} has {len(gait.phases)} legs, and the robot has "
                f"{len(self.neutral)}"
            )
        require_positive("the period", period, "s")
        is_other = (gait, period) != (self.gait, self.period)
        self._next_gait = (gait, period) if is_other else None

    @property
    def is_changing(self) -> bool:
        """Whether the robot stops for another gait."""
        return self._next_gait is not None

    def at(self, time: float) -> PlanRow:
        """Return the row of a time [s]: that of the last call, or the next one."""
        number = round(time / self.step)
        if self._row is None or number == self._then.number:
            self.now = self._then
            self._then = self._after(self.now)
            self._row = self._between(self.now, self._then)
        if number != self.now.number:
            raise InvalidValueError(
                f"a driven walk has no row for {time:g} s; it is at {self.now.number * self.step:g}"
                " s, and goes on step by step"
            )
        return self._row

    def _between(self, now: Moment, then: Moment) -> PlanRow:
        R = now.X_GB[:3, :3]
        swing = (now.speeds @ R + then.speeds @ then.X_GB[:3, :3]) / 2.0
        return PlanRow(
            X_GB=now.X_GB,
            twist=(now.twist + then.twist) / 2.0,
            feet=(now.feet - now.X_GB[:3, 3]) @ R,
            swing=swing,
            down=now.down,
            torques=self._loads(now, then),
            swung=np.stack(
                [now.swung, np.where(now.down, 0.0, np.where(then.down, 1.0, then.swung))]
            ),
        )

    def _loads(self, now: Moment, then: Moment) -> Array:
        if self._torques is not None and then.number % HELD == 1:
            self._held = self._torques(self, now, then)
        return self._held

    def firmness(self, at: Moment, fading: float) -> Array:
        """How firmly each foot stands, (n,), as of ``Walk``; one that is to stay stands firmly."""
        done = (at.phase - np.array(self.gait.phases)) % 1.0
        since, until = self.period * done, self.period * (self.gait.duty - done)
        stays = np.linalg.norm(self._ahead(at, np.zeros(len(done))) - at.places, axis=1) <= NEAR
        rise = np.where(at.landed, smoothstep(since / fading).value, 1.0)
        fall = np.where(stays | (until <= 0.0), 1.0, smoothstep(until / fading).value)
        return np.where(at.down, rise * fall, 0.0)

    def _after(self, now: Moment) -> Moment:
        """Go on by one time step."""
        if self._next_gait is not None and self._rests(now):
            (self.gait, self.period), self._next_gait = self._next_gait, None
            now = replace(now, phase=0.0, landed=np.zeros_like(now.landed))
        moved = self._body_after(now)
        return self._feet_after(now, moved)

    def _rests(self, now: Moment) -> bool:
        return bool(now.down.all() and (np.abs(now.velocity) < STILL).all())

    def _body_after(self, now: Moment) -> Moment:
        dt = self.step
        target = np.zeros(3) if self.is_changing else np.asarray(self.command, dtype=np.float64)
        wanted = np.clip(RESPONSE * (target - now.velocity), -GREATEST, GREATEST)
        acceleration = now.acceleration + _share(dt) * (wanted - now.acceleration)
        velocity = now.velocity + dt * (now.acceleration + acceleration) / 2.0
        climb = float(np.clip(RESPONSE * (self.height - now.height), -RISE, RISE))
        climb = now.climb + _share(dt) * (climb - now.climb)
        mean = (now.velocity + velocity) / 2.0
        return replace(
            now,
            number=now.number + 1,
            course=_moved(now.course, mean, dt),
            velocity=velocity,
            acceleration=acceleration,
            height=now.height + dt * (now.climb + climb) / 2.0,
            climb=climb,
            climbing=(climb - now.climb) / dt,
            phase=(now.phase + dt / self.period) % 1.0,
        )

    def _feet_after(self, now: Moment, moved: Moment) -> Moment:
        duty, lasts = self.gait.duty, self.period * (1.0 - self.gait.duty)
        since = (moved.phase - np.array(self.gait.phases)) % 1.0 - duty  # of the swing, if not less
        u = np.where(since >= 0.0, since / (1.0 - duty), 0.0)
        before = self._ahead(now, now.swung)
        ahead = self._ahead(moved, u)
        lifts = (u > 0.0) & now.down & (u * lasts <= self.step * (1.0 + 1e-9))
        far = np.linalg.norm(ahead - now.places, axis=1) > NEAR
        swings = np.where(now.down, lifts & far, u > 0.0)
        lands = ~now.down & ~swings
        landed = swings | (now.landed & (u == 0.0))
        weight = 1.0 - smoothstep(u / AIMED).value[:, np.newaxis]
        aims = np.where(now.down[:, np.newaxis], ahead, now.aims + weight * (ahead - before))
        places = np.where(lands[:, np.newaxis], now.aims, now.places)
        u = np.where(swings, u, 0.0)
        part, rate, _ = (one[:, np.newaxis] for one in advance(u))
        rise, climb, _ = bump(u)
        feet = places + part * (aims - places)
        feet[:, 2] += self.lift * rise
        aim_rates = np.where(now.down[:, np.newaxis], 0.0, (aims - now.aims) / self.step)
        speeds = rate / lasts * (aims - places) + part * aim_rates
        speeds[:, 2] += self.lift * climb / lasts
        speeds[~swings] = 0.0
        return replace(
            moved, places=places, aims=aims, swung=u, feet=feet, speeds=speeds, landed=landed
        )

    def _ahead(self, at: Moment, u: Array) -> Array:
        """Where feet stand best after swings of which u are done, (n, 3) [m]."""
        rest = self.period * ((1.0 - self.gait.duty) * (1.0 - u) + self.gait.duty / 2.0)
        found = np.empty_like(self.neutral)
        for foot, time in enumerate(rest.tolist()):
            X = _pose(_moved(at.course, at.velocity, time), 0.0)
            found[foot] = X[:3, :3] @ self.neutral[foot] + X[:3, 3]
        return found


def _share(dt: float) -> float:
    """Of the way to the wanted acceleration, in a time step: neither lags nor overshoots."""
    return 1.0 - math.exp(-4.0 * RESPONSE * dt)


def _moved(course: Array, velocity: Array, time: float) -> Array:
    """Course after a time at a constant velocity in the moving frame."""
    x, y, heading = course.tolist()
    forward, sideways, turning = velocity.tolist()
    angle = turning * time
    if abs(angle) < 1e-9:
        along, across = forward * time, sideways * time
    else:
        s, v = math.sin(angle) / turning, (1.0 - math.cos(angle)) / turning
        along, across = s * forward - v * sideways, v * forward + s * sideways
    c, s = math.cos(heading), math.sin(heading)
    return np.array([x + c * along - s * across, y + s * along + c * across, heading + angle])


def _pose(course: Array, height: float) -> Array:
    x, y, heading = course.tolist()
    c, s = math.cos(heading), math.sin(heading)
    return np.array(
        [[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, height], [0.0, 0.0, 0.0, 1.0]]
    )
