"""``drake-leg replay``."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from drake_leg.cli.common import Commands
from drake_leg.cli.robot_source import robot_source
from drake_leg.cli.view import add_view
from drake_leg.errors import OutputError
from drake_leg.progress import ProgressBar
from drake_leg.robot import Robot


def add(commands: Commands) -> None:
    """Add the command.

    Parameters
    ----------
    commands : argparse subparsers
        Of the program.
    """
    parser = commands.add_parser(
        "replay",
        help="show a run again, as a page or as video",
        description="Make a run's recorded motion a page that opens from disk, with a play "
        "button, a time slider and the reports' views (.html), or a video (.mp4, .gif), which "
        "needs no display.",
    )
    parser.add_argument("run", type=Path, metavar="DIR", help="folder that 'drake-leg run' made")
    parser.add_argument(
        "--out",
        required=True,
        type=Path,
        metavar="FILE",
        help="file to make, .html, .mp4 or .gif",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it exists")
    add_view(parser, "of a video, or first one of a page")
    parser.add_argument(
        "--robot",
        metavar="NAME|FILE.toml",
        help="what moved, where the run was made with a robot or lengths of your own",
    )
    parser.set_defaults(command=_replay)


def _replay(chosen: argparse.Namespace) -> int:
    from drake_leg.recording import read_csv
    from drake_leg.scene.files import check_show, write_show
    from drake_leg.scene.motion import recorded_motion
    from drake_leg.scene.views import view_named

    view = view_named(chosen.view)
    check_show(chosen.out, overwrite=chosen.overwrite)
    _require_run(chosen.run)
    robot = _robot(chosen)
    motion = recorded_motion(robot, read_csv(chosen.run / "recording.csv"))
    bar = ProgressBar(sys.stderr, "replay", max(motion.duration, 1e-300), "s")
    try:
        write_show(chosen.out, motion, view=view, overwrite=chosen.overwrite, progress=bar)
    finally:
        bar.close()
    print(f"wrote {chosen.out}: {motion.duration:g} s of {robot.title}")
    return 0


def _require_run(folder: Path) -> None:
    """Refuse what is no folder with a recording."""
    try:
        recorded = (folder / "recording.csv").is_file()
    except (OSError, ValueError):
        recorded = False
    if not recorded:
        raise OutputError(f"{folder} is no folder of a run: give one that 'drake-leg run' has made")


def _robot(chosen: argparse.Namespace) -> Robot:
    """Find what moved: as told, or as the run's summary names it."""
    if chosen.robot:
        return robot_source(chosen.robot).robot()
    file = chosen.run / "summary.json"
    try:
        name = json.loads(file.read_text(encoding="utf-8"))["robot"]
        return robot_source(str(name).replace("_", "-")).robot()
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(
            f"{file} does not tell which robot moved ({error}): name it with --robot"
        ) from None
