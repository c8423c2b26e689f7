"""From drawn lines to signal wires and physical nodes."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.diagram import Diagram, DrawnBlock, DrawnLine
from drake_leg.simulink.model import SignalWire, split_port


def wires_of(diagram: Diagram) -> tuple[SignalWire, ...]:
    """Make one wire of every way from an output to an input.

    Lines that hang, and those at blocks that are commented out, are left out; what goes into a
    block that is commented through comes out of it.
    """
    through = diagram.through
    blocks = diagram.blocks | through
    wires: dict[str, SignalWire] = {}
    for line in diagram.lines:
        if line.physical or not line.source:
            continue
        _require_blocks(line, blocks, diagram.commented)
        _require_directions(line)
        for end in line.ends:
            if not _has_blocks((line.source, end), blocks):
                continue
            if end in wires:
                raise InvalidValueError(
                    f"two lines end at input {end} of {blocks[split_port(end)[0]]}: save the "
                    "model again in Simulink"
                )
            wires[end] = SignalWire(source=line.source, target=end, name=line.name)
    ends = [wire for wire in wires.values() if split_port(wire.target)[0] not in through]
    bridged = (_bridged(wire, wires, through) for wire in ends)
    return tuple(wire for wire in bridged if wire is not None)


def _bridged(
    wire: SignalWire, wires: Mapping[str, SignalWire], through: Container[str]
) -> SignalWire | None:
    """Follow a wire backwards through blocks that are commented through."""
    seen: set[str] = set()
    while True:
        sid, kind, number = split_port(wire.source)
        if sid not in through:
            return wire
        before = wires.get(f"{sid}#in:{number}") if kind == "out" else None
        if before is None:
            return None
        if wire.source in seen:
            raise InvalidValueError(
                f"the signal at {wire.target} runs in a circle of blocks that are commented "
                "through: uncomment one"
            )
        seen.add(wire.source)
        wire = replace(wire, source=before.source, name=wire.name or before.name)


def nodes_of(diagram: Diagram) -> tuple[tuple[str, ...], ...]:
    """Join the physical ports that are connected, at least two a node.

    A block that is commented through joins its first ports on both sides.
    """
    through = diagram.through
    blocks = diagram.blocks | through
    groups: list[list[str]] = []
    for line in diagram.lines:
        if line.physical:
            _require_blocks(line, blocks, diagram.commented)
            groups.append([end for end in line.ends if _has_blocks((end,), blocks)])
    groups += [[f"{sid}#lconn:1", f"{sid}#rconn:1"] for sid in through]
    kept = (
        tuple(port for port in node if split_port(port)[0] not in through) for node in join(groups)
    )
    return tuple(node for node in kept if len(node) > 1)


def join(groups: Iterable[Sequence[str]]) -> tuple[tuple[str, ...], ...]:
    """Unite groups that share a member; those of one member are left out."""
    parent: dict[str, str] = {}

    def root(member: str) -> str:
        while (above := parent.setdefault(member, member)) != member:
            parent[member] = parent[above]
            member = above
        return member

    for group in groups:
        for other in group[1:]:
            parent[root(other)] = root(group[0])
    united: dict[str, list[str]] = {}
    for member in list(parent):
        united.setdefault(root(member), []).append(member)
    return tuple(tuple(members) for members in united.values() if len(members) > 1)


def _require_directions(line: DrawnLine) -> None:
    for port, wrong in ((line.source, "in"), *((end, "out") for end in line.ends)):
        if split_port(port)[1] == wrong:
            side = "begins" if wrong == "in" else "ends"
            raise InvalidValueError(
                f"a line {side} at {port}, which is no {'output' if wrong == 'in' else 'input'}: "
                "save the model again in Simulink"
            )


def _has_blocks(ports: Iterable[str], blocks: Mapping[str, DrawnBlock]) -> bool:
    return all(split_port(port)[0] in blocks for port in ports)


def _require_blocks(
    line: DrawnLine, blocks: Mapping[str, DrawnBlock], commented: Container[str]
) -> None:
    for port in (line.source, *line.ends):
        sid = split_port(port)[0] if port else ""
        if port and sid not in blocks and sid not in commented:
            raise InvalidValueError(
                f"a line ends at {port}, but there is no block with SID {sid}: save the model "
                "again in Simulink"
            )
