"""``drake-leg replay``."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.cli.pictures import picture
from drake_leg.cli.robot_source import ROBOT_NAMES, robot_source
from drake_leg.cli.shows import stop_note
from drake_leg.cli.view import add_view
from drake_leg.errors import DrakeLegError, OutputError, UnreadableFileError
from drake_leg.files import read_text
from drake_leg.progress import ProgressBar
from drake_leg.robot import Robot
from drake_leg.runs.catalogue import RUNS, STEP

if TYPE_CHECKING:
    from drake_leg.recording import Recording
    from drake_leg.scene.motion import Motion, OtherRobotError


def configure_replay(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Make a run's recorded motion a page that opens from disk, with a play "
        "button, a time slider and the reports' views (.html), or a video (.mp4, .gif), which "
        "needs no display."
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
    from drake_leg.scene.files import check_show, write_show
    from drake_leg.scene.views import view_named

    view = view_named(chosen.view)
    check_show(chosen.out, overwrite=chosen.overwrite)
    _require_run(chosen.run)
    summary = _summary(chosen.run)
    motion = _motion(chosen, summary)
    with (
        ProgressBar(sys.stderr, "replay", max(motion.duration, 1e-300), "s") as bar,
        picture(f"the replay {chosen.out}"),
    ):
        write_show(
            chosen.out,
            motion,
            title=_title(summary, motion.robot),
            note=stop_note(summary),
            view=view,
            overwrite=chosen.overwrite,
            progress=bar,
        )
    print(f"wrote {chosen.out}: {motion.duration:g} s of {motion.robot.title}")
    return 0


def _require_run(folder: Path) -> None:
    """Refuse what is no folder with a recording."""
    try:
        recorded = (folder / "recording.csv").is_file()
    except (OSError, ValueError):
        recorded = False
    if not recorded:
        raise OutputError(f"{folder} is no folder of a run: give one that 'drake-leg run' has made")


def _motion(chosen: argparse.Namespace, summary: Mapping[str, Any]) -> Motion:
    """Read what moved, and how."""
    from drake_leg.recording import read_csv
    from drake_leg.scene.motion import OtherRobotError, recorded_motion

    robot = (
        _recorded_robot(chosen.run) if chosen.robot is None else robot_source(chosen.robot).robot()
    )
    recording = read_csv(chosen.run / "recording.csv")
    _require_all_rows(chosen.run, recording, summary)
    try:
        motion = recorded_motion(robot, recording)
    except OtherRobotError as error:
        raise _clearer(error, chosen.run, robot) from None
    _require_end(chosen.run, motion, summary)
    return motion


def _require_all_rows(folder: Path, recording: Recording, summary: Mapping[str, Any]) -> None:
    """Refuse a recording that has other rows than its summary tells of."""
    found, rows = len(recording["time"]), summary.get("rows")
    if isinstance(rows, int) and rows != found:
        raise OutputError(
            f"{folder / 'recording.csv'} has {found} rows and summary.json tells of {rows}: "
            "one of them is not whole; carry out the run again"
        )


def _require_end(folder: Path, motion: Motion, summary: Mapping[str, Any]) -> None:
    """Refuse a recording that has another end than its summary tells of."""
    end = summary.get("stopped_at_s", summary.get("duration_s"))
    end = summary.get("duration_s") if end is None else end
    last = float(motion.time[-1])
    if summary.get("rows") and isinstance(end, float) and not math.isclose(last, end, rel_tol=1e-9):
        raise OutputError(
            f"{folder / 'recording.csv'} ends at {last:.9g} s and summary.json tells of "
            f"{end:.9g} s: one of them is not whole; carry out the run again"
        )


def _clearer(error: OtherRobotError, folder: Path, robot: Robot) -> DrakeLegError:
    """Name the robot that moved, where the summary tells that it was another one."""
    try:
        name = _recorded_name(folder)
    except OutputError:
        return error
    if name == robot.name:
        return error
    remedy = (
        "leave --robot out" if _known(name, folder) else f"give its TOML file, --robot {name}.toml"
    )
    return OutputError(f"{folder} is a run of {name!r}, not of {robot.name!r}: {remedy}")


def _recorded_robot(folder: Path) -> Robot:
    """Find the robot of the reports that moved."""
    name = _recorded_name(folder)
    robot = _known(name, folder)
    if robot is None:
        raise OutputError(
            f"{folder} is a run of {name!r}, a robot of your own: give its TOML file with --robot, "
            f"as in --robot {name}.toml"
        )
    return robot


def _known(name: str, folder: Path) -> Robot | None:
    """Return a robot of the reports; one from a file is none of them, whatever its name."""
    if str(_summary(folder).get("run")).lower().endswith(".toml"):
        return None
    return ROBOT_NAMES.get(name.replace("_", "-"))


def _recorded_name(folder: Path) -> str:
    """Read off a run's summary which robot moved."""
    file = folder / "summary.json"
    try:
        summary = json.loads(read_text(file))
    except json.JSONDecodeError as error:
        raise _untold(f"{file} is damaged in line {error.lineno}, column {error.colno}") from None
    except RecursionError:
        raise _untold(f"{file} is damaged: it is no JSON") from None
    except UnreadableFileError as error:
        raise _untold(f"{file} cannot be read ({error.reason})") from None
    name = summary.get("robot") if isinstance(summary, dict) else None
    if not isinstance(name, str):
        raise _untold(f"{file} has no entry 'robot' with a name")
    return name


def _untold(why: str) -> OutputError:
    return OutputError(f"{why}: tell which robot moved with --robot")


def _summary(folder: Path) -> Mapping[str, Any]:
    """Read what the run's summary tells, or nothing."""
    try:
        summary = json.loads(read_text(folder / "summary.json"))
    except (ValueError, RecursionError):  # an UnreadableFileError, too
        return {}
    return summary if isinstance(summary, dict) else {}


def _title(summary: Mapping[str, Any], robot: Robot) -> str:
    """Find what the run is called: a robot from a file makes the straight step."""
    name = str(summary.get("run"))
    if name in RUNS:
        return RUNS[name].heading
    return f"{robot.title}: {STEP}" if name.lower().endswith(".toml") else robot.title
