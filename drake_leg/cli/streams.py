"""The standard streams: if their reader has gone, the program goes on."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


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
