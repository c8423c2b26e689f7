"""Long work: its progress bar, its time budget, its interruption."""

from __future__ import annotations

import gc
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from types import FrameType
from typing import Generic, NoReturn, Self, TextIO, TypeVar

from drake_leg.errors import TimeBudgetError

T = TypeVar("T")


# --- progress bar ----------------------------------------------------------------------------

PATIENCE = 1.0  # [s] before the bar appears
REFRESH = 0.1  # [s] between two updates
LINES = 10.0  # [s] before the first plain line, and between two lines
WIDTH = 30  # characters of the bar
PACED = 5.0  # [s] of work before it is said how long the rest takes


class ProgressBar:
    """Shows the progress of something that takes more than a second.

    On a stream that is not a terminal it writes a line every ten seconds instead. In a ``with``
    statement it is updated even while no progress is reported.
    """

    def __init__(self, stream: TextIO, label: str, total: float, unit: str) -> None:
        self._stream = stream
        self._label = label
        self._total = total
        self._unit = unit
        self._done = 0.0
        self._first: tuple[float, float] | None = None  # [s], and how much was done then
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
        """Report how much of the total is done, in its unit."""
        self._done = done
        self._first = self._first or (time.perf_counter(), done)
        self._show()

    def count(self, done: float, total: float) -> None:
        """Report how much is done of a total that is known only now."""
        if total != self._total:
            self._total, self._first = total, None
        self(done)

    def turn_to(self, stage: str) -> None:
        """Show a stage whose progress is unknown."""
        self._stage = stage
        self._show()

    def close(self) -> None:
        """Erase the bar for good."""
        self._closed.set()
        if self._ticker.is_alive():
            self._ticker.join()
        self.wipe()

    def wipe(self) -> None:
        """Erase the bar, so that something can be printed; the next update draws it again."""
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
        return f"{self._label}: {what}, at work for {elapsed:.0f} s{self._rest()}"

    def _rest(self) -> str:
        """Say how long the rest takes at the pace since the first report, where that is known."""
        (then, first), now = self._first or (0.0, self._done), time.perf_counter()
        if self._stage or now - then < PACED or not first < self._done < self._total:
            return ""
        left = (now - then) * (self._total - self._done) / (self._done - first)
        return f", about {_in_words(left)} more at this pace"

    def _amount(self) -> str:
        return f"{self._done:.4g} of {self._total:g} {self._unit}"

    def _write(self, text: str) -> None:
        """Write; ignore a reader that has gone."""
        with suppress(OSError, ValueError):
            self._stream.write(text)
            self._stream.flush()


def _in_words(seconds: float) -> str:
    """Write a time to come: seconds, minutes or hours."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.0f} h"


# --- time budget -----------------------------------------------------------------------------

BUDGET = 120.0  # [s] of a derivation by default
POLL = 0.02  # [s] between two checks of whether the work is done
GRACE = 2.0  # [s] in which stopped work must end


class TimeBudget:
    """A time limit that several pieces of work share; it starts when it is made."""

    def __init__(self, seconds: float) -> None:
        # A window of VTK must be freed in the thread that made it, and not by the worker.
        gc.collect()
        self.seconds = seconds
        self._end = time.monotonic() + seconds

    @property
    def left(self) -> float:
        """Remaining time [s]."""
        return max(self._end - time.monotonic(), 0.0)

    def spend(self, work: Callable[[], T]) -> T:
        """Do a piece of work and return its result.

        Only Python code can be stopped: nothing stops a single call into compiled code.

        Raises
        ------
        TimeBudgetError
            If it was not done in the remaining time; the work is stopped.
        """
        if self.left <= 0.0:
            raise TimeBudgetError(seconds=self.seconds)
        worker = _Worker(work)
        try:
            worker.start()
            while worker.is_alive() and self.left > 0.0:
                worker.join(min(POLL, self.left))
            if worker.is_alive():
                raise TimeBudgetError(seconds=self.seconds)
        finally:
            worker.stop()
        return worker.result()


class _Worker(threading.Thread, Generic[T]):
    """Does work while another thread waits for it."""

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
        """Raise ``SystemExit`` inside the work, repeatedly if it goes on."""
        import ctypes

        end = time.monotonic() + GRACE
        while self.is_alive() and time.monotonic() < end:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(
                ctypes.c_ulong(self.ident or 0), ctypes.py_object(SystemExit)
            )
            self.join(POLL)

    def result(self) -> T:
        if self._error is not None:
            raise self._error
        return self._results[0]


@contextmanager
def uncollected() -> Iterator[None]:
    """Let the garbage collector rest while many objects are made, nearly all of which are kept.

    It would go through all of them again and again.
    """
    worked = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if worked:
            gc.enable()


# --- interruption ----------------------------------------------------------------------------

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
SOON = 0.01  # [s], when a callback is over


@dataclass
class Interrupts:
    """Which signals were received, and whether they may interrupt."""

    received: int | None = None  # the last one
    raised: int = 0  # how often an interrupt was raised
    late: bool = False  # one was received while signals were held back
    held: int = 0  # how many parts of the program hold signals back
    once: bool = False  # after the first one, results are saved, and signals held back

    def take(self, number: int, _frame: FrameType | None) -> None:
        """Interrupt now, or later if signals are held back."""
        self.received = number
        if self.held:
            if self.late and self.once and self.held == 1:  # nothing is half done
                self.interrupt()
            self.late = True
            return
        if self.once:
            self.held += 1
        self.interrupt()

    def interrupt(self) -> NoReturn:
        """Raise an interrupt, and count it."""
        self.raised += 1
        raise KeyboardInterrupt

    def repeat(self) -> None:
        """Interrupt again soon: what was raised in a callback or a destructor is lost."""
        if self.once and self.held:
            self.held -= 1
        main = threading.main_thread().ident
        threading.Timer(SOON, signal.pthread_kill, [main, self.received]).start()

    def release(self, held: int) -> None:
        """Interrupt now, if a signal was held back and nothing holds signals back any longer."""
        self.held = held
        if self.late and not held:
            self.late = False
            self.interrupt()


_interrupts = Interrupts()


@contextmanager
def interruptible() -> Iterator[Interrupts]:
    """Let Ctrl-C, SIGTERM and SIGHUP interrupt, unless whoever started the process ignores them."""
    _interrupts.received, _interrupts.late, _interrupts.held = None, False, 0
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in SIGNALS:
            if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                before[number] = signal.signal(number, _interrupts.take)
    hook = sys.unraisablehook

    def notice(lost: sys.UnraisableHookArgs) -> None:
        if _interrupts.received is not None and issubclass(lost.exc_type, KeyboardInterrupt):
            _interrupts.repeat()
        else:
            hook(lost)

    sys.unraisablehook = notice
    try:
        yield _interrupts
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Raise an interrupt as itself where compiled code turned it into another error.

    Such code calls Python to convert an argument, for example, and takes an interrupt in that call
    for an argument of a wrong type.
    """
    before = _interrupts.raised
    try:
        yield
    except (Exception, SystemExit) as error:
        if _interrupts.raised > before:
            raise KeyboardInterrupt from error
        raise


@contextmanager
def held() -> Iterator[None]:
    """Hold signals back while something must not be interrupted; then they interrupt."""
    if threading.current_thread() is not threading.main_thread():  # other threads receive none
        yield
        return
    before = _interrupts.held
    _interrupts.held += 1
    try:
        yield
    except BaseException:
        _interrupts.held = before
        raise
    _interrupts.release(before)


@contextmanager
def saved() -> Iterator[Callable[[], None]]:
    """Let one signal interrupt, and hold the next one back until the results are saved.

    A third one interrupts the saving. The function that is yielded holds signals back once it is
    called, when all results are there.
    """

    def hold() -> None:
        _interrupts.held = max(_interrupts.held, 1)

    before, _interrupts.once = _interrupts.held, True
    try:
        yield hold
    except BaseException:
        _interrupts.held = before
        raise
    finally:
        _interrupts.once = False
    _interrupts.release(before)
