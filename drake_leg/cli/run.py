"""``drake-leg run``: one run carried out, written and drawn."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.cli.inputs import add_numbers, ground_of, named_or_robot
from drake_leg.cli.model_files import (
    add_feature_option,
    add_model_options,
    add_model_run_options,
    is_model,
    refuse_model_options,
    refuse_model_run_options,
)
from drake_leg.cli.model_page import add_page_option
from drake_leg.cli.run_options import add_run_options, explain_run, options_from, overridden
from drake_leg.cli.shows import add_shows, check_shows, shows_of
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    STOPPED_EARLY,
    Pictures,
    add_output,
    at_work,
    fail,
    place_given_by,
    refuse_ignored,
    remark,
    remark_if_sketched,
    stop_note,
)
from drake_leg.errors import InvalidValueError, require_matplotlib
from drake_leg.files import ResultsFolder
from drake_leg.pictures.formats import CHOICES, CHOSEN, formats_of
from drake_leg.progress import ProgressBar, saved
from drake_leg.runs.catalogue import RUNS, RunKind, run_kind
from drake_leg.runs.options import RunOptions

if TYPE_CHECKING:
    from drake_leg.runs.outcome import Outcome
    from drake_leg.scene.motion import PlantMotion

STRAIGHT = 0.01  # [deg]; a walk that was to turn by less goes straight


def configure_run(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Carry out one run and write recording.csv (its rows are the integrator's "
        "own steps, at most 40 ms apart), summary.json and figures into DIR. A Simulink model "
        "runs for as long as its file says, and what its scopes show is recorded, at 501 times "
        "that divide the run evenly."
    )
    parser.epilog = (
        "Lists are written with commas: --q0 -90,50,90. An option that a run does not "
        "have is refused: drake-leg run NAME --help explains those that it has."
    )
    parser.add_argument(
        "name",
        metavar="NAME",
        help=f"one of {', '.join(RUNS)}; a TOML or .par file of a robot of your own, "
        "whose foot makes the straight step; or a Simulink model (.slx, .mdl)",
    )
    add_numbers(parser)
    add_output(parser)
    parser.add_argument(
        "--figures",
        metavar="FORMAT",
        help=f"format of the figures: {', '.join(CHOICES)} (default {CHOSEN})",
    )
    add_shows(parser)
    add_page_option(parser)
    add_model_options(parser)
    add_feature_option(parser)
    add_model_run_options(parser)
    explain = partial(explain_run, options=add_run_options(parser))
    parser.set_defaults(command=_run, explain=explain)


def _run(chosen: argparse.Namespace) -> int:
    if is_model(chosen.name):
        from drake_leg.cli.model_run import run_model_file

        return run_model_file(chosen)
    refuse_model_options(chosen)
    refuse_model_run_options(chosen)
    refuse_ignored(
        {"--page": chosen.page is not None}, "is for Simulink models and means nothing here"
    )
    kind = run_kind(named_or_robot(chosen.name, chosen.numbers))
    _refuse_walker(chosen, kind)
    options, formats = _options_and_formats(kind, chosen)
    folder = ResultsFolder(chosen.out, overwrite=chosen.overwrite)
    check_shows(chosen)
    if formats:
        require_matplotlib()
    with saved() as hold:
        outcome = _carried_out(chosen.name, kind, options, hold)
        with folder.begun() as scratch:
            outcome.write(scratch, chosen.name)
        summary = outcome.summary
        rows = f"{summary['rows']} rows, {summary['real_time_factor']:.0f} x real time"
        print(f"wrote {folder.path}: {rows}{_quality(summary)}")
    pictures = Pictures()
    try:
        with at_work(chosen.name, "pictures"):
            if formats:
                _draw(chosen.name, kind, outcome, formats, folder, pictures)
            made = _write_shows(chosen, kind.heading, outcome, folder, pictures)
    except KeyboardInterrupt:
        return fail(f"interrupted; the data in {folder.path} are whole", INTERRUPTED)
    for path in made:
        print(f"wrote {path}")
    pictures.print_failures()
    if chosen.stills:
        remark_if_sketched()
    warnings = map(summary.get, ("grazing", "ill_conditioned", "inaccuracy"))
    remarks = [*summary.get("limits_exceeded", ()), *warnings]
    for sentence in filter(None, remarks):
        remark(sentence)
    return _status(summary, folder, pictures)


def _refuse_walker(chosen: argparse.Namespace, kind: RunKind) -> None:
    """Refuse a robot with legs and no ``--tip``, which walks by the name of another run."""
    robot = kind.own
    if robot is not None and robot.floating and len(robot.tips) > 1 and not hasattr(chosen, "tip"):
        raise InvalidValueError(
            f"{chosen.name} is a robot with {len(robot.tips)} legs, and this run moves one foot",
            advice=f"let it walk by drake-leg run hexapod --robot {chosen.name}, or choose a foot "
            "by `tip`",
        )


def _carried_out(
    name: str, kind: RunKind, options: RunOptions, hold: Callable[[], None]
) -> Outcome:
    """Simulate; from the end on, signals wait until the recording is saved."""
    duration = options.the_duration
    with ProgressBar(sys.stderr, name, max(duration, 1e-300), "s") as bar:

        def progress(time: float) -> None:
            if time >= duration:
                hold()
            bar(time)

        return kind.run(options, progress)


def _draw(
    name: str,
    kind: RunKind,
    outcome: Outcome,
    formats: Sequence[str],
    folder: ResultsFolder,
    pictures: Pictures,
) -> None:
    """Add the figures to the data, one by one."""
    with pictures.trying(f"a figure of {name}"):
        from drake_leg.runs.figures import figure_files

        for file_name, write in figure_files(kind.title, outcome, formats):
            with pictures.trying(f"the figure {file_name}"), folder.more() as scratch:
                write(scratch)


def _status(summary: Mapping[str, Any], folder: ResultsFolder, pictures: Pictures) -> int:
    """Print what went wrong, and choose the exit status."""
    status = FAILED if summary.get("inaccuracy") else 0
    if pictures.failures:
        status = fail(f"the data in {folder.path} are whole", FAILED)
    if folder.remark:
        status = fail(folder.remark, BAD_INPUT)
    if summary.get("fell"):
        status = fail(f"the robot fell at {summary['fell_at_s']:.3g} s", STOPPED_EARLY)
    if summary["stop_reason"] is None:
        return status
    interrupted = summary["stop_reason"] == "interrupted"
    return fail(
        f"stopped at {summary['stopped_at_s']:.9g} s of {summary['duration_s']:g} s: "
        f"{summary['stop_reason']}",
        INTERRUPTED if interrupted else STOPPED_EARLY,
    )


def _quality(summary: Mapping[str, Any]) -> str:
    disturbed = summary.get("disturbance")
    if disturbed:
        return _cost(summary, disturbed)
    if summary.get("time_off_command_s") and "filter_time_constant_s" not in summary:
        farthest = summary["greatest_distance_from_command_m"]
        return (
            f", foot up to {farthest:.3g} m from its command, farther than "
            f"{1e3 * summary['off_command_m']:g} mm for "
            f"{summary['time_off_command_s']:.3g} s"
        )
    if "commanded_distance_m" in summary:
        return _way(summary)
    if "max_closure_m" in summary:
        return f", loops closed to {summary['max_closure_m']:.1e} m"
    if "max_position_error_m" in summary:
        lag = summary.get("filter_time_constant_s")
        filters = "" if lag is None else f", by input filters of {lag:g} s"
        return f", foot within {summary['max_position_error_m']:.1e} m of the exact path{filters}"
    within, of = ("up to", "from") if summary["inaccuracy"] else ("within", "of")
    return f", angle {within} {summary['max_angle_error_rad']:.1e} rad {of} the exact motion"


def _way(summary: Mapping[str, Any]) -> str:
    """Describe how far a robot walked and turned, and its heading."""
    said = []
    if summary["distance_error_percent"] is not None:
        said.append(
            f"{summary['distance_m']:.4g} m of {summary['commanded_distance_m']:.4g} m walked"
        )
    if abs(summary["commanded_turn_deg"]) > STRAIGHT:
        said.append(
            f"turned by {summary['turn_deg']:.4g} of {summary['commanded_turn_deg']:.4g} deg"
        )
    heading = f"heading off by {summary['heading_error_deg']:.2g} deg"
    return f", {', '.join([*(said or ['stood']), heading])}"


def _cost(summary: Mapping[str, Any], disturbed: Mapping[str, Any]) -> str:
    """Describe how far a disturbance took the foot, for how long, and with what torques."""
    said = (
        f", foot up to {summary['greatest_distance_from_command_m']:.3g} m from its command, "
        f"farther than {disturbed['band_m']:g} m for {disturbed['time_off_band_s']:.3g} s, "
        f"{summary['distance_from_command_at_the_end_m']:.2g} m off at the end, torques up to "
        f"{disturbed['greatest_torque_given']:.3g} N*m"
    )
    if disturbed["time_at_torque_limit_s"]:
        said += f", at their limit for {disturbed['time_at_torque_limit_s']:.3g} s"
    return said


def _options_and_formats(
    kind: RunKind, chosen: argparse.Namespace
) -> tuple[RunOptions, tuple[str, ...]]:
    """Combine the options, and find the formats of the figures in the same way."""
    options, others = options_from(kind, chosen, {"figures": formats_of})
    formats = others.get("figures", CHOICES[CHOSEN])
    if chosen.figures is not None:
        formats = formats_of(chosen.figures)
    return overridden(kind, options, chosen), formats


def _write_shows(
    chosen: argparse.Namespace,
    title: str,
    outcome: Outcome,
    folder: ResultsFolder,
    pictures: Pictures,
) -> list[Path]:
    """Write stills into the folder of results, page and video beside it; return these two."""
    made = []

    @cache
    def motion() -> PlantMotion:
        from drake_leg.scene.motion import motion_of

        ground = ground_of(outcome.summary)
        return motion_of(outcome.robot, outcome.recording, ground=ground)

    if chosen.stills:
        from drake_leg.scene.views import VIEWS

        for view in VIEWS:
            with pictures.trying(f"the still {view}"), folder.more() as scratch:
                from drake_leg.scene.media import still, walking_still

                shown, start = motion().shown, motion().q[0]
                if motion().footing is None:
                    png = still(shown, start, view=view, motion=motion()).png
                else:
                    png = walking_still(motion(), motion().time[-1] / 2.0, view=view).png
                (scratch / f"still_{view}.png").write_bytes(png)
    for option, path in shows_of(chosen).items():
        with pictures.trying(f"the {option} {path}"), place_given_by(f"--{option}"):
            from drake_leg.scene.media import write_show

            note = stop_note(outcome.summary)
            write_show(path, motion(), title=title, note=note, overwrite=chosen.overwrite)
            made.append(path)
    return made
