"""Initial joint positions and velocities from state targets and motions, as in Simscape."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robot import Robot
from drake_leg.units import in_words

CLOSE = 1e-9  # relative or absolute difference at which a target is met


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
    unless a motion drives the joint: then the motion wins. ``motion`` maps the name of each driven
    joint to its initial position [rad or m] and velocity [rad/s or m/s].

    Raises
    ------
    InvalidValueError
        If the motion does not start at a target of high priority, or the robot has no joint of
        that name.
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
