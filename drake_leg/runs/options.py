"""The options of the runs, in the units and under the names of the command line.

Each family of runs has one dataclass; a YAML file has the same keys. What an option takes follows
from the annotation of its field, which must therefore not be postponed to a string; values from
Python, from the command line and from a YAML file go through the same check. Methods convert
values to SI units, and raise InvalidValueError for one that makes no sense.
"""

import dataclasses
import math
import reprlib
from collections.abc import Collection, Mapping, Set
from contextlib import suppress
from dataclasses import dataclass, field
from numbers import Real
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, get_args, get_origin

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import (
    ALUMINIUM,
    HEXABOT_LENGTHS,
    LEG_A_POSTURE,
    LEG_B_POSTURE,
    PENDULUM_SIZE,
    SCARA_LENGTHS,
    SCARA_POSTURE,
    WATER,
    LegVariant,
    hexabot_leg,
    pendulum,
    scara,
)
from drake_leg.simulation.integrator import INTEGRATORS, IntegratorSettings
from drake_leg.units import DAMPING_UNITS, SPRING_UNITS, STANDARD_GRAVITY, in_si

if TYPE_CHECKING:
    from drake_leg.kinematics.motions import EllipticStep, SineStep

Direction = tuple[float, float, float]  # unit vector

STATE_TARGET = 30.0  # [deg], report A, section 1.2
INVERSE, FORWARD, NONE = "inverse", "forward", "none"  # how torques are found
DISTURBING = ("push", "mass_error", "torque_limit", "stiffness")
WEIGHTY = ("gravity", "density", "damping", "damping_unit")  # what no motion depends on
EXACT = "exact"  # the inverse that stops where the Jacobian is singular

# One text for an option that several runs have.
DURATION = "simulated time"
DAMPING = "damping of every joint, in `damping_unit`"
Q0 = "initial joint angles; a pendulum's is 0 where it is horizontal, 90 where it hangs"
DIRECTION = "of the motion, in the base frame"
AMPLITUDE = "greatest speed of the foot or of the tool"
FILTER = "time constant of input filters at the joints, which lag as Simscape's do (there 0.001)"
DYNAMICS = (
    "how torques are found: inverse simulates the joints' kinematics and computes the torques "
    "along their motion, forward simulates the plant that they drive, none computes no torques"
)
TASK = (
    "position moves the foot and lets it turn as the joints want; pose keeps its orientation, too"
)
TIP = "which tip of a branched robot is its foot; joints that do not move it are held"
NO_FILTER = "none, the motion's derivatives are wired"
L1 = "length of the coxa or of the first arm"
L2 = "length of the femur or of the second arm"
LIMIT = "{} angle, beyond which a spring and a damper push back, as Simscape's joint limits do"
TARGET = "where pendulum-damped starts; where the spring of pendulum-spring is at rest"


@dataclass(frozen=True)
class Numbers:
    """A list of numbers that an option takes."""

    count: int
    words: str  # what they are, with an example


ANGLES = Numbers(3, "three finite angles in degrees, as `q0=[90, -50, -90]`")
ANGLE = Numbers(1, "one finite angle in degrees, as `q0=[30]`")
VECTOR = Numbers(3, "three finite numbers, as `direction=[1, 0, 0]`")
FORCE = Numbers(3, "three numbers in N, as `push=[0, 0, 0.1]`")
SIZE = Numbers(3, "length, width and height in m, as `size=[0.4, 0.01, 0.01]`")


def option(
    default: Any,  # noqa: ANN401
    help_text: str,
    unit: str = "",
    *,
    shown: str = "",
    takes: Numbers | None = None,
    joined: str = "",
) -> Any:  # noqa: ANN401
    """Declare an option: a dataclass field with the text of its help.

    ``shown`` is the default in the help, where the value does not say it; ``takes`` is how many
    numbers a list must have, unless that depends on the robot. A text with ``joined`` may be given
    several times on the command line; its parts are joined by that.
    """
    metadata = {
        "help": help_text,
        "unit": unit,
        "shown": shown,
        "takes": takes,
        "joined": joined,
    }
    if isinstance(default, list):
        return field(default_factory=lambda: list(default), metadata=metadata)
    return field(default=default, metadata=metadata)


def type_of(option: "dataclasses.Field[Any]") -> type:
    """Return what an option takes other than None: float, list (of numbers), str or bool."""
    kind: Any = next(kind for kind in _types(option) if kind is not NoneType)
    origin: type = get_origin(kind) or kind
    return origin


def _types(option: "dataclasses.Field[Any]") -> tuple[Any, ...]:
    return get_args(option.type) if isinstance(option.type, UnionType) else (option.type,)


def converted(option: "dataclasses.Field[Any]", value: object) -> object:
    """Convert a value to the type of an option.

    Raises
    ------
    InvalidValueError
        If the option does not take such a value.
    """
    kind = type_of(option)
    if value is None and NoneType in _types(option):
        return None
    if kind is list:
        return _numbers(option, value)
    if kind is float:
        return finite_number(option.name, value)
    if not isinstance(value, kind):
        wanted = "true or false" if kind is bool else "a string"
        raise InvalidValueError(f"{option.name} is {reprlib.repr(value)}; it must be {wanted}")
    return value


def _numbers(option: "dataclasses.Field[Any]", value: object) -> list[float]:
    """Read a list; a single number is a list of one."""
    takes: Numbers | None = option.metadata["takes"]
    words = takes.words if takes else "a list of finite numbers, as [90, -50, -90]"
    items = [value] if isinstance(value, Real) else value
    if isinstance(items, str | bytes | Mapping | Set) or not isinstance(items, Collection):
        raise InvalidValueError(f"{option.name} is {reprlib.repr(value)}; it must be {words}")
    numbers = [_number(option.name, item) for item in items]
    if not all(map(math.isfinite, numbers)) or (takes and len(numbers) != takes.count):
        raise InvalidValueError(f"{option.name} is {numbers}; it must be {words}")
    return numbers


def finite_number(name: str, value: object) -> float:
    """Take a finite number.

    Raises
    ------
    InvalidValueError
        If it is none.
    """
    number = _number(name, value)
    if not math.isfinite(number):
        raise InvalidValueError(f"{name} is {number!r}; it must be a finite number")
    return number


def _number(name: str, value: object) -> float:
    """Refuse texts, though Python would read numbers out of some of them."""
    if not isinstance(value, bool) and isinstance(value, Real):
        with suppress(OverflowError):
            return float(value)
    raise InvalidValueError(f"{name} is {reprlib.repr(value)}; it must be a finite number")


@dataclass(kw_only=True)
class RunOptions:
    """Options of every run."""

    duration: float = option(20.0, DURATION, "s")
    gravity: float = option(STANDARD_GRAVITY, "gravity, along -z", "m/s^2")

    def __post_init__(self) -> None:
        for each in dataclasses.fields(self):
            setattr(self, each.name, converted(each, getattr(self, each.name)))

    @property
    def the_duration(self) -> float:
        """Simulated time [s], also where it follows from other options."""
        return self.duration


@dataclass(kw_only=True)
class IntegratedOptions(RunOptions):
    """Options of every run that an integrator steps."""

    integrator: str = option("runge_kutta5", f"one of {', '.join(INTEGRATORS)}")
    accuracy: float | None = option(
        None, "relative accuracy of error control", shown="none, the steps are fixed"
    )
    max_step: float | None = option(
        None,
        "greatest step, at most 0.04: the rows of recording.csv are the integrator's own steps",
        "s",
        shown="0.04, and less for a fast motion, a stiff joint, a singularity nearby; "
        "a pendulum's 0.002",
    )

    def integrator_settings(self, default_step: float) -> IntegratorSettings:
        """Return the integrator's settings; ``default_step`` [s] is the longest step by default."""
        return IntegratorSettings(
            scheme=self.integrator,
            accuracy=self.accuracy,
            max_step=default_step if self.max_step is None else self.max_step,
        )


@dataclass(kw_only=True)
class DampingOptions(IntegratedOptions):
    """Options of every run whose robot comes with this package."""

    damping: float | None = option(None, DAMPING, shown="0")
    damping_unit: str | None = option(
        None, f"unit of `damping`: {' or '.join(DAMPING_UNITS)}", shown="N*m*s/rad"
    )

    def si_damping(self) -> float:
        """Return the damping in N*m*s/rad."""
        unit = _unit("damping", self.damping_unit, DAMPING_UNITS)
        if self.damping is not None:
            return in_si("damping", self.damping, unit, DAMPING_UNITS)
        if self.damping_unit is not None:
            raise InvalidValueError(
                f"the damping unit is {unit!r} and there is no damping",
                advice="give it, as `damping=0.01`",
            )
        return 0.0


@dataclass(kw_only=True)
class StepOptions(IntegratedOptions):
    """Options of every run whose foot or tool follows a sine."""

    q0: list[float] | None = option(
        None, Q0, "deg", shown="the joints' state targets; zero, or the limit that is nearest"
    )
    amplitude: float = option(0.0, AMPLITUDE, "m/s")
    frequency: float = option(1.0, "of the sine", "rad/s")
    direction: list[float] | None = option(
        None,
        DIRECTION,
        shown="1,0,0, or the first of y and z that the foot can follow",
        takes=VECTOR,
    )
    force: bool = option(False, "run up to the foreseen singularity and save the recording")
    inverse: str = option(
        EXACT, "of the Jacobian: exact stops where it is singular, damped and limited go on"
    )
    damped_below: float | None = option(
        None,
        "smallest singular value below which damped and limited are not exact",
        "m",
        shown="0.03 of the arm's length",
    )
    rate_limit: float | None = option(
        None, "of every turning joint, for limited", "deg/s", shown="the robot's own, or 360"
    )
    correction: float | None = option(
        None,
        "K of a drift correction, v + K (p_d - p); with damped and limited the sum is at most 1.25 "
        "times the fastest v, or half the arm's length in a second",
        "1/s",
        shown="0; 5 with damped and limited",
    )
    q0_error: list[float] | None = option(
        None, "where the joints really start, minus q0", "deg", shown="0"
    )
    push: list[float] | None = option(
        None,
        "greatest force of a push on the foot or the tool, half a sine wave",
        "N",
        shown="none",
        takes=FORCE,
    )
    push_at: float | None = option(None, "when the push begins", "s", shown="2")
    push_for: float | None = option(None, "how long the push lasts", "s", shown="0.1")
    mass_error: float = option(0.0, "of the computed torque: 0.2 assumes masses 20 % too large")
    torque_limit: float | None = option(
        None, "of every joint's motor", "N*m, or N of a joint that slides", shown="none"
    )
    stiffness: float | None = option(
        None,
        "k of the pull k e + 2 sqrt(k) de/dt that keeps joints on their motion",
        "1/s^2",
        shown="4; 2500 with a push, a mass error or a torque limit",
    )
    dynamics: str | None = option(
        None,
        DYNAMICS,
        shown="inverse; forward with `push`, `mass_error`, `stiffness` or a `torque_limit` reached",
    )

    def motion(self, direction: Direction | None = None) -> "SineStep":
        """Return the commanded motion, along ``direction`` or that of the options."""
        from drake_leg.kinematics.motions import SineStep  # which needs NumPy, as help does not

        return SineStep(
            amplitude=self.amplitude,
            frequency=self.frequency,
            direction=direction or self.unit_direction(),
        )

    def unit_direction(self) -> Direction:
        """Return the direction with length 1."""
        length = math.hypot(*self.direction or ())
        if not (math.isfinite(length) and length > 0.0):
            raise InvalidValueError(
                f"the direction is {self.direction}; it must be finite and not zero"
            )
        x, y, z = (value / length for value in self.direction or ())
        return x, y, z

    def posture(self) -> tuple[float, float, float]:
        """Return q0 in rad."""
        q1, q2, q3 = map(math.radians, self.q0 or ())
        return q1, q2, q3

    def refuse_ignored(self) -> None:
        """Refuse options that would have no effect beside the others."""
        if self.force and self.inverse != EXACT:
            raise InvalidValueError(
                f"`force=True` means nothing with `inverse={self.inverse!r}`, which goes on past a "
                "singularity",
                advice="leave one of the two out",
            )
        if self.amplitude == 0.0:
            self._refuse_at_rest()
        if self.chosen_dynamics() == NONE:
            weightless = [name for name in WEIGHTY if hasattr(self, name)]
            self._require_defaults("dynamics are 'none'", *weightless)

    def chosen_dynamics(self) -> str:
        """Return how torques are found, as it was given or as nothing disturbs the joints."""
        given = {name: getattr(self, name) for name in DISTURBING}
        acting = [name for name, value in given.items() if value]
        if given["stiffness"] is not None and not acting:
            acting = ["stiffness"]
        if self.dynamics is None:
            return FORWARD if acting else INVERSE
        if self.dynamics not in (INVERSE, FORWARD, NONE):
            raise InvalidValueError(
                f"the dynamics are {self.dynamics!r}; they must be {INVERSE}, {FORWARD} or {NONE}",
                advice=did_you_mean(self.dynamics, (INVERSE, FORWARD, NONE)),
            )
        if acting and self.dynamics != FORWARD:
            name = acting[0]
            raise InvalidValueError(
                f"{name} is {given[name]!r}, which means nothing to the dynamics "
                f"{self.dynamics!r}, where joints follow their motion exactly",
                advice=f"leave one of the two out, or choose `dynamics='{FORWARD}'`",
            )
        return self.dynamics

    def _refuse_at_rest(self) -> None:
        """Refuse options that have no effect without an amplitude."""
        self._require_defaults("amplitude is 0", "frequency", "direction")

    def _require_defaults(self, why: str, *names: str) -> None:
        """Refuse options that were given but have no effect."""
        known = {each.name: each for each in dataclasses.fields(self)}
        for name in names:
            value = getattr(self, name)
            if value != _default(known[name]):
                raise InvalidValueError(
                    f"{name} is {value!r}, which means nothing where the {why}",
                    advice="leave it out",
                )


@dataclass(kw_only=True)
class LegOptions(StepOptions, DampingOptions):
    """The hexabot leg, in variant B's posture by default."""

    q0: list[float] = option(list(LEG_B_POSTURE), Q0, "deg", takes=ANGLES)
    amplitude: float = option(0.070, AMPLITUDE, "m/s")
    direction: list[float] = option([1.0, 0.0, 0.0], DIRECTION, takes=VECTOR)
    l1: float = option(HEXABOT_LENGTHS[0], L1, "m")
    l2: float = option(HEXABOT_LENGTHS[1], L2, "m")
    l3: float = option(HEXABOT_LENGTHS[2], "length of the tibia", "m")
    density: float = option(WATER, "of the solids", "kg/m^3")

    def robot(self, variant: LegVariant = "B") -> Robot:
        """Return the leg."""
        return hexabot_leg(
            variant,
            l1=self.l1,
            l2=self.l2,
            l3=self.l3,
            density=self.density,
            damping=self.si_damping(),
        )


@dataclass(kw_only=True)
class StraightOptions(StepOptions):
    """The straight step of a foot."""

    amplitude: float = option(0.050, AMPLITUDE, "m/s")
    gain: float = option(
        1.0, "of a gain block after the sine, whose own amplitude is amplitude / gain; 1: no block"
    )
    filter_time_constant: float | None = option(None, FILTER, "s", shown=NO_FILTER)
    feedback: str = option(
        "sensed", "what the inverse Jacobian takes as joint positions: sensed or integrated"
    )
    task: str | None = option(
        None, TASK, shown="pose where the joints can keep it, otherwise position"
    )

    def _refuse_at_rest(self) -> None:
        super()._refuse_at_rest()
        self._require_defaults("amplitude is 0", "gain")


@dataclass(kw_only=True)
class OwnOptions(StraightOptions):
    """The straight step of a robot from a file, or of one that is not the reports'."""

    tip: str | None = option(None, TIP, shown="the only one")


@dataclass(kw_only=True)
class LoopOptions(IntegratedOptions):
    """The motion of a robot with closed loops."""

    q0: list[float] | None = option(
        None, "of all joints, or of the active ones", "deg", shown="the joints' state targets"
    )
    swing: list[float] | None = option(
        None,
        "of a robot with closed loops: A of each active joint, q0 + A (1 - cos w t)",
        "deg, or m of a joint that slides",
        shown="none, it is released from rest",
    )
    frequency: float | None = option(None, "w of the swing", "rad/s", shown="1")


@dataclass(kw_only=True)
class LegBOptions(LegOptions, StraightOptions):
    """The straight step of variant B."""


@dataclass(kw_only=True)
class LegAOptions(LegBOptions):
    """The straight step of variant A, from the same foot position."""

    q0: list[float] = option(list(LEG_A_POSTURE), Q0, "deg", takes=ANGLES)

    def robot(self, variant: LegVariant = "A") -> Robot:
        """Return the leg."""
        return super().robot(variant)


@dataclass(kw_only=True)
class EllipseOptions(LegOptions):
    """The elliptic step."""

    lift: float = option(0.040, "height of the ellipse", "m")
    filter_time_constant: float | None = option(None, FILTER, "s", shown=NO_FILTER)

    def motion(self, direction: Direction | None = None) -> "EllipticStep":
        """Return the commanded motion."""
        from drake_leg.kinematics.motions import EllipticStep

        return EllipticStep(
            amplitude=self.amplitude,
            frequency=self.frequency,
            direction=direction or self.unit_direction(),
            lift=self.lift,
        )

    def _refuse_at_rest(self) -> None:
        if self.lift == 0.0:
            self._require_defaults("amplitude and the lift are 0", "frequency", "direction")
        self._require_defaults("amplitude is 0", "direction")


@dataclass(kw_only=True)
class ScaraOptions(StepOptions, DampingOptions):
    """The SCARA's straight move."""

    q0: list[float] = option(list(SCARA_POSTURE), Q0, "deg", takes=ANGLES)
    amplitude: float = option(0.050, AMPLITUDE, "m/s")
    direction: list[float] = option([1.0, 0.0, 0.0], DIRECTION, takes=VECTOR)
    tool_height: float = option(0.050, "R, of the tool over its lowest position", "m")
    l1: float = option(SCARA_LENGTHS[0], L1, "m")
    l2: float = option(SCARA_LENGTHS[1], L2, "m")
    density: float = option(ALUMINIUM, "of the solids", "kg/m^3")

    def robot(self) -> Robot:
        """Return the arm."""
        return scara(l1=self.l1, l2=self.l2, density=self.density, damping=self.si_damping())


@dataclass(kw_only=True)
class PendulumOptions(DampingOptions):
    """Options of every pendulum."""

    q0: list[float] | None = option(None, Q0, "deg", shown="0", takes=ANGLE)
    size: list[float] = option(
        list(PENDULUM_SIZE), "length, width, height of the link", "m", takes=SIZE
    )
    density: float = option(WATER, "of the solids", "kg/m^3")
    velocity_target: float = option(0.0, "speed at the start", "deg/s")
    lower_limit: float | None = option(None, LIMIT.format("least"), "deg", shown="none")
    upper_limit: float | None = option(None, LIMIT.format("greatest"), "deg", shown="none")
    limit_stiffness: float | None = option(
        None, "of the springs at the limits", "N*m/deg", shown="10000"
    )
    limit_damping: float | None = option(
        None, "of the dampers at the limits", "N*m/(deg/s)", shown="10"
    )
    limit_width: float | None = option(
        None, "depth beyond a limit at which spring and damper act in full", "deg", shown="0.1"
    )

    def limits(self) -> dict[str, Any]:
        """Return bounds and stops in SI units, as ``JointMechanics`` takes them."""
        bounds = {"lower": self.lower_limit, "upper": self.upper_limit}
        of_stop = {
            "stiffness": self.limit_stiffness,
            "damping": self.limit_damping,
            "transition_width": self.limit_width,
        }
        stop = {name: value for name, value in of_stop.items() if value is not None}
        given = {side: math.radians(angle) for side, angle in bounds.items() if angle is not None}
        if stop and not given:
            name = next(iter(stop))
            raise InvalidValueError(
                f"the limit's {name.replace('_', ' ')} is {stop[name]!r} and there is no limit",
                advice="give one, as `lower_limit=20`",
            )
        return {**given, **{f"{side}_stop": HardStop.rotational(**stop) for side in given}}

    def start(self) -> float:
        """Return the initial angle in rad."""
        return math.radians(self.q0[0] if self.q0 else 0.0)

    def mechanics(self) -> dict[str, Any]:
        """Return damping, start and limits in SI units, as ``JointMechanics`` takes them."""
        return {
            "damping": self.si_damping(),
            "actuated": False,
            "position_target": StateTarget(value=self.start()),
            "velocity_target": StateTarget(value=math.radians(self.velocity_target)),
            **self.limits(),
        }

    def robot(self) -> Robot:
        """Return the pendulum."""
        length, width, height = self.size
        return pendulum(
            size=(length, width, height),
            density=self.density,
            mechanics=JointMechanics(**self.mechanics()),
        )


@dataclass(kw_only=True)
class FreePendulumOptions(PendulumOptions):
    """The free pendulum."""

    duration: float = option(10.0, DURATION, "s")


@dataclass(kw_only=True)
class DampedPendulumOptions(PendulumOptions):
    """The damped pendulum; its state target is where it starts, not where it goes."""

    duration: float = option(30.0, DURATION, "s")
    damping: float = option(0.01, DAMPING)
    target: float | None = option(None, TARGET, "deg", shown=f"{STATE_TARGET:g}")
    q0: list[float] | None = option(None, Q0, "deg", shown="as `target`", takes=ANGLE)

    def start(self) -> float:
        """Return the state target in rad, under either of its names."""
        if not self.q0:
            return math.radians(STATE_TARGET if self.target is None else self.target)
        (angle,) = self.q0
        if self.target not in (None, angle):
            raise InvalidValueError(
                f"q0 is {angle:g} deg and the state target {self.target:g} deg, two names "
                "of the angle where the simulation starts",
                advice="give one of them",
            )
        return math.radians(angle)


@dataclass(kw_only=True)
class SpringPendulumOptions(PendulumOptions):
    """The damped pendulum with a spring that pulls it to a target."""

    duration: float = option(30.0, DURATION, "s")
    damping: float = option(0.01, DAMPING)
    spring_stiffness: float = option(5.0, "of the spring at the joint, in `spring_unit`")
    spring_unit: str | None = option(
        None, f"unit of `spring_stiffness`: {' or '.join(SPRING_UNITS)}", shown="N*m/rad"
    )
    target: float | None = option(None, TARGET, "deg", shown=f"{STATE_TARGET:g}")

    def equilibrium(self) -> float:
        """Return the angle in rad at which the spring is at rest."""
        if self.target is not None and self.spring_stiffness == 0.0:
            raise InvalidValueError(
                f"the target is {self.target:g} deg and the spring stiffness is 0, so that nothing "
                "pulls there",
                advice="give a `spring_stiffness`, or leave the target out",
            )
        return math.radians(STATE_TARGET if self.target is None else self.target)

    def si_stiffness(self) -> float:
        """Return the spring's stiffness in N*m/rad."""
        unit = _unit("spring", self.spring_unit, SPRING_UNITS)
        return in_si("spring", self.spring_stiffness, unit, SPRING_UNITS)

    def mechanics(self) -> dict[str, Any]:
        """Return them with the spring."""
        spring = {
            "spring_stiffness": self.si_stiffness(),
            "equilibrium_position": self.equilibrium(),
        }
        return super().mechanics() | spring


def _default(option: "dataclasses.Field[Any]") -> Any:  # noqa: ANN401
    """Return the default of an option."""
    if option.default_factory is dataclasses.MISSING:
        return option.default
    return option.default_factory()


def _unit(what: str, unit: str | None, units: Mapping[str, float]) -> str:
    """Return the unit that was given, or the first, which is SI."""
    if unit is None:
        return next(iter(units))
    in_si(what, 0.0, unit, units)
    return unit
