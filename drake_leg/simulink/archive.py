"""The parts of a model's file, read within limits as trees; nothing is unpacked to the disk."""

from __future__ import annotations

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import ParseError, XMLParser

from drake_leg.errors import InvalidValueError, UnreadableFileError
from drake_leg.files import read_bytes
from drake_leg.simulink.text_model import is_package, parts_of_package, tree_of

LARGEST_FILE = 64 << 20  # bytes, packed
LARGEST_DIRECTORY = 4 << 20  # bytes of the list of parts
MOST_PARTS = 20_000
LARGEST_PART = 64 << 20  # bytes, unpacked
LARGEST_TOTAL = 256 << 20  # bytes, unpacked
HIGHEST_RATIO = 200  # unpacked to packed, of parts above 1 MiB
DEEPEST = 200  # elements in elements
MOST_ELEMENTS = 1_000_000

_END_OF_DIRECTORY = struct.Struct("<4s4H2LH")
_SMALL = 1 << 20
WHOLE = "simulink/blockdiagram.xml"  # the part that has all in older files

_TEXT_MODEL = re.compile(rb"\s*(#[^\n]*\n\s*)*(Model|Library|Subsystem)\s*\{")
_DAMAGES = (
    *(zipfile.BadZipFile, zlib.error, OSError, EOFError),
    *(NotImplementedError, RuntimeError, ValueError, struct.error),
)
_DAMAGED = "it is cut short or damaged: copy the file again or save the model again"


class Parts(Protocol):
    """The parts of one file."""

    def names(self) -> tuple[str, ...]:
        """Return the names of all parts."""
        ...

    def tree(self, name: str) -> Element | None:
        """Return a part as a tree; None where the file has no such part."""
        ...

    def read(self, name: str) -> bytes | None:
        """Return a part as it is; None where the file has no such part."""
        ...


def parts_of(content: bytes) -> Parts:
    """Open the content of a file, .slx or .mdl, as `content_of` reads it.

    Raises
    ------
    InvalidValueError
        If it is none or is damaged.
    """
    if is_package(content):
        return _TextParts(parts_of_package(content))
    if _TEXT_MODEL.match(content[:4096]):
        return _TextParts({WHOLE: tree_of(content)})
    return Archive(content)


class _TextParts:
    """The parts of a .mdl: a text of several, or a single one."""

    def __init__(self, parts: Mapping[str, bytes | Element]) -> None:
        self._parts = parts

    def names(self) -> tuple[str, ...]:
        return tuple(self._parts)

    def tree(self, name: str) -> Element | None:
        part = self._parts.get(name)
        return parse_markup(part, name) if isinstance(part, bytes) else part

    def read(self, name: str) -> bytes | None:
        part = self._parts.get(name)
        return part if isinstance(part, bytes) else None


class Archive:
    """The parts of a .slx, held in memory."""

    def __init__(self, content: bytes) -> None:
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(content))
            self._entries = _checked(self._archive.infolist())
        except InvalidValueError:
            raise
        except (zipfile.BadZipFile, ValueError, struct.error, EOFError, OverflowError):
            raise InvalidValueError(_DAMAGED) from None
        except (NotImplementedError, OSError) as error:
            raise InvalidValueError(f"it cannot be opened ({error})") from None

    def names(self) -> tuple[str, ...]:
        """Return the names of all parts."""
        return tuple(self._entries)

    def tree(self, name: str) -> Element | None:
        """Return a part as a tree; None where the file has no such part."""
        content = self.read(name)
        return None if content is None else parse_markup(content, name)

    def read(self, name: str) -> bytes | None:
        """Read a part; None where the file has no such part."""
        entry = self._entries.get(name)
        if entry is None:
            return None
        try:
            with self._archive.open(entry) as part:
                content = part.read(entry.file_size + 1)
        except _DAMAGES:
            raise InvalidValueError(
                f"its part {name} is damaged: save the model again or copy the file again"
            ) from None
        if len(content) != entry.file_size:
            raise InvalidValueError(f"its part {name} is cut short: copy the file again")
        return content


def parse_markup(content: bytes, part: str) -> Element:
    """Parse one part, which must have no document type and no entities."""
    tree = TreeBuilder()
    parser = XMLParser(target=tree, forbid_dtd=True)
    if content.count(b"<") - content.count(b"</") > MOST_ELEMENTS:
        raise _too_large(part)
    try:
        parser.feed(content)
        root: Element = parser.close()
    except DefusedXmlException:
        raise InvalidValueError(
            f"its part {part} declares a document type or an entity, which no Simulink file does: "
            "save the model again in Simulink"
        ) from None
    except ParseError as error:
        _require_shallow(tree.close(), part)
        raise InvalidValueError(
            f"its part {part} is not XML ({expat.ErrorString(error.code)}, line "
            f"{error.position[0]}): save the model again in Simulink"
        ) from None
    except (LookupError, UnicodeError) as error:
        raise InvalidValueError(
            f"its part {part} is in an encoding that is not supported ({error}): save the model "
            "again in Simulink"
        ) from None
    _require_shallow(root, part)
    return root


def _require_shallow(root: Element | None, part: str) -> None:
    level = [] if root is None else [root]
    for _ in range(DEEPEST):
        level = [child for element in level for child in element]
    if level:
        raise _too_large(part)


def _too_large(part: str) -> InvalidValueError:
    return InvalidValueError(
        f"its part {part} is deeper than {DEEPEST} levels or longer than {MOST_ELEMENTS} elements, "
        "as no model is"
    )


def parameters(element: Element) -> dict[str, str]:
    """Return the ``<P Name="...">`` directly under an element, name to text.

    Those whose value is in another part are left out.
    """
    return {
        child.get("Name", ""): child.text or ""
        for child in element
        if child.tag == "P" and child.get("Ref") is None
    }


def one_line(text: str) -> str:
    """Return a name with its line breaks as spaces."""
    return " ".join(text.splitlines())


def plain_name(text: str) -> str:
    """Return a name with one space wherever it has some, line breaks included."""
    return " ".join(text.split())


def content_of(path: Path) -> bytes:
    """Read the file, or explain why it is no model."""
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
    if _TEXT_MODEL.match(head) or is_package(head):
        return content
    if not head.startswith(b"PK"):
        raise InvalidValueError(
            "it is not a ZIP archive, as every .slx is, nor a .mdl: choose a model's file"
        )
    end = tail.rfind(b"PK\x05\x06")
    if end < 0 or len(tail) - end < _END_OF_DIRECTORY.size:
        raise InvalidValueError(_DAMAGED)
    if _END_OF_DIRECTORY.unpack_from(tail, end)[5] > LARGEST_DIRECTORY:
        raise InvalidValueError("it lists more parts than any model has: it is not a .slx")
    return content


def _checked(entries: list[zipfile.ZipInfo]) -> Mapping[str, zipfile.ZipInfo]:
    if len(entries) > MOST_PARTS:
        raise InvalidValueError(f"it has {len(entries)} parts, more than any model ({MOST_PARTS})")
    total = 0
    checked: dict[str, zipfile.ZipInfo] = {}
    for entry in entries:
        name = entry.filename
        if name in checked:
            raise InvalidValueError(f"it has two parts named {name!r}: save the model again")
        if entry.flag_bits & 0x1:
            raise InvalidValueError(
                f"its part {name!r} is encrypted: save the model without a password"
            )
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise InvalidValueError(
                f"its part {name!r} is packed in a way that Simulink does not use: save the model "
                "again"
            )
        total += entry.file_size
        if entry.file_size > LARGEST_PART or total > LARGEST_TOTAL:
            raise InvalidValueError(
                f"its parts unpack to more than {LARGEST_TOTAL >> 20} MiB (one: "
                f"{LARGEST_PART >> 20} MiB), at {name!r}: it is not a .slx, or it is a ZIP bomb"
            )
        if entry.file_size > max(_SMALL, HIGHEST_RATIO * entry.compress_size):
            raise InvalidValueError(
                f"its part {name!r} unpacks to more than {HIGHEST_RATIO} times its size: it is "
                "not a .slx, or it is a ZIP bomb"
            )
        checked[name] = entry
    return checked
