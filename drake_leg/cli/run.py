"""``drake-leg run``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from typing import Any

from drake_leg.cli.common import INTERRUPTED, STOPPED_EARLY, Commands, add_output, fail, remark
from drake_leg.cli.run_options import add_run_options, kind_of, options_of
from drake_leg.cli.shows import Shows, add_shows, say_if_sketched
from drake_leg.imports import require_pillow
from drake_leg.output import check_target, results_folder
from drake_leg.progress import ProgressBar
from drake_leg.runs.catalogue import RUNS


def add(commands: Commands) -> None:
    """Add the command.

    Parameters
    ----------
    commands : argparse subparsers
        Of the program.
    """
    parser = commands.add_parser(
        "run",
        help="carry out one run",
        description="Carry out one run and write recording.csv (its rows are the integrator's "
        "own steps, at most 40 ms apart), summary.json and figures (PNG, SVG and PDF) into DIR.",
        epilog="Lists are written with commas: --q0 -90,50,90. An option that a run does not "
        "have is refused.",
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
    check_target(chosen.out, overwrite=chosen.overwrite)
    shows = Shows.of(chosen)
    shows.check()
    require_pillow()
    bar = ProgressBar(sys.stderr, chosen.name, max(options.duration, 1e-300), "s")
    try:
        outcome = kind.run(options, bar)
    finally:
        bar.close()
    from drake_leg.runs.files import write_outcome

    with results_folder(chosen.out) as folder:
        write_outcome(folder, chosen.name, kind.title, outcome)
        shows.write_into(folder, outcome)
    summary = outcome.summary
    rows = f"{summary['rows']} rows, {summary['real_time_factor']:.0f} x real time"
    print(f"wrote {chosen.out}: {rows}{_quality(summary)}")
    for path in shows.write(kind.heading, outcome):
        print(f"wrote {path}")
    remarks = [*summary.get("limits_exceeded", ()), summary.get("grazing")]
    for sentence in filter(None, remarks):
        remark(sentence)
    if shows.stills:
        say_if_sketched()
    if summary["stop_reason"] is None:
        return 0
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
            f", foot up to {farthest:.3g} m from its command and off it for "
            f"{summary['time_off_command_s']:.3g} s"
        )
    if "max_position_error_m" in summary:
        lag = summary.get("filter_time_constant_s")
        filters = "" if lag is None else f", by input filters of {lag:g} s"
        return f", foot within {summary['max_position_error_m']:.1e} m of the exact path{filters}"
    return f", angle within {summary['max_angle_error_rad']:.1e} rad of the exact motion"


def _cost(summary: Mapping[str, Any], disturbed: Mapping[str, Any]) -> str:
    """Say how far a disturbance took the foot, for how long, and with what torques."""
    said = (
        f", foot up to {summary['greatest_distance_from_command_m']:.3g} m from its command, "
        f"farther than {disturbed['band_m']:g} m for {disturbed['time_off_band_s']:.3g} s, "
        f"{summary['distance_from_command_at_the_end_m']:.2g} m off at the end, torques up to "
        f"{disturbed['greatest_torque_given']:.3g} N*m"
    )
    if disturbed["time_at_torque_limit_s"]:
        said += f", at their limit for {disturbed['time_at_torque_limit_s']:.3g} s"
    return said
