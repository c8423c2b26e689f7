"""The text format of Simulink's older models, .mdl, as the trees of the newer ones."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Iterator
from itertools import count
from xml.etree.ElementTree import Element, SubElement

from drake_leg.errors import InvalidValueError

DEEPEST = 200  # sections in sections
MOST_ENTRIES = 2_000_000

_PACKAGE = b"# MathWorks OPC Text Package"
_PART = re.compile(rb"^__MWOPC_PART_BEGIN__ (/[^ \r\n]+)( BASE64)?[ \t]*\r?\n", re.MULTILINE)
_TOKEN = re.compile(
    r"""[ \t\r\n]+|\#[^\n]*
    |(?P<string>"(?:[^"\\]|\\.)*")
    |(?P<open>\{)|(?P<close>\})
    |(?P<list>\[[^\]]*\])
    |(?P<word>[^\s{}"\[\]]+)""",
    re.VERBOSE | re.DOTALL,
)
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r"}
_ESCAPED = re.compile(r"\\(.)", re.DOTALL)
_ATTRIBUTES = {
    "Block": ("BlockType", "Name", "SID"),
    "Object": ("ClassName", "PropName"),
    "Array": ("PropName",),
    "chart": ("id",),
}
_CONNECTOR = re.compile(r"([LR])Conn(\d{1,6})")


def is_package(content: bytes) -> bool:
    """Whether a text is a package of parts, as .mdl files are since R2021b."""
    return content.startswith(_PACKAGE)


def parts_of_package(content: bytes) -> dict[str, bytes]:
    """Return the parts of a package by name.

    Raises
    ------
    InvalidValueError
        If a part is damaged.
    """
    marks = list(_PART.finditer(content))
    ends = [mark.start() for mark in marks[1:]] + [len(content)]
    found = {}
    for mark, end in zip(marks, ends, strict=True):
        name, part = mark[1].decode(errors="replace").lstrip("/"), content[mark.end() : end]
        if mark[2]:
            try:
                part = base64.b64decode(part)
            except binascii.Error:
                raise InvalidValueError(
                    f"its part {name} is damaged: copy the file again"
                ) from None
        found[name] = part.strip()
    return found


def tree_of(content: bytes) -> Element:
    """Return a .mdl as the tree that ``blockdiagram.xml`` has in a .slx.

    Raises
    ------
    InvalidValueError
        If it is cut short or damaged.
    """
    root = Element("ModelInformation")
    _fill(root, content.decode("utf-8", errors="replace"))
    numbers = count(1)
    for block in root.iter("Block"):
        if not block.get("SID"):  # before R2011
            block.set("SID", f"n{next(numbers)}")
    for system in root.iter("System"):
        _name_ends(system)
    _put_code_into_charts(root)
    return root


def _fill(root: Element, text: str) -> None:
    """Read sections, ``name { ... }``, and their entries, ``name value``."""
    sections, name, value = [root], "", None
    for kind, token in _tokens(text):
        if kind == "string" and value is not None:  # continued on the next line
            value.text = (value.text or "") + _unescaped(token)
        elif kind == "open":
            if not name:
                raise _damaged("a section has no name")
            sections.append(_section(sections[-1], name))
            if len(sections) > DEEPEST:
                raise _damaged(f"its sections lie more than {DEEPEST} deep")
            name, value = "", None
        elif kind == "close":
            if len(sections) == 1 or name:
                raise _damaged("a section ends that did not begin, or an entry has no value")
            _settle(sections.pop())
            value = None
        elif not name:
            if kind != "word":
                raise _damaged("a value has no name")
            name, value = token, None
        else:
            value = SubElement(sections[-1], "P", Name=name.lstrip("$"))
            value.text = _unescaped(token) if kind == "string" else token
            name, value = "", value if kind == "string" else None
    if len(sections) > 1 or name:
        raise _damaged("it ends within a section")


def _tokens(text: str) -> Iterator[tuple[str, str]]:
    place = 0
    for _ in range(MOST_ENTRIES):
        found = _TOKEN.match(text, place)
        if found is None:
            break
        place = found.end()
        if found.lastgroup:
            yield found.lastgroup, found.group()
    if place < len(text):
        raise _damaged(f"line {text.count(chr(10), 0, place) + 1} makes no sense")


def _section(parent: Element, name: str) -> Element:
    if "." in name:  # a class: Simulink.SolverCC
        return SubElement(parent, "Object", ClassName=name)
    return SubElement(parent, name)


def _settle(section: Element) -> None:
    """Make attributes of the entries that are such in a .slx."""
    for name in _ATTRIBUTES.get(section.tag, ()):
        for entry in section.findall("P"):
            if entry.get("Name") == name:
                section.set(name, entry.text or "")
                section.remove(entry)


def _name_ends(system: Element) -> None:
    """Let the lines of a system end at ports, ``5#in:1``, and not at the names of blocks."""
    sids = {block.get("Name"): block.get("SID", "") for block in system.findall("Block")}
    for line in (inside for drawn in system.findall("Line") for inside in drawn.iter()):
        if line.tag not in ("Line", "Branch"):
            continue
        entries = {entry.get("Name"): entry.text or "" for entry in line.findall("P")}
        for side, kind in (("Src", "out"), ("Dst", "in")):
            block = entries.get(f"{side}Block")
            if block is not None and block in sids:
                port = _port(entries.get(f"{side}Port", "1"), kind)
                SubElement(line, "P", Name=side).text = f"{sids[block]}#{port}"


def _port(text: str, kind: str) -> str:
    connector = _CONNECTOR.fullmatch(text)
    if connector:
        return f"{connector[1].lower()}conn:{connector[2]}"
    return f"{kind}:{text}" if text.isdecimal() else text


def _put_code_into_charts(root: Element) -> None:
    """Put the code of a MATLAB Function, which is in a state, into its chart."""
    charts = {chart.get("id"): chart for chart in root.iter("chart")}
    for state in list(root.iter("state")):
        texts = {entry.get("Name"): entry.text for entry in state.findall("P")}
        chart = charts.get(texts.get("chart"))
        if chart is not None:
            chart.extend(state.findall("eml"))


def _unescaped(token: str) -> str:
    return _ESCAPED.sub(lambda found: _ESCAPES.get(found[1], found[1]), token[1:-1])


def _damaged(why: str) -> InvalidValueError:
    return InvalidValueError(f"it is a .mdl that is cut short or damaged ({why}): copy it again")
