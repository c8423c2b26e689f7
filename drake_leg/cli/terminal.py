"""What commands print: sentences with options, what could not be drawn, the exit status."""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from drake_leg.arguments import printable
from drake_leg.errors import (
    GIVE_A_VALUE,
    DrakeLegError,
    InvalidValueError,
    PictureError,
    PlaceError,
)
from drake_leg.progress import BUDGET, ProgressBar
from drake_leg.units import require_positive

FAILED, BAD_INPUT, STOPPED_EARLY, INTERRUPTED = 1, 2, 3, 130  # exit statuses
TRACEBACK = "DRAKE_LEG_TRACEBACK"  # environment variable: print tracebacks of unexpected errors

_SETTING = re.compile(r"`(?:(?P<name>[a-z][a-z0-9_]*)(?:=(?P<value>[^`]+))?|(?P<other>'[^`]+'))`")

_VALUE = re.compile(
    rf"{GIVE_A_VALUE}(?P<name>[A-Za-z]\w*)(?P<field>(?:\.\w+)*)(?:, [A-Za-z][\w.]*)*(?! by --)"
)
_PLACE = re.compile(r"give a place (?P<too>and a direction )?to '(?P<name>[^']*)'")

_CANDIDATE = re.compile(r"place '(?P<name>[^'\n]*)' at (?P<at>[-+.,e\d]+) \((?P<what>[^)\n]*)\)")


def as_options(text: object) -> str:
    """Rewrite the settings in a sentence of the library as options."""

    def written(setting: re.Match[str]) -> str:
        name, value, other = setting.group("name", "value", "other")
        if other:
            return _plain(other)
        option = option_of(name)
        return option if value in (None, "True") else f"{option} {_plain(value)}"

    def place(feature: re.Match[str]) -> str:
        numbers = "X,Y,Z,DX,DY,DZ" if feature["too"] else "X,Y,Z"
        return f"give --feature '{feature['name']}={numbers}' [m],"

    text = _CANDIDATE.sub(r"--feature '\g<name>=\g<at>'  # \g<what>", str(text))
    return _with_values(_SETTING.sub(written, _PLACE.sub(place, text)))


def _with_values(text: str) -> str:
    """Name the options that give values, where a sentence first asks for one."""
    asked = _VALUE.search(text)
    if asked is None:
        return text
    name = asked["name"]
    is_struct = bool(asked["field"]) or re.search(rf"\b{name}\.[A-Za-z]", text)
    by_hand = "" if is_struct else f"--set {name}=1 or "
    return f"{text[: asked.end()]} by {by_hand}--init FILE{text[asked.end() :]}"


def option_of(name: str) -> str:
    """Write the name of a setting as its option: ``max_step`` as ``--max-step``."""
    return f"--{name.replace('_', '-')}"


def _plain(value: str) -> str:
    """Write a Python value as it is typed: ``(1, 0, 0)`` as ``1,0,0``."""
    return re.sub(r"[()\[\]' ]", "", value)


@contextmanager
def place_given_by(option: str) -> Iterator[None]:
    """Add to a ``PlaceError`` the advice to change this option, unless it names another."""
    try:
        yield
    except PlaceError as error:
        if "--" not in error.advice:
            overwrite = ", or add --overwrite" if error.replaceable else ""
            error.advice = f"choose another {option}{overwrite}"
        raise


def fail(error: object, status: int) -> int:
    """Print what went wrong on the standard error, and return the exit status."""
    remark(error)
    return status


def remark(sentence: object) -> None:
    """Print a sentence on the standard error, with settings as options."""
    lines = map(printable, as_options(sentence).split("\n"))
    print("drake-leg: " + "\n".join(lines), file=sys.stderr)


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
            advice = (
                "put commas without spaces between the numbers" if len(part.split()) > 1 else ""
            )
            raise InvalidValueError(
                f"{option} is {text!r}, in which {part!r} is not a number", advice=advice
            ) from None
    if not all(map(math.isfinite, values)):
        raise InvalidValueError(f"{option} is {text!r}; its numbers must be finite")
    if count is not None and len(values) != count:
        whole, *decimals = text.split(",")
        comma = count == 1 and len(decimals) == 1 and decimals[0].isdecimal()
        raise InvalidValueError(
            f"{option} is {text!r}; it takes {count} number{'s' * (count > 1)}, not {len(values)}",
            advice=f"write a decimal point, as {whole}.{decimals[0]}" if comma else "",
        )
    return values


@contextmanager
def at_work(label: str, stage: str) -> Iterator[None]:
    """Show for how long something of unknown length has been going on."""
    with ProgressBar(sys.stderr, label, 1.0, "") as bar:
        bar.turn_to(stage)
        yield


@contextmanager
def picture(what: str) -> Iterator[None]:
    """Raise any error of a picture as a ``PictureError``."""
    try:
        yield
    except DrakeLegError:
        raise
    except Exception as error:
        show_traceback()
        raise PictureError(what, error) from error


class Pictures:
    """Collects the errors of pictures that are made one after the other."""

    def __init__(self) -> None:
        self.failures: list[PictureError] = []

    @contextmanager
    def trying(self, what: str) -> Iterator[None]:
        """Keep the error if this picture fails."""
        try:
            yield
        except Exception as error:
            show_traceback()
            self.failures.append(PictureError(what, error))

    def print_failures(self) -> None:
        """Print the errors."""
        for failure in self.failures:
            remark(failure)


def show_traceback() -> None:
    """Print the traceback of the current error, if the environment asks for it."""
    if TRACEBACK in os.environ:
        traceback.print_exc()


def stop_note(summary: Mapping[str, Any]) -> str | None:
    """Describe why a run stopped before its end, if it did, from its ``summary.json``."""
    reason, at = summary.get("stop_reason"), summary.get("stopped_at_s")
    if not isinstance(reason, str):
        return None
    reason = as_options(reason)
    return f"stopped at {at:.4g} s: {reason}" if isinstance(at, float) else f"stopped: {reason}"


def add_view(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the option that names a view."""
    parser.add_argument(
        "--from",
        dest="view",
        default="3d",
        metavar="VIEW",
        help=f"view {what}: 3d, right, front or top (default 3d)",
    )


def remark_if_sketched() -> None:
    """Print why matplotlib drew the pictures instead of VTK, if it did."""
    from drake_leg.scene.media import sketching

    sentence = sketching()
    if sentence is not None:
        remark(sentence)
