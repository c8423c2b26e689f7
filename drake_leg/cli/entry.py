"""The parser, the errors' way to the terminal, and the exit status."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

from drake_leg.cli import (
    check,
    compare,
    derive,
    diagram,
    doctor,
    errata,
    inspect,
    listing,
    replay,
    report,
    run,
    sdf,
    teleop,
    view,
)
from drake_leg.cli.common import BAD_INPUT, FAILED, STOPPED_EARLY, fail
from drake_leg.errors import (
    DrakeLegError,
    JointLimitError,
    OutputError,
    PictureError,
    SingularConfigurationError,
)

COMMANDS = (
    listing,
    run,
    replay,
    view,
    teleop,
    report,
    derive,
    errata,
    doctor,
    sdf,
    check,
    inspect,
    compare,
    diagram,
)


class _Version(argparse.Action):
    """Prints the version, looked up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Print it and end."""
        from importlib.metadata import version

        print(f"{parser.prog} {version('drake-leg')}")
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one sentence, without the usage in front."""

    def error(self, message: str) -> NoReturn:
        self.exit(BAD_INPUT, f"{self.prog}: {message}\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; by default the process's own.
    """
    words = sys.argv[1:] if arguments is None else list(arguments)
    parser = _build_parser()
    chosen = parser.parse_args(_join_negative_values(words))
    try:
        _require_here()
        status: int = chosen.command(chosen)
        _require_said()
    except (JointLimitError, SingularConfigurationError) as error:
        return fail(error, STOPPED_EARLY)
    except PictureError as error:
        return fail(error, FAILED)
    except DrakeLegError as error:
        return fail(error, BAD_INPUT)
    except OSError as error:
        return fail(f"cannot write what was asked for ({error.strerror})", BAD_INPUT)
    return status


def _require_here() -> None:
    """Refuse to work in a folder that has been removed, where neither we nor Drake can."""
    try:
        os.getcwd()  # noqa: PTH109 - no path is wanted
    except OSError:
        raise OutputError(
            "the folder that you are in has been removed: go to another one, with cd"
        ) from None


def _require_said() -> None:
    """Find out now whether what was printed can be written."""
    if sys.stdout is not None:
        sys.stdout.flush()


def _join_negative_values(words: Sequence[str]) -> list[str]:
    """Make ``--q0 -90,50,90`` into ``--q0=-90,50,90``: no option here begins with a number."""
    joined: list[str] = []
    for word in words:
        option_before = joined and re.fullmatch(r"--[a-z][a-z0-9-]*", joined[-1])
        if option_before and re.match(r"-[\d.]|-(inf|nan)", word, re.IGNORECASE):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _build_parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="drake-leg",
        description="A pendulum, a leg of a six-legged robot and a SCARA arm on Drake: "
        "from their Khalil tables to simulated, compared and plotted runs.",
        epilog="COMMAND --help tells every option with its unit and its default. Exit status: "
        "0 all well, 1 a check found something wrong, a run's error shows or a picture could not "
        "be made, 2 bad input, 3 a run stopped before its end or a proof or derivation before its "
        "own, 70 an error that nobody foresaw, 130 interrupted, 128 + n ended by signal n.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and end")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    for command in COMMANDS:
        command.add(commands)
    return parser
