"""What a walk demands of a robot at the worst of its times, and whether the robot can do that."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.clearance import capsules_of
from drake_leg.kinematics.walking.gaits import Walk
from drake_leg.kinematics.walking.lateness import (
    GAP,
    LATE,
    late_times,
    position_errors,
)
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.loads import outwards_on, planned_loads
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.robot.ground import FLAT, Ground
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import Servo
from drake_leg.units import AT_LIMIT, STANDARD_GRAVITY

BEHIND = 0.15  # [rad], how far a joint may be behind its plan while its foot stands


@dataclass(frozen=True, kw_only=True)
class Demand:
    """One quantity of a walk where it is worst."""

    what: str  # "reach", "joint limit", "joint speed", ...
    where: str  # leg, joint, link, or two links; empty for the whole robot
    time: float  # [s]
    value: float
    limit: float
    spare: float  # how far it is on the right side of the limit; negative or NaN where it fails
    unit: str
    problem: str  # in a sentence, what is wrong if it fails

    @property
    def is_met(self) -> bool:
        """Whether the robot can do it."""
        return self.spare >= 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Abilities:
    """What a robot can do when it walks on a ground.

    A ``dynamic`` walk may leave its static support.
    """

    robot: Robot
    servo: Servo | None = None
    ground: Ground = FLAT
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    dynamic: bool = False

    @cached_property
    def legs(self) -> Legs:
        """The robot's legs."""
        return Legs.of(self.robot)

    def _own_limits(self, name: str) -> Array:
        """Limits of speed or effort of every joint, (n, 3); infinite where there is none."""
        own = [getattr(segment.mechanics, name) for segment in self.robot.moving]
        return np.array([math.inf if each is None else each for each in own]).reshape(-1, 3)

    @property
    def falling(self) -> tuple[float, float, float]:
        """Gravity in the frame of the ground, (3,) [m/s^2]."""
        x, y, z = (-self.gravity * part for part in self.ground.X_WG[2][:3])
        return x, y, z

    def plan(self, walk: Walk, times: Array) -> PlannedWalk:
        """Let the robot follow a walk at times (rows,) [s]."""
        return PlannedWalk(
            robot=self.robot,
            legs=self.legs,
            walk=walk,
            times=times,
            gravity=self.falling,
            outwards=outwards_on(self.ground),
        )

    def first_unmet(self, walk: Walk, times: Array, *, geometry: bool = False) -> Demand | None:
        """Return the first demand that the robot cannot meet; of geometry only if asked for."""
        plan = self.plan(walk, times)
        demands = self.geometry(plan) if geometry else self.demands(plan)
        return next((one for one in demands if not one.is_met), None)

    def geometry(self, plan: PlannedWalk) -> Iterator[Demand]:
        """Yield what must hold for each posture; only the first one if a foot is out of reach."""
        reach = self._reach(plan)
        yield reach
        if reach.is_met:
            yield from self._limits(plan)
            yield self._body_clearance(plan)

    def demands(self, plan: PlannedWalk) -> Iterator[Demand]:
        """Yield all that must hold, the cheapest first; little more if a foot is out of reach."""
        yield self._friction(plan)
        reach = self._reach(plan)
        yield reach
        if reach.is_met:
            yield from self._limits(plan)
            yield from self._speeds(plan)
            yield self._body_clearance(plan)
            yield from self._gaps(plan)
            yield self._static_margin(plan)
            yield from self._following(plan)

    def informative(self, plan: PlannedWalk) -> Iterator[Demand]:
        """Yield what is worth knowing and refuses no walk; a servo may be late for an instant."""
        servo, names = self.servo, self.legs.joint_names
        peaks = [("joint speed", plan.joints.rate, "rad/s", servo and servo.no_load_speed)]
        if servo is not None:
            torques = self._drive_torques(plan, servo)
            peaks.append(("torque", torques, "N*m", servo.stall_torque))
        for what, values, unit, limit in peaks:
            number, leg, joint = _least(-np.abs(values))
            most = abs(float(values[number, leg, joint]))
            yield _demand(plan, number, what, names[leg][joint], most, limit or math.inf, unit=unit)
        number = int(np.argmin(plan.dynamic_margins))
        margin = float(plan.dynamic_margins[number])
        yield _demand(plan, number, "dynamic margin", "", margin, -math.inf)
        number, leg = _least(plan.sigma_mins)
        least = float(plan.sigma_mins[number, leg])
        name = self.legs.names[leg]
        yield _demand(plan, number, "sigma_min", name, least, 0.0, unit="m/rad")

    def _reach(self, plan: PlannedWalk) -> Demand:
        l1, l2, l3 = self.legs.lengths.T
        x, y, z = np.moveaxis(plan.feet.value - self.legs.hips, -1, 0)
        far = np.hypot(np.hypot(x, y) - l1, z)
        longest, shortest = l2 + l3, np.abs(l2 - l3)
        number, leg = _least(np.minimum(longest - far, far - shortest))
        value = float(far[number, leg])
        too_far = longest[leg] - value < value - shortest[leg]
        limit = float(longest[leg] if too_far else shortest[leg])
        return _demand(
            plan, number, "reach", self.legs.names[leg], value, limit,
            limit - value if too_far else value - limit, "m",
            f"the foot of {self.legs.names[leg]} would be {value:.4g} m from its knee{{when}}, and "
            f"femur and tibia reach {'at most' if too_far else 'no nearer than'} {limit:.4g} m",
        )  # fmt: skip

    def _limits(self, plan: PlannedWalk) -> Iterator[Demand]:
        if np.isinf(self.legs.limits).all():
            return
        q, (low, high) = plan.angles, np.moveaxis(self.legs.limits, -1, 0)
        number, leg, joint = _least(np.minimum(q - low, high - q))
        value, lower, upper = q[number, leg, joint], low[leg, joint], high[leg, joint]
        nearest = lower if value - lower < upper - value else upper
        spare = float(min(value - lower, upper - value))
        name = self.legs.joint_names[leg][joint]
        at, least, most = (math.degrees(angle) for angle in (value, lower, upper))
        yield _demand(
            plan, number, "joint limit", name, float(value), float(nearest),
            0.0 if -AT_LIMIT <= spare < 0.0 else spare, "rad",
            f"the joint {name} would be at {at:.4g} deg{{when}}, outside its limits {least:.6g} "
            f"... {most:.6g} deg",
        )  # fmt: skip

    def _body_clearance(self, plan: PlannedWalk) -> Demand:
        heights = plan.body_clearance
        number = int(np.argmin(heights))
        value = float(heights[number])
        return _demand(
            plan, number, "body over ground", "", value, 0.0, value, "m",
            f"the body would be {-1000.0 * value:.4g} mm in the ground{{when}}",
        )  # fmt: skip

    def _speeds(self, plan: PlannedWalk) -> Iterator[Demand]:
        limits = self._own_limits("velocity")
        if np.isinf(limits).all():
            return
        rates = np.abs(plan.joints.rate)
        number, leg, joint = _least(1.0 - rates / limits)
        value, limit = float(rates[number, leg, joint]), float(limits[leg, joint])
        name = self.legs.joint_names[leg][joint]
        yield _demand(
            plan, number, "speed limit", name, value, limit, limit - value, "rad/s",
            f"the joint {name} would turn at {value:.4g} rad/s{{when}}, and its limit is "
            f"{limit:.4g} rad/s",
        )  # fmt: skip

    def _following(self, plan: PlannedWalk) -> Iterator[Demand]:
        if self.servo is None:
            return
        servo, rates = self.servo, plan.joints.rate
        torques = self._drive_torques(plan, servo)
        stall = np.minimum(self._own_limits("effort"), servo.stall_torque)
        behind = lags(plan.times, torques, stall, servo.back_emf_damping)
        standing = np.where(plan.down[..., np.newaxis], np.abs(behind), 0.0)
        number, leg, joint = _least(-standing)
        value = float(standing[number, leg, joint])
        name = self.legs.joint_names[leg][joint]
        fast, strong = (float(np.abs(one[:, leg, joint]).max()) for one in (rates, torques))
        yield _demand(
            plan, number, "lag", name, value, BEHIND, BEHIND - value, "rad",
            f"the joint {name} would be {math.degrees(value):.3g} deg behind its plan{{when}}, its "
            f"foot on the ground, because it is to turn at {fast:.4g} rad/s and give {strong:.4g} "
            f"N*m, and the servo {servo.name!r} turns at most at {servo.no_load_speed:.4g} rad/s "
            f"and gives at most {stall[leg, joint]:.4g} N*m",
        )  # fmt: skip
        yield self._lateness(plan, servo, torques, stall)

    def _lateness(self, plan: PlannedWalk, servo: Servo, torques: Array, stall: Array) -> Demand:
        errors = position_errors(plan.times, torques, stall, servo)
        J = self.legs.jacobians(plan.angles)
        off = np.linalg.norm(J @ errors[..., np.newaxis], axis=(-2, -1))
        late = late_times(plan.times, off, plan.down)
        number, leg = _least(-late)
        share = float(late.max(axis=0).mean()) / plan.walk.period
        strong = np.abs(torques[:, leg]).max(axis=0)
        joint = int(np.argmax(strong / stall[leg]))
        name = self.legs.names[leg]
        return _demand(
            plan, number, "late feet", name, share, LATE, LATE - share, "of a period",
            f"feet would come late to their places, and stand out of them for {100.0 * share:.2g} "
            f"% of a period, worst of all {name}{{when}}, because in its swing the joint "
            f"{self.legs.joint_names[leg][joint]} is to give {strong[joint]:.4g} N*m, and the "
            f"servo {servo.name!r} gives at most {stall[leg, joint]:.4g} N*m",
        )  # fmt: skip

    def _drive_torques(self, plan: PlannedWalk, servo: Servo) -> Array:
        """Torques that the servos are to drive with, (rows, n, 3) [N*m]."""
        return planned_loads(plan, servo).torques.reshape(plan.joints.rate.shape)

    def _gaps(self, plan: PlannedWalk) -> Iterator[Demand]:
        capsules, distances = capsules_of(self.robot), plan.gaps
        if distances.size:
            number, pair = _least(distances)
            value = float(distances[number, pair])
            one, other = (capsules.names[each] for each in capsules.pairs[pair])
            yield _demand(
                plan, number, "gap between legs", f"{one}, {other}", value, 0.0, value, "m",
                f"{one} and {other} would collide{{when}}, {-1000.0 * value:.4g} mm in each other",
            )  # fmt: skip

    def _friction(self, plan: PlannedWalk) -> Demand:
        x, y, z = self.falling
        angle, most = math.atan2(math.hypot(x, y), -z), math.atan(self.ground.friction)
        return _demand(
            plan, 0, "slope", "", angle, most, most - angle, "rad",
            f"the ground slopes by {math.degrees(angle):.4g} deg, and with a friction of "
            f"{self.ground.friction:.4g} feet slide from {math.degrees(most):.4g} deg on",
        )  # fmt: skip

    def _static_margin(self, plan: PlannedWalk) -> Demand:
        margins = plan.static_margins
        number = int(np.argmin(margins))
        value = float(margins[number])
        feet = int(plan.down[number].sum())
        return _demand(
            plan, number, "static margin", "", value, 0.0,
            math.inf if self.dynamic else value, "m",
            f"the center of mass would be {-1000.0 * value:.4g} mm outside of the support by "
            f"{feet} feet{{when}}",
        )  # fmt: skip


def lags(times: Array, torques: Array, stall: Array, back_emf_damping: float) -> Array:
    """How far servos are behind their plan, (rows, ...) [rad], at planned torques (rows, ...).

    A motor at full voltage has the stall torque less ``back_emf_damping * speed``. Where more is
    planned, it is slower by what is missing over that damping; afterwards it catches up by what is
    left. Time begins without a lag, and again after each gap.
    """
    found = np.zeros_like(torques)
    steps = np.diff(times)
    gap = GAP * float(np.median(steps)) if len(steps) else 0.0
    for row, step in enumerate(steps):
        if step > gap:
            continue
        drive = 0.5 * (torques[row] + torques[row + 1])
        ahead, back = (
            found[row] + step * (drive - side * stall) / back_emf_damping for side in (1.0, -1.0)
        )
        found[row + 1] = np.maximum(ahead, 0.0) + np.minimum(back, 0.0)
    return found


def _least(values: Array) -> tuple[int, ...]:
    """Index of the smallest value, or of the first that is not a number."""
    return tuple(int(part) for part in np.unravel_index(int(np.argmin(values)), values.shape))


def _demand(
    plan: PlannedWalk, row: int, what: str, where: str, value: float, limit: float,
    spare: float = math.inf, unit: str = "m", problem: str = "",
) -> Demand:  # fmt: skip
    """Make a demand of the row of a plan, the time put into its sentence."""
    time = float(plan.times[row])
    part = (time - plan.walk.begins) / plan.walk.period % 1.0
    return Demand(
        what=what,
        where=where,
        time=time,
        value=value,
        limit=limit,
        spare=spare,
        unit=unit,
        problem=problem.replace("{when}", f" at t = {round(time, 4):g} s, {part:.2f} of the cycle"),
    )
