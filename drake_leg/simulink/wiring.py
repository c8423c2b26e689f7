"""A model without its boundaries: subsystems opened, Goto and From joined."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.diagram import Diagram, DrawnBlock, DrawnLine
from drake_leg.simulink.model import Block, Model, SignalWire, split_port

_GATES = {
    "enable": "EnablePort",
    "trigger": "TriggerPort",
    "ifaction": "ActionPort",
    "reset": "ResetPort",
}
ITERATORS = ("ForEach", "ForIterator", "WhileIterator")
_ROUTING = ("Goto", "From", "GotoTagVisibility")
_LABELS = ("Connection Label", "ConnectionLabel")
_CONNECTION_PORTS = ("PMIOPort", "Connection Port")
_BUS = "SimscapeBus"


def flatten(model: Model, *, gates: bool = False, strict: bool = True) -> Model:
    """Take away every boundary, so that wires and nodes lead from leaf block to leaf block.

    Subsystems, virtual or atomic, go with their Inport, Outport and Connection Port blocks, and so
    do Goto, From, Connection Labels and Simscape Buses. Inport and Outport blocks of the top stay.
    Wires have the name that is nearest to their target. `Block.system` still tells where a block
    was. Ports of one element of a bus stay: an Inport takes it out, and the first Outport of a port
    joins all. With ``gates``, the Outports of subsystems that are enabled, triggered, chosen or
    reset stay, too: they hold what they put out last. Unless it is ``strict``, nothing comes from a
    From that has no Goto or several.

    Raises
    ------
    InvalidValueError
        If a From has no Goto or several, or a signal runs in a circle of such blocks only.
    """
    blocks = {block.sid: block for block in model.blocks}
    gated = kept_ports(model) if gates else {}
    leaves = tuple(block for block in model.blocks if is_leaf(block, gated))
    return replace(
        model,
        blocks=leaves,
        wires=_Signals(model, blocks, gated, strict=strict).wires(),
        nodes=_nodes(model, blocks),
    )


def gated_systems(model: Model) -> frozenset[str]:
    """SIDs of the subsystems that are enabled, triggered, reset, or chosen by an If."""
    return frozenset(block.system for block in model.blocks if block.type in _GATES.values())


def kept_ports(model: Model) -> dict[str, tuple[str, ...]]:
    """Return the kinds of ports that stay of subsystems, by their SIDs.

    They are the Outports of those that are gated, and all ports of those that iterate.
    """
    kept: dict[str, tuple[str, ...]] = dict.fromkeys(gated_systems(model), ("Outport",))
    iterating = (block.system for block in model.blocks if block.type in ITERATORS and block.system)
    return kept | dict.fromkeys(iterating, ("Inport", "Outport"))


def physical_part(model: Model) -> Model:
    """Take away every boundary of the physical connections, and all signals."""
    blocks = {block.sid: block for block in model.blocks}
    leaves = tuple(block for block in model.blocks if is_leaf(block))
    return replace(model, blocks=leaves, wires=(), nodes=_nodes(model, blocks))


def is_open(block: Block) -> bool:
    """Tell whether it is a subsystem that one can look into."""
    return block.type == "SubSystem" and block.parameters.get("SFBlockType") == "NONE"


def is_of_bus(block: Block) -> bool:
    """Tell whether it is a port of one element of a bus; several of them share one port."""
    return bool(element_of(block)) and block.type in ("Inport", "Outport")


def element_of(block: Block) -> str:
    """Return the element of the bus that a port takes, ``leg.knee``; "" where it takes all."""
    texts: Mapping[str, str] = getattr(block.parameters, "texts", {})
    return texts.get("Element", "").strip()


def _place_in_bus(block: Block) -> int:
    text = getattr(block.parameters, "texts", {}).get("PortBlockIndex", "")
    return int(text) if text.isdecimal() else 1


def is_leaf(block: Block, kept: Mapping[str, tuple[str, ...]] | None = None) -> bool:
    """Tell whether a block stays where boundaries are taken away."""
    if kept and block.type in kept.get(block.system, ()):
        return True
    if block.system and is_of_bus(block):
        return block.type == "Inport" or _place_in_bus(block) == 1
    if block.type in ("Inport", "Outport") or block.kind in _CONNECTION_PORTS:
        return not block.system
    if block.type == _BUS:
        return False
    return not (is_open(block) or block.type in _ROUTING or block.kind in _LABELS)


class _Signals:
    """Follows signals backwards, from an input to the leaf block that drives it."""

    def __init__(
        self,
        model: Model,
        blocks: dict[str, Block],
        gated: Mapping[str, tuple[str, ...]],
        *,
        strict: bool,
    ) -> None:
        self._blocks, self._gated, self._strict = blocks, gated, strict
        # In a library, what a From takes may come from the model that uses it.
        self._may_lack = model.variables is not None and model.variables.is_lent
        self._drivers = {wire.target: wire for wire in model.wires}
        self._ports = {
            (block.system, block.type, block.parameters.get("Port")): block
            for block in model.blocks
            if block.type in ("Inport", "Outport") and (not is_of_bus(block) or is_leaf(block))
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
            if is_open(block) and kind.lower() in _GATES:
                target = self._gate(block, kind.lower())
            elif block.type == "Outport" and block.system and is_of_bus(block):
                first = self._ports[block.system, "Outport", block.parameters.get("Port")]
                target = f"{first.sid}#in:{_place_in_bus(block)}"
            elif not is_leaf(block, self._gated):
                continue
            source, name = self._origin(wire)
            if block.type == "Outport" and is_of_bus(block):
                name = element_of(block)
            if source:
                found.append(SignalWire(source=source, target=target, name=name))
        return (*found, *self._into_elements(), *self._into_iterations())

    def _into_elements(self) -> Iterator[SignalWire]:
        """Yield the wires into ports of one element of a bus, from the bus."""
        for block in self._blocks.values():
            if block.type == "Inport" and block.system and is_of_bus(block):
                source, name = self._origin(self._drivers.get(self._behind(block, 1)))
                if source:
                    yield SignalWire(source=source, target=f"{block.sid}#in:1", name=name)

    def _into_iterations(self) -> Iterator[SignalWire]:
        """Yield the wires into ports of subsystems that iterate."""
        for block in self._blocks.values():
            if block.type == "Inport" and block.system in self._gated and not is_of_bus(block):
                if not is_leaf(block, self._gated):
                    continue
                source, name = self._origin(self._drivers.get(self._behind(block, 1)))
                if source:
                    yield SignalWire(source=source, target=f"{block.sid}#in:1", name=name)

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
                    f"the signal at {wire.target} forms a loop without any block: wire it to one"
                )
            seen.add(wire.target)
            name = name or wire.name
            sid, _, number = split_port(wire.source)
            block = self._blocks[sid]
            if is_leaf(block, self._gated):
                return wire.source, name
            held = self._ports.get((sid, "Outport", float(number)))
            if held is not None and is_leaf(held, self._gated):
                return f"{held.sid}#out:1", name
            wire = self._drivers.get(self._behind(block, number))
        return "", name

    def _behind(self, block: Block, number: int) -> str:
        """Return the input that an output of a boundary block repeats; "" where there is none."""
        if block.type == "From":
            goto = self._goto(block)
            return f"{goto.sid}#in:1" if goto else ""
        if block.type == "Inport":
            return f"{block.system}#in:{_count(block.parameters.get('Port'))}"
        outport = self._ports.get((block.sid, "Outport", float(number)))
        return f"{outport.sid}#in:1" if outport else ""

    def _goto(self, block: Block) -> Block | None:
        """Return the Goto of a From: that of its system, or the only one that is visible there."""
        tag = str(block.parameters.get("GotoTag"))
        alike = self._gotos.get(tag, [])
        near = [goto for goto in alike if goto.system == block.system]
        far = [goto for goto in alike if goto.parameters.get("TagVisibility") != "local"]
        fits = near or far
        if len(fits) != 1 and not (self._strict and (fits or not self._may_lack)):
            return None
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
        sides = (
            (block.sid, str(block.parameters.get("Side")), _count(block.parameters.get("Port")))
            for block in connection_ports
        )
        groups.extend(
            (f"{system}#{outer}", port)
            for sid, outer in outer_ports(sides if system else ()).items()
            for port in ports_of.get(sid, ())
        )
    kept = (
        tuple(port for port in node if is_leaf(blocks[split_port(port)[0]]))
        for node in _through_buses(groups, blocks)
    )
    return tuple(node for node in kept if len(node) > 1)


def _through_buses(
    groups: list[tuple[str, ...]], blocks: Mapping[str, Block]
) -> tuple[tuple[str, ...], ...]:
    """Unite groups, and what meets through Simscape Buses whose buses meet.

    The bus is at the right; its elements, named in order, are at the left.
    """
    while True:
        nodes = join(groups)
        found = [
            elements
            for node in nodes
            for elements in _elements(node, blocks).values()
            if len(elements) > 1
        ]
        united = {port: place for place, node in enumerate(nodes) for port in node}
        new = [each for each in found if len({united.get(port, port) for port in each}) > 1]
        if not new:
            return nodes
        groups = [*groups, *(tuple(each) for each in new)]


def _elements(node: Iterable[str], blocks: Mapping[str, Block]) -> dict[str, list[str]]:
    """Group the ports at the elements of a bus by their names."""
    found: dict[str, list[str]] = {}
    for port in node:
        sid, side, _ = split_port(port)
        if blocks[sid].type == _BUS and side == "rconn":
            names = str(blocks[sid].parameters.get("HierarchyStrings", "")).split(";")
            for place, name in enumerate(names, start=1):
                found.setdefault(name.strip(), []).append(f"{sid}#lconn:{place}")
    return found


def outer_ports(connection_ports: Iterable[tuple[str, str, int]]) -> dict[str, str]:
    """Number the connection ports of a subsystem from outside: ``lconn:1``, by SID.

    Each has its SID, its ``Side``, and its ``Port``, which orders those of one side.
    """
    ports = sorted(connection_ports, key=lambda port: port[2])
    numbered: dict[str, str] = {}
    for side, kind in (("left", "lconn"), ("right", "rconn")):
        here = [sid for sid, its, _ in ports if its.lower() == side]
        numbered |= {sid: f"{kind}:{place}" for place, sid in enumerate(here, start=1)}
    return numbered


def _count(value: object) -> int:
    return int(value) if isinstance(value, float) and 0 < value < 1e6 else 0


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
                f"the signal at {wire.target} forms a loop of blocks that are commented "
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
            side, right = ("begins", "output") if wrong == "in" else ("ends", "input")
            raise InvalidValueError(
                f"a line {side} at {port}, which is not an {right}: save the model again in "
                "Simulink"
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
