"""What the commands share."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping
from pathlib import Path

from drake_leg.cli.advice import as_options
from drake_leg.errors import InvalidValueError
from drake_leg.progress import BUDGET
from drake_leg.quantities import require_positive

FAILED, BAD_INPUT, STOPPED_EARLY, INTERRUPTED = 1, 2, 3, 130


def fail(error: object, status: int) -> int:
    """Print what went wrong on the standard error, and return the exit status."""
    remark(error)
    return status


def remark(sentence: object) -> None:
    """Print a sentence on the standard error, with settings as options."""
    print(f"drake-leg: {as_options(sentence)}", file=sys.stderr)


def refuse_ignored(options: Mapping[str, bool], why: str) -> None:
    """Refuse an option that would be ignored, from options and whether they were given.

    The reason ends the sentence: ``means nothing with --printed``.
    """
    for option, given in options.items():
        if given:
            raise InvalidValueError(f"{option} {why}: leave it out")


def add_output(parser: argparse.ArgumentParser) -> None:
    """Add the options of a command that makes a folder."""
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder to make")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace DIR if it holds older results"
    )


def add_budget(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the option that limits the time of something."""
    parser.add_argument(
        "--budget",
        metavar="SECONDS",
        help=f"time limit {what}; what is not done by then is listed, and the exit status is 3 "
        f"(default {BUDGET:g})",
    )


def budget_of(chosen: argparse.Namespace) -> float:
    """Read ``--budget`` [s]."""
    if chosen.budget is None:
        return BUDGET
    (seconds,) = numbers("--budget", chosen.budget, 1)
    require_positive("--budget", seconds, "s")
    return seconds


def numbers(option: str, text: str, count: int | None = None) -> list[float]:
    """Read numbers with commas between them, of which there may have to be a given count."""
    values = []
    for part in text.split(","):
        try:
            values.append(float(part))
        except ValueError:
            raise InvalidValueError(
                f"{option} is {text!r}, in which {part!r} is not a number"
            ) from None
    if not all(map(math.isfinite, values)):
        raise InvalidValueError(f"{option} is {text!r}; its numbers must be finite")
    if count is not None and len(values) != count:
        raise InvalidValueError(
            f"{option} is {text!r}; it takes {count} number{'s' * (count > 1)}, not {len(values)}"
        )
    return values
