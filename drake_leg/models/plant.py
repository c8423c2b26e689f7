"""Builds Drake's MultibodyPlant from a robot's SDF, and writes the files of ``sdf/``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import (
    LEG_FILE,
    THIGH_FILE,
    package_text,
    sdf_text,
    thigh_leg_text,
    thigh_text,
)
from drake_leg.models.walker_sdf import body_text, leg_text
from drake_leg.robot.hexapods import HEXABOT, PHANTOMX
from drake_leg.robot.robot import Robot, Segment, require_robot
from drake_leg.robot.robots import LEG_B, ROBOTS
from drake_leg.units import STANDARD_GRAVITY, require_non_negative

# Walking robots by the names of their files: of the body, which includes the file of a leg.
WALKERS = {"hexapod": HEXABOT, "phantomx": PHANTOMX}


def generated_files() -> dict[str, str]:
    """Generate all files of the folder ``sdf``: file name to text."""
    files = {f"{robot.name}.sdf": sdf_text(robot) for robot in ROBOTS}
    thighs = {THIGH_FILE: thigh_text(), LEG_FILE: thigh_leg_text(LEG_B)}
    walkers: dict[str, str] = {}
    for name, robot in WALKERS.items():
        leg_file = f"{name}_leg.sdf"
        walkers[f"{name}.sdf"] = body_text(robot, leg_file=leg_file)
        walkers[leg_file] = leg_text(robot)
    return {"package.xml": package_text(), **files, **thighs, **walkers}


def sdf_folder() -> Path:
    """Find the folder of SDF files and their ``package.xml``, in a wheel or in a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "sdf"
    return installed if installed.is_dir() else package.parent / "sdf"


def build_plant(robot: Robot, *, gravity: float = STANDARD_GRAVITY) -> MultibodyPlant:
    """Parse a robot's SDF into a continuous, finalized plant.

    Parameters
    ----------
    robot : Robot
        The robot; its base is welded to the world.
    gravity : float
        Strength of gravity, along the world's -z [m/s^2].

    Returns
    -------
    MultibodyPlant
        Named like the robot, with one model instance. Limits that push back are not the
        plant's, because a continuous plant does not enforce them: ``JointStops`` does.

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
    require_robot(robot)
    return parsed_plant(sdf_text(robot), robot, gravity=gravity)


def parsed_plant(
    text: str, robot: Robot, *, gravity: float, package: Path | None = None
) -> MultibodyPlant:
    """Parse an SDF document of a robot, which may include files of a package.

    Limits that push back are left to ``JointStops``.
    """
    require_non_negative("gravity", gravity, "m/s^2")
    plant = MultibodyPlant(time_step=0.0)
    plant.set_name(robot.name)
    parser = Parser(plant)
    parser.SetStrictParsing()
    if package is not None:
        parser.package_map().AddPackageXml(str(package))
    try:
        parser.AddModelsFromString(text, "sdf")
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -gravity])
        for segment in robot.moving:
            _leave_limits_to_stops(plant, segment)
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(f"Drake refuses the model {robot.name!r}: {reason}") from None
    return plant


def _leave_limits_to_stops(plant: MultibodyPlant, segment: Segment) -> None:
    if segment.mechanics.stops:
        joint = plant.GetJointByName(segment.joint)
        lower, upper = joint.position_lower_limits(), joint.position_upper_limits()
        for side, _, _ in segment.mechanics.stops:
            (lower if side < 0 else upper)[0] = side * math.inf
        joint.set_position_limits(lower, upper)


def thigh_leg(robot: Robot, *, gravity: float = STANDARD_GRAVITY) -> MultibodyPlant:
    """Compose a leg of thigh subsystems (report B, figure 5) into a continuous, finalized plant.

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


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for file_name, text in generated_files().items():
        (folder / file_name).write_text(text, encoding="utf-8")
