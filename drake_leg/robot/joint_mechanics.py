"""Joint mechanics under Simscape's names: damping, spring, limits, actuation, state targets."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import NoneType
from typing import TYPE_CHECKING, Literal, Self

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.units import (
    DAMPING_UNITS,
    SPRING_UNITS,
    in_words,
    require_angle,
    require_non_negative,
    require_number,
    require_positive,
)

if TYPE_CHECKING:
    from drake_leg.robot.robot import Robot

Priority = Literal["high", "low"]
PRIORITIES = ("high", "low")
CLOSE = 1e-9  # relative or absolute difference at which a state target is met

_PER_DEGREE, _PER_DEGREE_PER_SECOND = SPRING_UNITS["N*m/deg"], DAMPING_UNITS["N*m/(deg/s)"]


@dataclass(frozen=True, kw_only=True)
class StateTarget:
    """Initial position or velocity of a joint; it has no effect afterwards."""

    value: float  # [rad or m], or [rad/s or m/s]
    priority: Priority = "high"  # a low one may be left unmet

    def __post_init__(self) -> None:
        require_angle("the state target", self.value)
        if self.priority not in PRIORITIES:
            raise InvalidValueError(
                f"the state target's priority is {self.priority!r}; it must be "
                f"{' or '.join(PRIORITIES)}, and where there is no target, leave it out"
            )


@dataclass(frozen=True, kw_only=True)
class HardStop:
    """Spring and damper that push a joint back beyond its limit, scaled up smoothly from 0."""

    stiffness: float  # [N*m/rad] or [N/m]
    damping: float  # [N*m*s/rad] or [N*s/m]
    transition_width: float  # [rad] or [m], depth at which spring and damper act in full

    def __post_init__(self) -> None:
        require_positive("the limit's stiffness", self.stiffness, "N*m/rad")
        require_non_negative("the limit's damping", self.damping, "N*m*s/rad")
        require_positive("the limit's transition width", self.transition_width, "rad")

    @classmethod
    def rotational(
        cls, stiffness: float = 1e4, damping: float = 10.0, transition_width: float = 0.1
    ) -> Self:
        """Make the stop of a revolute joint, by default with Simscape's values.

        The units are Simscape's: N*m/deg, N*m/(deg/s), deg.
        """
        return cls(
            stiffness=stiffness * _PER_DEGREE,
            damping=damping * _PER_DEGREE_PER_SECOND,
            transition_width=math.radians(transition_width),
        )

    @classmethod
    def translational(
        cls, stiffness: float = 1e6, damping: float = 1e3, transition_width: float = 1e-4
    ) -> Self:
        """Make the stop of a prismatic joint, by default with Simscape's values.

        The units are N/m, N*s/m, m.
        """
        return cls(stiffness=stiffness, damping=damping, transition_width=transition_width)


@dataclass(frozen=True, kw_only=True)
class JointMechanics:
    """A joint's state targets, internal mechanics, limits and actuation, as in Simscape.

    A limit with a stop pushes the joint back; a limit without one must not be passed, and
    a run ends there.
    """

    damping: float = 0.0  # [N*m*s/rad] or [N*s/m]
    dry_friction: float = 0.0  # [N*m] or [N], Coulomb's; Drake's joints have none
    rotor_inertia: float = 0.0  # [kg*m^2] or [kg], of the motor's rotor, seen at the joint
    spring_stiffness: float = 0.0  # [N*m/rad] or [N/m]
    equilibrium_position: float = 0.0  # [rad] or [m], where the spring is at rest
    actuated: bool = True
    lower: float | None = None  # [rad] or [m], least position; None: no limit
    upper: float | None = None  # [rad] or [m], greatest position
    velocity: float | None = None  # [rad/s] or [m/s], greatest speed
    effort: float | None = None  # [N*m] or [N], greatest torque or force of the actuator
    lower_stop: HardStop | None = None
    upper_stop: HardStop | None = None
    position_target: StateTarget | None = None  # [rad] or [m], where the joint starts
    velocity_target: StateTarget | None = None  # [rad/s] or [m/s]

    def __post_init__(self) -> None:
        require_non_negative("the damping", self.damping, "N*m*s/rad")
        require_non_negative("the dry friction", self.dry_friction, "N*m")
        require_non_negative("the rotor's inertia", self.rotor_inertia, "kg*m^2")
        require_non_negative("the spring stiffness", self.spring_stiffness, "N*m/rad")
        require_angle("the spring's equilibrium position", self.equilibrium_position)
        require_kind("whether the joint is actuated", self.actuated, bool)
        for name in ("position_target", "velocity_target"):
            require_kind(f"the {name}", getattr(self, name), StateTarget, NoneType)
        for name in ("lower_stop", "upper_stop"):
            require_kind(f"the {name}", getattr(self, name), HardStop, NoneType)
        self._check_limits()
        for name in ("lower", "upper"):
            if getattr(self, f"{name}_stop") is not None and getattr(self, name) is None:
                raise InvalidValueError(
                    f"the {name} limit pushes back, but has no bound: give both or none"
                )

    def _check_limits(self) -> None:
        for name, limit in (("lower", self.lower), ("upper", self.upper)):
            if limit is not None:
                require_number(f"the {name} limit", limit)
            if limit is not None and not math.isfinite(limit):
                raise InvalidValueError(
                    f"the {name} limit is {limit!r}; it must be finite, or left out"
                )
        if self.lower is not None and self.upper is not None and self.lower >= self.upper:
            raise InvalidValueError(
                f"the lower limit is {self.lower:.9g} and the upper one {self.upper:.9g}; the "
                "lower one must be less, and a joint that cannot move is a fixed row"
            )
        if self.velocity is not None:
            require_positive("the velocity limit", self.velocity, "rad/s")
        if self.effort is not None:
            require_positive("the effort limit", self.effort, "N*m")
        if self.effort is not None and not self.actuated:
            raise InvalidValueError(
                f"the effort limit is {self.effort!r} N*m at a joint that is not actuated; "
                "leave out one of the two"
            )

        if self.rotor_inertia and not self.actuated:
            raise InvalidValueError(
                f"the rotor's inertia is {self.rotor_inertia!r} kg*m^2 at a joint that is not "
                "actuated; leave out one of the two"
            )

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest position [rad] or [m]; infinite where there is no limit."""
        return (
            -math.inf if self.lower is None else self.lower,
            math.inf if self.upper is None else self.upper,
        )

    @property
    def hard_bounds(self) -> tuple[float, float]:
        """The bounds that must not be passed; infinite where a limit pushes back."""
        lower, upper = self.bounds
        return (
            lower if self.lower_stop is None else -math.inf,
            upper if self.upper_stop is None else math.inf,
        )

    @property
    def stops(self) -> tuple[tuple[int, float, HardStop], ...]:
        """The limits that push back: side (-1 lower, 1 upper), bound [rad or m], stop."""
        limits = ((-1, self.lower, self.lower_stop), (1, self.upper, self.upper_stop))
        return tuple(
            (side, bound, stop)
            for side, bound, stop in limits
            if bound is not None and stop is not None
        )

    @classmethod
    def rotational(
        cls,
        *,
        equilibrium_position: float = 0.0,
        spring_stiffness: float = 0.0,
        damping_coefficient: float = 0.0,
        position_target: float | None = None,
        position_priority: Priority = "high",
        velocity_target: float | None = None,
        velocity_priority: Priority = "high",
        lower: float | None = None,
        upper: float | None = None,
        lower_stop: HardStop | None = None,
        upper_stop: HardStop | None = None,
        actuated: bool = True,
    ) -> Self:
        """Make the mechanics of a revolute joint from its settings in Simscape, in their units.

        Angles are in deg, speeds in deg/s, the stiffness in N*m/deg, the damping in N*m/(deg/s).
        A limit without a stop of its own gets ``HardStop.rotational()``.
        """
        position, velocity = (
            None if value is None else StateTarget(value=math.radians(value), priority=priority)
            for value, priority in (
                (position_target, position_priority),
                (velocity_target, velocity_priority),
            )
        )
        default = HardStop.rotational()
        return cls(
            damping=damping_coefficient * _PER_DEGREE_PER_SECOND,
            spring_stiffness=spring_stiffness * _PER_DEGREE,
            equilibrium_position=math.radians(equilibrium_position),
            actuated=actuated,
            lower=None if lower is None else math.radians(lower),
            upper=None if upper is None else math.radians(upper),
            lower_stop=lower_stop or (None if lower is None else default),
            upper_stop=upper_stop or (None if upper is None else default),
            position_target=position,
            velocity_target=velocity,
        )


@dataclass(frozen=True, kw_only=True)
class InitialState:
    """Initial state of the joints, in the robot's order, and the targets that were not met."""

    q: tuple[float, ...]  # [rad or m]
    qdot: tuple[float, ...]  # [rad/s or m/s]
    unmet: tuple[str, ...] = ()  # a sentence for each low-priority target that was not met


def initial_state(
    robot: Robot, motion: Mapping[str, tuple[float, float]] | None = None
) -> InitialState:
    """Start every joint at its motion, at its state target, or at rest at 0.

    The joints of a chain are independent, so every target can be met, whatever its priority,
    unless a motion drives the joint: then the motion wins, and must start at a target of high
    priority. ``motion`` maps the name of each driven joint to its initial position [rad or m] and
    velocity [rad/s or m/s].
    """
    driven = dict(motion or {})
    positions: list[float] = []
    velocities: list[float] = []
    unmet: list[str] = []
    for segment in robot.moving:
        mechanics, name = segment.mechanics, str(segment.joint)
        for values, quantity, target, given in zip(
            (positions, velocities),
            ("position", "velocity"),
            (mechanics.position_target, mechanics.velocity_target),
            driven.pop(name, (None, None)),
            strict=True,
        ):
            values.append(_value(target, given))
            if target is not None and given is not None and not _met(target, given):
                slides, per = segment.row.joint == "prismatic", "/s" * (quantity == "velocity")
                there, starts = (in_words(x, slides=slides) + per for x in (target.value, given))
                sentence = (
                    f"the {quantity} target of joint {name} is {there}, but its motion starts at "
                    f"{starts}"
                )
                if target.priority == "high":
                    raise InvalidValueError(
                        sentence, advice="start the motion there, or give the target low priority"
                    )
                unmet.append(sentence)
    if driven:
        raise InvalidValueError(
            f"{robot.name} has no joint {next(iter(driven))!r}; its joints are "
            f"{', '.join(str(segment.joint) for segment in robot.moving)}"
        )
    return InitialState(q=tuple(positions), qdot=tuple(velocities), unmet=tuple(unmet))


def starting_posture(robot: Robot) -> tuple[float, ...]:
    """Initial posture [rad or m]: state targets, or else as near to 0 as the limits allow."""
    return tuple(_beginning(segment.mechanics) for segment in robot.moving)


def _beginning(mechanics: JointMechanics) -> float:
    if mechanics.position_target is not None:
        return mechanics.position_target.value
    low, high = mechanics.bounds
    return min(max(0.0, low), high)


def _value(target: StateTarget | None, given: float | None) -> float:
    if given is not None:
        return given
    return 0.0 if target is None else target.value


def _met(target: StateTarget, given: float) -> bool:
    return abs(target.value - given) <= CLOSE * max(1.0, abs(given))
