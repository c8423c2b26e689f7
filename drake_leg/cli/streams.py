"""The terminal's streams: a reader that has gone away changes nothing."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class _Patient(io.FileIO):
    """Writes; goes on in silence when nobody reads any longer, and after it has failed once."""

    _deaf = False

    def write(self, data: ReadableBuffer) -> int:
        """Write, or let the rest of what is said be lost."""
        if self._deaf:
            return memoryview(data).nbytes
        try:
            return super().write(data)
        except BrokenPipeError:
            self._deaf = True
            return memoryview(data).nbytes
        except OSError:
            self._deaf = True
            raise


@contextmanager
def patient_streams() -> Iterator[None]:
    """Let a closed pipe be no error, and write what the terminal cannot show as escapes."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _patient(sys.stdout), _patient(sys.stderr)
    try:
        yield
    finally:
        for stream, old in zip((sys.stdout, sys.stderr), before, strict=True):
            if stream is not old:
                with suppress(OSError):
                    stream.flush()
        sys.stdout, sys.stderr = before


def _patient(stream: TextIO) -> TextIO:
    """Replace a stream that ends in a file, a pipe or a terminal."""
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    stream.reconfigure(errors="backslashreplace")
    buffered = hasattr(stream.buffer, "raw")
    if not isinstance(stream.buffer.raw if buffered else stream.buffer, io.FileIO):
        return stream
    with suppress(OSError):
        stream.flush()
    end = _Patient(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(
        io.BufferedWriter(end) if buffered else end,
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
