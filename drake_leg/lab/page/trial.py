"""Finds out whether VTK renders, in a copy of a process that has loaded what the pages need."""

from __future__ import annotations

import multiprocessing
import os
from multiprocessing.connection import Connection

from drake_leg.lab.page.workers import without_script
from drake_leg.processes import begin_process
from drake_leg.scene import artists

STDERR = 2  # its file descriptor


class RenderingTrial:
    """VTK, tried in a process of its own, which has loaded already what it takes."""

    def __init__(self) -> None:
        self._heard, said = multiprocessing.Pipe(duplex=False)
        with said, without_script():
            self._process = begin_process(_try_rendering, said)

    def fault(self) -> str | None:
        """Wait for what went wrong, in one line, or None, as ``rendering_fault`` returns it."""
        with self._heard:
            if not self._heard.poll(artists.PATIENCE):
                self._process.kill()
                return "TimeoutExpired"
            try:
                fault: str | None = self._heard.recv()
            except EOFError:
                self._process.join()
                return artists.ended_by(self._process.exitcode or 0) or "the renderer said nothing"
            return fault


def _try_rendering(said: Connection) -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), STDERR)  # what VTK says itself
    try:
        artists.try_rendering()
    except Exception as error:
        said.send(f"{type(error).__name__}: {error}"[: artists.MOST_SAID])
    else:
        said.send(None)
