"""``drake-leg teleop``."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from drake_leg.cli.posture import add_posture, as_option, posture
from drake_leg.cli.robot_source import add_robot_source, robot_source
from drake_leg.cli.server import LEAVING, add_server, start_server
from drake_leg.errors import SingularConfigurationError
from drake_leg.robot import Robot
from drake_leg.runs.options import TASK

if TYPE_CHECKING:
    from drake_leg.scene.driven_foot import Step

KEYS = (
    "keys in the page, held: A D along x, S W along y, F R along z; space halts, "
    "1 to 4 are the views, Escape quits"
)
IDLE = "the guard is idle"


def configure_teleop(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Open a robot in the browser, in Meshcat, and drive its foot: "
        "sliders set its velocity along x, y, z; buttons or the keys A D, S W, F R drive it while "
        "they are held; the space bar halts. It also halts when the page is left or loses its "
        "connection. The page shows a section of a leg's workspace and the smallest singular "
        "value; near a singularity a guard slows the foot and stops it (green, orange, red), and "
        "lets it go back. The terminal also shows what the guard does. A foot with fewer than "
        "three joints moves only along some directions, which the page names."
    )
    parser.epilog = LEAVING
    add_robot_source(parser)
    add_posture(parser)
    parser.add_argument(
        "--task",
        metavar="TEXT",
        help=f"{TASK} (default pose if the joints can hold it, otherwise position)",
    )
    add_server(parser)
    parser.set_defaults(command=_teleop)


def _teleop(chosen: argparse.Namespace) -> int:
    from drake_leg.scene.teleop import drive_robot

    robot = robot_source(chosen.robot).robot()
    q = posture(chosen.robot, robot, chosen.q)
    start = _start(robot, q, chosen.task)
    try:
        with start_server(chosen, f"{robot.title}, driven by A D, S W, F R") as server:
            _say(f"{KEYS}\nat the start sigma_min is {_mm(start)}, {start.sentence or IDLE}")
            step = drive_robot(robot, q, server, say=_say, keep=chosen.task, once=chosen.once)
    except KeyboardInterrupt:
        return 0
    print(f"the robot was left at --q {as_option(robot, step.q.tolist())}")
    return 0


def _start(robot: Robot, q: list[float], keep: str | None) -> Step:
    """Describe where the robot starts, or refuse a singular posture."""
    from drake_leg.scene.driven_foot import DrivenFoot
    from drake_leg.singularity.families import singular_words

    drive = DrivenFoot(robot, keep)
    try:
        return drive.at_rest(q)
    except SingularConfigurationError as error:
        where = singular_words(drive.moved.geometry, q, "")
        raise SingularConfigurationError(
            q=error.q,
            sigma_min=error.sigma_min,
            problem=f"at --q {as_option(robot, q)} {where}: from this "
            "singular posture the foot cannot be driven",
            advice="choose another `q`"
            + (", or `task='position'`" if drive.moved.keeps_orientation else ""),
        ) from None


def _mm(step: Step) -> str:
    return f"{1e3 * step.sigma_min:.2f} mm"


def _say(sentence: str) -> None:
    print(sentence, flush=True)
