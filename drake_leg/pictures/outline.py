"""Reads the top of a Simulink model as a picture: its subsystems stay closed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from drake_leg.pictures.of_simulink import signal_blocks
from drake_leg.pictures.simulink_mechanism import cut, unique_names
from drake_leg.pictures.svg import Net, Picture
from drake_leg.simulink.lacks import with_texts
from drake_leg.simulink.mechanism import ports_by_block
from drake_leg.simulink.model import Model, split_port

Line = tuple[str, tuple[str, ...], str, bool]  # from a port, to others; its name; if physical


def outline_picture(model: Model, *, title: str) -> Picture:
    """Draw the blocks at the top of a model, its subsystems as boxes."""
    names = unique_names(model)
    top = {block.sid: block for block in with_texts(model).blocks if not block.system}
    lines = [*_signals(model, top), *_connections(model, top)]
    outputs = ports_by_block(source for source, *_ in lines)
    inputs = ports_by_block(port for _, targets, *_ in lines for port in targets)
    blocks = sorted(top.values(), key=lambda block: block.sid not in outputs)
    place = {block.sid: number for number, block in enumerate(blocks)}
    physical = {split_port(port)[0] for source, targets, _, is_physical in lines if is_physical
                for port in (source, *targets)}  # fmt: skip
    drawn = (
        replace(drawing, physical=block.sid in physical)
        for block, drawing in zip(
            blocks, signal_blocks(model, blocks, names, inputs, outputs), strict=True
        )
    )

    def end(port: str, ports: Mapping[str, list[str]]) -> tuple[int, int]:
        sid = split_port(port)[0]
        return place[sid], ports[sid].index(port)

    nets = (
        Net(
            source=end(source, outputs),
            targets=tuple(end(port, inputs) for port in targets),
            label=cut(name),
            physical=is_physical,
            arrow=not is_physical,
        )
        for source, targets, name, is_physical in lines
    )
    return Picture(
        title=title, blocks=tuple(drawn), nets=tuple(sorted(nets, key=lambda net: net.source))
    )


def _signals(model: Model, top: Mapping[str, object]) -> Iterator[Line]:
    targets: dict[str, list[str]] = {}
    names: dict[str, str] = {}
    for wire in model.wires:
        if _are_in(top, (wire.source, wire.target)):
            targets.setdefault(wire.source, []).append(wire.target)
            names[wire.source] = names.get(wire.source) or wire.name
    for source, ends in targets.items():
        yield source, tuple(ends), names[source], False


def _connections(model: Model, top: Mapping[str, object]) -> Iterator[Line]:
    """Yield the physical connections; they have no direction, but leave blocks at the right."""
    for node in model.nodes:
        inside = [port for port in node if _are_in(top, (port,))]
        inside.sort(key=lambda port: split_port(port)[1] != "rconn")
        if len(inside) > 1:
            yield inside[0], tuple(inside[1:]), "", True


def _are_in(top: Mapping[str, object], ports: Iterable[str]) -> bool:
    return all(split_port(port)[0] in top for port in ports)
