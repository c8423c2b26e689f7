"""Work that may take for ever, stopped after a while."""

from __future__ import annotations

import ctypes
import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from drake_leg.errors import TimeBudgetError

T = TypeVar("T")

BUDGET = 120.0  # [s] of a derivation, where no other is given
LOOK = 0.02  # [s] between two looks at what is done
GRACE = 2.0  # [s] in which what is stopped may come to its end


class TimeBudget:
    """Seconds that several pieces of work share, from now on.

    Parameters
    ----------
    seconds : float
        For all of them.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._end = time.monotonic() + seconds

    @property
    def left(self) -> float:
        """What is left of it [s]."""
        return max(self._end - time.monotonic(), 0.0)

    def spend(self, work: Callable[[], T]) -> T:
        """Carry work out within what is left.

        Parameters
        ----------
        work : callable
            In Python: nothing stops a single call into compiled code.

        Returns
        -------
        object
            Of the work; what it raises is raised.

        Raises
        ------
        TimeBudgetError
            If it was not done in time.
        """
        if self.left <= 0.0:
            raise TimeBudgetError(seconds=self.seconds)
        worker = _Worker(work)
        try:
            worker.start()
            while worker.is_alive() and self.left > 0.0:
                worker.join(min(LOOK, self.left))
            if worker.is_alive():
                raise TimeBudgetError(seconds=self.seconds)
        finally:
            worker.stop()
        return worker.result()


class _Worker(threading.Thread, Generic[T]):
    """Carries work out beside the thread that waits for it."""

    def __init__(self, work: Callable[[], T]) -> None:
        super().__init__(daemon=True)
        self._work = work
        self._results: list[T] = []
        self._error: BaseException | None = None

    def run(self) -> None:
        try:
            self._results.append(self._work())
        except BaseException as error:  # handed over by result()
            self._error = error

    def stop(self) -> None:
        """Raise ``SystemExit`` inside the work, again where it goes on in spite of it."""
        end = time.monotonic() + GRACE
        while self.is_alive() and time.monotonic() < end:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(
                ctypes.c_ulong(self.ident or 0), ctypes.py_object(SystemExit)
            )
            self.join(LOOK)

    def result(self) -> T:
        if self._error is not None:
            raise self._error
        return self._results[0]
