"""The command line ``drake-leg``: the only place that prints.

Exit status: 0 when all went well, 1 when ``check`` found something wrong, a run's error can be seen
in its figures, or a picture could not be made (the data are saved), 2 for bad input or a place that
cannot be written, 3 when a run stopped before its end (what it recorded until then is saved), or a
proof or derivation at its time budget, 70 for an unexpected error, 130 on Ctrl-C,
128 + n on another signal n. A reader of the output that goes away changes nothing.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence

from drake_leg.progress import Interrupts, interruptible

__all__ = ["main"]

UNFORESEEN, INTERRUPTED = 70, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; whatever goes wrong, while it loads, too, is one sentence.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; by default the process's own.
    """
    with interruptible() as interrupts:
        return _of_signal(interrupts, _carried_out(arguments))


def _carried_out(arguments: Sequence[str] | None) -> int:
    from drake_leg.cli.streams import patient_streams

    with patient_streams():
        try:
            from drake_leg.cli import entry

            return entry.main(arguments)
        except KeyboardInterrupt:
            return _said("interrupted", INTERRUPTED)
        except Exception as error:
            if isinstance(error, ImportError) and _is_interrupt(error):
                return _said("interrupted", INTERRUPTED)
            return _unforeseen(error)


def _of_signal(interrupts: Interrupts, status: int) -> int:
    """Return what a process returns that a signal has ended; Ctrl-C is the commands' own."""
    if interrupts.received in (None, signal.SIGINT):
        return status
    return 128 + interrupts.received


def _unforeseen(error: Exception) -> int:
    from drake_leg.cli.pictures import PLACES, show_place
    from drake_leg.errors import in_a_line

    show_place()
    return _said(
        f"an unexpected error ({in_a_line(error)}): please report it, with the command "
        f"that you gave; {PLACES}=1 before it shows where it came from",
        UNFORESEEN,
    )


def _said(sentence: str, status: int) -> int:
    try:
        print(f"drake-leg: {sentence}", file=sys.stderr)
    except OSError:  # the terminal has gone
        return status
    return status


def _is_interrupt(error: BaseException | None) -> bool:
    """Tell whether an import failed by Ctrl-C, as that of a compiled module does."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
