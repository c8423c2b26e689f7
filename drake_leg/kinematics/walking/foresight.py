"""What a walk will meet, before it is run: what fails, and the greatest values that work."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from drake_leg.arguments import checked
from drake_leg.errors import ImpossibleWalkError, InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.cycle_times import attitudes_end, times_of, times_within
from drake_leg.kinematics.walking.demands import Abilities, Demand
from drake_leg.kinematics.walking.gait import Gait
from drake_leg.kinematics.walking.gaits import Attitude, Command, Walk
from drake_leg.kinematics.walking.plan import require_phases
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.kinematics.walking.searches import (
    DOUBLINGS,
    bisected,
    greatest,
    rounded_down,
    rounded_up,
)
from drake_leg.robot.ground import FLAT, Ground
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import Servo
from drake_leg.units import STANDARD_GRAVITY, require_non_negative, require_positive

FEWEST_DOWN = 3  # feet that support a body at rest
FINER = 11  # halvings of the interval in which a least or greatest height lies
HEIGHTS = 40  # that are tried where the given one does not work
STEADY = 1.5  # periods at full speed, in which every leg swings from start to end
OFF_GROUND = 1e-3  # [m], how far a foot may be from the ground at the start
LEAST_SHARE = 2.0**-DOUBLINGS  # of a speed or a change of attitude that counts as none
_FORWARD = Command(forward=1.0)


@dataclass(frozen=True, kw_only=True)
class Remedy:
    """A change of the walk, by a value, with which it works."""

    what: str  # "speed", "lift", "attitude", "height"
    share: float  # of what was asked for; of the height, the change [m]
    says: str


@dataclass(frozen=True, kw_only=True, eq=False)
class WalkForesight:
    """What a robot will meet on a walk.

    Greatest and least values are those of one cycle at steady speed, all else being as given.
    """

    abilities: Abilities
    walk: Walk
    required: tuple[Demand, ...]  # each where it is worst; none after a foot is out of reach
    _plan: PlannedWalk

    @cached_property
    def demands(self) -> tuple[Demand, ...]:
        """What is required, and what is only told: peaks and margins that refuse no walk."""
        if not np.isfinite(self._plan.angles).all():
            return self.required
        return (*self.required, *self.abilities.informative(self._plan))

    @property
    def unmet(self) -> tuple[Demand, ...]:
        """Demands that the robot cannot meet."""
        return tuple(one for one in self.required if not one.is_met)

    def demand(self, what: str) -> Demand | None:
        """Return one of the demands by its name; None if it is unknown."""
        return next((one for one in self.demands if one.what == what), None)

    @cached_property
    def refusal(self) -> str | None:
        """A sentence on what fails, with the greatest value that works; None if nothing does."""
        return str(self._error) if self.unmet else None

    def require_walkable(self) -> None:
        """Refuse a walk that the robot cannot make.

        Raises
        ------
        ImpossibleWalkError
            With what fails, and the greatest value that works.
        """
        if self.unmet:
            raise self._error

    @cached_property
    def _error(self) -> ImpossibleWalkError:
        first = self.unmet[0]
        remedy = self.remedy
        says = remedy.says if remedy else "no slower or lower walk of these feet works"
        return ImpossibleWalkError(
            first.problem,
            advice=f"{says}; `force=True` goes on",
            where=first.where,
            time=first.time,
            value=first.value,
            limit=first.limit,
        )

    def lines(self) -> tuple[str, ...]:
        """Describe each demand where it is worst, one line each."""
        return tuple(
            f"{one.what}{f' of {one.where}' if one.where else ''}: {one.value:.4g} {one.unit}"
            + (f", limit {one.limit:.4g}" if math.isfinite(one.limit) and one.limit else "")
            + f", at t = {round(one.time, 4):g} s"
            for one in self.demands
        )

    # --- greatest values that work ---

    @cached_property
    def greatest_scale(self) -> float:
        """Greatest common factor of all commands at steady speed, 0 if none works.

        Without a command it is that of 1 m/s forward.
        """
        walks = [self._steady(command) for command in self._commands]

        def works(scale: float) -> bool:
            return all(
                self.abilities.first_unmet(_scaled(walk, scale), times) is None
                for walk, times in walks
            )

        return greatest(works)

    @property
    def greatest_speed(self) -> float:
        """Greatest speed along the ground of the fastest command [m/s]."""
        return self.greatest_scale * _speed(self._fastest)

    @property
    def greatest_turning(self) -> float:
        """Greatest rate of turning of the fastest command [rad/s]."""
        return self.greatest_scale * abs(self._fastest.turning)

    @property
    def greatest_stride(self) -> float:
        """How far the body goes in a period at the greatest speed [m]."""
        return self.greatest_speed * self.walk.period

    @cached_property
    def height(self) -> float:
        """Height of the body's frame over the ground in the steady walk [m]."""
        plan = self.abilities.plan(*self._steady_walk)
        return float((plan.body.value[:, 2, 3] - plan.support_heights).mean())

    @cached_property
    def heights(self) -> tuple[float, float] | None:
        """Least and greatest height of the body inside workspaces and joint limits [m].

        None if there is no such height.
        """
        walk, times = self._steady_walk

        def works(change: float) -> bool:
            raised = _raised(walk, change)
            return self.abilities.first_unmet(raised, times, geometry=True) is None

        lowest, highest = -self.height, self._length
        tried = sorted(np.linspace(lowest, highest, HEIGHTS).tolist(), key=abs)
        inside = next(filter(works, (0.0, *tried)), None)
        if inside is None:
            return None
        least, most = (bisected(works, inside, end, FINER) for end in (lowest, highest))
        return rounded_up(self.height + least), rounded_down(self.height + most)

    @cached_property
    def greatest_lift(self) -> float:
        """Greatest lift inside workspaces and joint limits [m], 0 if none works."""
        walk, times = self._steady_walk

        def works(share: float) -> bool:
            lifted = replace(walk, lift=share * self._length)
            return self.abilities.first_unmet(lifted, times, geometry=True) is None

        return greatest(works, start=0.25) * self._length

    # --- what a walk that fails can do instead ---

    @cached_property
    def remedy(self) -> Remedy | None:
        """The first change with which the walk works; None if there is none, or it works."""
        if not self.unmet:
            return None
        for change in (self._slower, self._lower_swing, self._smaller_attitude, self._other_height):
            found = change()
            if found is not None:
                return found
        return None

    def _slower(self) -> Remedy | None:
        if not any(command.twist.any() for command in self.walk.commands):
            return None
        period = self.walk.period
        share = self._greatest_share(lambda share: _scaled(self.walk, share))
        if share == 0.0:
            return None
        fastest, parts = self._fastest, []
        if _speed(fastest):
            value = rounded_down(share * _speed(fastest))
            share = min(share, value / _speed(fastest))
            parts.append(f"a speed of {value:.3g} m/s (a stride of {value * period:.3g} m)")
        if fastest.turning:
            rate = rounded_down(math.degrees(share * abs(fastest.turning)))
            share = min(share, math.radians(rate) / abs(fastest.turning))
            parts.append(f"a turn rate of {rate:.3g} deg/s")
        return Remedy(
            what="speed", share=share, says=f"{' with '.join(parts)} is the greatest that works"
        )

    def _lower_swing(self) -> Remedy | None:
        share = self._greatest_share(lambda share: replace(self.walk, lift=share * self.walk.lift))
        if share == 0.0:
            return None
        lift = rounded_down(share * self.walk.lift)
        return Remedy(
            what="lift",
            share=lift / self.walk.lift,
            says=f"a lift of {lift:.3g} m is the greatest that works",
        )

    def _smaller_attitude(self) -> Remedy | None:
        share = rounded_down(self._greatest_share(lambda share: _leaning(self.walk, share)))
        if share == 0.0:
            return None
        leaning = [one for one in _leaning(self.walk, share).attitudes if _is_to_come(one)]
        what = f"{share:.3g} of every change of attitude"
        if len(leaning) == 1:
            what = _lean(leaning[0])
        return Remedy(what="attitude", share=share, says=f"{what} is the greatest that works")

    def _other_height(self) -> Remedy | None:
        if self.heights is None:
            return None
        least, most = self.heights
        height, middle = self.height, 0.5 * (least + most)

        def works(other: float) -> bool:
            raised = _raised(self.walk, other - height)
            return self.abilities.first_unmet(raised, self._plan.times) is None

        if not works(middle):
            return None
        edge = min(max(height, least), most)
        if not works(edge):
            edge = bisected(works, middle, edge)
        edge = rounded_up(edge) if height < middle else rounded_down(edge)
        word = "least" if height < middle else "greatest"
        return Remedy(
            what="height",
            share=edge - height,
            says=f"a height of the body of {edge:.3g} m is the {word} that works",
        )

    def _greatest_share(self, changed: Callable[[float], Walk]) -> float:
        """Greatest part of a change with which the whole walk works, 0 if none does.

        It is sought at the times that have failed so far, and confirmed at all of them.
        """
        seen = self._near(self.unmet[0].time)

        def works(share: float) -> bool:
            return self.abilities.first_unmet(changed(share), seen) is None

        while works(LEAST_SHARE):
            share = greatest(works, most=1.0)
            failed = self.abilities.first_unmet(changed(share), self._plan.times)
            if failed is None:
                return share
            more = np.union1d(seen, self._near(failed.time))
            if len(more) == len(seen):
                break
            seen = more
        return 0.0

    def _near(self, time: float) -> Array:
        return self._plan.times[np.abs(self._plan.times - time) <= self.walk.period]

    # --- parts ---

    @property
    def _length(self) -> float:
        """Length of the longest leg [m]."""
        return float(self.abilities.legs.lengths.sum(axis=1).max())

    @property
    def _commands(self) -> tuple[Command, ...]:
        return tuple(one for one in self.walk.commands if one.twist.any()) or (_FORWARD,)

    @property
    def _fastest(self) -> Command:
        return max(self._commands, key=lambda one: _speed(one) + self._length * abs(one.turning))

    @cached_property
    def _steady_walk(self) -> tuple[Walk, Array]:
        if not any(one.twist.any() for one in self.walk.commands):
            return replace(self.walk, commands=()), np.array([attitudes_end(self.walk)])
        return self._steady(self._fastest)

    def _steady(self, command: Command) -> tuple[Walk, Array]:
        """A walk by one command, and times at full speed."""
        walk, period = self.walk, self.walk.period
        start = walk.earliest_start
        alone = replace(command, start=start, end=math.inf, ramp=period)
        begin = max(start + 3.0 * period, attitudes_end(walk))
        times = times_within([(begin, begin + STEADY * period)], walk)
        return replace(walk, commands=(alone,)), times

    def as_json(self) -> dict[str, Any]:
        """Return its numbers for the summary of a run."""
        heights = self.heights
        return {
            "refusal": self.refusal,
            "greatest_speed_m_s": self.greatest_speed,
            "greatest_stride_m": self.greatest_stride,
            "greatest_turning_rad_s": self.greatest_turning,
            "height_m": self.height,
            "heights_m": None if heights is None else list(heights),
            "greatest_lift_m": self.greatest_lift,
            "worst": {
                one.what: {
                    "where": one.where,
                    "time_s": one.time,
                    "value": one.value if math.isfinite(one.value) else None,
                    "limit": one.limit if math.isfinite(one.limit) else None,
                    "unit": one.unit,
                }
                for one in self.demands
            },
        }


@checked
def foresee_walk(
    robot: Robot,
    walk: Walk,
    servo: Servo | None = None,
    *,
    ground: Ground = FLAT,
    gravity: float = STANDARD_GRAVITY,
    dynamic: bool = False,
    duration: float = math.inf,
    foot_height: float = 0.0,
) -> WalkForesight:
    """Look at all demands of a walk on a robot before it is run.

    Parameters
    ----------
    robot : Robot
        With legs of three joints on a floating body.
    walk : Walk
        Planned in the frame of the ground.
    servo : Servo, optional
        Of every joint; without one, speeds and torques have no limit.
    ground : Ground
        Its slopes and friction count, and where it is under the feet at the start.
    gravity : float
        [m/s^2].
    dynamic : bool
        Whether the center of mass may leave the support by the feet.
    duration : float
        Of the run [s].
    foot_height : float
        Of a standing foot's point over the ground [m]: the radius of a ball.

    Returns
    -------
    WalkForesight
        Its ``refusal`` says what fails; its ``require_walkable`` raises that.

    Raises
    ------
    InvalidValueError
        If an argument makes no sense, the gait is for another number of legs, fewer than three feet
        are down at some time and the walk is not ``dynamic``, or a foot is not on the ground at the
        start.

    Examples
    --------
    >>> from drake_leg.kinematics.walking.foresight import foresee_walk
    >>> from drake_leg.kinematics.walking.gaits import Command
    >>> from drake_leg.kinematics.walking.plan import walk_of
    >>> from drake_leg.robot.hexapods import HEXABOT
    >>> walk = walk_of(HEXABOT, commands=[Command(forward=0.1, start=1.0)])
    >>> found = foresee_walk(HEXABOT, walk)
    >>> round(found.demand("static margin").value, 3)  # [m]
    0.078
    >>> found.refusal is None
    True
    """
    require_positive("gravity, by which feet stand,", gravity, "m/s^2")
    require_non_negative("the height of a standing foot", foot_height, "m")
    if not duration > 0.0:
        raise InvalidValueError(f"the duration is {duration!r} s; it must be positive")
    abilities = Abilities(robot=robot, servo=servo, ground=ground, gravity=gravity, dynamic=dynamic)
    require_gait(robot, walk.gait, abilities.legs.count, dynamic=dynamic)
    if walk.begins == 0.0:
        _require_ground(abilities, walk, foot_height)
    plan = abilities.plan(walk, times_of(walk, duration))
    return WalkForesight(
        abilities=abilities, walk=walk, required=tuple(abilities.demands(plan)), _plan=plan
    )


def require_gait(robot: Robot, gait: Gait, legs: int, *, dynamic: bool) -> None:
    """Refuse a gait for another number of legs, or one that leaves less than three feet down."""
    require_phases(gait, robot.name, legs)
    if gait.fewest_down >= FEWEST_DOWN or dynamic:
        return
    duties = np.arange(1, 100) / 100.0
    enough = (duty for duty in duties if replace(gait, duty=float(duty)).fewest_down >= FEWEST_DOWN)
    duty = next(enough, None)
    longer = "" if duty is None else f"a duty factor of {duty:g} keeps three; "
    raise InvalidValueError(
        f"the gait {gait.name!r} has only {gait.fewest_down} of {legs} feet down at some time, and "
        "a body at rest needs three",
        advice=f"{longer}`dynamic=True` allows it",
    )


def _require_ground(abilities: Abilities, walk: Walk, foot_height: float) -> None:
    """Refuse a walk whose feet are not on the ground at the start."""
    feet = walk.feet_in_world(0.0).value
    above = feet[:, 2] - foot_height - abilities.ground.height(feet[:, 0], feet[:, 1])
    worst = int(np.argmax(np.abs(above)))
    off = float(above[worst])
    if abs(off) > OFF_GROUND:
        raise InvalidValueError(
            f"the foot of {abilities.legs.names[worst]} is {1000.0 * abs(off):.4g} mm "
            f"{'above' if off > 0.0 else 'in'} the ground at the start, at ({feet[worst, 0]:.4g}, "
            f"{feet[worst, 1]:.4g}) m; all feet stand then"
        )


# --- changes of a walk ---


def _scaled(walk: Walk, scale: float) -> Walk:
    commands = [
        replace(
            one,
            forward=scale * one.forward,
            sideways=scale * one.sideways,
            turning=scale * one.turning,
        )
        for one in walk.commands
    ]
    return replace(walk, commands=commands)


def _leaning(walk: Walk, share: float) -> Walk:
    """The walk with a part of each change of attitude that is not over at the start."""
    attitudes = [
        replace(
            one,
            roll=share * one.roll,
            pitch=share * one.pitch,
            yaw=share * one.yaw,
            shift=(share * one.shift[0], share * one.shift[1], share * one.shift[2]),
        )
        if _is_to_come(one)
        else one
        for one in walk.attitudes
    ]
    return replace(walk, attitudes=attitudes)


def _is_to_come(attitude: Attitude) -> bool:
    """Whether a change of attitude is not over at the start."""
    return attitude.start + attitude.lasting > 0.0


def _lean(attitude: Attitude) -> str:
    """Say how far an attitude turns and shifts the body: ``a roll of 12 deg``."""
    angles = {"roll": attitude.roll, "pitch": attitude.pitch, "yaw": attitude.yaw}
    parts = [
        f"a {name} of {_towards_zero(math.degrees(one)):.3g} deg"
        for name, one in angles.items()
        if one
    ]
    if any(attitude.shift):
        shift = ", ".join(f"{_towards_zero(one):.3g}" for one in attitude.shift)
        parts.append(f"a shift by {shift} m")
    return " with ".join(parts)


def _towards_zero(value: float) -> float:
    """Round to what is printed, so that what is printed works, too."""
    return math.copysign(rounded_down(abs(value)), value)


def _raised(walk: Walk, change: float) -> Walk:
    """The walk with its body higher by a change [m]."""
    higher = Attitude(shift=(0.0, 0.0, change), start=-1.0, lasting=1.0)
    return replace(walk, attitudes=(higher, *walk.attitudes))


def _speed(command: Command) -> float:
    return math.hypot(command.forward, command.sideways)
