"""In which order the blocks of a network run, and where algebraic loops leave none."""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from drake_leg.arguments import some_of
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, split_port
from drake_leg.simulink.running.kinds import Kind
from drake_leg.simulink.running.network import Node
from drake_leg.simulink.running.settings import Settings

CONSTRAINTS = ("AlgebraicConstraint", "Algebraic Constraint")  # they put out unknowns
BUSES = ("BusCreator", "BusAssignment")
SHOWN = 20  # blocks of a loop in a sentence
ROOTS = 40  # blocks of a loop at which its order is tried to begin

Needs = Mapping[str, Sequence[tuple[str, str | None]]]  # blocks that one needs, by which port


@dataclass(frozen=True, eq=False, kw_only=True)
class AlgebraicLoop:
    """Blocks each of which needs the outputs of all at once."""

    blocks: tuple[Block, ...]  # in the order of the file
    order: tuple[str, ...]  # their SIDs as they run, once the unknowns are known
    torn: tuple[str, ...]  # ports whose values are the unknowns
    is_constrained: bool  # whether an Algebraic Constraint or a physical network asks for it
    is_open: bool  # whether the unknowns leave an order

    @property
    def names(self) -> str:
        """Name the blocks."""
        return some_of([f"{block.name!r} (SID {block.sid})" for block in self.blocks], SHOWN)

    @property
    def refusal(self) -> str:
        """Say that it does not run, and the ways out."""
        ways = "break it with a Memory or a Unit Delay, or replace one of them"
        if self.is_open:
            ways = "break it with a Memory or a Unit Delay, replace one of them, or `solve_loops`"
        return f"the signals form an algebraic loop: {self.names}: {ways}"


@dataclass(frozen=True, eq=False, kw_only=True)
class Iteration:
    """The blocks of a subsystem that iterates, in the order in which they run."""

    iterator: str  # SID of its For Iterator or While Iterator
    order: tuple[str, ...]


Step = str | AlgebraicLoop | Iteration


def ordered(nodes: Mapping[str, tuple[Node, Kind]]) -> list[Step]:
    """Order the blocks so that each comes after those whose outputs it needs at once.

    Where there is no such order, an algebraic loop stands for its blocks; and an iteration for
    those of a subsystem that iterates, which need all that comes into it.
    """
    unit = {sid: node.loops[0] if node.loops else sid for sid, (node, _) in nodes.items()}
    needs: dict[str, list[tuple[str, str | None]]] = {one: [] for one in unit.values()}
    within: dict[str, dict[str, tuple[Node, Kind]]] = {}
    for sid, found in nodes.items():
        if not found[0].loops:
            needs[sid] += _needed_at_once(*found, nodes)
            continue
        within.setdefault(unit[sid], {})[sid] = found
        ports = [port for port in found[0].inputs if port is not None]
        sources = [(gate, None) for gate in found[0].gates] + [(split_port(p)[0], p) for p in ports]
        needs[unit[sid]] += [each for each in sources if unit.get(each[0], unit[sid]) != unit[sid]]
    needs = {one: [(unit[sid], port) for sid, port in each] for one, each in needs.items()}
    return [_step(step, within) for step in _ordered(nodes, needs)]


def _step(step: str | AlgebraicLoop, within: Mapping[str, Mapping[str, tuple[Node, Kind]]]) -> Step:
    """Return a step; an iteration in the place of its iterator, none in an algebraic loop."""
    if isinstance(step, AlgebraicLoop):
        return replace(step, is_open=False) if set(step.order) & set(within) else step
    if step not in within:
        return step
    inside = within[step]
    needs = {sid: _needed_at_once(*found, inside) for sid, found in inside.items()}
    inner = _ordered(inside, needs)
    for each in inner:
        if isinstance(each, AlgebraicLoop):
            return replace(each, is_open=False)
    return Iteration(iterator=step, order=tuple(each for each in inner if isinstance(each, str)))


def _ordered(nodes: Mapping[str, tuple[Node, Kind]], needs: Needs) -> list[str | AlgebraicLoop]:
    """Order what needs one another."""
    found: list[str | AlgebraicLoop] = []
    for circle in _circles(needs):
        (first, *others) = circle
        if others or any(source == first for source, _ in needs[first]):
            found.append(_loop(sorted(circle, key=list(nodes).index), needs, nodes))
        else:
            found.append(first)
    return found


def _needed_at_once(node: Node, kind: Kind, nodes: Container[str]) -> list[tuple[str, str | None]]:
    """Find the blocks that a block needs at once: what lets it run, and the ports that it reads."""
    try:
        places = tuple(kind.direct(node, Settings(node.block)))
    except InvalidValueError:
        places = ()  # what is wrong with a value is said where the block is written
    ports = [port for place in places if (port := node.inputs[place]) is not None]
    sources = [(gate, None) for gate in node.gates] + [(split_port(p)[0], p) for p in ports]
    return [each for each in sources if each[0] in nodes]


def _circles(needs: Needs) -> Iterator[list[str]]:
    """Yield the blocks that need one another, those that they need before them.

    By R. Tarjan: Depth-first search and linear graph algorithms, SIAM J. Comput. 1 (1972).
    """
    number: dict[str, int] = {}
    least: dict[str, int] = {}
    open_ones: dict[str, None] = {}
    for first in needs:
        if first in number:
            continue
        line: list[tuple[str, Iterator[str]]] = []
        following: str | None = first
        while following is not None or line:
            if following is not None:
                number[following] = least[following] = len(number)
                open_ones[following] = None
                line.append((following, iter([source for source, _ in needs[following]])))
            sid, rest = line[-1]
            following = None
            for source in rest:
                if source not in number:
                    following = source
                    break
                if source in open_ones:
                    least[sid] = min(least[sid], number[source])
            if following is not None:
                continue
            line.pop()
            if line:
                above = line[-1][0]
                least[above] = min(least[above], least[sid])
            if least[sid] == number[sid]:
                circle: list[str] = []
                while not circle or circle[-1] != sid:
                    circle.append(open_ones.popitem()[0])
                yield circle


def _loop(
    sids: Sequence[str], needs: Needs, nodes: Mapping[str, tuple[Node, Kind]]
) -> AlgebraicLoop:
    """Choose the unknowns of a loop: as few ports as possible, and none of a bus."""
    blocks = {sid: nodes[sid][0].block for sid in sids}
    constraints = [sid for sid in sids if blocks[sid].kind in CONSTRAINTS]
    within: Needs = {
        sid: [
            (source, port)
            for source, port in needs[sid]
            if source in blocks and source not in constraints
        ]
        for sid in sids
    }
    given = tuple(port for sid in constraints for port in nodes[sid][0].outputs)
    least, order = math.inf, list(sids)
    torn: list[str | None] = [None]
    for root in sids[:ROOTS]:
        its_order, its_torn = _opened([root, *sids], within)
        cost = sum(_cost(port, blocks) for port in its_torn)
        if cost < least:
            least, order, torn = cost, its_order, its_torn
    return AlgebraicLoop(
        blocks=tuple(blocks.values()),
        order=tuple(order),
        torn=(*given, *(port for port in torn if port is not None)),
        is_constrained=bool(given) or all(nodes[sid][0].part is not None for sid in sids),
        is_open=None not in torn,
    )


def _cost(port: str | None, blocks: Mapping[str, Block]) -> float:
    """Tell how bad it is that a port is unknown; None is what lets a block run."""
    if port is None:
        return math.inf
    return len(blocks) if blocks[split_port(port)[0]].type in BUSES else 1.0


def _opened(roots: Sequence[str], within: Needs) -> tuple[list[str], list[str | None]]:
    """Order blocks that need one another from a root; the ports are read before they are known.

    Among them is None where a block would run before it is known whether it may.
    """
    order: list[str] = []
    torn: dict[str | None, None] = {}
    state: dict[str, int] = {}  # 1 on the way, 2 done
    for root in roots:
        if root in state:
            continue
        state[root] = 1
        line = [(root, iter(within[root]))]
        while line:
            sid, rest = line[-1]
            source, port = next(rest, ("", None))
            if not source:
                state[sid] = 2
                order.append(sid)
                line.pop()
            elif source not in state:
                state[source] = 1
                line.append((source, iter(within[source])))
            elif state[source] == 1:
                torn[port] = None
    return order, list(torn)
