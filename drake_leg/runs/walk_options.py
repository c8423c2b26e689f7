"""The options of a walk, in the units and under the names of the command line.

What an option takes follows from the annotation of its field, as in ``options.py``.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.walking.gait import GAITS, Gait, usual_period
from drake_leg.robot.file_names import ENDINGS, is_robot_file
from drake_leg.robot.ground import FOOT_STIFFNESS, Blocks, Ground, Steps
from drake_leg.robot.hexapods import HEXAPODS
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import SERVOS, Servo
from drake_leg.runs.option import option
from drake_leg.runs.options import RunOptions
from drake_leg.runs.walk_changes import Pace, changed_walk, paces
from drake_leg.units import require_positive

if TYPE_CHECKING:
    from drake_leg.kinematics.motions import Push
    from drake_leg.kinematics.walking.gaits import Walk
    from drake_leg.kinematics.walking.sequence import WalkSequence

ROBOTS = {robot.name.replace("_", "-"): robot for robot in HEXAPODS}
STANDS = 0.5  # [s], for which the robot stands first
RAMP = 1.0  # [s], in which it gets its speed, and stops
AFTER = 1.0  # [s], for which it stands at the end
WALKING = 10.0  # [s], by default
SPEED = 0.1  # [m/s], forward, by default
AFTER_CHANGE = 5.0  # [s], for which it walks at least after its last change
AHEAD = 0.30  # [m], from where the body starts to stairs or blocks
PUSH_LASTS, PUSH_AT, TO_THE_LEFT = 0.050, 3.0, 90.0  # [s], [s], [deg]
STAIRS, STEP_RUN = 3, 0.20  # how many, and from one to the next [m]
BESIDE = {  # options that mean nothing without another
    "push_at": "push_speed",
    "push_direction": "push_speed",
    "search_depth": "touch_down",
    "step_count": "steps",
    "step_run": "steps",
    "block_seed": "blocks",
}


@dataclass(kw_only=True)
class WalkOptions(RunOptions):
    """A robot with legs walks."""

    duration: float | None = option(  # type: ignore[assignment]
        None,
        "simulated time",
        "s",
        shown="10, or until `distance` or `angle` is walked, or 5 after the last change",
    )
    robot: str = option(
        "hexabot", f"that walks: {', '.join(ROBOTS)}, or a TOML or .par file of one's own"
    )
    gait: str = option("tripod", f"one of {', '.join(GAITS)}, or own, with `phases` and `duty`")
    phases: list[float] | None = option(
        None, "of an own gait: when each leg's stance begins, 0 to 1", shown="none"
    )
    duty: float | None = option(
        None, "how much of the period a foot stands, 0 to 1", shown="that of the gait"
    )
    period: float | None = option(
        None, "of the gait", "s", shown="tripod 1, the ripple gaits 1.5, wave 3"
    )
    speed: float | None = option(None, "of the body, forward", "m/s", shown="0.1, unless another")
    sideways: float = option(0.0, "speed of the body to the left", "m/s")
    turn: float = option(0.0, "angular speed of the body to the left", "deg/s")
    distance: float | None = option(
        None, "that the body goes before it stops", "m", shown="none, it does not stop"
    )
    angle: float | None = option(
        None, "by which the body turns before it stops", "deg", shown="none, it does not stop"
    )
    then: str | None = option(
        None,
        "changes of gait and velocity, each with its time [s], as 'gait=wave speed=0.03 at=5; "
        "sideways=0.1 at=20'; they take gait, period, duty, lift, speed, sideways, turn",
        shown="none",
        joined="; ",
    )
    height: float | None = option(
        None, "of the body over the ground", "m", shown="that of the robot's starting posture"
    )
    lift: float = option(0.03, "height of a swing", "m")
    roll: float = option(0.0, "of the body, its right side down", "deg")
    pitch: float = option(0.0, "of the body, its front down", "deg")
    shift: list[float] | None = option(
        None, "of the body over its feet: forward, to the left", "m", shown="0,0"
    )
    servo: str = option("ideal", f"at every joint: {', '.join(SERVOS)}, or a TOML file")
    gain: float | None = option(
        None, "Position P Gain of a DYNAMIXEL servo, 1 to 16383", shown="that of the servo"
    )
    effort: float | None = option(
        None, "greatest torque of a servo", "N*m", shown="its stall torque"
    )
    feed_forward: str = option(
        "full", "what the servos are told of their load: full, gravity or none"
    )
    feedback: float | None = option(
        None,
        "rate at which the body is brought back to its planned pose",
        "1/s",
        shown="none, open loop",
    )
    level: float | None = option(
        None,
        "rate at which the body is levelled by sensed roll and pitch, against gravity",
        "1/s",
        shown="none",
    )
    touch_down: bool = option(
        False, "let the feet sense the ground: they stop where they touch it, or search it"
    )
    search_depth: float | None = option(
        None, "how far a foot goes down to find the ground", "m", shown="0.03"
    )
    dynamic: bool = option(False, "let fewer than three feet be down: the robot may fall")
    force: bool = option(False, "walk, though the foresight says that it will fail")
    payload: float = option(0.0, "on the body, of which the plan does not know", "kg")
    push_speed: float | None = option(
        None, "change of the robot's speed by a push of 50 ms", "m/s", shown="none"
    )
    push_at: float | None = option(None, "when the push begins", "s", shown="3")
    push_direction: float | None = option(
        None, "of the push: 0 forward, 90 to the left", "deg", shown="90"
    )
    time_step: float = option(0.005, "of the simulation: the rows of recording.csv", "s")
    foot_stiffness: float = option(FOOT_STIFFNESS, "of a foot's contact", "N/m")
    foot_radius: float = option(0.0, "of a foot's ball, which rolls; 0 is a point", "m")
    friction: float = option(0.8, "coefficient of the ground")
    slope: float = option(0.0, "of the ground, upwards along the way", "deg")
    across: float = option(0.0, "of the ground across the way, its left side up", "deg")
    steps: float | None = option(
        None, "height of stairs across the way; negative: down", "m", shown="none"
    )
    step_count: float | None = option(None, "how many stairs there are", shown="3")
    step_run: float | None = option(None, "from one stair to the next", "m", shown="0.2")
    blocks: float | None = option(
        None, "greatest height of a field of random blocks", "m", shown="none"
    )
    block_seed: float | None = option(None, "of the random blocks", shown="0")

    def __post_init__(self) -> None:
        RunOptions.__post_init__(self)
        for name, other in BESIDE.items():
            if getattr(self, name) is not None and getattr(self, other) in (None, False):
                raise InvalidValueError(
                    f"`{name}` means nothing without `{other}`",
                    advice=f"give `{other}`, too, or leave it out",
                )
        if self.then is not None and self.ends is not None:
            raise InvalidValueError(
                "`then` means nothing with a `distance` or an `angle`, after which the robot stops",
                advice="let it stop by `speed=0 at=...`",
            )
        require_positive("the duration", self.the_duration, "s")
        if self.then is not None:
            self._require_before_end("last change begins", self.the_paces[-1].at, "time")
        if self.push_speed is not None:
            at = PUSH_AT if self.push_at is None else self.push_at
            self._require_before_end("push begins", at, "`push_at`")

    def _require_before_end(self, what: str, time: float, option: str) -> None:
        if time >= self.the_duration:
            raise InvalidValueError(
                f"the {what} at {time:g} s, and the run is over at {self.the_duration:g} s",
                advice=f"choose an earlier {option} or a longer `duration`",
            )

    @property
    def the_duration(self) -> float:
        """Simulated time [s]; by default until the way is walked, or some time."""
        if self.duration is not None:
            return self.duration
        if self.ends is not None:
            return self.ends + RAMP + AFTER
        changes = self.the_paces[1:] if self.then is not None else ()
        return max([WALKING, *(pace.at + AFTER_CHANGE for pace in changes)])

    @property
    def the_speed(self) -> float:
        """Speed forward [m/s]; by default 0 if another velocity is given."""
        if self.speed is not None:
            return self.speed
        return 0.0 if self.sideways or self.turn else SPEED

    @cached_property
    def the_robot(self) -> Robot:
        """The robot that walks."""
        if self.robot in ROBOTS:
            return ROBOTS[self.robot]
        if is_robot_file(self.robot):
            from drake_leg.robot.robot_file import (
                load_robot,
            )  # with readers that help does not need

            return load_robot(self.robot)
        own = f"the robots are {', '.join(ROBOTS)}; one of your own is a file ending in {ENDINGS}"
        raise InvalidValueError(
            f"there is no robot {self.robot!r}", advice=did_you_mean(self.robot, ROBOTS, own)
        )

    @property
    def the_gait(self) -> Gait:
        """The gait, by its name or by its phases."""
        if self.gait == "own":
            if self.phases is None or self.duty is None:
                raise InvalidValueError(
                    "an own gait needs `phases` and `duty`, as `phases=[0, 0.5, 0, 0.5, 0, 0.5]` "
                    "and `duty=0.6`"
                )
            phases = tuple(self.phases)
            return Gait(name="own", phases=phases, duty=self.duty, source="the user's table")
        if self.gait not in GAITS:
            raise InvalidValueError(
                f"there is no gait {self.gait!r}; the gaits are {', '.join(GAITS)}, and own",
                advice=did_you_mean(self.gait, [*GAITS, "own"]),
            )
        if self.phases is not None:
            raise InvalidValueError(
                f"the gait {self.gait} has phases of its own: leave `phases` out, or give "
                "`gait='own'`"
            )
        gait = GAITS[self.gait]
        return gait if self.duty is None else replace(gait, duty=self.duty)

    @property
    def the_period(self) -> float:
        """Of the gait [s]; by default its usual one."""
        if self.period is not None:
            require_positive("the period", self.period, "s")
            return self.period
        return usual_period(self.the_gait)

    @property
    def the_servo(self) -> Servo:
        """The servo at every joint."""
        if self.servo in SERVOS:
            servo = SERVOS[self.servo]
        elif Path(self.servo).suffix.lower() == ".toml":
            from drake_leg.robot.toml.servo import load_servo  # with readers, as above

            servo = load_servo(self.servo)
        else:
            raise InvalidValueError(
                f"there is no servo {self.servo!r}",
                advice=did_you_mean(
                    self.servo,
                    SERVOS,
                    f"the servos are {', '.join(SERVOS)}, or a file ending in .toml",
                ),
            )
        if self.gain is not None:
            servo = servo.with_gain(self.gain)
        if self.effort is None:
            return servo
        require_positive("the effort", self.effort, "N*m")
        # The motor's line keeps its slope.
        slope = servo.back_emf_damping
        return replace(servo, stall_torque=self.effort, no_load_speed=self.effort / slope)

    @property
    def the_ground(self) -> Ground:
        """The ground; stairs or blocks begin ``AHEAD`` of the body's start."""
        steps = blocks = None
        if self.steps is not None:
            count = _whole("step_count", self.step_count, STAIRS)
            run = STEP_RUN if self.step_run is None else self.step_run
            steps = Steps(height=self.steps, run=run, start=AHEAD, count=count)
        if self.blocks is not None:
            seed = _whole("block_seed", self.block_seed, 0)
            blocks = Blocks(height=self.blocks, start=AHEAD, seed=seed)
        return Ground(
            slope=math.radians(self.slope),
            across=math.radians(self.across),
            friction=self.friction,
            steps=steps,
            blocks=blocks,
        )

    @property
    def the_push(self) -> "Push | None":
        """The push on the body, in the world's frame."""
        if self.push_speed is None:
            return None
        from drake_leg.kinematics.motions import Push  # with NumPy, which help does without
        from drake_leg.kinematics.walking.weights import total_mass

        weight = total_mass(self.the_robot) + self.payload
        strength = self.push_speed * weight * math.pi / (2.0 * PUSH_LASTS)
        angle = math.radians(TO_THE_LEFT if self.push_direction is None else self.push_direction)
        at = PUSH_AT if self.push_at is None else self.push_at
        force = (strength * math.cos(angle), strength * math.sin(angle), 0.0)
        return Push(force=force, at=at, lasting=PUSH_LASTS)

    @property
    def starts(self) -> float:
        """When the body begins to move [s]; the first foot swings ``STANDS`` after the start."""
        return STANDS + self.the_period * (1.0 - self.the_gait.duty / 2.0)

    @property
    def ends(self) -> float | None:
        """When the body begins to stop [s], if a distance or an angle is given."""
        if self.distance is not None and self.angle is not None:
            raise InvalidValueError("give a distance or an angle, not both")
        speed, turning = math.hypot(self.the_speed, self.sideways), abs(self.turn)
        for way, rate, what, of in (
            (self.distance, speed, "distance", "speed"),
            (self.angle, turning, "angle", "turn"),
        ):
            if way is None:
                continue
            require_positive(f"the {what}", way, "m" if what == "distance" else "deg")
            if rate == 0.0:
                raise InvalidValueError(
                    f"the {what} is {way:g} and the {of} is 0, so that it takes forever: give "
                    f"`{of}`, too"
                )
            return self.starts + way / rate
        return None

    @cached_property
    def the_paces(self) -> tuple[Pace, ...]:
        """How the robot walks: at first, and after each change."""
        first = Pace(
            gait=self.the_gait,
            period=self.the_period,
            lift=self.lift,
            forward=self.the_speed,
            sideways=self.sideways,
            turn=self.turn,
            at=self.starts,
        )
        return paces(first, self.then)

    def the_walk(self) -> "Walk | WalkSequence":
        """Plan the walk.

        Raises
        ------
        InvalidValueError
            If an option makes no sense.
        """
        from drake_leg.kinematics.walking.gaits import Attitude
        from drake_leg.kinematics.walking.plan import walk_of

        ends = self.ends
        shift = [0.0, 0.0] if self.shift is None else self.shift
        if len(shift) != 2:
            raise InvalidValueError(
                f"shift is {shift}; it must be two numbers in m: forward, to the left"
            )
        attitudes = []
        if self.roll or self.pitch or any(shift):
            attitudes.append(
                Attitude(
                    roll=math.radians(self.roll),
                    pitch=math.radians(self.pitch),
                    shift=(shift[0], shift[1], 0.0),
                    lasting=STANDS,
                )
            )
        standing = walk_of(
            self.the_robot,
            self.the_gait,
            period=self.the_period,
            lift=self.lift,
            attitudes=attitudes,
            height=self.height,
            foot_height=self.foot_radius,
        )
        return changed_walk(standing, self.the_paces, RAMP, math.inf if ends is None else ends)


def _whole(name: str, value: float | None, otherwise: int) -> int:
    if value is None:
        return otherwise
    if value != int(value) or value < 0.0:
        raise InvalidValueError(f"{name} is {value:g}; it must be a whole number, not negative")
    return int(value)
