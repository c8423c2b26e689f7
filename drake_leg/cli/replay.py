"""``drake-leg replay``: a recorded run as a page or a video."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from drake_leg.cli.inputs import FILE, ROBOT_NAMES, add_numbers, ground_of, robot_source
from drake_leg.cli.terminal import add_view, picture, refuse_ignored, stop_note
from drake_leg.errors import OutputError, UnreadableFileError
from drake_leg.files import read_text
from drake_leg.progress import ProgressBar
from drake_leg.robot.file_names import PAR, TOML
from drake_leg.robot.robot import Robot
from drake_leg.runs.catalogue import RUNS, STEP

if TYPE_CHECKING:
    from drake_leg.scene.motion import PlantMotion


def configure_replay(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Turn a run's recorded motion into a page that opens from disk, with a play "
        "button, a time slider and the reports' views (.html), or into a video (.mp4, .gif). "
        "Neither needs a display."
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
        metavar=f"NAME|{FILE}",
        help="the robot that moved, if the run was made with a robot or lengths of your own",
    )
    add_numbers(parser)
    parser.set_defaults(command=_replay)


def _replay(chosen: argparse.Namespace) -> int:
    from drake_leg.scene.media import check_show, write_show
    from drake_leg.scene.views import as_view

    if chosen.robot is None:
        refuse_ignored({"--set": bool(chosen.numbers)}, "means nothing without --robot")
    view = as_view(chosen.view)
    check_show(chosen.out, overwrite=chosen.overwrite)
    run = _RecordedRun.of(chosen.run)
    motion = _motion(run, chosen.robot, chosen.numbers)
    with (
        ProgressBar(sys.stderr, "replay", max(motion.duration, 1e-300), "s") as bar,
        picture(f"the replay {chosen.out}"),
    ):
        write_show(
            chosen.out,
            motion,
            title=run.title(motion.shown.title),
            note=stop_note(run.summary),
            view=view,
            overwrite=chosen.overwrite,
            progress=bar,
        )
    print(f"wrote {chosen.out}: {motion.duration:g} s of {motion.shown.title}")
    return 0


@dataclass(frozen=True, kw_only=True)
class _RecordedRun:
    """A folder that ``drake-leg run`` made."""

    folder: Path
    summary: Mapping[str, Any]  # empty if it cannot be read
    fault: str | None  # why the summary does not say which robot moved

    @classmethod
    def of(cls, folder: Path) -> Self:
        """Read the summary of a run; refuse a folder without a recording."""
        try:
            recorded = (folder / "recording.csv").is_file()
        except (OSError, ValueError):
            recorded = False
        if not recorded:
            raise OutputError(f"{folder} is not a run's folder: give one that 'drake-leg run' made")
        fault, summary = None, {}
        try:
            summary = json.loads(read_text(folder / "summary.json"))
        except json.JSONDecodeError as error:
            fault = f"is damaged in line {error.lineno}, column {error.colno}"
        except RecursionError:
            fault = "is damaged: it is no JSON"
        except UnreadableFileError as error:
            fault = f"cannot be read ({error.reason})"
        summary = summary if isinstance(summary, dict) else {}
        if isinstance(summary.get("model"), str):
            raise OutputError(
                f"{folder} is a run of the Simulink model {summary['model']!r}: run the model "
                "again with --replay FILE, or --video FILE"
            )
        if fault is None and not isinstance(summary.get("robot"), str):
            fault = "has no entry 'robot' with a name"
        return cls(folder=folder, summary=summary, fault=fault)

    @property
    def recording(self) -> Path:
        """Its file of data."""
        return self.folder / "recording.csv"

    @property
    def of_file(self) -> bool:
        """Whether the robot was read from a file; then it is not one of the reports'."""
        return str(self.summary.get("run")).lower().endswith((TOML, PAR))

    def title(self, robot: str) -> str:
        """Find the run's title; a robot from a file makes the straight step."""
        name = str(self.summary.get("run"))
        if name in RUNS:
            return RUNS[name].heading
        return f"{robot}: {STEP}" if self.of_file else robot

    def reports_robot(self) -> Robot | None:
        """Return the robot that moved if it is one of the reports'."""
        name = str(self.summary.get("robot"))
        return None if self.of_file else ROBOT_NAMES.get(name.replace("_", "-"))

    def robot(self) -> Robot:
        """Return the robot that moved, or refuse to guess."""
        if self.fault is not None:
            file = self.folder / "summary.json"
            raise OutputError(f"{file} {self.fault}: name the robot that moved with --robot")
        robot, name = self.reports_robot(), self.summary["robot"]
        if robot is None:
            raise OutputError(
                f"{self.folder} is a run of {name!r}, a robot of your own: give its file with "
                f"--robot, as in --robot {name}.toml"
            )
        return robot


def _motion(run: _RecordedRun, robot_name: str | None, given: Sequence[str] | None) -> PlantMotion:
    """Read how a robot moved, the recorded one or the one that was named."""
    from drake_leg.scene.motion import OtherRobotError, motion_of
    from drake_leg.simulation.recording import Recording

    robot = run.robot() if robot_name is None else robot_source(robot_name, given).robot()
    recording = Recording.read_csv(run.recording)
    found, rows = len(recording["time"]), run.summary.get("rows")
    if isinstance(rows, int) and rows != found:
        raise _incomplete(run, f"has {found} rows", f"{rows}")
    try:
        motion = motion_of(robot, recording, ground=ground_of(run.summary))
    except OtherRobotError as error:
        raise _other_robot(run, robot) or error from None
    end = run.summary.get("stopped_at_s")
    end = run.summary.get("duration_s") if end is None else end
    last = float(motion.time[-1])
    if rows and isinstance(end, float) and not math.isclose(last, end, rel_tol=1e-9):
        raise _incomplete(run, f"ends at {last:.9g} s", f"{end:.9g} s")
    return motion


def _incomplete(run: _RecordedRun, found: str, told: str) -> OutputError:
    return OutputError(
        f"{run.recording} {found} and summary.json says {told}: one of them is incomplete; run it "
        "again"
    )


def _other_robot(run: _RecordedRun, robot: Robot) -> OutputError | None:
    """Name the robot that moved, if the summary says that it was another one."""
    name = run.summary.get("robot")
    if run.fault is not None or name == robot.name:
        return None
    known = run.reports_robot() is not None
    remedy = "leave --robot out" if known else f"give its file, --robot {name}.toml"
    return OutputError(f"{run.folder} is a run of {name!r}, not of {robot.name!r}: {remedy}")
