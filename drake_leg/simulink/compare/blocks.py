"""The blocks of two models that act, and which of them stand for each other.

Blocks that only carry signals on have dissolved in these, and so have constants and sines. What is
left is matched by its kind and by what it is connected with, some blocks away; of blocks that are
alike in that, names and values decide, and then the order.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Hashable, Mapping, Sequence
from functools import cached_property, partial

from drake_leg.simulink.compare.signals import Atom, Signal
from drake_leg.simulink.compare.simulink_signals import SimulinkSignals, unit_factor
from drake_leg.simulink.mechanism import TO_PHYSICAL, Frame
from drake_leg.simulink.model import Block, Model

REACH = 4  # blocks away, as far as a block is told by what it is connected with
CONFIGURATIONS = ("Mechanism Configuration", "Solver Configuration")
WORLDS = ("World Frame", "Reference Frame")
NOTHING = ("Terminator", "Ground")
End = tuple[Hashable, ...]  # what a physical port is connected with


class ActingBlocks:
    """The acting blocks of a flattened model, and what they are connected with.

    Parameters
    ----------
    bodies : mapping
        Frame of the model -> number of the body that carries it, or None, the same on both sides.
    placed : mapping
        SID of a block of the mechanism -> a joint's or a sensor's name, the same on both sides; ""
        of what is rigid.
    """

    def __init__(
        self,
        model: Model,
        signals: SimulinkSignals,
        bodies: Mapping[Frame, int | None],
        placed: Mapping[str, str],
    ) -> None:
        self.signals = signals
        self._bodies, self._placed = bodies, placed
        self._nodes = model.nodes
        self._node_of = {port: place for place, node in enumerate(model.nodes) for port in node}
        self._around: dict[str, list[tuple[Hashable, str]]] = {}
        self.ports: dict[str, list[str]] = {}  # SID -> its physical ports that are connected
        for port in self._node_of:
            self.ports.setdefault(port.partition("#")[0], []).append(port)
        self.acting = {block.sid: block for block in model.blocks if self._acts(block)}

    def _acts(self, block: Block) -> bool:
        if block.sid in self._placed or block.kind in WORLDS or block.type in NOTHING:
            return False
        return block.sid in self.signals.makers or not self.signals.dissolves(block)

    def inputs(self, sid: str) -> dict[str, Signal]:
        """Map the connected inputs of a block, ``in:1`` and so on, to their signals.

        What enters the physical network does so in SI.
        """
        block = self.acting[sid]
        factor = unit_factor(block) if block.kind == TO_PHYSICAL else 1.0
        found = {}
        for port in self.signals.inputs_of.get(sid, ()):
            signal = self.signals.at(port) or ()
            if factor != 1.0:
                signal = tuple(scalar.scaled(factor) for scalar in signal)
            found[port.partition("#")[2]] = signal
        return found

    def ends(self, sid: str, name: Callable[[str], Hashable]) -> dict[str, frozenset[End]]:
        """Map the physical ports of a block to what they are connected with.

        ``name`` names another acting block by its SID.
        """
        found: dict[str, frozenset[End]] = {}
        for port in self.ports.get(sid, ()):
            node = self._node_of[port]
            if node in self._bodies:
                ends: list[End] = [("body", self._bodies[node])]
            else:
                ends = [end for other in self._nodes[node] if (end := self._end(other, port, name))]
            found[port.partition("#")[2]] = frozenset(ends)
        return found

    def frame(self, port: str) -> Frame:
        """Return the frame at a physical port."""
        return self._node_of.get(port, port)

    def _end(self, other: str, port: str, name: Callable[[str], Hashable]) -> End:
        sid, _, place = other.partition("#")
        if other == port:
            return ()
        if self._placed.get(sid):
            return (self._placed[sid], place)
        return ("block", name(sid), place) if sid in self.acting else ()

    def around(self, sid: str) -> list[tuple[Hashable, str]]:
        """List the acting blocks that one is connected with, and how."""
        if sid not in self._around:
            found: dict[tuple[Hashable, str], None] = {}
            for port, signal in self.inputs(sid).items():
                for place, scalar in enumerate(signal):
                    for atom in scalar.terms:
                        if atom.of in self.acting:
                            found[("in", port, place, atom.what, atom.index), atom.of] = None
            for other, port in self.consumers.get(sid, ()):
                found[("out", port), other] = None
            for port, ends in self.ends(sid, lambda other: other).items():
                for end in ends:
                    if end[0] == "block":
                        found[("end", port, end[2]), str(end[1])] = None
            self._around[sid] = list(found)
        return self._around[sid]

    @cached_property
    def consumers(self) -> dict[str, list[tuple[str, str]]]:
        """Map a block to the inputs, as block and port, that its outputs reach."""
        found: dict[str, list[tuple[str, str]]] = {}
        for sid in self.acting:
            for port, signal in self.inputs(sid).items():
                for source in dict.fromkeys(atom.of for one in signal for atom in one.terms):
                    if source in self.acting:
                        found.setdefault(source, []).append((sid, port))
        return found


Names = Callable[[Block], Sequence[Hashable]]


def match_blocks(ours: ActingBlocks, theirs: ActingBlocks, names: Names) -> dict[str, str]:
    """Match acting blocks: SID -> the other's SID.

    ``names`` lists what tells a block from others that are connected alike, the best first.
    """
    words: dict[Hashable, int] = {}
    levels = list(zip(_labels(ours, words), _labels(theirs, words), strict=True))
    matching = _Matching(ours, theirs)
    for mine, others in reversed(levels):
        matching.at_level(mine, others, names)
    return matching.found


_Named = list[tuple[str, tuple[Hashable, ...]]]  # SIDs, each with what names its block


def _named(names: Names, blocks: Sequence[Block]) -> _Named:
    return [(block.sid, (*names(block), "in order")) for block in blocks]


def _keyed(blocks: _Named, place: int) -> list[tuple[str, Hashable]]:
    return [(sid, keys[place]) for sid, keys in blocks]


class _Matching:
    """Matches blocks of one label, and goes from each pair to the blocks that it is connected with.

    So of several equal parts that do the same, whose labels are the same, each one is matched with
    a single one.
    """

    def __init__(self, ours: ActingBlocks, theirs: ActingBlocks) -> None:
        self._ours, self._theirs = ours, theirs
        self.found: dict[str, str] = {}
        self._taken: set[str] = set()
        self._labels: tuple[Mapping[str, int], Mapping[str, int]] = ({}, {})

    def at_level(self, mine: Mapping[str, int], others: Mapping[str, int], names: Names) -> None:
        """Match what is left by its label: what is alone with it, then by its names and order."""
        self._labels = mine, others
        for pair in list(self.found.items()):
            self._go_on(pair)
        groups: dict[int, tuple[list[Block], list[Block]]] = {}
        for block in self._left(self._ours, self.found):
            groups.setdefault(mine[block.sid], ([], []))[0].append(block)
        for block in self._left(self._theirs, self._taken):
            groups.setdefault(others[block.sid], ([], []))[1].append(block)
        both = [group for group in groups.values() if all(group)]
        for mine_alike, others_alike in both:
            if len(mine_alike) == len(others_alike) == 1:
                self._match(mine_alike[0].sid, others_alike[0].sid)
        several = [group for group in both if len(group[0]) + len(group[1]) > 2]
        self._by_names([tuple(map(partial(_named, names), group)) for group in several])

    def _by_names(self, groups: Sequence[tuple[_Named, ...]]) -> None:
        """Match what is alike by its names, the best first, and then in order."""
        count = max((len(keys) for side, _ in groups for _, keys in side), default=0)
        for place in range(count):
            for ours, theirs in groups:
                self._by_key(_keyed(ours, place), _keyed(theirs, place))

    def _left(self, side: ActingBlocks, known: Container[str]) -> list[Block]:
        return [block for sid, block in side.acting.items() if sid not in known]

    def _by_key(
        self, ours: Sequence[tuple[str, Hashable]], theirs: Sequence[tuple[str, Hashable]]
    ) -> None:
        """Match what is left of both sides by keys, in order."""
        free: dict[Hashable, list[str]] = {}
        for sid, key in reversed(theirs):
            if sid not in self._taken:
                free.setdefault(key, []).append(sid)
        for sid, key in ours:
            if sid in self.found:
                continue
            alike = free.get(key, [])
            while alike and alike[-1] in self._taken:
                alike.pop()
            if alike:
                self._match(sid, alike.pop())

    def _match(self, sid: str, other: str) -> None:
        """Match a pair, and all that follows from it."""
        if sid in self.found or other in self._taken:
            return
        line = [(sid, other)]
        self.found[sid] = other
        self._taken.add(other)
        while line:
            line += self._next(line.pop())

    def _go_on(self, pair: tuple[str, str]) -> None:
        line = [pair]
        while line:
            line += self._next(line.pop())

    def _next(self, pair: tuple[str, str]) -> list[tuple[str, str]]:
        """Match what is connected with both blocks of a pair in one way, and with no others."""
        found = []
        around = [
            side.around(sid) for side, sid in zip((self._ours, self._theirs), pair, strict=True)
        ]
        ends: list[dict[Hashable, list[str]]] = [{}, {}]
        for side, (labels, known) in enumerate(
            zip(self._labels, (self.found, self._taken), strict=True)
        ):
            for how, sid in around[side]:
                if sid not in known:
                    ends[side].setdefault((how, labels[sid]), []).append(sid)
        for how, mine in ends[0].items():
            others = ends[1].get(how, [])
            if len(mine) == len(others) == 1:
                (a,), (b,) = mine, others
                if a not in self.found and b not in self._taken:
                    self.found[a] = b
                    self._taken.add(b)
                    found.append((a, b))
        return found


def _labels(side: ActingBlocks, words: dict[Hashable, int]) -> list[dict[str, int]]:
    """Number blocks by their kind, then by what they are connected with, farther and farther."""

    def number(word: Hashable) -> int:
        return words.setdefault(word, len(words))

    inputs = {sid: side.inputs(sid) for sid in side.acting}
    found = [{sid: number(block.kind) for sid, block in side.acting.items()}]
    for _ in range(REACH):
        last = found[-1]

        def told(atom: Atom, last: Mapping[str, int] = last) -> Hashable:
            """Tell an atom without its numbers and without the SID of its block."""
            if atom.kind == "sine":
                return "sine"
            if atom.kind in ("sensed", "foot"):
                return atom
            return atom.kind, last.get(atom.of, -1), atom.what, atom.index

        found.append(
            {
                sid: number(
                    (
                        last[sid],
                        tuple(
                            (port, tuple(frozenset(map(told, one.terms)) for one in signal))
                            for port, signal in sorted(inputs[sid].items())
                        ),
                        tuple(sorted((last[c], port) for c, port in side.consumers.get(sid, ()))),
                        tuple(sorted(side.ends(sid, last.__getitem__).items(), key=_port)),
                    )
                )
                for sid in side.acting
            }
        )
    return found


def _port(item: tuple[str, object]) -> str:
    return item[0]
