"""Live scripts (.mlx): MATLAB code between formatted text, kept in an archive."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import LARGEST_FILE, Archive

_PART = "matlab/document.xml"
_W = "{http://schemas.openxmlformats.org/wordprocessingml/2006/main}"


def code_of(path: Path) -> str:
    """Read the code of a live script or live function; its text and its results are left out.

    Raises
    ------
    InvalidValueError
        If it is none, or is damaged.
    """
    if path.stat().st_size > LARGEST_FILE:
        raise InvalidValueError(f"{path.name} is larger than {LARGEST_FILE:,} bytes")
    try:
        document = Archive(path.read_bytes()).tree(_PART)
    except InvalidValueError as error:
        raise InvalidValueError(f"{path.name}: {error}") from None
    if document is None:
        raise InvalidValueError(f"{path.name} is no live script: save it again as .m")
    return "\n".join(_text(each) for each in document.iter(f"{_W}p") if _is_code(each))


def _is_code(paragraph: Element) -> bool:
    styles = paragraph.iterfind(f"{_W}pPr/{_W}pStyle")
    return any(style.get(f"{_W}val") == "code" for style in styles)


def _text(paragraph: Element) -> str:
    return "".join(each.text or "" for each in paragraph.iterfind(f"{_W}r/{_W}t"))
