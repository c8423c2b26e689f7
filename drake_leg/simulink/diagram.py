"""What is drawn in the systems of a file: blocks and lines with their ports, still as text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import one_line, parameters
from drake_leg.simulink.masks import Charts, Mask, read_mask
from drake_leg.simulink.model import Function, split_port

_PORT = re.compile(r"(?P<sid>[^#]+)#(?P<kind>[A-Za-z]+)(?::(?P<number>\d{1,6}))?")
_PHYSICAL = ("lconn", "rconn")
_OLD_PORTS = {"in": 0, "out": 1, "lconn": 5, "rconn": 6}  # places in <P Name="Ports">
_DEEPEST = 100  # subsystems in subsystems
_OF_THE_DRAWING = """
Position ZOrder BlockRotation BlockMirror ShowName HideAutomaticName NameLocation NamePlacement
FontName FontSize FontWeight FontAngle ForegroundColor BackgroundColor DropShadow IconDisplay
Ports LibraryVersion SourceType SourceProductName SourceProductBaseCode LibrarySourceBlock
SourceBlock ContentPreviewEnabled GraphicalSettings WindowPosition ScopeSpecificationString
ScopeGraphics Location WasSavedAsWebScope OpenFcn AttributesFormatString Description
"""
_DRAWING = frozenset(_OF_THE_DRAWING.split())
MATLAB_FUNCTION = "MATLAB Function"


@dataclass(frozen=True, kw_only=True)
class DrawnLine:
    """A line with all its branches."""

    name: str
    physical: bool
    source: str  # port; "" where the line hangs, and of physical lines
    ends: tuple[str, ...]  # ports; of a physical line all of them


def read_line(element: Element) -> DrawnLine:
    """Read a ``<Line>`` with its branches."""
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
            f"a line ends at {text[:60]!r}, which is not a port (5#in:1): save the model again in "
            "Simulink"
        )
    return f"{found['sid']}#{found['kind']}:{int(found['number'] or 1)}"


@dataclass(frozen=True, kw_only=True)
class DrawnBlock:
    """A block as it is in the file."""

    sid: str
    name: str
    path: str  # names of the subsystems that hold it and its own, a slash between; // is a slash
    type: str
    source: str
    system: str
    texts: dict[str, str]  # parameters in the file
    ports: dict[str, int]  # counts of in, out, lconn, rconn; missing ones are not told
    mask: Mask

    def __str__(self) -> str:
        return f"block {self.name!r} (SID {self.sid})"


@dataclass(frozen=True, kw_only=True)
class Diagram:
    """All systems of a model."""

    blocks: dict[str, DrawnBlock] = field(default_factory=dict)  # by SID
    lines: list[DrawnLine] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    commented: set[str] = field(default_factory=set)  # SIDs of blocks commented out, and inside
    through: dict[str, DrawnBlock] = field(default_factory=dict)  # of them, those that are wires


def read_diagram(root: Element, fetch: Callable[[str], Element], charts: Charts) -> Diagram:
    """Read the ``<System>`` of the top and all systems inside it.

    ``fetch`` finds the ``<System>`` that a ``<System Ref="...">`` names.
    """
    walk = _Walk(fetch, charts)
    walk.read_system(root, "", "", depth=0, commented=False)
    return walk.diagram


class _Walk:
    def __init__(self, fetch: Callable[[str], Element], charts: Charts) -> None:
        self.diagram = Diagram()
        self._fetch, self._charts = fetch, charts
        self._seen: set[str] = set()

    def read_system(
        self, system: Element, sid: str, path: str, *, depth: int, commented: bool
    ) -> None:
        if depth > _DEEPEST:
            raise InvalidValueError(
                f"its subsystems lie more than {_DEEPEST} deep, which no model does: save the "
                "model again in Simulink"
            )
        for child in system:
            if child.tag == "Block":
                self._read_block(child, sid, path, depth=depth, commented=commented)
            elif child.tag == "Line":
                self.diagram.lines.append(read_line(child))

    def _read_block(
        self, element: Element, system: str, path: str, *, depth: int, commented: bool
    ) -> None:
        block, found = _drawn_block(element, system, path), self.diagram
        if block.sid in found.blocks or block.sid in found.commented:
            raise InvalidValueError(
                f"two blocks have the SID {block.sid}, the second is {block.name!r}: save the "
                "model again in Simulink"
            )
        systems = [self._resolve(inner, block) for inner in element if inner.tag == "System"]
        names = block.path, block.name, _chart_tag(systems)
        if _is_unnamed_chart(block) and systems and self._charts.is_function(*names):
            block = replace(block, texts=block.texts | {"SFBlockType": MATLAB_FUNCTION})
        how, chart = block.texts.get("Commented", "off"), block.texts.get("SFBlockType", "NONE")
        if how == "through":
            found.through[block.sid] = block
        if commented or how != "off":
            commented = True
            found.commented.add(block.sid)
        else:
            found.blocks[block.sid] = block
            if chart == MATLAB_FUNCTION:
                script = self._charts.script(*names)
                found.functions.append(Function(sid=block.sid, name=block.name, script=script))
        for inside in systems if chart == "NONE" else ():
            path = f"{block.path}/"
            self.read_system(inside, block.sid, path, depth=depth + 1, commented=commented)

    def _resolve(self, system: Element, block: DrawnBlock) -> Element:
        name = system.get("Ref")
        if name is None:
            return system
        if name in self._seen:
            raise InvalidValueError(
                f"{block} shows the system {name}, which another block shows already: save the "
                "model again in Simulink"
            )
        self._seen.add(name)
        return self._fetch(name)


def _drawn_block(element: Element, system: str, path: str) -> DrawnBlock:
    name = one_line(element.get("Name", ""))
    kind, sid = element.get("BlockType", ""), element.get("SID", "")
    if not sid or not kind:
        raise InvalidValueError(
            f"block {name!r} has no {'BlockType' if sid else 'SID'}: save the model again in "
            "Simulink"
        )
    texts = parameters(element)
    ports = _ports(element, texts)
    source = " ".join(texts.get("SourceBlock", "").split()) if kind == "Reference" else ""
    for child in element:
        if child.tag == "InstanceData":
            texts |= parameters(child)
    return DrawnBlock(
        sid=sid,
        name=name,
        path=path + name.replace("/", "//"),
        type=kind,
        source=source,
        system=system,
        texts={key: text for key, text in texts.items() if key not in _DRAWING},
        ports=ports,
        mask=read_mask(element, texts),
    )


def _ports(element: Element, texts: dict[str, str]) -> dict[str, int]:
    counted = element.find("PortCounts")
    if counted is not None:
        return {kind: int(text) for kind, text in counted.items() if re.fullmatch(r"\d{1,6}", text)}
    places = re.findall(r"\d{1,6}", texts.get("Ports", ""))
    return {kind: int(places[at]) for kind, at in _OLD_PORTS.items() if at < len(places)}


def _is_unnamed_chart(block: DrawnBlock) -> bool:
    """Tell whether a block holds a chart, as of about R2012, but not of what kind."""
    return "SFBlockType" not in block.texts and block.mask.type == "Stateflow"


def _chart_tag(systems: list[Element]) -> str:
    """Return what the machinery inside a MATLAB Function block is tagged with."""
    for block in (block for system in systems for block in system):
        if block.get("BlockType") == "S-Function":
            return parameters(block).get("Tag", "")
    return ""
