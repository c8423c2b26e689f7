"""What the pages command: a velocity that lapses when its page falls silent."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from threading import Lock
from typing import Any

from drake_leg.scene.live.command import Command, deed, numbers_of, tab_of

FASTEST = 100.0  # [mm/s] along each axis
SILENCE = 1.0  # [s] without a word of the driving page, after which the foot halts
DEEDS = ("drive", "alive", "halt", "start", "clear", "quit")
REST = [0.0, 0.0, 0.0]


@dataclass(frozen=True, kw_only=True)
class Orders:
    """What has been commanded since one last asked."""

    velocity: list[float]  # (3,) [mm/s]
    tab: str  # of the page that drives; empty at rest
    halts: int  # how often the foot was halted, and what pages held let go
    lapsed: bool  # whether the driving page has fallen silent just now
    start: bool
    clear: bool
    quit: bool


class VelocityDesk:
    """The commanded velocity, one page's at a time.

    Parameters
    ----------
    clock : callable
        Tells the time [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._lock = clock, Lock()
        self._velocity, self._tab, self._heard = REST, "", 0.0
        self._halts, self._asked = 0, set[str]()

    def take(self, command: Command) -> dict[str, Any]:
        """Carry a command out.

        Parameters
        ----------
        command : Command
            ``{"do": "drive", "velocity": [x, y, z], "tab": name}`` in mm/s, at most ``FASTEST``
            along each axis; ``{"do": "alive", "tab": name}`` from the same page keeps it up, or it
            lapses after ``SILENCE``. ``halt``, ``start``, ``clear``, ``quit`` take nothing else.

        Returns
        -------
        dict
            ``velocity``: what is commanded now.

        Raises
        ------
        InvalidValueError
            If it is none of these, or its numbers are not finite.
        """
        wanted = deed(command, DEEDS)
        if wanted == "drive":
            given, tab = numbers_of(command, "velocity", 3), tab_of(command)
            with self._lock:
                self._velocity = [min(max(v, -FASTEST), FASTEST) for v in given]
                self._tab, self._heard = tab if any(given) else "", self._clock()
                return {"velocity": self._velocity}
        tab = tab_of(command) if wanted == "alive" else ""
        with self._lock:
            if wanted == "alive":
                self._heard = self._clock() if tab == self._tab else self._heard
            else:
                self._asked.add(wanted)
            if wanted in ("halt", "start", "quit"):
                self._halt()
            return {"velocity": self._velocity}

    def read(self) -> Orders:
        """Return what is commanded now, and what else was asked for since the last call."""
        with self._lock:
            lapsed = bool(self._tab) and self._clock() - self._heard > SILENCE
            if lapsed:
                self._halt()
            asked, self._asked = self._asked, set()
            return Orders(
                velocity=self._velocity,
                tab=self._tab,
                halts=self._halts,
                lapsed=lapsed,
                start="start" in asked,
                clear="clear" in asked,
                quit="quit" in asked,
            )

    def _halt(self) -> None:
        self._velocity, self._tab, self._halts = REST, "", self._halts + 1
