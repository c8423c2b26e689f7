"""What commands take: a robot by its name or file, and a posture in degrees and meters."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import counted
from drake_leg.cli.terminal import numbers, remark
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.files import read_text
from drake_leg.robot.file_names import ENDINGS, is_par, is_robot_file
from drake_leg.robot.ground import FLAT, Ground, ground_from
from drake_leg.robot.hexapods import HEXAPODS
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.linkages import NAMED_LINKAGES
from drake_leg.robot.robot import Robot, Segment
from drake_leg.robot.robots import ROBOTS
from drake_leg.robot.symoro.as_robot import Numbers, numbers_of, require_letters, robot_of_par
from drake_leg.robot.symoro.reader import ParFile, load_par
from drake_leg.robot.symoro.text import parts_of
from drake_leg.robot.toml.keys import Document, parse_document
from drake_leg.robot.toml.reader import read_robot
from drake_leg.robot.toml.writer import robot_toml
from drake_leg.runs.catalogue import reports_posture
from drake_leg.runs.options import TIP

if TYPE_CHECKING:
    from drake_leg.kinematics.closed_loops import ClosedLoops
    from drake_leg.symbolic.table import SymbolicTable

FILE = "FILE.toml|FILE.par"  # of a robot
WALKERS = {"hexapod": "hexabot"}  # names of runs that are no robots'

# The package's robots by their modules, and by their names on the command line.
_MODULES = {"robots": ROBOTS, "hexapods": HEXAPODS, "linkages": NAMED_LINKAGES}
ROBOT_NAMES = {
    robot.name.replace("_", "-"): robot for robots in _MODULES.values() for robot in robots
}


@dataclass(frozen=True, kw_only=True)
class TomlSource:
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

    @property
    def title(self) -> str:
        """The robot's title."""
        return self.robot().title

    def table(self) -> SymbolicTable:
        """Write its table in symbols, whose numbers it keeps."""
        from drake_leg.symbolic.table import table_of_robot

        return table_of_robot(self.robot())


class ParSource:
    """A file of SYMORO, with numbers for its letters; what is doubtful about it is printed."""

    def __init__(self, where: str, settings: Mapping[str, str]) -> None:
        self.where, self.origin = where, Path(where).name
        self._settings = settings

    @cached_property
    def _par(self) -> ParFile:
        return load_par(self.where)

    @cached_property
    def _numbers(self) -> Numbers:
        found = numbers_of(self._settings, "--set")
        require_letters(self._par, found)
        return found

    @cached_property
    def _robot(self) -> Robot:
        loaded = robot_of_par(self._par, self._numbers)
        for note in loaded.notes:
            remark(note)
        return loaded.robot

    @property
    def title(self) -> str:
        """The robot's name in the file."""
        return self._par.name

    def document(self) -> Document:
        """Return the nested tables that the robot has in TOML."""
        return parse_document(robot_toml(self._robot), self.where)

    def robot(self) -> Robot:
        """Make the robot, for which all letters of its table need numbers."""
        return self._robot

    def table(self) -> SymbolicTable:
        """Write its table in symbols: letters without numbers stay."""
        from drake_leg.symbolic.par_table import table_of_par

        for note in self._par.notes:
            remark(note)
        return table_of_par(self._par, self._numbers)


RobotSource = TomlSource | ParSource


def walks(robot: Robot) -> bool:
    """Tell whether a robot has legs to walk on, and a gait for as many."""
    from drake_leg.kinematics.walking.gait import LEGS
    from drake_leg.kinematics.walking.legs import Legs

    try:
        return Legs.of(robot).count == len(LEGS)
    except InvalidValueError:
        return False


def add_robot_source(parser: argparse.ArgumentParser, *, models: bool = False) -> None:
    """Add the argument that names a robot or its file, or a model's where there are ``models``."""
    names = ", ".join(ROBOT_NAMES)
    parser.add_argument(
        "robot",
        metavar=f"NAME|{FILE}{'|FILE.slx' if models else ''}",
        help=f"one of {names}, or a robot of your own: a TOML file ('drake-leg sdf leg-b --toml' "
        "prints one), or a .par file of SYMORO (--par prints one)"
        + ("; or a Simulink model (.slx, .mdl)" if models else ""),
    )
    add_numbers(parser)


def ground_of(summary: Mapping[str, Any]) -> Ground:
    """Return the ground of a walk, as the summary of its run has it; level ground of others."""
    data = summary.get("ground")
    return ground_from(data) if isinstance(data, Mapping) else FLAT


def add_numbers(parser: argparse.ArgumentParser) -> None:
    """Add the option that gives numbers to the letters of a ``.par`` file."""
    parser.add_argument(
        "--set",
        action="append",
        dest="numbers",
        metavar="D3=0.45,RL4=0.45",
        help="numbers for letters of a .par file [m, rad, kg], or values of variables of a "
        "Simulink model, as L1=0.05; may be repeated",
    )


def add_tip(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--tip``."""
    parser.add_argument("--tip", metavar="NAME", help=f"{TIP} (default: the only one)")


def robot_source(name: str, numbers: Sequence[str] | None = None) -> RobotSource:
    """Find the text of a robot by its name, or in its file.

    ``numbers`` is what was given with ``--set``, for the letters of a ``.par`` file.
    """
    settings = settings_of(name, numbers)
    if name in ROBOT_NAMES:
        robot = ROBOT_NAMES[name]
        module = next(module for module, robots in _MODULES.items() if robot in robots)
        return TomlSource(text=robot_toml(robot), origin=f"drake_leg.robot.{module}", where=name)
    path = Path(name)
    if is_par(path):
        return ParSource(name, settings)
    if is_robot_file(path):
        return TomlSource(text=read_text(path), origin=path.name, where=name)
    robots = (
        f"the robots are {', '.join(ROBOT_NAMES)}; one of your own is a file ending in {ENDINGS}"
    )
    raise InvalidValueError(
        f"there is no robot {name!r}", advice=did_you_mean(name, ROBOT_NAMES, robots)
    )


def named_or_robot(name: str, numbers: Sequence[str] | None) -> str | Robot:
    """Return the robot of a ``.par`` file, and any other name as it is.

    ``numbers`` is what was given with ``--set``.
    """
    if is_par(name):
        return robot_source(name, numbers).robot()
    settings_of(name, numbers)
    return name


def settings_of(name: str, given: Sequence[str] | None) -> dict[str, str]:
    """Read ``D3=0.45,RL4=0.45``, of which there may be several."""
    if given and not is_par(name):
        raise InvalidValueError(
            f"--set gives numbers to the letters of a .par file, and {name} has none: leave it out"
        )
    settings: dict[str, str] = {}
    for part, _ in (each for text in given or () for each in parts_of(text)):
        letter, equals, number = (word.strip() for word in part.partition("="))
        if not (letter and equals and number):
            raise InvalidValueError(f"--set has {part!r} in it; write D3=0.45,RL4=0.45")
        if letter in settings:
            raise InvalidValueError(f"--set gives {letter} twice; keep one of the numbers")
        settings[letter] = number
    return settings


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
        q = list(starting_posture(robot)) if reports is None else joint_positions(robot, reports)
    else:
        q = joint_positions(robot, numbers("--q", text))
    return closed_posture(robot, q, searched=text is None)


def closed_posture(robot: Robot, q: list[float], *, searched: bool = False) -> list[float]:
    """Close the loops of a robot from a posture, if it has any; the passive joints move.

    Where that is not possible, a closed posture is ``searched``, and what was found is said.
    """
    if not robot.loops:
        return q
    from drake_leg.kinematics.closed_loops import ClosedLoops

    loops = ClosedLoops(robot)
    try:
        return [float(value) for value in loops.position([q[i] for i in loops.active_columns], q)]
    except InvalidValueError:
        found = _searched(loops, q) if searched else None
        if found is None:
            raise
        return found


def searched_start(robot: Robot) -> list[float] | None:
    """Search a closed posture, and say what was found; None where the robot starts in one."""
    start = list(starting_posture(robot))
    found = closed_posture(robot, start, searched=True)
    moves = any(
        f != s for f, s, g in zip(found, start, robot.moving, strict=True) if g.mechanics.actuated
    )
    return found if moves else None


def _searched(loops: ClosedLoops, q: list[float]) -> list[float] | None:
    from drake_leg.kinematics.assemblies import closed_near

    found = closed_near(loops, q)
    if found is None:
        return None
    closed, starts, closing = found
    position: list[float] = closed.tolist()
    remark(
        f"the loops do not close with {loops.in_words([q[i] for i in loops.active_columns])}, "
        f"where {loops.robot.name} starts: of {starts} starts of Newton's method, with all joints "
        f"moving, {closing} closed; the nearest posture is --q {as_typed(loops.robot, position)}"
    )
    return position


def joint_positions(
    robot: Robot, values: Sequence[float], *, moving: Sequence[Segment] = ()
) -> list[float]:
    """Convert degrees where a joint turns, of all joints or of these [rad or m]."""
    moving = moving or robot.moving
    if len(values) != len(moving):
        raise InvalidValueError(
            f"--q has {counted(len(values), 'number')}; {robot.name} has "
            f"{counted(len(robot.moving), 'joint position')}"
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
