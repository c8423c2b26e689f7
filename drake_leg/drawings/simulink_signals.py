"""The signals of a Simulink model as a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from drake_leg.drawings.picture import Net, Picture
from drake_leg.drawings.simulink_blocks import GLYPHS, signal_block
from drake_leg.drawings.simulink_names import cut
from drake_leg.drawings.simulink_network import Network, ports_by_block
from drake_leg.simulink.model import Block, Model, split_port


@dataclass(frozen=True)
class _Line:
    """All that leaves one port."""

    source: str
    targets: tuple[str, ...]
    name: str
    physical: bool


def signals_picture(
    model: Model, network: Network, names: Mapping[str, str], *, title: str
) -> Picture:
    """Draw the signals of a model, and the joints and sensors that they drive or come from.

    A model without signals has a picture without blocks.
    """
    lines = _lines(model, network)
    inputs = ports_by_block(port for line in lines for port in line.targets)
    outputs = ports_by_block(line.source for line in lines)
    blocks = [
        block
        for block in model.blocks
        if block.sid not in network.mechanical or block.sid in network.sensed
    ]
    blocks.sort(key=lambda block: block.sid not in outputs)  # so that scopes are below
    scripts = {function.sid: function.script for function in model.functions}
    drawn = (
        signal_block(
            block,
            name=names[block.sid],
            inputs=inputs.get(block.sid, ()),
            outputs=outputs.get(block.sid, ()),
            script=scripts.get(block.sid, ""),
        )
        for block in blocks
    )
    return Picture(
        title=title,
        blocks=tuple(
            replace(picture, physical=block.sid in network.physical)
            for block, picture in zip(blocks, drawn, strict=True)
        ),
        nets=_nets(lines, blocks, inputs, outputs),
    )


def _nets(
    lines: Sequence[_Line],
    blocks: Sequence[Block],
    inputs: Mapping[str, list[str]],
    outputs: Mapping[str, list[str]],
) -> tuple[Net, ...]:
    index = {block.sid: place for place, block in enumerate(blocks)}
    glyph = {block.sid: GLYPHS.get(block.kind, "") for block in blocks}

    def end(port: str, ports: Mapping[str, list[str]]) -> tuple[int, int]:
        sid, _, _ = split_port(port)
        return index[sid], ports[sid].index(port)

    nets = [
        Net(
            source=end(line.source, outputs),
            targets=tuple(end(port, inputs) for port in line.targets),
            label=cut(line.name),
            physical=line.physical,
            wide=_is_wide(line, glyph),
        )
        for line in lines
    ]
    return tuple(sorted(nets, key=lambda net: net.source))


def _lines(model: Model, network: Network) -> list[_Line]:
    """Gather the wires and the physical signals by the ports that they leave."""
    targets: dict[str, list[str]] = {}
    names: dict[str, str] = {}
    for wire in model.wires:
        targets.setdefault(wire.source, []).append(wire.target)
        names[wire.source] = names.get(wire.source) or wire.name
    return [
        *(_Line(source, tuple(ends), names[source], False) for source, ends in targets.items()),
        *(_Line(node[0], node[1:], "", True) for node in network.signals),
    ]


def _is_wide(line: _Line, glyph: Mapping[str, str]) -> bool:
    """Whether a Mux or a Demux tells that a line carries several signals."""
    ends = {glyph[split_port(port)[0]] for port in line.targets}
    return glyph[split_port(line.source)[0]] == "mux" or "demux" in ends
