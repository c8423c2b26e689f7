"""From a robot to Drake's MultibodyPlant, by way of its SDF."""

from __future__ import annotations

import math

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import sdf_text
from drake_leg.quantities import STANDARD_GRAVITY, require_non_negative
from drake_leg.robot import Robot


def build_plant(robot: Robot, *, gravity: float = STANDARD_GRAVITY) -> MultibodyPlant:
    """Parse a robot's SDF into a continuous, finalised plant.

    Parameters
    ----------
    robot : Robot
        The robot; its base is welded to the world.
    gravity : float
        Strength of gravity, along the world's -z [m/s^2].

    Returns
    -------
    MultibodyPlant
        Named like the robot, with one model instance. A limit that pushes back, which a
        continuous plant does not do, is none of the plant's own: ``JointStops`` does it.

    Raises
    ------
    InvalidValueError
        If gravity is negative or not finite, or Drake refuses the model.

    Examples
    --------
    >>> from drake_leg import LEG_B, build_plant
    >>> plant = build_plant(LEG_B)
    >>> plant.num_positions(), plant.HasFrameNamed("frame_4")
    (3, True)
    >>> context = plant.CreateDefaultContext()
    >>> foot = plant.GetFrameByName("frame_4").CalcPoseInWorld(context).translation()
    >>> foot.round(3).tolist()  # stretched along x [m]
    [0.25, 0.0, 0.0]
    """
    require_non_negative("gravity", gravity, "m/s^2")
    plant = MultibodyPlant(time_step=0.0)
    plant.set_name(robot.name)
    parser = Parser(plant)
    parser.SetStrictParsing()
    try:
        parser.AddModelsFromString(sdf_text(robot), "sdf")
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -gravity])
        _leave_limits_to_stops(plant, robot)
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(f"Drake does not take the model {robot.name!r}: {reason}") from None
    return plant


def _leave_limits_to_stops(plant: MultibodyPlant, robot: Robot) -> None:
    for segment in robot.moving:
        if segment.mechanics.stops:
            joint = plant.GetJointByName(segment.joint)
            lower, upper = joint.position_lower_limits(), joint.position_upper_limits()
            for side, _, _ in segment.mechanics.stops:
                (lower if side < 0 else upper)[0] = side * math.inf
            joint.set_position_limits(lower, upper)
