"""``drake-leg sweep``: many runs carried out, tabulated and plotted."""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import counted
from drake_leg.cli.inputs import add_numbers, named_or_robot, settings_of
from drake_leg.cli.run_options import add_run_options, options_of
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    Pictures,
    add_output,
    at_work,
    fail,
    numbers,
    remark,
)
from drake_leg.errors import (
    InvalidValueError,
    did_you_mean,
    in_a_line,
    require_distributed,
)
from drake_leg.progress import ProgressBar
from drake_leg.runs.catalogue import RUNS, RunKind, run_kind
from drake_leg.runs.options import RunOptions

if TYPE_CHECKING:
    from drake_leg.studies.sweep import SweepResult

UNFINISHED = ("failed", "lost")  # runs that came to nothing, and should have
REFUSED = "refused"  # because its options make no sense


def configure_sweep(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Carry out many runs: every point of a grid, or samples. DIR holds runs.parquet with a row "
        "for each run, stopped and failed ones, too; plots as SVG and PNG; and index.html, which "
        "shows them. If a sweep is interrupted, the same command goes on with it."
    )
    parser.epilog = (
        "--vary femur=0.06:0.14:9 takes nine lengths from 0.06 to 0.14 m; coxa, femur and tibia "
        "are a leg's links. --vary inverse=exact,damped takes two choices, --vary 'q0[1]=-60:-40:5'"
        " a component of a list (the first one is 0). Where --fields asks for no "
        "others than stroke_m, sigma_min_m, det_j_min_m3, det_j_max_m3, max_rate_rad_s and "
        "max_static_torque_n_m of a leg's undisturbed step, they are computed in closed form, and "
        "nothing is simulated."
    )
    parser.add_argument(
        "name",
        metavar="NAME",
        help=f"one of {', '.join(RUNS)}, or a TOML or .par file of a robot of your own",
    )
    add_numbers(parser)
    parser.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="OPTION=VALUES",
        help="an option, or a letter of a .par file, and its range low:high:count, or its choices "
        "with commas; may be repeated, the last one varies fastest",
    )
    parser.add_argument(
        "--sample", metavar="N", help="take N samples of ranges low:high (default: the whole grid)"
    )
    parser.add_argument(
        "--sampler", metavar="TEXT", help="of the samples: sobol or random (default sobol)"
    )
    parser.add_argument("--seed", metavar="S", help="of the samples (default 0)")
    parser.add_argument(
        "--fields", metavar="A,B", help="entries of the summary to keep (default: all)"
    )
    parser.add_argument(
        "--simulated", action="store_true", help="simulate even what has a closed form"
    )
    add_output(parser)
    parser.add_argument("--workers", metavar="N", help="processes (default: all cores)")
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask cluster, as tcp://10.0.0.1:8786"
    )
    parser.add_argument(
        "--plot",
        action="append",
        default=[],
        metavar="FIELD",
        help="field to plot over what is varied; may be repeated (default: those that vary)",
    )
    parser.add_argument(
        "--over", metavar="A,B", help="one or two varied options to plot over (default: the first)"
    )
    parser.add_argument(
        "--pareto",
        action="append",
        default=[],
        metavar="max:A,min:B",
        help="plot the Pareto front of two fields, each the greatest or the least; may be repeated",
    )
    add_run_options(parser)
    parser.set_defaults(command=_sweep)


def _sweep(chosen: argparse.Namespace) -> int:
    vary = _vary(chosen.vary)
    kind, settings = _kind(chosen, vary)
    over = chosen.over.split(",") if chosen.over else None
    fronts = [_pair(text) for text in chosen.pareto]
    _require_plots(chosen, list(vary), over, fronts)
    try:
        result = _carried_out(chosen, kind, vary, settings)
    except KeyboardInterrupt:
        again = ", without --overwrite," if chosen.overwrite else ""
        return fail(
            f"interrupted; what was done is in {chosen.out}: the same command{again} goes on",
            INTERRUPTED,
        )
    counts = ", ".join(f"{count} {status}" for status, count in result.counts.items())
    print(f"wrote {chosen.out}: {counted(len(result), 'run')} ({counts})")
    pictures = Pictures()
    with at_work(chosen.name, "pictures"), pictures.trying("the page"):
        result.write_pictures(chosen.plot, over=over, fronts=fronts)
    pictures.print_failures()
    if result.folder is not None and result.folder.remark:
        remark(result.folder.remark)
    for field in result.unknown_fields:
        remark(f"no summary of {chosen.name} has a field {field}: see the summary.json of a run")
    lacking = sum(result.counts.get(status, 0) for status in UNFINISHED)
    if lacking:
        return fail(f"{lacking} runs failed; their rows say why", FAILED)
    if set(result.counts) == {REFUSED}:
        return fail(
            f"all runs were refused, the first one because {result['message'][0]}", BAD_INPUT
        )
    return FAILED if pictures.failures or result.unknown_fields else 0


def _kind(
    chosen: argparse.Namespace, vary: dict[str, str]
) -> tuple[RunKind, dict[str, str] | None]:
    """Return what is run, and the numbers of a file of which letters vary."""
    from drake_leg.studies.lettered import lettered_file
    from drake_leg.studies.sweep import first_numbers

    settings = settings_of(chosen.name, chosen.numbers)
    file = lettered_file(chosen.name, settings, vary)
    if file is None:
        return run_kind(named_or_robot(chosen.name, chosen.numbers)), None
    loaded = file.loaded(first_numbers(file, vary))
    for note in loaded.notes:
        remark(note)
    return run_kind(loaded.robot), settings


def _carried_out(
    chosen: argparse.Namespace,
    kind: RunKind,
    vary: dict[str, str],
    settings: dict[str, str] | None,
) -> SweepResult:
    from drake_leg.studies.sweep import sweep

    sample = _whole("--sample", chosen.sample)
    with (
        _executor(chosen.scheduler) as executor,
        ProgressBar(sys.stderr, chosen.name, 1.0, "runs") as bar,
    ):
        return sweep(
            chosen.name if settings is not None else kind.own or chosen.name,
            vary=vary,
            numbers=settings,
            sample=sample,
            sampler=chosen.sampler,
            seed=_whole("--seed", chosen.seed),
            fields=chosen.fields.split(",") if chosen.fields else None,
            simulated=chosen.simulated,
            out=chosen.out,
            overwrite=chosen.overwrite,
            executor=executor,
            workers=_whole("--workers", chosen.workers),
            progress=bar.count,
            **_given(kind, chosen),
        )


def _vary(texts: list[str]) -> dict[str, str]:
    """Read ``name=values`` of each ``--vary``."""
    vary: dict[str, str] = {}
    for text in texts:
        name, equals, values = text.partition("=")
        if not equals or not name or not values:
            raise InvalidValueError(
                f"--vary is {text!r}", advice="write it as --vary femur=0.06:0.14:9"
            )
        if name in vary:
            raise InvalidValueError(f"--vary {name} is given twice: leave one of the two out")
        vary[name] = values
    return vary


def _pair(text: str) -> tuple[str, str]:
    first, comma, second = text.partition(",")
    if not comma or "," in second:
        raise InvalidValueError(
            f"--pareto is {text!r}; it takes two fields", advice="write it as max:A,min:B"
        )
    return first, second


def _require_plots(
    chosen: argparse.Namespace,
    varied: list[str],
    over: list[str] | None,
    fronts: list[tuple[str, str]],
) -> None:
    """Refuse plots that could not be drawn of what the sweep keeps."""
    from drake_leg.studies.pictures import require_varied, wish
    from drake_leg.studies.row import HEADING, wanted

    if over is not None:
        require_varied(over, varied)
    fields = [*chosen.plot, *(wish(text)[1] for front in fronts for text in front)]
    if chosen.fields is None:
        return
    kept = chosen.fields.split(",")
    for field in fields:
        if not wanted(field, [*kept, *varied, *HEADING]):
            raise InvalidValueError(
                f"{field} is to be plotted and is not among --fields {chosen.fields}",
                advice=did_you_mean(field, kept, "add it there"),
            )


def _whole(option: str, text: str | None) -> int | None:
    if text is None:
        return None
    (value,) = numbers(option, text, 1)
    if value != int(value):
        raise InvalidValueError(f"{option} is {text!r}; it must be a whole number")
    return int(value)


def _given(kind: RunKind, chosen: argparse.Namespace) -> dict[str, Any]:
    """Options that differ from the run's own defaults."""
    options: RunOptions = options_of(kind, chosen)
    defaults = kind.options()
    names = [field.name for field in dataclasses.fields(options)]
    return {
        name: getattr(options, name)
        for name in names
        if getattr(options, name) != getattr(defaults, name)
    }


@contextmanager
def _executor(address: str | None) -> Iterator[Executor | None]:
    """Connect to a Dask cluster, if there is to be one."""
    if address is None:
        yield None
        return
    require_distributed()
    distributed: Any = import_module("distributed")  # which has few types

    try:
        client = distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise InvalidValueError(
            f"no Dask scheduler answers at {address} ({in_a_line(error)})",
            advice="start one with dask scheduler, and give the address that it prints",
        ) from None
    with client:
        yield client.get_executor(pure=False)
