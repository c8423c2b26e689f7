"""What acts at a joint: the tables ``mechanics`` and ``limits`` of a row."""

from __future__ import annotations

from drake_leg.joint_mechanics import PRIORITIES, HardStop, JointMechanics, StateTarget
from drake_leg.robot_file.keys import Keys
from drake_leg.units import JointUnits

_MECHANICS_KEYS = (
    "damping",
    "damping_unit",
    "spring_stiffness",
    "spring_unit",
    "equilibrium_position",
    "actuated",
    "position_target",
    "position_priority",
    "velocity_target",
    "velocity_priority",
)
_LIMIT_KEYS = ("lower", "upper", "velocity", "effort", "lower_stop", "upper_stop")
_STOP_KEYS = ("stiffness", "spring_unit", "damping", "damping_unit", "transition_width")
_INSTEAD_OF_MECHANICS = {
    **dict.fromkeys(("limits", *_LIMIT_KEYS), "limits go under [row.limits]"),
    "stiffness": "did you mean 'spring_stiffness'?",
    "mimic": "joints do not follow one another here, each row that moves has a position of its own",
    "friction": "friction that grows with speed is damping; there is no other",
    **dict.fromkeys(("q0", "home", "initial_position"), "write position_target"),
}
_INSTEAD_OF_LIMITS = {
    "min": "write lower",
    "max": "write upper",
    **dict.fromkeys(("speed", "rate", "velocity_limit"), "write velocity, the greatest speed"),
    **dict.fromkeys(("torque", "force", "effort_limit"), "write effort, the greatest of the motor"),
    **dict.fromkeys(
        ("stiffness", "damping"),
        "a limit that pushes back has them: lower_stop = { stiffness = ..., damping = ... }",
    ),
}


def read_mechanics(
    mechanics: object, limits: object, where: str, units: JointUnits
) -> JointMechanics:
    """Read what acts at the joint of a row, from the values of these two keys.

    ``where`` is the file and row, with which every error begins.
    """
    acting = Keys(mechanics, f"{where}, mechanics", _MECHANICS_KEYS, _INSTEAD_OF_MECHANICS)
    bounds = Keys(limits, f"{where}, limits", _LIMIT_KEYS, _INSTEAD_OF_LIMITS)
    lower, upper = (bounds.optional(key, units.position) for key in ("lower", "upper"))
    if lower is not None and upper is not None and lower >= upper:
        raise bounds.error(
            f"lower is {lower:.9g} {units.position} and upper is {upper:.9g} {units.position}; "
            'lower must be less, and a joint that cannot move is a fixed row (sigma = "~")'
        )
    velocity = bounds.optional("velocity", units.velocity, positive=True)
    equilibrium = acting.number("equilibrium_position", units.position, 0.0)
    if acting.has("equilibrium_position") and not acting.has("spring_stiffness"):
        raise acting.error(
            f"equilibrium_position is {equilibrium:.9g} {units.position}, but there is no "
            "spring_stiffness; give both"
        )
    actuated = acting.flag("actuated", True)
    effort = bounds.optional("effort", units.effort, positive=True)
    if effort is not None and not actuated:
        raise bounds.error(
            f"effort is {effort:.9g} {units.effort} at a joint with actuated = false; leave out "
            "one of the two"
        )
    return bounds.make(
        JointMechanics,
        damping=_in_si(acting, "damping", "damping_unit", units.damping, 0.0),
        spring_stiffness=_in_si(acting, "spring_stiffness", "spring_unit", units.stiffness, 0.0),
        equilibrium_position=units.si(equilibrium),
        actuated=actuated,
        lower=None if lower is None else units.si(lower),
        upper=None if upper is None else units.si(upper),
        velocity=None if velocity is None else units.si(velocity),
        effort=effort,
        lower_stop=_stop(bounds, "lower_stop", units),
        upper_stop=_stop(bounds, "upper_stop", units),
        position_target=_target(acting, "position", units.position, units),
        velocity_target=_target(acting, "velocity", units.velocity, units),
    )


def _in_si(keys: Keys, key: str, unit_key: str, units: dict[str, float], default: float) -> float:
    """Read a number that is not negative, and the unit that the file may choose for it."""
    unit = keys.choice(unit_key, tuple(units), next(iter(units)))
    if keys.has(key):
        return keys.non_negative(key, unit, 0.0) * units[unit]
    if keys.has(unit_key):
        raise keys.error(f"{unit_key} is {unit!r}, but there is no {key}; give both")
    return default


def _stop(bounds: Keys, key: str, units: JointUnits) -> HardStop | None:
    """Read how a limit pushes back; what the file leaves out is as in Simscape."""
    if not bounds.has(key):
        return None
    keys = Keys(bounds.value(key), f"{bounds.where}, {key}", _STOP_KEYS)
    default = HardStop.translational() if units.position == "m" else HardStop.rotational()
    width = keys.optional("transition_width", units.position, positive=True)
    return keys.make(
        HardStop,
        stiffness=_in_si(keys, "stiffness", "spring_unit", units.stiffness, default.stiffness),
        damping=_in_si(keys, "damping", "damping_unit", units.damping, default.damping),
        transition_width=default.transition_width if width is None else units.si(width),
    )


def _target(acting: Keys, quantity: str, unit: str, units: JointUnits) -> StateTarget | None:
    """Read where the joint starts, or how fast."""
    key, priority_key = f"{quantity}_target", f"{quantity}_priority"
    priority = acting.choice(priority_key, PRIORITIES, "high")
    value = acting.optional(key, unit)
    if value is not None:
        return acting.make(StateTarget, value=units.si(value), priority=priority)
    if acting.has(priority_key):
        raise acting.error(f"{priority_key} is {priority!r}, but there is no {key}; give both")
    return None
