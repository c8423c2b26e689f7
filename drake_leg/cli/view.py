"""``drake-leg view``."""

from __future__ import annotations

import argparse
from pathlib import Path

from drake_leg.cli.advice import place_given_by
from drake_leg.cli.common import refuse_ignored
from drake_leg.cli.pictures import picture
from drake_leg.cli.posture import add_posture, as_option, posture
from drake_leg.cli.robot_source import add_robot_source, robot_source
from drake_leg.cli.server import LEAVING, add_server, server_options, start_server
from drake_leg.cli.shows import say_if_sketched
from drake_leg.imports import require_pillow


def configure_view(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Open a robot in the browser, in Meshcat: the frames of its table (x red, y "
        "green, z blue), a slider and a box for every joint, the trace of its tip, and the "
        "reports' views. Or write one picture, without a browser, with --still."
    )
    parser.epilog = LEAVING
    add_robot_source(parser)
    add_posture(parser)
    add_server(parser)
    parser.add_argument(
        "--still", type=Path, metavar="FILE.png", help="write one picture instead, and end"
    )
    add_view(parser, "of the picture, or first one in the browser")
    parser.add_argument("--overwrite", action="store_true", help="replace FILE.png if it exists")
    parser.set_defaults(command=_view)


def add_view(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the option that names a view."""
    parser.add_argument(
        "--from",
        dest="view",
        default="3d",
        metavar="VIEW",
        help=f"view {what}: 3d, right, front or top (default 3d)",
    )


def _view(chosen: argparse.Namespace) -> int:
    if chosen.still is not None:
        refuse_ignored(server_options(chosen), "means nothing with --still, which opens no page")
        return _still(chosen)
    refuse_ignored({"--overwrite": chosen.overwrite}, "means nothing without --still")
    robot = robot_source(chosen.robot).robot()
    q = posture(chosen.robot, robot, chosen.q)
    from drake_leg.scene.scene import as_view
    from drake_leg.scene.viewer import view_served

    view = as_view(chosen.view)
    try:
        with start_server(chosen, robot.title) as server:
            left_at = view_served(robot, q, server, view=view, once=chosen.once)
    except KeyboardInterrupt:
        return 0
    print(f"the sliders were left at --q {as_option(robot, left_at.tolist())}")
    return 0


def _still(chosen: argparse.Namespace) -> int:
    from drake_leg.files import whole_file
    from drake_leg.scene.images import still
    from drake_leg.scene.scene import as_view

    robot = robot_source(chosen.robot).robot()
    q = posture(chosen.robot, robot, chosen.q)
    view = as_view(chosen.view)
    require_pillow()
    with (
        picture(f"the still {chosen.still}"),
        place_given_by("--still"),
        whole_file(chosen.still, endings=(".png",), overwrite=chosen.overwrite) as scratch,
    ):
        scratch.write_bytes(still(robot, q, view=view).png)
    print(f"wrote {chosen.still}")
    say_if_sketched()
    return 0
