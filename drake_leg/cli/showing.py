"""What shows a motion: a page, a video, stills, and the server of a live page."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from drake_leg.cli.terminal import Pictures, as_options, numbers, place_given_by, remark
from drake_leg.errors import InvalidValueError, OutputError
from drake_leg.files import ResultsFolder

if TYPE_CHECKING:
    from drake_leg.runs.outcome import Outcome
    from drake_leg.scene.scene import PlantMotion
    from drake_leg.scene.server import Server

ENDINGS = {"replay": (".html",), "video": (".mp4", ".gif")}


def stop_note(summary: Mapping[str, Any]) -> str | None:
    """Say why a run stopped before its end, from what ``summary.json`` says, if it did."""
    reason, at = summary.get("stop_reason"), summary.get("stopped_at_s")
    if not isinstance(reason, str):
        return None
    reason = as_options(reason)
    return f"stopped at {at:.4g} s: {reason}" if isinstance(at, float) else f"stopped: {reason}"


def add_shows(parser: argparse.ArgumentParser) -> None:
    """Add ``--replay``, ``--video`` and ``--stills``."""
    parser.add_argument(
        "--replay", type=Path, metavar="FILE", help="write a page that replays the run (.html)"
    )
    parser.add_argument(
        "--video", type=Path, metavar="FILE", help="write a video of the run (.mp4, .gif)"
    )
    parser.add_argument(
        "--stills", action="store_true", help="add pictures from every side to DIR, at the start"
    )


def say_if_sketched() -> None:
    """Print why matplotlib drew what VTK could not render, if it did."""
    from drake_leg.scene.images import sketching

    sentence = sketching()
    if sentence is not None:
        remark(sentence)


@dataclass(frozen=True, kw_only=True)
class Shows:
    """What was asked for besides the folder of results."""

    replay: Path | None
    video: Path | None
    stills: bool
    overwrite: bool

    @classmethod
    def of(cls, chosen: argparse.Namespace) -> Self:
        """Read it from the command line."""
        return cls(
            replay=chosen.replay,
            video=chosen.video,
            stills=chosen.stills,
            overwrite=chosen.overwrite,
        )

    def check(self) -> None:
        """Refuse files that cannot be made, before any work is done for them."""
        for option, path in self._files().items():
            from drake_leg.scene.replay import check_show

            if path.suffix.lower() not in ENDINGS[option]:
                endings = " or ".join(ENDINGS[option])
                raise OutputError(f"--{option} is {path}; its name must end in {endings}")
            with place_given_by(f"--{option}"):
                check_show(path, overwrite=self.overwrite)

    def write(
        self, title: str, outcome: Outcome, folder: ResultsFolder, pictures: Pictures
    ) -> list[Path]:
        """Write stills into the folder of results, page and video beside it.

        Returns the paths of those of the page and the video that could be made.
        """
        made = []

        @cache
        def motion() -> PlantMotion:
            from drake_leg.scene.scene import motion_of

            return motion_of(outcome.robot, outcome.recording)

        if self.stills:
            self._write_stills(motion, folder, pictures)
        for option, path in self._files().items():
            with pictures.trying(f"the {option} {path}"), place_given_by(f"--{option}"):
                from drake_leg.scene.replay import write_show

                write_show(
                    path,
                    motion(),
                    title=title,
                    note=stop_note(outcome.summary),
                    overwrite=self.overwrite,
                )
                made.append(path)
        return made

    def _write_stills(
        self, motion: Callable[[], PlantMotion], folder: ResultsFolder, pictures: Pictures
    ) -> None:
        from drake_leg.scene.scene import VIEWS

        for view in VIEWS.values():
            with pictures.trying(f"the still {view.name}"), folder.more() as scratch:
                from drake_leg.scene.images import write_stills

                write_stills(scratch, motion(), views=[view])

    def _files(self) -> dict[str, Path]:
        given = {"replay": self.replay, "video": self.video}
        return {option: path for option, path in given.items() if path is not None}


HOST = "localhost"


def add_server(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "--host",
        help=f"name or address to serve at; '*' lets other machines in (default {HOST})",
    )
    parser.add_argument(
        "--port", metavar="N", help="port to serve at (default the first free one from 7000 on)"
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")
    parser.add_argument(
        "--once", action="store_true", help="end at once, without a browser, to try it"
    )


def server_options(chosen: argparse.Namespace) -> dict[str, bool]:
    """Tell which of the options were given."""
    return {
        "--host": chosen.host is not None,
        "--port": chosen.port is not None,
        "--no-browser": chosen.no_browser,
        "--once": chosen.once,
    }


LEAVING = (
    "Escape in the page, or Ctrl-C here, ends it. Then the posture is printed, as for --q, and "
    "the exit status is 0."
)


def start_server(chosen: argparse.Namespace, shows: str) -> Server:
    """Listen, print where, and open a browser; the server does not serve yet."""
    from drake_leg.scene.server import Server, open_browser

    server = Server(HOST if chosen.host is None else chosen.host, _port(chosen.port))
    print(f"{shows}: {server.url}", flush=True)
    print("Press Escape in the page or Ctrl-C here to end", flush=True)
    if not (chosen.once or chosen.no_browser or open_browser(server.url)):
        print(
            f"drake-leg: no browser was found; open {server.url} in one",
            file=sys.stderr,
            flush=True,
        )
    return server


def _port(text: str | None) -> int | None:
    if text is None:
        return None
    value = numbers("--port", text, 1)[0]
    if value != int(value):
        raise InvalidValueError(f"--port is {text}; it must be a whole number")
    return int(value)
