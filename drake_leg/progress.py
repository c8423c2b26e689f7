"""Whatever takes more than a second says how far it is: a bar on a terminal, else plain lines."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from typing import Self, TextIO

PATIENCE = 1.0  # [s] before the bar appears
REFRESH = 0.1  # [s] between two pictures of it
LINES = 10.0  # [s] before the first plain line, and between two of them
WIDTH = 30  # characters


class ProgressBar:
    """Shows how far something has come, once it has taken more than a second.

    On a stream that is no terminal it writes a line every ten seconds instead. In a ``with`` it
    does so on its own, also while nothing is reported.

    Parameters
    ----------
    stream : TextIO
        Where to draw, usually the standard error.
    """

    def __init__(self, stream: TextIO, label: str, total: float, unit: str) -> None:
        self._stream = stream
        self._label = label
        self._total = total
        self._unit = unit
        self._done = 0.0
        self._stage = ""
        self._shown = False
        self._terminal = stream.isatty()
        self._began = time.perf_counter()
        self._next = self._began + (PATIENCE if self._terminal else LINES)
        self._drawing = threading.Lock()
        self._closed = threading.Event()
        self._ticker = threading.Thread(target=self._tick, daemon=True)

    def __enter__(self) -> Self:
        self._ticker.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def __call__(self, done: float) -> None:
        """Say how much is done, in the unit of the total.

        Parameters
        ----------
        done : float
            At most the total.
        """
        self._done = done
        self._show()

    def turn_to(self, stage: str) -> None:
        """Say what goes on from now on, of which nobody knows how much is done."""
        self._stage = stage
        self._show()

    def close(self) -> None:
        """Wipe the bar off for good."""
        self._closed.set()
        if self._ticker.is_alive():
            self._ticker.join()
        self.wipe()

    def wipe(self) -> None:
        """Wipe the bar off, so that something can be printed; it comes back by itself."""
        with self._drawing:
            if self._shown:
                self._write("\r" + " " * 78 + "\r")
                self._shown = False

    def _tick(self) -> None:
        while not self._closed.wait(REFRESH):
            self._show()

    def _show(self) -> None:
        now = time.perf_counter()
        if now < self._next:
            return
        with self._drawing:
            if now < self._next:
                return
            self._next = now + (REFRESH if self._terminal else LINES)
            if self._terminal:
                self._shown = True
                self._write(f"\r{self._bar(now - self._began):<78}")
            else:
                self._write(f"drake-leg: {self._line(now - self._began)}\n")

    def _bar(self, elapsed: float) -> str:
        if self._stage:
            return self._line(elapsed)
        part = min(self._done / self._total, 1.0)
        bar = ("#" * round(part * WIDTH)).ljust(WIDTH, ".")
        return f"{self._label} [{bar}] {part:4.0%}  {self._amount()} "

    def _line(self, elapsed: float) -> str:
        what = self._stage or self._amount()
        return f"{self._label}: {what}, at work for {elapsed:.0f} s"

    def _amount(self) -> str:
        return f"{self._done:.4g} of {self._total:g} {self._unit}"

    def _write(self, text: str) -> None:
        """Write, unless nobody reads any more: no work is lost for that."""
        with suppress(OSError, ValueError):
            self._stream.write(text)
            self._stream.flush()
