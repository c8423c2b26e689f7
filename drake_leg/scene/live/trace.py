"""The way that a tip goes while somebody moves it."""

from __future__ import annotations

from collections import deque
from threading import Lock
from typing import Any

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.scene.marks import TRACE_SPACING

MOST_PIECES = 500  # of a trace; its oldest pieces go when it is longer


class Trace:
    """Straight pieces, numbered as they come; pages ask for those that they have not yet seen.

    Parameters
    ----------
    size : float
        Of the scene [m].
    """

    def __init__(self, size: float) -> None:
        self._spacing = TRACE_SPACING / 2.0 * size
        self._pieces: deque[list[float]] = deque(maxlen=MOST_PIECES)
        self._last: Array | None = None
        self._count = self._cleared = 0
        self._lock = Lock()

    @property
    def mark(self) -> tuple[int, int]:
        """How often it was cleared, and how many pieces have come since."""
        return self._cleared, self._count

    def add(self, point: Array) -> None:
        """Go on to a point, unless it is near the last one.

        Parameters
        ----------
        point : (3,) ndarray
            In the world [m].
        """
        with self._lock:
            if self._last is None:
                self._last = np.array(point)
            if np.linalg.norm(point - self._last) < self._spacing:
                return
            self._pieces.append([round(float(part), 6) for part in (*self._last, *point)])
            self._last, self._count = np.array(point), self._count + 1

    def lift(self) -> None:
        """Leave a gap before the next point: the tip was put there, it did not go."""
        with self._lock:
            self._last = None

    def clear(self) -> None:
        """Begin again."""
        with self._lock:
            self._pieces.clear()
            self._last, self._count, self._cleared = None, 0, self._cleared + 1

    def since(self, cleared: int, count: int) -> dict[str, Any]:
        """Tell what is new.

        Parameters
        ----------
        cleared, count : int
            As told last; -1 and 0 at first.

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
