"""What acts at a joint: the tables ``mechanics`` and ``limits`` of a row."""

from __future__ import annotations

from drake_leg.robot import JointMechanics
from drake_leg.robot_file.keys import Keys
from drake_leg.robot_file.units import JointUnits

_MECHANICS_KEYS = (
    "damping",
    "damping_unit",
    "spring_stiffness",
    "equilibrium_position",
    "actuated",
)
_LIMIT_KEYS = ("lower", "upper", "velocity", "effort")
_INSTEAD_OF_MECHANICS = {
    **dict.fromkeys(("limits", *_LIMIT_KEYS), "limits stand under [row.limits]"),
    "stiffness": "did you mean 'spring_stiffness'?",
}


def read_mechanics(
    mechanics: object, limits: object, where: str, units: JointUnits
) -> JointMechanics:
    """Read what acts at the joint of a row.

    Parameters
    ----------
    mechanics, limits : object
        What stands behind these keys; an empty table where there is nothing.
    where : str
        File and row, the beginning of every error's sentence.
    units : JointUnits
        The file's units at this joint.

    Returns
    -------
    JointMechanics

    Raises
    ------
    InvalidValueError
        With file, key and value.
    """
    acting = Keys(mechanics, f"{where}, mechanics", _MECHANICS_KEYS, _INSTEAD_OF_MECHANICS)
    damping_unit = acting.choice("damping_unit", tuple(units.damping), next(iter(units.damping)))
    bounds = Keys(limits, f"{where}, limits", _LIMIT_KEYS)
    lower, upper = (bounds.optional(key, units.position) for key in ("lower", "upper"))
    if lower is not None and upper is not None and lower >= upper:
        raise bounds.error(
            f"lower is {lower:.9g} {units.position} and upper is {upper:.9g} {units.position}; "
            'lower must be less, and a joint that cannot move is a fixed row (sigma = "~")'
        )
    velocity = bounds.optional("velocity", units.velocity, positive=True)
    damping = acting.non_negative("damping", damping_unit, 0.0)
    equilibrium = acting.number("equilibrium_position", units.position, 0.0)
    actuated = acting.flag("actuated", True)
    effort = bounds.optional("effort", units.effort, positive=True)
    if effort is not None and not actuated:
        raise bounds.error(
            f"effort is {effort:.9g} {units.effort} at a joint with actuated = false; leave out "
            "one of the two"
        )
    return bounds.make(
        JointMechanics,
        damping=damping * units.damping[damping_unit],
        spring_stiffness=acting.non_negative("spring_stiffness", units.stiffness, 0.0),
        equilibrium_position=units.si(equilibrium),
        actuated=actuated,
        lower=None if lower is None else units.si(lower),
        upper=None if upper is None else units.si(upper),
        velocity=None if velocity is None else units.si(velocity),
        effort=effort,
    )
