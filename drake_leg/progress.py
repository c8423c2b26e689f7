"""A progress bar on the terminal, for whatever takes more than a second."""

from __future__ import annotations

import time
from typing import TextIO

PATIENCE = 1.0  # [s] before the bar appears
REFRESH = 0.1  # [s] between two pictures of it
WIDTH = 30  # characters


class ProgressBar:
    """Shows how far something has come, once it has taken more than a second.

    On a stream that is no terminal nothing is shown.

    Parameters
    ----------
    stream : TextIO
        Where to draw, usually the standard error.
    label : str
        What goes on.
    total : float
        Where it ends.
    unit : str
        Of the total.
    """

    def __init__(self, stream: TextIO, label: str, total: float, unit: str) -> None:
        self._stream = stream
        self._label = label
        self._total = total
        self._unit = unit
        self._next = time.perf_counter() + PATIENCE
        self._shown = False
        self._active = stream.isatty()

    def __call__(self, done: float) -> None:
        """Say how much is done, in the unit of the total.

        Parameters
        ----------
        done : float
            At most the total.
        """
        now = time.perf_counter()
        if not self._active or now < self._next:
            return
        self._next = now + REFRESH
        self._shown = True
        part = min(done / self._total, 1.0)
        bar = ("#" * round(part * WIDTH)).ljust(WIDTH, ".")
        line = f"\r{self._label} [{bar}] {part:4.0%}  {done:.4g} of {self._total:g} {self._unit} "
        self._stream.write(line)
        self._stream.flush()

    def close(self) -> None:
        """Wipe the bar off."""
        if self._shown:
            self._stream.write("\r" + " " * 78 + "\r")
            self._stream.flush()
