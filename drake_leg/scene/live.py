"""States, traces and commands that a running program exchanges with its open pages."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Iterator, Mapping
from secrets import token_hex
from threading import Condition, Lock
from typing import Any

import numpy as np

from drake_leg.colours import Colour
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.scene.parts import BLUE, GREEN, RED, TRACE, TRACE_RADIUS, TRACE_SPACING
from drake_leg.scene.scene import Scene, View
from drake_leg.scene.web_page import stage_data

MOST_PIECES = 500  # of a trace; its oldest pieces go when it is longer
QUIET = 1.0  # [s] without a new state, after which a page is told that the program still runs
LONGEST_NAME = 40  # of a page

Command = Mapping[str, Any]  # an object of JSON: what to do, under "do", and its numbers
Entry = tuple[str, tuple[Colour, ...]]  # of a legend: words, and the colours of what they name

AXES: tuple[Entry, ...] = (("x", (RED,)), ("y", (GREEN,)), ("z", (BLUE,)))


class Trace:
    """The paths of moving tips, as numbered straight pieces.

    Pages ask for those that they have not yet seen.

    Parameters
    ----------
    size : float
        Of the scene [m].
    """

    def __init__(self, size: float) -> None:
        self._spacing = TRACE_SPACING / 2.0 * size
        self._pieces: deque[list[float]] = deque(maxlen=MOST_PIECES)
        self._last: dict[int, Array] = {}  # of each tip
        self._count = self._cleared = 0
        self._lock = Lock()

    @property
    def mark(self) -> tuple[int, int]:
        """How often it was cleared, and how many pieces have come since."""
        return self._cleared, self._count

    def add(self, points: Array) -> None:
        """Extend the paths to points of the world, one per tip, (k, 3) or (3,) [m], unless near."""
        with self._lock:
            for tip, point in enumerate(np.atleast_2d(points)):
                last = self._last.setdefault(tip, np.array(point))
                if np.linalg.norm(point - last) >= self._spacing:
                    self._pieces.append([round(float(part), 6) for part in (*last, *point)])
                    self._last[tip], self._count = np.array(point), self._count + 1

    def lift(self) -> None:
        """Leave a gap before the next point, to which the tip jumps."""
        with self._lock:
            self._last.clear()

    def clear(self) -> None:
        """Begin again."""
        with self._lock:
            self._pieces.clear()
            self._last.clear()
            self._count, self._cleared = 0, self._cleared + 1

    def since(self, cleared: int, count: int) -> dict[str, Any]:
        """Return the pieces that are new since an answer with these numbers; -1 and 0 at first.

        Returns
        -------
        dict
            ``cleared``: how often the trace was cleared; ``count``: pieces since then;
            ``pieces``: the new ones, x, y, z of their ends [m].
        """
        with self._lock:
            known = count if cleared == self._cleared else 0
            new = min(self._count - known, len(self._pieces))
            pieces = list(self._pieces)[len(self._pieces) - new :]
            return {"cleared": self._cleared, "count": self._count, "pieces": pieces}


class Feed:
    """Publishes the latest state and the trace to all open pages, and the end of the session.

    A slow page misses the states in between.
    """

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.session = token_hex(4)  # tells a page whether it belongs to this feed
        self._changed = Condition()
        self._state: Mapping[str, Any] | None = None
        self._mark = trace.mark
        self._number = self._readers = 0
        self._ended = False

    def publish(self, state: Mapping[str, Any]) -> None:
        """Publish a new state, which JSON can write, or a new trace."""
        with self._changed:
            if (state, self.trace.mark) != (self._state, self._mark):
                self._state, self._mark = state, self.trace.mark
                self._number += 1
                self._changed.notify_all()

    def end(self, patience: float = QUIET) -> None:
        """Announce the end of the session; wait at most ``patience`` [s] for the pages."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._readers == 0, patience)

    def follow(self, quiet: float = QUIET) -> Iterator[Mapping[str, Any] | None]:
        """Follow what is published until the session has ended.

        Parameters
        ----------
        quiet : float
            Time without a new state, after which None is yielded [s].

        Yields
        ------
        mapping or None
            The state with ``session`` and with ``trace``, as ``Trace.since`` returns it; None when
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


def action_of(command: Command, actions: Collection[str]) -> str:
    """Read what a command asks for, one of ``actions``.

    Raises
    ------
    InvalidValueError
        If it asks for something else.
    """
    wanted = command.get("do")
    if not isinstance(wanted, str) or wanted not in actions:
        raise InvalidValueError(f'"do" must be one of {", ".join(actions)}')
    return wanted


def numbers_of(command: Command, name: str, count: int) -> list[float]:
    """Read the ``count`` numbers that a command has under a name.

    Raises
    ------
    InvalidValueError
        If they are missing, of another count, or not finite.
    """
    values = command.get(name)
    if (
        not isinstance(values, list)
        or len(values) != count
        or not all(isinstance(value, int | float) and _finite(value) for value in values)
    ):
        raise InvalidValueError(f'"{name}" must be a list of {count} finite numbers')
    return [float(value) for value in values]


def tab_of(command: Command) -> str:
    """Read the name of the page that a command comes from; the page chose it.

    Raises
    ------
    InvalidValueError
        If it has none, or a long one.
    """
    tab = command.get("tab")
    if not isinstance(tab, str) or not 0 < len(tab) <= LONGEST_NAME:
        raise InvalidValueError(f'"tab" must be a name of at most {LONGEST_NAME} letters')
    return tab


def live_data(scene: Scene, first: View, session: str) -> dict[str, Any]:
    """Collect the data that the scripts of all live pages need.

    Parameters
    ----------
    first : View
        From where it is seen first.
    session : str
        Of the feed that the page follows.
    """
    pen = {"most": MOST_PIECES, "radius": TRACE_RADIUS * scene.size, "colour": TRACE}
    return {**stage_data(scene, first), "pen": pen, "session": session}


def millimetres(point: Array) -> list[float]:
    """Write a point [m] as pages show it."""
    return [round(1e3 * float(part), 2) + 0.0 for part in point]


def _finite(value: float) -> bool:
    try:
        return not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:
        return False
