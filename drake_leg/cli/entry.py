"""Parses the command line, carries out the command and prints its errors."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from itertools import pairwise
from typing import Any, NoReturn

from drake_leg.arguments import printable
from drake_leg.cli.terminal import BAD_INPUT, FAILED, STOPPED_EARLY, fail, place_given_by
from drake_leg.errors import (
    DrakeLegError,
    ImpossibleWalkError,
    JointLimitError,
    MissingNumbersError,
    OutputError,
    PictureError,
    SingularConfigurationError,
    did_you_mean,
)

# Name -> module, whose function configure_NAME describes the command, and a line of help. Only the
# module of the command that is run is imported.
COMMANDS = {
    "list": ("drake_leg.cli.entry", "list the runs"),
    "run": ("drake_leg.cli.run", "carry out one run"),
    "sweep": ("drake_leg.cli.sweep", "carry out many runs, and plot what came out"),
    "replay": ("drake_leg.cli.replay", "show a run again, as a page or as video"),
    "view": ("drake_leg.cli.view", "look at a robot in 3D, its joints on sliders"),
    "teleop": ("drake_leg.cli.view", "drive a leg's foot, or a robot that walks, in real time"),
    "report": (
        "drake_leg.cli.reports",
        "reproduce the figures and tables of both reports on one page",
    ),
    "derive": ("drake_leg.cli.reports", "derive a robot's matrices and equations with SymPy"),
    "errata": ("drake_leg.cli.reports", "list what the reports print wrongly"),
    "doctor": ("drake_leg.cli.doctor", "examine a posture before simulating it"),
    "inverse": ("drake_leg.cli.inverse", "find all postures for a pose of the foot"),
    "sdf": ("drake_leg.cli.robots", "write a robot as SDF, as TOML or as a .par file"),
    "check": ("drake_leg.cli.robots", "prove a robot, or grade a print against it"),
    "inspect": ("drake_leg.cli.simulink", "list what a Simulink model holds"),
    "port": ("drake_leg.cli.port", "write a Simulink model as a Python script for Drake"),
    "compare": ("drake_leg.cli.simulink", "compare a Simulink model with a run or another model"),
    "diagram": (
        "drake_leg.cli.diagram",
        "draw a run's block diagram, its mechanism, its robot's frames; or a Simulink model",
    ),
}


EXAMPLES = {
    "run": "run leg-b --out results",
    "sweep": "sweep leg-b --vary femur=0.06:0.14:9 --out sweep",
    "replay": "replay results --out replay.html",
    "view": "view leg-b",
    "teleop": "teleop leg-b",
    "report": "report --out report",
    "derive": "derive leg-b",
    "errata": "errata 5",
    "doctor": "doctor leg-b --q 90,-50,-90",
    "inverse": "inverse leg-b --foot 0.1,0.05,-0.1",
    "sdf": "sdf leg-b --out leg-b.sdf",
    "check": "check leg-b",
    "inspect": "inspect leg.slx",
    "port": "port leg.slx --out leg.py",
    "compare": "compare leg.slx leg-b",
    "diagram": "diagram leg-b --out leg-b.svg",
}

# An option, and numbers with spaces between them.
_SPACED = re.compile(r"(--[a-z][a-z0-9-]*)[ =](-?[\d.]\S*(?: -?[\d.]\S*)+)")


class _Version(argparse.Action):
    """Prints the version, looked up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Print it and exit."""
        from importlib.metadata import version

        print(f"{parser.prog} {version('drake-leg')}")
        parser.exit()


class _Help(argparse.Action):
    """Prints the help of a command, which may depend on what was given before ``--help``."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option_string: str | None = None,
    ) -> None:
        explain = getattr(namespace, "explain", None)
        if explain is not None:
            explain(namespace)
        parser.print_help()
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """Prints errors in one sentence, without the usage; an option is written in full."""

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401 - as argparse's
        super().__init__(allow_abbrev=False, add_help=False, **settings)
        self.add_argument(
            "-h", "--help", action=_Help, nargs=0, help="show this help message and exit"
        )

    def error(self, message: str) -> NoReturn:
        option = re.fullmatch(r"argument (\S+): expected one argument", message)
        lacking = re.fullmatch(r"the following arguments are required: (.*)", message)
        if option:
            takes = self._option_string_actions[option[1]].metavar
            message = f"{option[1]} needs a value: write {option[1]} {takes}"
        elif lacking:
            names = lacking[1].split(", ")
            message = f"{' and '.join(names)} {'is' if len(names) == 1 else 'are'} missing"
        example = EXAMPLES.get(self.prog.rpartition(" ")[2])
        if example and (option or lacking):
            message += f"{',' if option else ':'} as in drake-leg {example}"
        self.exit(BAD_INPUT, f"{self.prog}: {printable(message)}\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; by default the process's own arguments."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words[:1] == ["help"]:
        words = [*words[1:2], "--help"]
    first = next((word for word in words if not word.startswith("-")), None)
    name = first if first in COMMANDS else None
    parser = _build_parser(only=name or "")
    if first is not None and name is None:
        known = did_you_mean(first, COMMANDS, f"the commands are {', '.join(COMMANDS)}")
        parser.error(f"there is no command {first!r}: {known}")
    for option, value in pairwise([*words, "."]):
        if re.fullmatch(r"--[a-z][a-z0-9-]*=", option) or (option[:2] == "--" and value == ""):
            parser.error(f"{option.rstrip('=')} is empty: give it a value, or leave it out")
    chosen, unknown = parser.parse_known_args(_join_negative_values(words))
    if unknown:
        parser.error(_unrecognized(parser, unknown, words, name))
    if "command" not in chosen:
        parser.print_help()
        return BAD_INPUT
    try:
        _require_working_folder()
        with place_given_by("--out"):
            status: int = chosen.command(chosen)
        if sys.stdout is not None:
            sys.stdout.flush()  # now, so that a failure to write is an error
    except (ImpossibleWalkError, JointLimitError, SingularConfigurationError) as error:
        return fail(error, STOPPED_EARLY)
    except PictureError as error:
        return fail(error, FAILED)
    except MissingNumbersError as error:
        error.advice = f"give numbers, as --set {','.join(f'{a}=0.1' for a in error.letters)}"
        return fail(error, BAD_INPUT)
    except DrakeLegError as error:
        return fail(error, BAD_INPUT)
    except OSError as error:
        return fail(f"cannot write what was asked for ({error.strerror})", BAD_INPUT)
    return status


def _require_working_folder() -> None:
    """Refuse to work in a folder that has been removed, where Drake cannot work either."""
    try:
        os.getcwd()  # noqa: PTH109 - no path is wanted
    except OSError:
        raise OutputError(
            "the folder that you are in has been removed: go to another one, with cd"
        ) from None


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


def _writing(options: Mapping[str, argparse.Action]) -> list[str]:
    """Name the options that write one file."""
    return [
        f"{option} {action.metavar}"
        for option, action in options.items()
        if str(action.metavar).startswith("FILE.")
    ]


def _unrecognized(
    parser: argparse.ArgumentParser, unknown: Sequence[str], words: Sequence[str], name: str | None
) -> str:
    """Say which words are not options of a command, and what was meant."""
    sentence = f"unrecognized arguments: {' '.join(unknown)}"
    commands = next(a.choices for a in parser._actions if isinstance(a.choices, dict))
    known = (commands[name] if name else parser)._option_string_actions
    spaced = _SPACED.search(" ".join(words))
    if spaced and "," in str(getattr(known.get(spaced[1]), "metavar", "")):
        numbers = ",".join(spaced[2].replace(",", " ").split())
        return f"{sentence}: put commas without spaces between numbers, as in {spaced[1]}={numbers}"
    for word in unknown:
        option = word.partition("=")[0]
        if option == "--out" and (writing := _writing(known)):
            return f"{sentence}: a file is written by {' or '.join(writing)}"
        is_guessed = option.startswith("--") and option != "--out"
        if is_guessed and (question := did_you_mean(option, known)):
            return f"{sentence}: {question}"
    command = f"drake-leg {name}" if name else "drake-leg"
    return f"{sentence}: {command} --help lists what it takes"


def _build_parser(only: str | None = None) -> argparse.ArgumentParser:
    """Build the parser, with the options of all commands or of only one."""
    parser = _Parser(
        prog="drake-leg",
        description="A pendulum, a leg of a six-legged robot and a SCARA arm on Drake: "
        "from their Khalil tables to simulated, compared and plotted runs.",
        epilog="COMMAND --help explains each option with its unit and default. Exit status: "
        "0 all well, 1 a check found something wrong, a foot is out of reach, a run's error shows "
        "or a picture could not be made, 2 bad input, 3 a run, proof or derivation stopped before "
        "its end, 70 an unexpected error, 130 interrupted, 128 + n ended by signal n.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", parser_class=_Parser)
    for name, (module, line) in COMMANDS.items():
        command = commands.add_parser(name, help=line)
        if only in (None, name):
            getattr(import_module(module), f"configure_{name}")(command)
    return parser


def configure_list(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = "List the runs."
    parser.set_defaults(command=_list)


def _list(_chosen: argparse.Namespace) -> int:
    from drake_leg.runs.catalogue import RUNS

    for name, kind in RUNS.items():
        print(f"{name:<16} {kind.title:<24} {kind.shows}")
    return 0
