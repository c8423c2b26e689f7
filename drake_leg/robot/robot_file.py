"""Reads a robot from a file, by its ending: TOML, or a ``.par`` of SYMORO."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePath
from types import NoneType

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.files import read_text
from drake_leg.robot.file_names import is_par
from drake_leg.robot.robot import Robot
from drake_leg.robot.symoro.as_robot import LoadedRobot, numbers_of, robot_of_par
from drake_leg.robot.symoro.reader import load_par
from drake_leg.robot.toml.reader import read_robot


def load_robot(path: Path | str, numbers: Mapping[str, float | str] | None = None) -> Robot:
    """Read a robot from a TOML file, or from a ``.par`` file of SYMORO.

    Parameters
    ----------
    path : Path or str
        ``drake-leg sdf leg-b --toml`` or ``--par`` prints one to start from.
    numbers : mapping of str to float, optional
        Of the letters of a ``.par`` file: ``{"D3": 0.45, "RL4": 0.45}``. A text such as
        ``"Pi/4"`` does, too.

    Returns
    -------
    Robot
        In Khalil's convention, whatever the file has.

    Raises
    ------
    InvalidValueError
        With file, key and value, if something is invalid. A ``MissingNumbersError`` has the names
        of all letters that need a number.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from drake_leg import LEG_B, load_robot
    >>> from drake_leg.robot.symoro.writer import robot_par
    >>> from drake_leg.robot.toml.writer import robot_toml
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "leg_b.toml"
    ...     _ = path.write_text(robot_toml(LEG_B))
    ...     load_robot(path) == LEG_B
    ...     path = Path(folder) / "leg_b.par"
    ...     _ = path.write_text(robot_par(LEG_B))
    ...     load_robot(path).rows == LEG_B.rows
    True
    True
    """
    return read_robot_file(path, numbers).robot


def read_robot_file(
    path: Path | str, numbers: Mapping[str, float | str] | None = None
) -> LoadedRobot:
    """Read a robot from a file, as ``load_robot`` does, with what is doubtful about it."""
    require_kind("the path of a robot file", path, str, PurePath)
    require_kind("`numbers`", numbers, Mapping, NoneType)
    if not is_par(path):
        if numbers:
            raise InvalidValueError(
                f"{path} has no letters, and needs no number of {next(iter(numbers))}; only a .par "
                "file has letters"
            )
        return LoadedRobot(robot=read_robot(read_text(Path(path)), str(path)))
    par = load_par(path)
    return robot_of_par(par, numbers_of(numbers or {}, par.where))
