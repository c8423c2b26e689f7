"""``drake-leg teleop``."""

from __future__ import annotations

import argparse

from drake_leg.cli.common import Commands
from drake_leg.cli.meshcat import add_meshcat, start_meshcat
from drake_leg.cli.posture import add_posture, as_option, posture
from drake_leg.cli.robot_source import add_robot_source, robot_source


def add(commands: Commands) -> None:
    """Add the command.

    Parameters
    ----------
    commands : argparse subparsers
        Of the program.
    """
    parser = commands.add_parser(
        "teleop",
        help="drive a leg's foot by hand, in real time",
        description="Open a robot of three joints in Meshcat and drive its foot: sliders or the "
        "keys A D, S W, F R set the velocity along x, y, z, the space bar halts. A leg's section "
        "of reach is shown, the smallest singular value too; near a singularity a guard slows "
        "the foot and stops it (green, orange, red), and lets it go back.",
    )
    add_robot_source(parser)
    add_posture(parser)
    add_meshcat(parser)
    parser.set_defaults(command=_teleop)


def _teleop(chosen: argparse.Namespace) -> int:
    from drake_leg.teleop.control import at_rest, drive_of
    from drake_leg.teleop.session import drive_robot

    robot = robot_source(chosen.robot).robot()
    q = posture(chosen.robot, robot, chosen.q)
    at_rest(drive_of(robot), q)
    meshcat = start_meshcat(chosen, f"{robot.title}, driven by A D, S W, F R")
    try:
        step = drive_robot(robot, q, meshcat, say=_say, once=chosen.once)
    except KeyboardInterrupt:
        return 0
    print(f"the robot was left at --q {as_option(robot, step.q.tolist())}")
    return 0


def _say(sentence: str) -> None:
    print(sentence, flush=True)
