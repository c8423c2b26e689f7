"""The command line ``drake-leg``: the only place that prints.

Exit status: 0 all well; 1 ``check`` found something wrong, a run's error can be seen in its
figures, or a picture could not be made (the data are saved); 2 bad input, or a place that cannot
be written; 3 a run stopped before its end (what it recorded is saved), or a proof or derivation at
its time limit; 70 an unexpected error; 130 Ctrl-C; 128 + n another signal n.
"""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, NoReturn, TextIO

from drake_leg.progress import Interrupts, interruptible, interrupts_kept

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

__all__ = ["main"]

UNEXPECTED, INTERRUPTED = 70, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line, by default with the process's arguments.

    Whatever goes wrong, also while modules load, becomes one sentence.
    """
    if arguments is None:
        _multiply_alone()
    with interruptible() as interrupts:
        try:
            status = _result(arguments)
        except KeyboardInterrupt:  # between the parts that answer it themselves
            status = _print_error("interrupted", INTERRUPTED)
        status = _of_signal(interrupts, status)
    if arguments is None and interrupts.received is not None:
        _leave(status)
    return status


def _multiply_alone() -> None:
    """Let one thread compute with matrices, unless the user says otherwise.

    A robot's are so small that sharing them among threads takes longer than computing them, and
    where other programs are busy, a hundred times as long. NumPy and SciPy read this as they load.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


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
    with tolerant_streams():
        try:
            with interrupts_kept():
                from drake_leg.cli import entry

                return entry.main(arguments)
        except KeyboardInterrupt:
            return _print_error("interrupted", INTERRUPTED)
        except Exception as error:
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


class _Tolerant(io.FileIO):
    """Writes, and stops writing without an error when the reader has gone."""

    _closed_pipe = False

    def write(self, data: ReadableBuffer) -> int:
        """Write, or drop the rest of the output."""
        if self._closed_pipe:
            return memoryview(data).nbytes
        try:
            return super().write(data)
        except BrokenPipeError:
            self._closed_pipe = True
            return memoryview(data).nbytes
        except OSError:
            self._closed_pipe = True
            raise


@contextmanager
def tolerant_streams() -> Iterator[None]:
    """Tolerate a closed pipe, and write what the terminal cannot show as escapes."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _tolerant(sys.stdout), _tolerant(sys.stderr)
    try:
        yield
    finally:
        for stream, old in zip((sys.stdout, sys.stderr), before, strict=True):
            if stream is not old:
                with suppress(OSError):
                    stream.flush()
        sys.stdout, sys.stderr = before


def _tolerant(stream: TextIO) -> TextIO:
    """Replace a stream that writes to a file, a pipe or a terminal."""
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    stream.reconfigure(errors="backslashreplace")
    buffered = hasattr(stream.buffer, "raw")
    if not isinstance(stream.buffer.raw if buffered else stream.buffer, io.FileIO):
        return stream
    with suppress(OSError):
        stream.flush()
    end = _Tolerant(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(
        io.BufferedWriter(end) if buffered else end,
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
