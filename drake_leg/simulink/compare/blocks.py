"""The blocks of two models that act, and which of them stand for each other.

Blocks that only carry signals on have dissolved in these, and so have constants and sines. What is
left is matched by its kind and by what it is connected with, some blocks away; of blocks that are
alike in that, names and values decide, and then the order.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping
from functools import cached_property

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


def match_blocks(
    ours: ActingBlocks, theirs: ActingBlocks, name: Callable[[Block], Collection[Hashable]]
) -> dict[str, str]:
    """Match acting blocks: SID -> the other's SID.

    ``name`` lists what tells a block from others that are connected alike, the best first.
    """
    words: dict[Hashable, int] = {}
    levels = list(zip(_labels(ours, words), _labels(theirs, words), strict=True))
    found: dict[str, str] = {}
    taken: set[str] = set()
    for mine, others in reversed(levels):
        groups: dict[int, tuple[list[Block], list[Block]]] = {}
        for side, acting, labels, known in (
            (0, ours.acting, mine, found.keys()),
            (1, theirs.acting, others, taken),
        ):
            for sid, block in acting.items():
                if sid not in known:
                    groups.setdefault(labels[sid], ([], []))[side].append(block)
        for one, other in groups.values():
            for a, b in _paired(one, other, name):
                found[a.sid] = b.sid
                taken.add(b.sid)
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


def _paired(
    ours: list[Block], theirs: list[Block], name: Callable[[Block], Collection[Hashable]]
) -> Iterable[tuple[Block, Block]]:
    """Pair blocks that are alike: by what names them, the best first, then by their order."""
    if not (ours and theirs):
        return []
    if len(ours) == len(theirs) == 1:
        return [(ours[0], theirs[0])]
    found: list[tuple[Block, Block]] = []
    named = [[(block, tuple(name(block))) for block in side] for side in (ours, theirs)]
    for place in range(len(named[0][0][1])):
        free: dict[Hashable, list[Block]] = {}
        for block, keys in reversed(named[1]):
            free.setdefault(keys[place], []).append(block)
        left = []
        for block, keys in named[0]:
            alike = free.get(keys[place])
            if alike:
                found.append((block, alike.pop()))
            else:
                left.append((block, keys))
        taken = {id(other) for _, other in found}
        named = [left, [each for each in named[1] if id(each[0]) not in taken]]
    found += [(a, b) for (a, _), (b, _) in zip(*named, strict=False)]
    return found
