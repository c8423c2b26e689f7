"""What is drawn in the systems of a file: blocks, masks, charts, and lines, still as text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import zip_longest
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import one_line, parameters
from drake_leg.simulink.model import Function, split_port

_EVALUATED = ("edit", "slider", "dial", "spinbox", "min", "max")  # the other types hold choices
_VARIABLE = re.compile(r"\s*([A-Za-z]\w*)\s*=\s*([@&])\d+\s*")  # L=@1, and & for a text
_COMMENT = re.compile(r"^([^'\"%\n]*)%.*$", re.MULTILINE)
_CONTINUED = re.compile(r"\.\.\.[^\n]*\n")
_SETS = re.compile(r"(?<![=~<>!])=(?!=)")
_WORD = re.compile(r"(?<![\w.])[A-Za-z]\w*")


@dataclass(frozen=True, kw_only=True)
class Mask:
    """The mask of a block."""

    type: str = ""
    values: dict[str, str] = field(default_factory=dict)  # name to text, of all its parameters
    literal: frozenset[str] = frozenset()  # parameters whose text is not an expression
    computed: frozenset[str] = frozenset()  # names that its initialization sets


def read_mask(block: Element, texts: dict[str, str]) -> Mask:
    """Read the mask of a ``<Block>``.

    It is a ``<Mask>``, in files of about R2013 an ``<Object ClassName="Simulink.Mask">``, and
    before ``MaskVariables`` and their values.
    """
    kind, code = texts.get("MaskType", ""), texts.get("MaskInitialization", "")
    entries = list(_oldest(texts))
    for child in block:
        if child.tag == "Mask" or child.get("ClassName") == "Simulink.Mask":
            own = parameters(child)
            kind = own.get("Type") or child.findtext("Type") or kind
            code = own.get("Initialization") or child.findtext("Initialization") or code
            entries += _newest(child) if child.tag == "Mask" else _older(child)
    return Mask(
        type=kind.strip(),
        values={name: text for name, text, _ in entries},
        literal=frozenset(name for name, _, evaluated in entries if not evaluated),
        computed=_computed(code),
    )


def _newest(mask: Element) -> Iterator[tuple[str, str, bool]]:
    for entry in mask:
        if entry.tag == "MaskParameter" and entry.get("Name"):
            evaluated = _is_evaluated(entry.get("Type", "edit"), entry.get("Evaluate", "on"))
            yield entry.get("Name", ""), entry.findtext("Value") or "", evaluated


def _older(mask: Element) -> Iterator[tuple[str, str, bool]]:
    for entries in mask:
        if entries.get("PropName") == "Parameters":
            for entry in [entries, *entries]:
                texts = parameters(entry)
                if texts.get("Name"):
                    evaluated = _is_evaluated(
                        texts.get("Type", "edit"), texts.get("Evaluate", "on")
                    )
                    yield texts["Name"], texts.get("Value", ""), evaluated


def _oldest(texts: dict[str, str]) -> Iterator[tuple[str, str, bool]]:
    values = texts.get("MaskValueString", "").split("|")
    styles = re.sub(r"\([^()]*\)", "", texts.get("MaskStyleString", "")).split(",")
    variables = [part for part in texts.get("MaskVariables", "").split(";") if part.strip()]
    for variable, text, style in zip_longest(variables, values, styles, fillvalue=""):
        found = _VARIABLE.fullmatch(variable)
        if found:
            how = "on" if found[2] == "@" else "off"
            yield found[1], text, _is_evaluated(style or "edit", how)


def _is_evaluated(kind: str, evaluate: str) -> bool:
    return kind.strip().lower() in _EVALUATED and evaluate != "off"


def _computed(code: str) -> frozenset[str]:
    """Return the names left of an equals sign, rather too many than too few."""
    names: set[str] = set()
    for statement in re.split(r"[;\n]", _CONTINUED.sub(" ", _COMMENT.sub(r"\1", code))):
        equals = _SETS.search(statement)
        if equals:
            left = statement[: equals.start()]
            last = left.rpartition(",")[2]
            whole = any(last.count(opening) != last.count(end) for opening, end in ("()", "[]"))
            names.update(_WORD.findall(left if whole else last))
    return frozenset(names)


@dataclass(frozen=True, kw_only=True)
class _Chart:
    number: str  # as at the end of the S-Function's tag
    names: frozenset[str]
    script: str
    is_function: bool  # a whole MATLAB function, not a state machine with functions inside


class Charts:
    """The charts of a file, from the roots of the parts that hold charts and their instances."""

    def __init__(self, stateflow: Iterable[Element]) -> None:
        self._charts = _charts(list(stateflow))

    def is_function(self, path: str, name: str, tag: str) -> bool:
        """Whether a block's chart, by the tag of the S-Function inside, is a MATLAB function."""
        fits = _fitting(path, name, tag, self._charts)
        return bool(fits) and all(chart.is_function for chart in fits)

    def script(self, path: str, name: str, tag: str) -> str:
        """Return the code of a MATLAB Function block; "" where the file has none, or several."""
        fits = _fitting(path, name, tag, [chart for chart in self._charts if chart.script])
        return fits[0].script if fits else ""


def _charts(roots: list[Element]) -> list[_Chart]:
    instances: dict[str, set[str]] = {}
    for root in roots:
        for instance in root.iter("instance"):
            texts = parameters(instance)
            instances.setdefault(texts.get("chart", ""), set()).add(_plain(texts.get("name", "")))
    charts = []
    for root in roots:
        for chart in root.iter("chart"):
            script = next(
                (found for eml in chart.iter("eml") if (found := parameters(eml).get("script"))), ""
            )
            texts = parameters(chart)
            names = {_plain(texts.get("name", "")), *instances.get(chart.get("id", ""), ())}
            charts.append(
                _Chart(
                    number=texts.get("chartFileNumber", ""),
                    names=frozenset(names),
                    script=script,
                    is_function=bool(script) and _is_function(chart, texts.get("type")),
                )
            )
    return charts


def _is_function(chart: Element, kind: str | None) -> bool:
    return chart.find("eml") is not None if kind is None else kind == "EML_CHART"


def _fitting(path: str, name: str, tag: str, charts: list[_Chart]) -> list[_Chart]:
    """Choose a block's chart: by its path, by the number that its machinery names, by its name."""
    path, name = _plain(path), _plain(name.replace("/", "//"))
    number = tag.rpartition(" ")[2]
    for fits in (
        [chart for chart in charts if path in chart.names],
        [chart for chart in charts if number and number == chart.number],
        [chart for chart in charts if any(each.endswith(f"/{path}") for each in chart.names)],
        [chart for chart in charts if name in chart.names],
    ):
        if len({chart.script for chart in fits}) == 1:
            return fits
    return []


def _plain(name: str) -> str:
    return " ".join(one_line(name).split())


# --- what a file says of blocks and ports ----------------------------------------------------

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
