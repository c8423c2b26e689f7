"""Which maps belong to a posture: where its robot is singular, and how well it moves elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from matplotlib.figure import Figure

from drake_leg.errors import InvalidValueError
from drake_leg.figures.dexterity import arm_dexterity, dexterity
from drake_leg.figures.singularities import determinant_map, foot_space, joint_space
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.of_robot import geometry_of
from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.robot import Robot

Maps = dict[str, Callable[[], Figure]]


def maps_of_posture(robot: Robot, q: Sequence[float]) -> Maps:
    """Name the maps of a posture of a leg or the SCARA, and the functions that draw them.

    The posture (m,) [rad or m] is marked; the SCARA's lift may be left out.

    Raises
    ------
    InvalidValueError
        If it is another robot.
    """
    match geometry_of(robot):
        case LegGeometry() as leg:
            return _of_leg(robot.title, leg, q)
        case ScaraGeometry() as arm:
            return _of_scara(robot.title, arm, q)
    raise InvalidValueError(
        f"the robot is {robot.name!r}; maps are drawn of a hexabot leg or the SCARA",
        advice="without `out` the posture is described in words",
    )


def _of_leg(title: str, leg: LegGeometry, q: Sequence[float]) -> Maps:
    return {
        "determinant": lambda: determinant_map(
            leg, q, f"{title}: the determinant, and where it is zero"
        ),
        "singular_postures": lambda: joint_space(
            leg, q, f"{title}: both families of singular postures"
        ),
        "singular_feet": lambda: foot_space(
            leg, f"{title}: where the foot is at singular postures"
        ),
        "sigma_min": lambda: dexterity(
            leg, q, f"{title}: how well the foot moves in the leg's own plane"
        ),
    }


def _of_scara(robot: str, arm: ScaraGeometry, q: Sequence[float]) -> Maps:
    posture = q if len(q) == 4 else (*q, lift_position(arm, 0.0))
    title = f"{robot}: how well the tool moves, from above"
    return {
        "sigma_min": lambda: arm_dexterity(arm, posture, title),
    }
