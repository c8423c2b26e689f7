"""The options of the pendulums: free, damped, and with a spring."""

import math
from dataclasses import dataclass
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import PENDULUM_SIZE, WATER, pendulum
from drake_leg.runs.option import Numbers, option
from drake_leg.runs.options import DAMPING, DURATION, Q0, DampingOptions, unit_or_first
from drake_leg.units import SPRING_UNITS, in_si

STATE_TARGET = 30.0  # [deg], report A, section 1.2
LIMIT = "{} angle, beyond which a spring and a damper push back, as Simscape's joint limits do"
TARGET = "where pendulum-damped starts; where the spring of pendulum-spring is at rest"
ANGLE = Numbers(1, "one finite angle in degrees, as `q0=[30]`")
SIZE = Numbers(3, "length, width and height in m, as `size=[0.4, 0.01, 0.01]`")


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
        if len(given) == 2 and given["lower"] >= given["upper"]:
            raise InvalidValueError(
                f"the lower limit is {self.lower_limit:g} deg and the upper one "
                f"{self.upper_limit:g} deg; the lower one must be less"
            )
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
        unit = unit_or_first("spring", self.spring_unit, SPRING_UNITS)
        return in_si("spring", self.spring_stiffness, unit, SPRING_UNITS)

    def mechanics(self) -> dict[str, Any]:
        """Return them with the spring."""
        spring = {
            "spring_stiffness": self.si_stiffness(),
            "equilibrium_position": self.equilibrium(),
        }
        return super().mechanics() | spring
