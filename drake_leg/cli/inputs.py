"""What commands take: a robot by its name or file, and a posture in degrees and meters."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from drake_leg.cli.terminal import numbers
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.files import read_text
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot, Segment
from drake_leg.robot.robots import ROBOTS
from drake_leg.robot.toml_keys import Document, parse_document
from drake_leg.robot.toml_reader import read_robot
from drake_leg.robot.toml_writer import robot_toml
from drake_leg.runs.catalogue import reports_posture
from drake_leg.runs.options import TIP

# The package's robots by their names on the command line.
ROBOT_NAMES = {robot.name.replace("_", "-"): robot for robot in (*ROBOTS, HEXABOT)}


@dataclass(frozen=True, kw_only=True)
class RobotSource:
    """The text of a robot, not yet read."""

    text: str  # TOML
    origin: str  # what an SDF file of it says that it was generated from
    where: str  # how errors about it begin

    def document(self) -> Document:
        """Return its nested tables."""
        return parse_document(self.text, self.where)

    def robot(self) -> Robot:
        """Read the robot."""
        return read_robot(self.text, self.where)


def add_robot_source(parser: argparse.ArgumentParser) -> None:
    """Add the argument that names a robot or its file."""
    names = ", ".join(ROBOT_NAMES)
    parser.add_argument(
        "robot",
        metavar="NAME|FILE.toml",
        help=f"one of {names}, or a robot of your own: a TOML file ('drake-leg sdf leg-b --toml' "
        "prints one)",
    )


def add_tip(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--tip``."""
    parser.add_argument("--tip", metavar="NAME", help=f"{TIP} (default: the only one)")


def robot_source(name: str) -> RobotSource:
    """Find the text of a robot by its name, or in its file."""
    if name in ROBOT_NAMES:
        text = robot_toml(ROBOT_NAMES[name])
        return RobotSource(text=text, origin="drake_leg.robot.robots", where=name)
    path = Path(name)
    if path.suffix.lower() == ".toml":
        return RobotSource(text=read_text(path), origin=path.name, where=name)
    robots = f"the robots are {', '.join(ROBOT_NAMES)}; one of your own is a file ending in .toml"
    raise InvalidValueError(
        f"there is no robot {name!r}", advice=did_you_mean(name, ROBOT_NAMES, robots)
    )


def add_posture(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--q``."""
    parser.add_argument(
        "--q", metavar="X,Y,Z", help="joint angles [deg]; a lift [m] (default: where a run starts)"
    )


def posture(name: str, robot: Robot, text: str | None) -> list[float]:
    """Read a posture, or choose the one where a run starts [rad or m].

    ``name`` is the robot's on the command line, ``text`` as in ``90,-50,-90``.
    """
    if text is None:
        reports = reports_posture(ROBOT_NAMES[name]) if name in ROBOT_NAMES else None
        return list(starting_posture(robot)) if reports is None else joint_positions(robot, reports)
    return joint_positions(robot, numbers("--q", text))


def joint_positions(
    robot: Robot, values: Sequence[float], *, moving: Sequence[Segment] = ()
) -> list[float]:
    """Convert degrees where a joint turns, of all joints or of these [rad or m]."""
    moving = moving or robot.moving
    if len(values) != len(moving):
        raise InvalidValueError(
            f"--q has {len(values)} numbers; {robot.name} has {len(robot.moving)} joint positions"
        )
    return [
        math.radians(value) if segment.row.joint == "revolute" else value
        for value, segment in zip(values, moving, strict=True)
    ]


def as_typed(robot: Robot, q: list[float]) -> str:
    """Write a posture [rad or m] as ``--q`` takes it."""
    return ",".join(
        f"{math.degrees(value) if segment.row.joint == 'revolute' else value:.6g}"
        for value, segment in zip(q, robot.moving, strict=True)
    )
