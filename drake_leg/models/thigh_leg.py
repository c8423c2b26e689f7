"""A leg's plant, composed of the thigh included three times."""

from __future__ import annotations

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.models.files import sdf_folder
from drake_leg.models.thigh_sdf import thigh_leg_text
from drake_leg.quantities import STANDARD_GRAVITY, require_non_negative
from drake_leg.robot import Robot


def thigh_leg(robot: Robot, *, gravity: float = STANDARD_GRAVITY) -> MultibodyPlant:
    """Compose a leg of thigh subsystems into a continuous, finalised plant.

    It moves exactly as ``plant.build_plant(robot)`` does: the same joints in the same order, the
    same masses, the same frames of the table. Its links are model instances of their own, each
    with the frames ``base``, ``cog``, ``end`` and ``solid``.

    Parameters
    ----------
    robot : Robot
        Its moving links are bricks, and each ends where the next row begins.
    gravity : float
        Strength of gravity, along the world's -z [m/s^2].

    Returns
    -------
    MultibodyPlant
        Named like the robot.

    Raises
    ------
    InvalidValueError
        If a link is no thigh, gravity is negative or not finite, or Drake refuses the model.

    References
    ----------
    Report B, figure 5.
    """
    require_non_negative("gravity", gravity, "m/s^2")
    plant = MultibodyPlant(time_step=0.0)
    plant.set_name(robot.name)
    parser = Parser(plant)
    parser.SetStrictParsing()
    parser.package_map().AddPackageXml(str(sdf_folder() / "package.xml"))
    try:
        parser.AddModelsFromString(thigh_leg_text(robot), "sdf")
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -gravity])
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(f"Drake does not take the leg {robot.name!r}: {reason}") from None
    return plant
