"""A leg's plant, composed of the thigh included three times."""

from __future__ import annotations

from pydrake.multibody.plant import MultibodyPlant

from drake_leg.models.files import sdf_folder
from drake_leg.models.plant import parsed_plant
from drake_leg.models.thigh_sdf import thigh_leg_text
from drake_leg.quantities import STANDARD_GRAVITY
from drake_leg.robot import Robot


def thigh_leg(robot: Robot, *, gravity: float = STANDARD_GRAVITY) -> MultibodyPlant:
    """Compose a leg of thigh subsystems (report B, figure 5) into a continuous, finalised plant.

    It moves exactly as ``build_plant(robot)`` does: the same joints in the same order, the same
    masses, the same frames of the table. Its links are model instances of their own, each with the
    frames ``base``, ``cog``, ``end`` and ``solid``. ``gravity`` is in m/s^2, along the world's -z.

    Raises
    ------
    InvalidValueError
        If a link is not a brick or does not end where the next row begins, gravity is negative, or
        Drake refuses the model.
    """
    package = sdf_folder() / "package.xml"
    return parsed_plant(thigh_leg_text(robot), robot, gravity=gravity, package=package)
