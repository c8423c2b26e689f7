"""Writes small .slx files in the shapes that Simulink saves, for the tests."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from drake_leg.simulink.lacks import require_understood
from drake_leg.simulink.reader import read_model

Texts = dict[str, str]


@dataclass
class WrittenBlock:
    """A block to be written; change its fields as you like before writing."""

    sid: str
    name: str
    type: str
    source: str
    system: str
    parameters: Texts
    ports: dict[str, int]
    script: str | None = None  # of MATLAB, or what a chart holds, as XML
    mask: str = ""  # of `mask_text`
    port_properties: str = ""  # what its outputs log, as XML


def _is_drawn(block: WrittenBlock) -> bool:
    """Tell whether a block is a chart of states."""
    return (block.script or "").startswith("<")


@dataclass
class WrittenLine:
    """A line to be written: a signal's source and targets, or the ends of a physical line."""

    system: str
    ports: list[str]
    name: str = ""
    physical: bool = False


@dataclass
class ModelBuilder:
    """A model to be written.

    A port is ``"SID#out:1"``; where a block's SID stands alone, its first output or input is meant.
    """

    solver: Texts = field(default_factory=lambda: {"StopTime": "10.0"})
    blocks: dict[str, WrittenBlock] = field(default_factory=dict)
    lines: list[WrittenLine] = field(default_factory=list)
    callbacks: Texts = field(default_factory=dict)
    workspace: Texts = field(default_factory=dict)  # where the model workspace comes from
    _last: int = 0

    def add_block(
        self,
        block_type: str,
        name: str,
        parameters: Texts | None = None,
        *,
        source: str = "",
        system: str = "",
        sid: str = "",
        ports: dict[str, int] | None = None,
        script: str | None = None,
    ) -> str:
        """Add a block and return its SID."""
        if not sid:
            self._last += 1
            sid = str(self._last)
        self.blocks[sid] = WrittenBlock(
            sid, name, block_type, source, system, dict(parameters or {}), ports or {}, script
        )
        return sid

    def add_library(self, source: str, name: str, parameters: Texts | None = None, **more) -> str:
        """Add a block of a library and return its SID."""
        return self.add_block("Reference", name, parameters, source=source, **more)

    def add_function(self, name: str, script: str, *, system: str = "", **ports: int) -> str:
        """Add a MATLAB Function block and return its SID."""
        settings = {"SFBlockType": "MATLAB Function"}
        return self.add_block(
            "SubSystem", name, settings, system=system, ports=ports or {"in": 1}, script=script
        )

    def connect(self, source: str, *targets: str, name: str = "") -> None:
        """Draw a signal line, with branches where it has several targets."""
        ports = [_port(source, "out"), *(_port(target, "in") for target in targets)]
        self.lines.append(WrittenLine(self._system_of(ports[0]), ports, name))

    def physical(self, *ports: str) -> None:
        """Draw a physical line between ports such as ``5#lconn:1``, with branches where needed."""
        self.lines.append(WrittenLine(self._system_of(ports[0]), list(ports), physical=True))

    def sid(self, name: str) -> str:
        """Return the SID of the only block of this name."""
        (found,) = [block.sid for block in self.blocks.values() if block.name == name]
        return found

    def set(self, name: str, **parameters: str | None) -> ModelBuilder:
        """Change parameters of the block of this name; None takes one out of the file."""
        texts = self.blocks[self.sid(name)].parameters
        for key, text in parameters.items():
            texts.pop(key, None)
            if text is not None:
                texts[key] = text
        return self

    def remove(self, name: str) -> ModelBuilder:
        """Take a block out, and its ends of lines."""
        sid = self.sid(name)
        del self.blocks[sid]
        kept = []
        for line in self.lines:
            held = [port for port in line.ports if port.split("#")[0] != sid]
            if len(held) > 1 and (line.physical or held[0] == line.ports[0]):
                line.ports = held
                kept.append(line)
        self.lines = kept
        return self

    def write(self, path: Path, *, layout: str = "new") -> Path:
        """Write the file: "new" has a part for each system, "old" has one for all."""
        return write_parts(path, self.parts(layout=layout))

    def parts(self, *, layout: str = "new") -> dict[str, str]:
        """Return the file's parts."""
        if layout == "old":
            body = self._system_text("", nested=True)
            configuration = _object(self.solver, "ConfigurationSets")
            whole = f"<Model>{self._settings()}{configuration}{body}</Model>"
            charts = "".join(
                self._chart(number, block) for number, block in enumerate(self._functions(), 1)
            )
            stateflow = f'<Stateflow><machine id="1"><Children>{charts}</Children></machine>'
            return {
                "simulink/blockdiagram.xml": _document(
                    f'<ModelInformation Version="1.0">{whole}{stateflow}{self._instances()}'
                    "</Stateflow></ModelInformation>"
                )
            }
        parts = {
            "simulink/blockdiagram.xml": _document(
                f'<ModelInformation Version="1.0"><Model>{self._settings()}'
                '<System Ref="system_root"/></Model></ModelInformation>'
            ),
            "simulink/configSet0.xml": _document(
                f"<ConfigSet>{_object(self.solver, 'Components')}</ConfigSet>"
            ),
            "simulink/systems/system_root.xml": _document(self._system_text("", nested=False)),
        }
        for block in self.blocks.values():
            if block.type == "SubSystem":
                parts[f"simulink/systems/system_{block.sid}.xml"] = _document(
                    self._system_text(block.sid, nested=False)
                )
        if self._functions():
            for number, block in enumerate(self._functions(), 1):
                parts[f"simulink/stateflow/chart_{number}.xml"] = _document(
                    self._chart(number, block)
                )
            parts["simulink/stateflow/machine.xml"] = _document(
                f'<Stateflow><machine id="1"/>{self._instances()}</Stateflow>'
            )
        return parts

    def package(self) -> dict[str, str]:
        """Return the file's parts with those that say what each is and how they belong together.

        As Simulink saves them, by the Open Packaging Conventions; all charts are in one part.
        """
        parts = {name: text for name, text in self.parts().items() if "/stateflow/" not in name}
        parts["simulink/configSetInfo.xml"] = _document(
            '<ConfigSetInfo><ConfigSet PartName="/simulink/configSet0.xml" Active="true">'
            "Configuration</ConfigSet></ConfigSetInfo>"
        )
        related = [("system_root", "systems/system_root.xml", "simulink/2010", "system")]
        if self._functions():
            charts = "".join(self._chart(n, b) for n, b in enumerate(self._functions(), 1))
            parts["simulink/stateflow.xml"] = _document(
                f'<Stateflow><machine id="1"><Children>{charts}</Children></machine>'
                f"{self._instances()}</Stateflow>"
            )
            related.append(("stateflow", "stateflow.xml", "simulinkModel/2014", "stateflowMachine"))
        rels = {
            "_rels/.rels": [
                ("blockDiagram", "simulink/blockdiagram.xml", "simulink/2010", "blockDiagram"),
                ("configSetInfo", "simulink/configSetInfo.xml", "simulink/2014", "configSetInfo"),
            ],
            "simulink/_rels/blockdiagram.xml.rels": related,
            "simulink/_rels/configSetInfo.xml.rels": [
                ("configSet0", "configSet0.xml", "simulink/2014", "configSet")
            ],
        }
        for block in self.blocks.values():
            if block.type == "SubSystem":
                holder = f"system_{block.system or 'root'}.xml"
                name = f"system_{block.sid}"
                rels.setdefault(f"simulink/systems/_rels/{holder}.rels", []).append(
                    (name, f"{name}.xml", "simulink/2010", "system")
                )
        return {
            "[Content_Types].xml": _content_types(parts),
            **{name: _relationships(targets) for name, targets in rels.items()},
            **parts,
        }

    def _settings(self) -> str:
        """Callbacks and workspace of the model as a whole."""
        callbacks = "".join(_p(*item) for item in self.callbacks.items())
        workspace = "".join(_p(*item) for item in self.workspace.items())
        return callbacks + (f"<ModelWorkspace>{workspace}</ModelWorkspace>" if workspace else "")

    def _system_of(self, port: str) -> str:
        return self.blocks[port.split("#")[0]].system

    def _functions(self) -> list[WrittenBlock]:
        return [block for block in self.blocks.values() if block.script is not None]

    def _path(self, block: WrittenBlock) -> str:
        above = self.blocks.get(block.system)
        return f"{self._path(above)}/{block.name}" if above else block.name

    def _chart(self, number: int, block: WrittenBlock) -> str:
        held = block.script or ""
        if not _is_drawn(block):
            held = f"<eml>{_p('isEML', '1')}{_p('script', held)}</eml>"
        return (
            f'<chart id="{number + 10}">{_p("name", self._path(block))}'
            f"{_p('chartFileNumber', str(number))}"
            f"{held}</chart>"
        )

    def _instances(self) -> str:
        return "".join(
            f'<instance id="{number + 50}">{_p("machine", "1")}{_p("name", self._path(block))}'
            f"{_p('chart', str(number + 10))}</instance>"
            for number, block in enumerate(self._functions(), 1)
        )

    def _system_text(self, system: str, *, nested: bool) -> str:
        holder = self.blocks.get(system)
        blocks = [block for block in self.blocks.values() if block.system == system]
        inner = "".join(self._block_text(block, nested) for block in blocks)
        lines = "".join(_line_text(line) for line in self.lines if line.system == system)
        if holder is not None and holder.script is not None and not _is_drawn(holder):
            number = self._functions().index(holder) + 1
            inner, lines = _machinery(holder.sid, number)
        return f"<System>{_p('Location', '[0, 0, 1630, 1016]')}{inner}{lines}</System>"

    def _block_text(self, block: WrittenBlock, nested: bool) -> str:
        head = (
            f"<Block BlockType={quoteattr(block.type)} Name={_attribute(block.name)} "
            f"SID={quoteattr(block.sid)}>"
        )
        counts = "".join(f' {kind}="{count}"' for kind, count in block.ports.items())
        body = f"<PortCounts{counts}/>" if counts else ""
        body += _p("Position", "[515, 282, 685, 358]") + _p("ZOrder", block.sid)
        texts = "".join(_p(name, text) for name, text in block.parameters.items())
        if block.source:
            body += _p("SourceBlock", block.source)
            body += f"<InstanceData>{_p('ContentPreviewEnabled', 'off')}{texts}</InstanceData>"
        else:
            body += texts
        body += block.mask + block.port_properties
        if block.type == "SubSystem":
            body += (
                self._system_text(block.sid, nested=True)
                if nested
                else f'<System Ref="system_{block.sid}"/>'
            )
        return f"{head}{body}</Block>"


PACKAGE = "http://schemas.openxmlformats.org/package/2006"
STANDALONE = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
CONTENT_TYPES = {
    "simulink/configSet0.xml": "simulink.configSet",
    "simulink/configSetInfo.xml": "simulink.configSetInfo",
    "simulink/stateflow.xml": "stateflow.machine",
}


def _content_types(parts: Texts) -> str:
    """Say what each part is; one that is not named is a part of a model."""
    kinds = {"rels": "openxmlformats-package.relationships", "xml": "mathworks.simulink.mdl"}
    defaults = "".join(
        f'<Default ContentType="application/vnd.{kind}+xml" Extension="{ending}"/>'
        for ending, kind in kinds.items()
    )
    overrides = "".join(
        f'<Override ContentType="application/vnd.mathworks.{kind}+xml" PartName="/{name}"/>'
        for name, kind in CONTENT_TYPES.items()
        if name in parts
    )
    return f'{STANDALONE}<Types xmlns="{PACKAGE}/content-types">{defaults}{overrides}</Types>\n'


def _relationships(targets: list[tuple[str, str, str, str]]) -> str:
    """Say which parts belong to a part: id, place, year of the schema, and kind of each."""
    found = "".join(
        f'<Relationship Id="{id_}" Target="{target}" '
        f'Type="http://schemas.mathworks.com/{schema}/relationships/{kind}"/>'
        for id_, target, schema, kind in targets
    )
    return f'{STANDALONE}<Relationships xmlns="{PACKAGE}/relationships">{found}</Relationships>\n'


def write_parts(path: Path, parts: dict[str, str | bytes]) -> Path:
    """Write a ZIP archive of these parts."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return path


def mask_text(
    values: Texts, initialization: str = "", *, form: str = "new", **attributes: str
) -> str:
    """Return a mask; `attributes` are those of all its parameters. The "R2013" form is older."""
    settings = {"Type": "edit"} | attributes
    if form == "R2013":
        entries = "".join(
            f"<Object>{''.join(_p(*item) for item in settings.items())}"
            f"{_p('Name', name)}{_p('Value', text)}</Object>"
            for name, text in values.items()
        )
        return (
            f'<Object PropName="MaskObject" ClassName="Simulink.Mask">'
            f"{_p('Initialization', initialization)}"
            f'<Array PropName="Parameters" Type="Simulink.MaskParameter">{entries}</Array></Object>'
        )
    marks = "".join(f" {key}={quoteattr(text)}" for key, text in settings.items())
    entries = "".join(
        f"<MaskParameter Name={quoteattr(name)}{marks}><Prompt>{name} [mm]</Prompt>"
        f"<Value>{escape(text)}</Value></MaskParameter>"
        for name, text in values.items()
    )
    return f"<Mask><Initialization>{escape(initialization)}</Initialization>{entries}</Mask>"


def _port(text: str, kind: str) -> str:
    return text if "#" in text else f"{text}#{kind}:1"


def _attribute(text: str) -> str:
    return quoteattr(text, {"\n": "&#xA;"})


def _p(name: str, text: str) -> str:
    return f'<P Name="{name}">{escape(text)}</P>'


def _document(body: str) -> str:
    return f'<?xml version="1.0" encoding="utf-8"?>\n{body}\n'


def _object(solver: Texts, array: str) -> str:
    texts = "".join(_p(name, text) for name, text in solver.items())
    return (
        f'<Array PropName="{array}" Type="Handle"><Object Version="1" '
        f'ClassName="Simulink.SolverCC">{texts}</Object><Object Version="1" '
        f'ClassName="Simulink.DataIOCC">{_p("Decimation", "1")}</Object></Array>'
    )


def _line_text(line: WrittenLine) -> str:
    first, *others = line.ports
    if not line.physical:
        ends = _p("Dst", others[0]) if len(others) == 1 else _branches(others)
        label = _p("Name", line.name) if line.name else ""
        return f"<Line>{label}{_p('ZOrder', '1')}{_p('Src', first)}{ends}</Line>"
    if len(others) == 1:
        return f'<Line LineType="Connection">{_p("Src", first)}{_p("Dst", others[0])}</Line>'
    branches = "".join(
        f"<Branch>{_p('ConnectType', 'DEST_DEST')}{_p('Src', end)}</Branch>"
        if place % 2
        else f"<Branch>{_p('ConnectType', 'DEST_SRC')}{_p('Dst', end)}</Branch>"
        for place, end in enumerate(others)
    )
    return f'<Line LineType="Connection">{_p("Src", first)}{branches}</Line>'


def _branches(ends: list[str]) -> str:
    """Split in two as often as it takes, as Simulink does when lines are tapped one by one."""
    if len(ends) == 1:
        return f"<Branch>{_p('Dst', ends[0])}</Branch>"
    rest = _branches(ends[1:])
    return f"<Branch>{_p('Dst', ends[0])}</Branch>" + (
        rest if len(ends) == 2 else f"<Branch>{rest}</Branch>"
    )


def _machinery(sid: str, number: int) -> tuple[str, str]:
    """Return the blocks and lines that Simulink keeps inside a MATLAB Function block."""
    blocks = "".join(
        f'<Block BlockType="{kind}" Name=" {name} " SID="{sid}::{place}">{texts}</Block>'
        for kind, name, place, texts in (
            ("Inport", "u", 1, ""),
            ("Demux", "Demux", 5, _p("Outputs", "1")),
            (
                "S-Function",
                "SFunction",
                4,
                _p("Tag", f"Stateflow S-Function model {number}") + _p("FunctionName", "sf_sfun"),
            ),
            ("Terminator", "Terminator", 6, ""),
            ("Outport", "y", 3, ""),
        )
    )
    lines = "".join(
        f"<Line>{_p('Src', f'{sid}::{source}')}{_p('Dst', f'{sid}::{target}')}</Line>"
        for source, target in (
            ("1#out:1", "4#in:1"),
            ("4#out:2", "3#in:1"),
            ("4#out:1", "5#in:1"),
            ("5#out:1", "6#in:1"),
        )
    )
    return blocks, lines


def read_understood(path):
    """Read a model all of which must be understood."""
    model = read_model(path)
    require_understood(model)
    return model
