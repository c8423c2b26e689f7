"""The command line ``drake-leg``: the only place that prints.

Exit status: 0 all well; 1 ``check`` found something wrong, a run's error can be seen in its
figures, or a picture could not be made (the data are saved); 2 bad input, or a place that cannot
be written; 3 a run stopped before its end (what it recorded is saved), or a proof or derivation at
its time limit; 70 an unexpected error; 130 Ctrl-C; 128 + n another signal n.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import NoReturn

from drake_leg.progress import Interrupts, interruptible

__all__ = ["main"]

UNEXPECTED, INTERRUPTED = 70, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line, by default with the process's arguments.

    Whatever goes wrong, also while modules load, becomes one sentence.
    """
    with interruptible() as interrupts:
        try:
            status = _result(arguments)
        except KeyboardInterrupt:  # between the parts that answer it themselves
            status = _print_error("interrupted", INTERRUPTED)
        status = _of_signal(interrupts, status)
    if arguments is None and interrupts.received is not None:
        _leave(status)
    return status


def _leave(status: int) -> NoReturn:
    """End the process with a status, at once.

    Python ends a process by SIGINT, whatever its status, if Ctrl-C has ever left code that a
    compiled module runs as text, as Drake's modules do while they load.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):  # none, gone, closed
            stream.flush()
    os._exit(status)


def _result(arguments: Sequence[str] | None) -> int:
    from drake_leg.cli.streams import tolerant_streams

    with tolerant_streams():
        try:
            from drake_leg.cli import entry

            return entry.main(arguments)
        except KeyboardInterrupt:
            return _print_error("interrupted", INTERRUPTED)
        except Exception as error:
            if isinstance(error, ImportError) and _is_interrupt(error):
                return _print_error("interrupted", INTERRUPTED)
            return _unexpected(error)


def _of_signal(interrupts: Interrupts, status: int) -> int:
    """Return the exit status, or that of a process that a signal ended; commands handle Ctrl-C."""
    if interrupts.received in (None, signal.SIGINT):
        return status
    return 128 + interrupts.received


def _unexpected(error: Exception) -> int:
    from drake_leg.cli.terminal import TRACEBACK, show_traceback
    from drake_leg.errors import in_a_line

    show_traceback()
    return _print_error(
        f"an unexpected error ({in_a_line(error)}): please report it, with the command "
        f"that you gave; {TRACEBACK}=1 in front of the command shows where it comes from",
        UNEXPECTED,
    )


def _print_error(sentence: str, status: int) -> int:
    try:
        print(f"drake-leg: {sentence}", file=sys.stderr)
    except OSError:  # the terminal has gone
        return status
    return status


def _is_interrupt(error: BaseException | None) -> bool:
    """Tell whether Ctrl-C made an import fail, as it does for a compiled module."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
