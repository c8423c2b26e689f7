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
    """Say on the standard error what went wrong.

    Parameters
    ----------
    error : object
        Its text is one sentence.
    """
    remark(error)
    return status


def remark(sentence: object) -> None:
    """Say something on the standard error.

    Parameters
    ----------
    sentence : object
        Its text is one sentence.
    """
    print(f"drake-leg: {as_options(sentence)}", file=sys.stderr)


def refuse_ignored(options: Mapping[str, bool], why: str) -> None:
    """Refuse options that would be ignored.

    Parameters
    ----------
    options : mapping of str to bool
        Option, as ``--samples``, to whether it was given.
    why : str
        The end of the sentence: ``means nothing with --printed``.

    Raises
    ------
    InvalidValueError
        With the first that was given.
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
    """Add the option that bounds how long a derivation may take.

    Parameters
    ----------
    what : str
        Whose time it is.
    """
    parser.add_argument(
        "--budget",
        metavar="SECONDS",
        help=f"time {what}; what is not done by then is said, and the exit status is 3 (default "
        f"{BUDGET:g})",
    )


def budget_of(chosen: argparse.Namespace) -> float:
    """Read ``--budget``.

    Returns
    -------
    float
        [s].

    Raises
    ------
    InvalidValueError
        If it is no positive number.
    """
    if chosen.budget is None:
        return BUDGET
    (seconds,) = numbers("--budget", chosen.budget, 1)
    require_positive("--budget", seconds, "s")
    return seconds


def numbers(option: str, text: str, count: int | None = None) -> list[float]:
    """Read numbers with commas between them.

    Parameters
    ----------
    option : str
        Where they were given, for the error's sentence.
    count : int, optional
        How many there must be.

    Raises
    ------
    InvalidValueError
        If a part is no finite number, or the count is another.
    """
    values = []
    for part in text.split(","):
        try:
            values.append(float(part))
        except ValueError:
            raise InvalidValueError(
                f"{option} is {text!r}, in which {part!r} is no number"
            ) from None
    if not all(map(math.isfinite, values)):
        raise InvalidValueError(f"{option} is {text!r}; its numbers must be finite")
    if count is not None and len(values) != count:
        raise InvalidValueError(
            f"{option} is {text!r}; it takes {count} number{'s' * (count > 1)}, not {len(values)}"
        )
    return values
