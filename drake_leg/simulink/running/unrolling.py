"""For Each subsystems as copies of their blocks, one for each part of what comes in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from drake_leg.simulink.running.network import Node, SignalNetwork

EACH = "ForEach"
_COUNT = ".copies"
JOINED = "joined copies"  # kind of the node that joins what copies put out


def count_of(sid: str) -> str:
    """Return the name under which the number of copies is noted that a For Each block asks for."""
    return f"{sid}{_COUNT}"


def is_count(name: str) -> bool:
    """Tell whether a number of copies is noted under a name."""
    return name.endswith(_COUNT)


def unrolled(network: SignalNetwork, counts: Mapping[str, tuple[int, ...]]) -> SignalNetwork:
    """Copy the blocks of For Each subsystems, as often as counted; once where that is not known."""
    nodes = dict(network.nodes)
    while folded := [s for s, node in nodes.items() if node.block.type == EACH and s in node.loops]:
        (count,) = counts.get(count_of(folded[0]), (1,))
        nodes = dict(_unrolled(nodes, folded[0], count))
    return replace(network, nodes=nodes)


def _unrolled(nodes: Mapping[str, Node], each: str, count: int) -> Iterator[tuple[str, Node]]:
    """Yield all nodes, those of one subsystem as copies."""
    inside = {sid for sid, node in nodes.items() if each in node.loops}
    for sid, node in nodes.items():
        if sid not in inside:
            yield sid, node
            continue
        copies = [_copy(node, place, inside, each) for place in range(count)]
        yield from ((copy.sid, copy) for copy in copies)
        if node.block.type == "Outport" and node.block.system == nodes[each].block.system:
            yield sid, _join(node, copies, each)


def _copy(node: Node, place: int, inside: set[str], each: str) -> Node:
    """Make a copy of a node, whose neighbors within the subsystem are copies, too."""

    def named(sid: str) -> str:
        return f"{sid}@{place + 1}" if sid in inside else sid

    def port(name: str | None) -> str | None:
        if name is None:
            return None
        sid, _, rest = name.partition("#")
        return f"{named(sid)}#{rest}"

    return replace(
        node,
        block=replace(node.block, sid=named(node.sid)),
        inputs=tuple(port(each) for each in node.inputs),
        outputs=tuple(str(port(each)) for each in node.outputs),
        read=frozenset(str(port(each)) for each in node.read),
        gates=tuple(named(gate) for gate in node.gates),
        loops=tuple(named(loop) for loop in node.loops if loop != each),
        copy=place,
        copied=each,
    )


def _join(outport: Node, copies: list[Node], each: str) -> Node:
    """Make the node that joins what the copies of an Outport put out."""
    port = f"{outport.sid}#out:1"
    return replace(
        outport,
        block=replace(outport.block, type=JOINED),
        inputs=tuple(f"{copy.sid}#out:1" for copy in copies),
        names=("",) * len(copies),
        outputs=(port,),
        gates=outport.gates,
        loops=tuple(loop for loop in outport.loops if loop != each),
    )
