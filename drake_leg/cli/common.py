"""What the commands share."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

BAD_INPUT, STOPPED_EARLY, INTERRUPTED = 2, 3, 130

Commands = Any  # what argparse's add_subparsers returns; its type has no public name


def fail(error: object, status: int) -> int:
    """Say on the standard error what went wrong.

    Parameters
    ----------
    error : object
        Its text is one sentence.
    status : int
        Exit status.

    Returns
    -------
    int
        The same status.
    """
    print(f"drake-leg: {error}", file=sys.stderr)
    return status


def add_output(parser: argparse.ArgumentParser) -> None:
    """Add the options of a command that makes a folder.

    Parameters
    ----------
    parser : ArgumentParser
        Of the command.
    """
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder to make")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace DIR if it holds older results"
    )
