"""Drawn lines, with all their branches, and the ports that they end at."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.markup import one_line, parameters

_PORT = re.compile(r"(?P<sid>[^#]+)#(?P<kind>[A-Za-z]+)(?::(?P<number>\d{1,6}))?")
_PHYSICAL = ("lconn", "rconn")


@dataclass(frozen=True, kw_only=True)
class DrawnLine:
    """A line with all its branches."""

    name: str
    physical: bool
    source: str  # port; "" where the line hangs, and of physical lines
    ends: tuple[str, ...]  # ports; of a physical line all of them


def read_line(element: Element) -> DrawnLine:
    """Read a line.

    Parameters
    ----------
    element : Element
        ``<Line>``, with its branches.

    Raises
    ------
    InvalidValueError
        If it ends at what is no port.
    """
    texts = parameters(element)
    ends = [_port(text) for text in _ends(element, texts)]
    physical = any(split_port(end)[1] in _PHYSICAL for end in ends)
    source = "" if physical or "Src" not in texts else _port(texts["Src"])
    if source:
        ends.remove(source)
    return DrawnLine(
        name=one_line(texts.get("Name", "")), physical=physical, source=source, ends=tuple(ends)
    )


def _ends(element: Element, texts: dict[str, str]) -> Iterator[str]:
    """Walk through a line and its branches, at whatever end they hold a port."""
    for key in ("Src", "Dst"):
        if texts.get(key):
            yield texts[key]
    for branch in element:
        if branch.tag == "Branch":
            yield from _ends(branch, parameters(branch))


def _port(text: str) -> str:
    found = _PORT.fullmatch(text.strip())
    if not found:
        raise InvalidValueError(
            f"a line ends at {text[:60]!r}, which is no port (5#in:1): save the model again in "
            "Simulink"
        )
    return f"{found['sid']}#{found['kind']}:{int(found['number'] or 1)}"


def split_port(port: str) -> tuple[str, str, int]:
    """Take a port apart.

    Returns
    -------
    kind : str
        ``in``, ``out``, ``lconn``, ``rconn``, ``enable``, ...
    """
    sid, _, rest = port.partition("#")
    kind, _, number = rest.partition(":")
    return sid, kind, int(number)
