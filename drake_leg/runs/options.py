"""The options of the runs, in the units and under the names of the command line.

Each family of runs has one dataclass; a YAML file has the same keys. Methods convert values to SI
units, and raise InvalidValueError for one that makes no sense.
"""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import (
    ALUMINIUM,
    HEXABOT_LENGTHS,
    LEG_A_POSTURE,
    LEG_B_POSTURE,
    SCARA_LENGTHS,
    SCARA_POSTURE,
    WATER,
    LegVariant,
    hexabot_leg,
    scara,
)
from drake_leg.runs.option import Numbers, converted, default_of, option
from drake_leg.simulation.integrator import INTEGRATORS, IntegratorSettings
from drake_leg.units import DAMPING_UNITS, STANDARD_GRAVITY, in_si

if TYPE_CHECKING:
    from drake_leg.kinematics.motions import EllipticStep, SineStep

Direction = tuple[float, float, float]  # unit vector

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

ANGLES = Numbers(3, "three finite angles in degrees, as `q0=[90, -50, -90]`")
VECTOR = Numbers(3, "three finite numbers, as `direction=[1, 0, 0]`")
FORCE = Numbers(3, "three numbers in N, as `push=[0, 0, 0.1]`")


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
        unit = unit_or_first("damping", self.damping_unit, DAMPING_UNITS)
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
            if value != default_of(known[name]):
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


def unit_or_first(what: str, unit: str | None, units: Mapping[str, float]) -> str:
    """Return the unit that was given, or the first, which is SI."""
    if unit is None:
        return next(iter(units))
    in_si(what, 0.0, unit, units)
    return unit
