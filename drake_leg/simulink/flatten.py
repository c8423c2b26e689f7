"""A model without its boundaries: subsystems opened, Goto and From joined."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, Model, SignalWire, split_port
from drake_leg.simulink.wiring import join

_GATES = {"enable": "EnablePort", "trigger": "TriggerPort", "ifaction": "ActionPort"}
_ROUTING = ("Goto", "From", "GotoTagVisibility")
_LABELS = ("Connection Label", "ConnectionLabel")
_CONNECTION_PORTS = ("PMIOPort", "Connection Port")


def flatten(model: Model) -> Model:
    """Take away every boundary, so that wires and nodes lead from leaf block to leaf block.

    Subsystems, virtual or atomic, go with their Inport, Outport and Connection Port blocks, and so
    do Goto, From and Connection Labels. Inport and Outport blocks of the top stay. Wires have the
    name that is nearest to their target. `Block.system` still tells where a block was.

    Raises
    ------
    InvalidValueError
        If a From has no Goto or several, or a signal runs in a circle of such blocks only.
    """
    blocks = {block.sid: block for block in model.blocks}
    leaves = tuple(block for block in model.blocks if _is_leaf(block))
    return replace(
        model,
        blocks=leaves,
        wires=_Signals(model, blocks).wires(),
        nodes=_nodes(model, blocks),
    )


def _is_open(block: Block) -> bool:
    """Whether it is a subsystem that one can look into."""
    return block.type == "SubSystem" and block.parameters.get("SFBlockType") == "NONE"


def _is_leaf(block: Block) -> bool:
    if block.type in ("Inport", "Outport") or block.kind in _CONNECTION_PORTS:
        return not block.system
    return not (_is_open(block) or block.type in _ROUTING or block.kind in _LABELS)


class _Signals:
    """Follows signals backwards, from an input to the leaf block that drives it."""

    def __init__(self, model: Model, blocks: dict[str, Block]) -> None:
        self._blocks = blocks
        self._drivers = {wire.target: wire for wire in model.wires}
        self._ports = {
            (block.system, block.type, block.parameters.get("Port")): block
            for block in model.blocks
            if block.type in ("Inport", "Outport")
        }
        self._gotos: dict[str, list[Block]] = {}
        for block in model.blocks:
            if block.type == "Goto":
                tag = str(block.parameters.get("GotoTag"))
                self._gotos.setdefault(tag, []).append(block)

    def wires(self) -> tuple[SignalWire, ...]:
        """Return the wires between leaf blocks."""
        found = []
        for wire in self._drivers.values():
            sid, kind, _ = split_port(wire.target)
            block = self._blocks[sid]
            target = wire.target
            if _is_open(block) and kind in _GATES:
                target = self._gate(block, kind)
            elif not _is_leaf(block):
                continue
            source, name = self._origin(wire)
            if source:
                found.append(SignalWire(source=source, target=target, name=name))
        return tuple(found)

    def _gate(self, subsystem: Block, kind: str) -> str:
        for block in self._blocks.values():
            if block.system == subsystem.sid and block.type == _GATES[kind]:
                return f"{block.sid}#in:1"
        raise InvalidValueError(
            f"block {subsystem.name!r} (SID {subsystem.sid}) has a wire to its {kind} port, but no "
            f"{_GATES[kind]} block inside: save the model again in Simulink"
        )

    def _origin(self, wire: SignalWire | None) -> tuple[str, str]:
        """Return the leaf output at the wire's beginning, "" where there is none, and a name."""
        name = ""
        seen = set()
        while wire is not None:
            if wire.target in seen:
                raise InvalidValueError(
                    f"the signal at {wire.target} runs in a circle without a block: wire it to one"
                )
            seen.add(wire.target)
            name = name or wire.name
            sid, _, number = split_port(wire.source)
            block = self._blocks[sid]
            if _is_leaf(block):
                return wire.source, name
            wire = self._drivers.get(self._behind(block, number))
        return "", name

    def _behind(self, block: Block, number: int) -> str:
        """Return the input that an output of a boundary block repeats; "" where there is none."""
        if block.type == "From":
            return f"{self._goto(block).sid}#in:1"
        if block.type == "Inport":
            return f"{block.system}#in:{_count(block.parameters.get('Port'))}"
        outport = self._ports.get((block.sid, "Outport", float(number)))
        return f"{outport.sid}#in:1" if outport else ""

    def _goto(self, block: Block) -> Block:
        """Return the Goto of a From: that of its system, or the only one that is visible there."""
        tag = str(block.parameters.get("GotoTag"))
        alike = self._gotos.get(tag, [])
        near = [goto for goto in alike if goto.system == block.system]
        far = [goto for goto in alike if goto.parameters.get("TagVisibility") != "local"]
        fits = near or far
        if len(fits) != 1:
            raise InvalidValueError(
                f"block {block.name!r} (SID {block.sid}) has the tag {tag!r}, for which there "
                f"{'are several Gotos' if fits else 'is no Goto'}: name each Goto differently"
            )
        return fits[0]


def _nodes(model: Model, blocks: dict[str, Block]) -> tuple[tuple[str, ...], ...]:
    """Unite nodes across connection ports and labels, then leave the leaves' ports."""
    groups: list[tuple[str, ...]] = list(model.nodes)
    ports_of: dict[str, set[str]] = {}
    for port in (port for node in model.nodes for port in node):
        ports_of.setdefault(split_port(port)[0], set()).add(port)
    inside: dict[str, list[Block]] = {}
    labels: dict[tuple[str, str], list[str]] = {}
    for block in model.blocks:
        own = sorted(ports_of.get(block.sid, ()))
        if block.kind in _CONNECTION_PORTS:
            inside.setdefault(block.system, []).append(block)
            groups.append(tuple(own))
        elif block.kind in _LABELS:
            label = (block.system, str(block.parameters.get("Label", block.name)))
            labels.setdefault(label, []).extend(own)
    groups.extend(tuple(ports) for ports in labels.values())
    for system, connection_ports in inside.items():
        groups.extend(
            (outer, port)
            for outer, block in _outer_ports(system, connection_ports)
            for port in ports_of.get(block.sid, ())
        )
    kept = (
        tuple(port for port in node if _is_leaf(blocks[split_port(port)[0]]))
        for node in join(groups)
    )
    return tuple(node for node in kept if len(node) > 1)


def _outer_ports(system: str, connection_ports: Iterable[Block]) -> list[tuple[str, Block]]:
    """Number the connection ports of a subsystem, each side by itself, in the order of `Port`."""
    if not system:
        return []
    numbered = []
    for side, kind in (("left", "lconn"), ("right", "rconn")):
        here = [
            block for block in connection_ports if str(block.parameters.get("Side")).lower() == side
        ]
        here.sort(key=lambda block: _count(block.parameters.get("Port")))
        numbered += [
            (f"{system}#{kind}:{place}", block) for place, block in enumerate(here, start=1)
        ]
    return numbered


def _count(value: object) -> int:
    return int(value) if isinstance(value, float) and 0 < value < 1e6 else 0
