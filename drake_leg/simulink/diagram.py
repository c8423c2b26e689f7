"""What is drawn in the systems of a file: blocks, masks, charts, and lines, still as text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import one_line, parameters
from drake_leg.simulink.catalogue import WHERE_ABSENT, known_parameters, under_todays_names
from drake_leg.simulink.file import SimulinkFile
from drake_leg.simulink.linking import Libraries, Linked
from drake_leg.simulink.logged import logged_ports
from drake_leg.simulink.masks import Mask, read_mask
from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.signal_builder import built_signals, text_of_signals
from drake_leg.simulink.model import Function, split_port
from drake_leg.simulink.stateflow import function_of, read_machine

BUILT = "SigBuilderData"  # parameter of a Signal Builder that holds its signals

_PORT = re.compile(r"(?P<sid>[^#]+)#(?P<kind>[A-Za-z]+)(?::(?P<number>\d{1,6}))?")
_PHYSICAL = ("lconn", "rconn")
_OLD_PORTS = {"in": 0, "out": 1, "lconn": 5, "rconn": 6}  # places in <P Name="Ports">
_DEEPEST = 100  # subsystems in subsystems
MOST_BLOCKS = 100_000
_OF_THE_DRAWING = """
Position ZOrder BlockRotation BlockMirror ShowName HideAutomaticName NameLocation NamePlacement
FontName FontSize FontWeight FontAngle ForegroundColor BackgroundColor DropShadow IconDisplay
Ports LibraryVersion SourceType SourceProductName SourceProductBaseCode LibrarySourceBlock
SourceBlock ContentPreviewEnabled GraphicalSettings WindowPosition ScopeSpecificationString
ScopeGraphics Location WasSavedAsWebScope OpenFcn AttributesFormatString Description
"""
_DRAWING = frozenset(_OF_THE_DRAWING.split())
MATLAB_FUNCTION, CHART = "MATLAB Function", "Chart"


@dataclass(frozen=True, kw_only=True)
class DrawnLine:
    """A line with all its branches."""

    name: str
    physical: bool
    source: str  # port; "" where the line hangs, and of physical lines
    ends: tuple[str, ...]  # ports; of a physical line all of them


def read_line(element: Element, prefix: str = "") -> DrawnLine:
    """Read a ``<Line>`` with its branches; the prefix is put before all SIDs."""
    texts = parameters(element)
    ends = [prefix + _port(text) for text in _ends(element, texts)]
    physical = any(split_port(end)[1] in _PHYSICAL for end in ends)
    source = "" if physical or not texts.get("Src") else prefix + _port(texts["Src"])
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
    unlinked: str = ""  # why what it refers to was not found
    undecided: str = ""  # why none of its variants was chosen
    logged: Mapping[int, str] = field(default_factory=dict)  # signals, by the number of the output

    def __str__(self) -> str:
        return f"block {self.name!r} (SID {self.sid})" if self.sid else f"the file {self.name!r}"


@dataclass(frozen=True, kw_only=True)
class Diagram:
    """All systems of a model."""

    blocks: dict[str, DrawnBlock] = field(default_factory=dict)  # by SID
    lines: list[DrawnLine] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    commented: set[str] = field(default_factory=set)  # SIDs of blocks commented out, and inside
    through: dict[str, DrawnBlock] = field(default_factory=dict)  # of them, those that are wires
    models: dict[str, SimulinkFile] = field(default_factory=dict)  # by the SIDs of their blocks


def mask_of_file(file: SimulinkFile) -> DrawnBlock | None:
    """Return the block that a subsystem in a file of its own is elsewhere, if it has a mask."""
    if file.is_model or not (file.mask.values or file.mask.code.strip()):
        return None
    return DrawnBlock(
        sid="",
        name=file.path.stem,
        path="",
        type="SubSystem",
        source="",
        system="",
        texts={},
        ports={},
        mask=file.mask,
    )


def read_diagram(file: SimulinkFile, libraries: Libraries) -> Diagram:
    """Read the top of a file and all systems inside it, those of its libraries included."""
    walk = _Walk(libraries)
    walk.read_system(file.top, _Place(file=file))
    return walk.diagram


@dataclass(frozen=True, kw_only=True)
class _Place:
    """Where a system stands: in the model, and in the file that draws it."""

    file: SimulinkFile
    sid: str = ""  # of the block that holds it
    path: str = ""  # of that block, with a slash behind; "" at the top
    depth: int = 0
    commented: bool = False
    prefix: str = ""  # of the SIDs of the file
    inside: str = ""  # path of the holding block in the file, with a slash behind
    linked: str | None = None  # path in the file of a block to which another one refers
    links: tuple[tuple[Path, str], ...] = ()  # references through which it is reached


class _Walk:
    def __init__(self, libraries: Libraries) -> None:
        self.diagram = Diagram()
        self._libraries = libraries
        self._seen: set[tuple[str, str]] = set()  # prefix, name of a system

    def read_system(self, system: Element, place: _Place) -> None:
        if place.depth > _DEEPEST:
            raise InvalidValueError(
                f"its subsystems lie more than {_DEEPEST} deep, which no model does: save the "
                "model again in Simulink"
            )
        for child in system:
            if child.tag == "Block":
                self._read_block(child, place)
            elif child.tag == "Line":
                self.diagram.lines.append(read_line(child, place.prefix))

    def _read_block(self, element: Element, place: _Place) -> None:
        block, found = _drawn_block(element, place), self.diagram
        if block.sid in found.blocks or block.sid in found.commented:
            raise InvalidValueError(
                f"two blocks have the SID {block.sid}, the second is {block.name!r}: save the "
                "model again in Simulink"
            )
        if len(found.blocks) >= MOST_BLOCKS:
            raise InvalidValueError(
                f"it has more than {MOST_BLOCKS} blocks, those of its libraries included, as no "
                "model has"
            )
        how = block.texts.get("Commented", "off")
        if how == "off" and not place.commented:
            block, element, place = self._followed(block, element, place)
        systems = [self._resolve(inner, block, place) for inner in element if inner.tag == "System"]
        inside = f"{place.inside}{block.name.replace('/', '//')}"
        if place.linked is not None:
            inside = place.linked
        names = inside, block.name, _chart_tag(systems)
        if _is_unnamed_chart(block) and systems:
            if place.file.charts.is_function(*names):
                block = replace(block, texts=block.texts | {"SFBlockType": MATLAB_FUNCTION})
            elif place.file.charts.machine(*names) is not None:
                block = replace(block, texts=block.texts | {"SFBlockType": CHART})
        chart = block.texts.get("SFBlockType", "NONE")
        if how == "through":
            found.through[block.sid] = block
        commented = place.commented or how != "off"
        if commented:
            found.commented.add(block.sid)
        else:
            found.blocks[block.sid] = block
            if chart == CHART:
                found.functions.append(_of_chart(block, place.file.charts.machine(*names), systems))
            if chart == MATLAB_FUNCTION:
                script = place.file.charts.script(*names)
                found.functions.append(
                    Function(
                        sid=block.sid,
                        name=block.name,
                        script=script,
                        parameters=place.file.charts.parameters(*names),
                    )
                )
        if not systems or chart != "NONE":
            return
        within = replace(
            place,
            sid=block.sid,
            path=f"{block.path}/",
            depth=place.depth + 1,
            commented=commented,
            inside=f"{inside}/" if inside else "",
            linked=None,
        )
        for system in systems:
            self.read_system(system, within)

    def _followed(
        self, block: DrawnBlock, element: Element, place: _Place
    ) -> tuple[DrawnBlock, Element, _Place]:
        """Put what a block refers to in its place, reference after reference."""
        while (reference := _reference(block)) is not None:
            try:
                linked = self._linked(block, reference, place)
            except InvalidValueError as error:
                return replace(block, unlinked=str(error)), element, place
            link = (linked.file.path, linked.path)
            if link in place.links:
                unlinked = f"{linked.path or linked.file.path.name} refers to itself"
                return replace(block, unlinked=unlinked), element, place
            place = replace(
                place,
                file=linked.file,
                prefix=f"{block.sid}:",
                linked=linked.path,
                links=(*place.links, link),
            )
            if linked.block is None:
                if block.type == "ModelReference":
                    self.diagram.models[block.sid] = linked.file
                else:
                    block = replace(block, mask=_with_own_values(linked.file.mask, block))
                element = Element("Block")
                element.append(linked.file.top)
                return replace(block, type="SubSystem"), element, place
            element = linked.block
            block = _put_in_place(block, _drawn_block(element, place))
        return block, element, place

    def _linked(self, block: DrawnBlock, reference: str, place: _Place) -> Linked:
        if block.type == "Reference":
            return self._libraries.block(reference, place.file)
        return Linked(file=self._libraries.file(reference))

    def _resolve(self, system: Element, block: DrawnBlock, place: _Place) -> Element:
        name = system.get("Ref")
        if name is None:
            return system
        if (place.prefix, name) in self._seen:
            raise InvalidValueError(
                f"{block} shows the system {name}, which another block shows already: save the "
                "model again in Simulink"
            )
        self._seen.add((place.prefix, name))
        return place.file.system(name)


def _reference(block: DrawnBlock) -> str | None:
    """Return what a block refers to in this file or others, None where it refers to nothing."""
    if block.type == "Reference":
        known = known_parameters(block.type, block.source) is not None
        known = known and block.source.partition("/")[0] not in WHERE_ABSENT
        return None if known or not block.source else block.source
    if block.type == "ModelReference":
        texts = block.texts
        return texts.get("ModelFile") or texts.get("ModelName") or texts.get("ModelNameDialog")
    if block.type == "SubSystem":
        return block.texts.get("ReferencedSubsystem") or None
    return None


def _put_in_place(block: DrawnBlock, linked: DrawnBlock) -> DrawnBlock:
    """Return the block of a library as a model has it: with its name, place and settings."""
    return replace(
        linked,
        sid=block.sid,
        name=block.name,
        path=block.path,
        system=block.system,
        texts=linked.texts | block.texts,
        ports=block.ports or linked.ports,
        logged=block.logged,
        mask=_with_own_values(linked.mask, block),
    )


def _with_own_values(mask: Mask, block: DrawnBlock) -> Mask:
    """Return the mask of what a block refers to with the values that the block gives."""
    own = block.mask.values | block.texts
    return replace(mask, values={name: own.get(name, text) for name, text in mask.values.items()})


def _drawn_block(element: Element, place: _Place) -> DrawnBlock:
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
        if child.get("Name") == BUILT and child.get("Ref"):
            texts |= _built(place.file.data(child.get("Ref", "")))
        if child.get("ListType") == "InterfaceData":  # of a port of one element of a bus
            own = parameters(child)
            texts |= {"Port": own.get("PortNumber", "1")} | own
    return DrawnBlock(
        sid=place.prefix + sid,
        name=name,
        path=place.path + name.replace("/", "//"),
        type="Inport" if kind == "InportShadow" else kind,  # the same port, drawn again
        source=source,
        system=place.sid,
        texts=under_todays_names({key: text for key, text in texts.items() if key not in _DRAWING}),
        ports=ports,
        mask=read_mask(element, texts),
        logged=logged_ports(element),
    )


def _built(content: bytes | None) -> dict[str, str]:
    """Read the signals of a Signal Builder; what is damaged is missing where it is needed."""
    with suppress(LackError):
        if content is not None:
            return {BUILT: text_of_signals(built_signals(content))}
    return {}


def _ports(element: Element, texts: dict[str, str]) -> dict[str, int]:
    counted = element.find("PortCounts")
    if counted is not None:
        return {kind: int(text) for kind, text in counted.items() if re.fullmatch(r"\d{1,6}", text)}
    places = re.findall(r"\d{1,6}", texts.get("Ports", ""))
    return {kind: int(places[at]) for kind, at in _OLD_PORTS.items() if at < len(places)}


def _is_unnamed_chart(block: DrawnBlock) -> bool:
    """Tell whether a block holds a chart, as of about R2012, but not of what kind."""
    return "SFBlockType" not in block.texts and block.mask.type == "Stateflow"


def _of_chart(block: DrawnBlock, chart: Element | None, systems: list[Element]) -> Function:
    """Write the code of a chart, or say why it has none."""
    inner = [parameters(each) | each.attrib for system in systems for each in system]
    ports = [
        (each.get("BlockType"), int(each.get("Port", "1")), each.get("Name", ""))
        for each in inner
        if each.get("BlockType") in ("Inport", "Outport") and each.get("Port", "1").isdecimal()
    ]
    script = problem = ""
    named: tuple[str, ...] = ()
    if chart is None:
        problem = "has no chart in the file: save the model again in Simulink"
    else:
        try:
            machine = read_machine(chart, [name for *_, name in sorted(ports)])
            named = tuple(datum.name for datum in machine.data if datum.scope == "PARAMETER")
            script = function_of(machine)
        except InvalidValueError as error:
            problem = str(error)
    return Function(
        sid=block.sid,
        name=block.name,
        script=script,
        parameters=named,
        is_chart=True,
        problem=problem,
    )


def _chart_tag(systems: list[Element]) -> str:
    """Return what the machinery inside a MATLAB Function block is tagged with."""
    for block in (block for system in systems for block in system):
        if block.get("BlockType") == "S-Function":
            return parameters(block).get("Tag", "")
    return ""
