"""The one place that opens files to read: regular ones of a sensible size, and nothing else."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path

from drake_leg.errors import UnreadableFileError

LARGEST_TEXT = 4 << 20  # bytes of a file that a person wrote
LARGEST_RECORDING = 4 << 30  # bytes


@contextmanager
def opened(path: Path, *, most: int = LARGEST_TEXT) -> Iterator[BufferedReader]:
    """Open a file; never wait on a pipe or a device.

    Parameters
    ----------
    most : int
        Bytes that it may have.

    Raises
    ------
    UnreadableFileError
        With the reason.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from None
    try:
        _require_regular(path, os.fstat(descriptor), most)
    except UnreadableFileError:
        os.close(descriptor)
        raise
    with os.fdopen(descriptor, "rb") as file:
        try:
            yield file
        except OSError as error:
            raise _unreadable(path, error) from None


def _require_regular(path: Path, status: os.stat_result, most: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        raise UnreadableFileError(path, f"it is {_kind(status.st_mode)}; give a file")
    if status.st_size > most:
        raise UnreadableFileError(path, _too_large(status.st_size, most))


def read_bytes(path: Path, *, most: int = LARGEST_TEXT) -> bytes:
    """Read a whole file.

    Parameters
    ----------
    most : int
        Bytes that it may have.

    Raises
    ------
    UnreadableFileError
        With the reason.
    """
    with opened(path, most=most) as file:
        content = file.read(most + 1)  # what calls itself empty, as in /proc, may never end
    if len(content) > most:
        raise UnreadableFileError(path, _too_large(len(content), most))
    return content


def read_text(path: Path, *, most: int = LARGEST_TEXT) -> str:
    """Read a whole file of text.

    Parameters
    ----------
    path : Path
        Text in UTF-8, with or without a byte order mark.
    most : int
        Bytes that it may have.

    Returns
    -------
    str
        Its lines end in a line feed.

    Raises
    ------
    UnreadableFileError
        With the reason.
    """
    try:
        text = read_bytes(path, most=most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        byte = error.object[error.start]
        raise UnreadableFileError(
            path, f"it is no text in UTF-8 (byte {error.start} is 0x{byte:02x}); save it as UTF-8"
        ) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _unreadable(path: Path, error: Exception) -> UnreadableFileError:
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return UnreadableFileError(path, reason)


def _kind(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "no regular file"


def _too_large(size: int, most: int) -> str:
    return f"it has {size} bytes or more, and at most {most} are read; give the right file"
