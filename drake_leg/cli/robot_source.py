"""The argument NAME|FILE.toml: a robot of the reports, or one's own."""

from __future__ import annotations

import argparse
import difflib
from dataclasses import dataclass
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.files import read_text
from drake_leg.robot import Robot
from drake_leg.robot_file.document import Document, parse_document
from drake_leg.robot_file.read import read_robot
from drake_leg.robot_file.write import robot_toml
from drake_leg.robots import ROBOTS

ROBOT_NAMES = {robot.name.replace("_", "-"): robot for robot in ROBOTS}


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


def robot_source(name: str) -> RobotSource:
    """Find the text of a robot by its name, or in its file."""
    if name in ROBOT_NAMES:
        text = robot_toml(ROBOT_NAMES[name])
        return RobotSource(text=text, origin="drake_leg.robots", where=name)
    path = Path(name)
    if path.suffix.lower() == ".toml":
        return RobotSource(text=read_text(path), origin=path.name, where=name)
    near = difflib.get_close_matches(name, ROBOT_NAMES, n=1)
    advice = f"did you mean {near[0]}" if near else f"the robots are {', '.join(ROBOT_NAMES)}"
    raise InvalidValueError(
        f"there is no robot {name!r}: {advice}; one of your own is a file that ends in .toml"
    )
