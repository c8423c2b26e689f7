"""The parts of a .slx file, read into memory within limits; nothing is unpacked to the disk."""

from __future__ import annotations

import io
import re
import stat
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from types import TracebackType

from drake_leg.errors import InvalidValueError, UnreadableFileError
from drake_leg.files import read_bytes

LARGEST_FILE = 64 << 20  # bytes, packed
LARGEST_DIRECTORY = 4 << 20  # bytes of the list of parts
MOST_PARTS = 20_000
LARGEST_PART = 64 << 20  # bytes, unpacked
LARGEST_TOTAL = 256 << 20  # bytes, unpacked
HIGHEST_RATIO = 200  # unpacked to packed, of parts above 1 MiB

_END_OF_DIRECTORY = struct.Struct("<4s4H2LH")
_SMALL = 1 << 20
_TEXT_MODEL = re.compile(rb"\s*(#[^\n]*\n\s*)*(Model|Library|Subsystem)\s*\{")


class Parts:
    """The parts of one file; a context manager."""

    def __init__(self, path: Path) -> None:
        content = _content(path)
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(content))
            self._entries = _checked(self._archive.infolist())
        except (zipfile.BadZipFile, ValueError, struct.error, EOFError, OverflowError) as error:
            if isinstance(error, InvalidValueError):
                self._archive.close()
                raise
            raise _damaged() from None
        except (NotImplementedError, OSError) as error:
            raise InvalidValueError(f"it cannot be opened ({error})") from None

    def __enter__(self) -> Parts:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._archive.close()

    def names(self) -> tuple[str, ...]:
        """Return the names of all parts."""
        return tuple(self._entries)

    def read(self, name: str) -> bytes | None:
        """Read a part.

        Returns
        -------
        bytes or None
            None where the file has no such part.

        Raises
        ------
        InvalidValueError
            If it is damaged.
        """
        entry = self._entries.get(name)
        if entry is None:
            return None
        try:
            with self._archive.open(entry) as part:
                content = part.read(entry.file_size + 1)
        except (
            zipfile.BadZipFile,
            zlib.error,
            OSError,
            EOFError,
            NotImplementedError,
            RuntimeError,
            ValueError,
            struct.error,
        ):
            raise InvalidValueError(
                f"its part {name} is damaged: save the model again or copy the file again"
            ) from None
        if len(content) != entry.file_size:
            raise InvalidValueError(f"its part {name} is cut short: copy the file again")
        return content


def _content(path: Path) -> bytes:
    """Read the file, or say what it is if it is no .slx."""
    try:
        content = read_bytes(path, most=LARGEST_FILE)
    except UnreadableFileError as error:
        raise InvalidValueError(f"it cannot be read ({error.reason})") from None
    head = content[:4096]
    tail = content[-(1 << 16) - _END_OF_DIRECTORY.size :]
    if path.suffix.lower() == ".slxp":
        raise InvalidValueError(
            "it is a protected model, whose diagram is encrypted: ask its author for the .slx"
        )
    if _TEXT_MODEL.match(head) or head.startswith(b"# MathWorks OPC Text Package"):
        raise InvalidValueError(
            "it is a .mdl, Simulink's older text format: open it in Simulink and save it as .slx"
        )
    if not head.startswith(b"PK"):
        raise InvalidValueError("it is no ZIP archive, which every .slx is: give a model's .slx")
    end = tail.rfind(b"PK\x05\x06")
    if end < 0 or len(tail) - end < _END_OF_DIRECTORY.size:
        raise _damaged()
    if _END_OF_DIRECTORY.unpack_from(tail, end)[5] > LARGEST_DIRECTORY:
        raise InvalidValueError("it lists more parts than any model has: it is no .slx")
    return content


def _damaged() -> InvalidValueError:
    return InvalidValueError(
        "it is cut short or damaged: copy the file again or save the model again"
    )


def _checked(entries: list[zipfile.ZipInfo]) -> Mapping[str, zipfile.ZipInfo]:
    if len(entries) > MOST_PARTS:
        raise InvalidValueError(f"it has {len(entries)} parts, more than any model ({MOST_PARTS})")
    total = 0
    checked: dict[str, zipfile.ZipInfo] = {}
    for entry in entries:
        name = entry.filename
        _require_plain(entry)
        if name in checked:
            raise InvalidValueError(f"it has two parts named {name!r}: save the model again")
        total += entry.file_size
        if entry.file_size > LARGEST_PART or total > LARGEST_TOTAL:
            raise InvalidValueError(
                f"its parts unpack to more than {LARGEST_TOTAL >> 20} MiB (one: "
                f"{LARGEST_PART >> 20} MiB), at {name!r}: it is no .slx, or a ZIP bomb"
            )
        if entry.file_size > max(_SMALL, HIGHEST_RATIO * entry.compress_size):
            raise InvalidValueError(
                f"its part {name!r} unpacks to more than {HIGHEST_RATIO} times its size: it is no "
                ".slx, or a ZIP bomb"
            )
        checked[name] = entry
    return checked


def _require_plain(entry: zipfile.ZipInfo) -> None:
    name = entry.orig_filename
    path = PurePosixPath(name.replace("\\", "/"))
    if path.is_absolute() or ".." in path.parts or ":" in name or "\0" in name:
        raise InvalidValueError(f"its part {name!r} has a path that leads outside: it is no .slx")
    if stat.S_ISLNK(entry.external_attr >> 16):
        raise InvalidValueError(f"its part {name!r} is a symbolic link: it is no .slx")
    if entry.flag_bits & 0x1:
        raise InvalidValueError(
            f"its part {name!r} is encrypted: save the model without a password"
        )
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise InvalidValueError(
            f"its part {name!r} is packed in a way that Simulink does not use: save the model again"
        )
