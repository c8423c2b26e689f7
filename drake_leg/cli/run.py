"""``drake-leg run``: one run carried out, written and drawn."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from drake_leg.cli.run_options import add_run_options, kind_of, options_of
from drake_leg.cli.showing import Shows, add_shows, remark_if_sketched
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    STOPPED_EARLY,
    Pictures,
    add_output,
    at_work,
    fail,
    remark,
)
from drake_leg.errors import require_matplotlib
from drake_leg.files import ResultsFolder
from drake_leg.progress import ProgressBar, saved
from drake_leg.runs.catalogue import RUNS, RunKind
from drake_leg.runs.options import RunOptions

if TYPE_CHECKING:
    from drake_leg.runs.outcome import Outcome


def configure_run(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Carry out one run and write recording.csv (its rows are the integrator's "
        "own steps, at most 40 ms apart), summary.json and figures (PNG, SVG and PDF) into DIR."
    )
    parser.epilog = (
        "Lists are written with commas: --q0 -90,50,90. An option that a run does not "
        "have is refused."
    )
    parser.add_argument(
        "name",
        metavar="NAME",
        help=f"one of {', '.join(RUNS)}, or a TOML file of a robot of your own, "
        "whose foot makes the straight step",
    )
    add_output(parser)
    add_shows(parser)
    add_run_options(parser)
    parser.set_defaults(command=_run)


def _run(chosen: argparse.Namespace) -> int:
    kind = kind_of(chosen.name)
    options = options_of(kind, chosen)
    folder = ResultsFolder(chosen.out, overwrite=chosen.overwrite)
    shows = Shows.of(chosen)
    shows.check()
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
            _draw(chosen.name, kind, outcome, folder, pictures)
            made = shows.write(kind.heading, outcome, folder, pictures)
    except KeyboardInterrupt:
        return fail(f"interrupted; the data in {folder.path} are whole", INTERRUPTED)
    for path in made:
        print(f"wrote {path}")
    pictures.print_failures()
    if shows.stills:
        remark_if_sketched()
    warnings = map(summary.get, ("grazing", "ill_conditioned", "inaccuracy"))
    remarks = [*summary.get("limits_exceeded", ()), *warnings]
    for sentence in filter(None, remarks):
        remark(sentence)
    return _status(summary, folder, pictures)


def _carried_out(
    name: str, kind: RunKind, options: RunOptions, hold: Callable[[], None]
) -> Outcome:
    """Simulate; from the end on, signals wait until the recording is saved."""
    with ProgressBar(sys.stderr, name, max(options.duration, 1e-300), "s") as bar:

        def progress(time: float) -> None:
            if time >= options.duration:
                hold()
            bar(time)

        return kind.run(options, progress)


def _draw(
    name: str, kind: RunKind, outcome: Outcome, folder: ResultsFolder, pictures: Pictures
) -> None:
    """Add the figures to the data, one by one."""
    with pictures.trying(f"a figure of {name}"):
        from drake_leg.runs.outcome import figure_files

        for file_name, write in figure_files(kind.title, outcome):
            with pictures.trying(f"the figure {file_name}"), folder.more() as scratch:
                write(scratch)


def _status(summary: Mapping[str, Any], folder: ResultsFolder, pictures: Pictures) -> int:
    """Print what went wrong, and choose the exit status."""
    status = FAILED if summary.get("inaccuracy") else 0
    if pictures.failures:
        status = fail(f"the data in {folder.path} are whole", FAILED)
    if folder.remark:
        status = fail(folder.remark, BAD_INPUT)
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
    if "max_position_error_m" in summary:
        lag = summary.get("filter_time_constant_s")
        filters = "" if lag is None else f", by input filters of {lag:g} s"
        return f", foot within {summary['max_position_error_m']:.1e} m of the exact path{filters}"
    within, of = ("up to", "from") if summary["inaccuracy"] else ("within", "of")
    return f", angle {within} {summary['max_angle_error_rad']:.1e} rad {of} the exact motion"


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
