"""The page, the video and the stills that a run writes besides its folder of results."""

from __future__ import annotations

import argparse
from pathlib import Path

from drake_leg.cli.terminal import place_given_by
from drake_leg.errors import OutputError

ENDINGS = {"replay": (".html",), "video": (".mp4", ".gif")}  # of the files of these options


def add_shows(parser: argparse.ArgumentParser) -> None:
    """Add ``--replay``, ``--video`` and ``--stills``."""
    parser.add_argument(
        "--replay", type=Path, metavar="FILE", help="write a page that replays the run (.html)"
    )
    parser.add_argument(
        "--video", type=Path, metavar="FILE", help="write a video of the run (.mp4, .gif)"
    )
    parser.add_argument(
        "--stills",
        action="store_true",
        help="add pictures from every side to DIR, at the start; of a walk, in its middle",
    )


def shows_of(chosen: argparse.Namespace) -> dict[str, Path]:
    """Return the files to write in addition to the folder of results, by option."""
    given = {"replay": chosen.replay, "video": chosen.video}
    return {option: path for option, path in given.items() if path is not None}


def check_shows(chosen: argparse.Namespace) -> None:
    """Refuse files that cannot be written, before work is done for them."""
    for option, path in shows_of(chosen).items():
        from drake_leg.scene.media import check_show  # not needed without these options

        if path.suffix.lower() not in ENDINGS[option]:
            endings = " or ".join(ENDINGS[option])
            raise OutputError(f"--{option} is {path}; its name must end in {endings}")
        with place_given_by(f"--{option}"):
            check_show(path, overwrite=chosen.overwrite)
