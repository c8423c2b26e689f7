"""What shows a robot or its motion: views, a page, a video, stills."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from drake_leg.cli.terminal import Pictures, as_options, place_given_by, remark
from drake_leg.errors import OutputError
from drake_leg.files import ResultsFolder

if TYPE_CHECKING:
    from drake_leg.runs.outcome import Outcome
    from drake_leg.scene.scene import PlantMotion

ENDINGS = {"replay": (".html",), "video": (".mp4", ".gif")}  # of the files of these options


def stop_note(summary: Mapping[str, Any]) -> str | None:
    """Describe why a run stopped before its end, if it did, from its ``summary.json``."""
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


@dataclass(frozen=True, kw_only=True)
class Shows:
    """The files to write besides the folder of results, and whether to add stills to it."""

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
        """Refuse files that cannot be written, before work is done for them."""
        for option, path in self._files().items():
            from drake_leg.scene.media import check_show

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
                from drake_leg.scene.media import write_show

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

        for view in VIEWS:
            with pictures.trying(f"the still {view}"), folder.more() as scratch:
                from drake_leg.scene.media import still

                shown, start = motion().shown, motion().q[0]
                png = still(shown, start, view=view, motion=motion()).png
                (scratch / f"still_{view}.png").write_bytes(png)

    def _files(self) -> dict[str, Path]:
        given = {"replay": self.replay, "video": self.video}
        return {option: path for option, path in given.items() if path is not None}
