"""``drake-leg report``."""

from __future__ import annotations

import argparse
import sys

from drake_leg.cli.common import BAD_INPUT, FAILED, add_output, fail, remark
from drake_leg.cli.shows import say_if_sketched
from drake_leg.files import ResultsFolder
from drake_leg.imports import require_matplotlib
from drake_leg.progress import ProgressBar


def configure_report(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Reproduce every figure, table and equation of both reports: report.html "
        "has everything on one page, with the errata where they belong; beside it are the figures "
        "as PNG, SVG and PDF, named as in the reports, and the 3D replays that the page plays."
    )
    add_output(parser)
    parser.set_defaults(command=_report)


def _report(chosen: argparse.Namespace) -> int:
    folder = ResultsFolder(chosen.out, overwrite=chosen.overwrite)
    require_matplotlib()
    from drake_leg.report.page import STAGES, write_report

    with ProgressBar(sys.stderr, "report", STAGES, "stages") as bar, folder.begun() as scratch:
        failures = write_report(scratch, bar)
    print(f"wrote {folder.path / 'report.html'} and its figures and replays")
    say_if_sketched()
    for error in failures:
        remark(error)
    if folder.remark:
        return fail(folder.remark, BAD_INPUT)
    return FAILED if failures else 0
