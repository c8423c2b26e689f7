"""Signals that end a command: told as KeyboardInterrupt, held back while something is saved."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass
class Interrupts:
    """Which signals have come, and whether they may interrupt."""

    received: int | None = None
    late: bool = False  # one came while it was held back
    held: int = 0  # how many hold signals back
    once: bool = False  # what the first one leaves is saved

    def take(self, number: int, _frame: FrameType | None) -> None:
        """Interrupt, or remember that it is to be done."""
        self.received = number
        if self.held:
            if self.late and self.once and self.held == 1:  # nothing is half done
                raise KeyboardInterrupt
            self.late = True
            return
        if self.once:
            self.held += 1
        raise KeyboardInterrupt

    def release(self, held: int) -> None:
        """Interrupt now, if a signal was held back and nothing holds it any longer."""
        self.held = held
        if self.late and not held:
            self.late = False
            raise KeyboardInterrupt


_interrupts = Interrupts()


@contextmanager
def heeded() -> Iterator[Interrupts]:
    """Let Ctrl-C, SIGTERM and SIGHUP interrupt, unless whoever started the process ignores them.

    Yields
    ------
    Interrupts
        With the signal that was received last.
    """
    _interrupts.received, _interrupts.late, _interrupts.held = None, False, 0
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in SIGNALS:
            if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                before[number] = signal.signal(number, _interrupts.take)
    try:
        yield _interrupts
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def held() -> Iterator[None]:
    """Hold signals back while something must be done whole; then they interrupt."""
    if threading.current_thread() is not threading.main_thread():  # none comes to others
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
    """Let one signal interrupt, and hold the next one back until what it left is saved.

    A third one gives that up.

    Yields
    ------
    callable
        Holds signals back from now on, for what there is is whole.
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
