"""What all open pages are told."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from secrets import token_hex
from threading import Condition
from typing import Any

from drake_leg.scene.live.trace import Trace

QUIET = 1.0  # [s] without news, after which a page is told that the program is still there


class Board:
    """The latest state and the trace; at last, that the session has ended.

    Every page hears the latest state; one that is slow misses what came in between.
    """

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.session = token_hex(4)  # tells a page whether it belongs to this board
        self._changed = Condition()
        self._state: Mapping[str, Any] | None = None
        self._mark = trace.mark
        self._number = self._readers = 0
        self._ended = False

    def show(self, state: Mapping[str, Any]) -> None:
        """Tell a new state, or a new trace.

        Parameters
        ----------
        state : mapping
            Of numbers, words and lists, for JSON.
        """
        with self._changed:
            if (state, self.trace.mark) != (self._state, self._mark):
                self._state, self._mark = state, self.trace.mark
                self._number += 1
                self._changed.notify_all()

    def end(self, patience: float = QUIET) -> None:
        """Tell that the session has ended, and wait until the pages have been told.

        Parameters
        ----------
        patience : float
            Longest wait [s].
        """
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._readers == 0, patience)

    def news(self, quiet: float = QUIET) -> Iterator[Mapping[str, Any] | None]:
        """Follow what is told until the session has ended.

        Parameters
        ----------
        quiet : float
            Time without news after which there is an empty piece [s].

        Yields
        ------
        mapping or None
            The state with ``session`` and with ``trace``, as ``Trace.since`` tells it; None when
            nothing was new for long.
        """
        seen, cleared, count = 0, -1, 0
        with self._changed:
            self._readers += 1
        try:
            while not self._ended:
                known, seen = seen, self._newer(seen, quiet)
                state = self._state
                if state is None or seen == known:
                    if not self._ended:
                        yield None
                    continue
                trace = self.trace.since(cleared, count)
                cleared, count = trace["cleared"], trace["count"]
                yield {**state, "session": self.session, "trace": trace}
        finally:
            with self._changed:
                self._readers -= 1
                self._changed.notify_all()

    def _newer(self, seen: int, quiet: float) -> int:
        """Wait for a newer state, the end, or long enough; return the latest state's number."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._number > seen, quiet)
            return self._number
