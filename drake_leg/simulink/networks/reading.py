"""Finds the networks of a flattened model, and what each of their blocks computes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from drake_leg.arguments import with_article
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, split_port
from drake_leg.simulink.networks import bridges, drives, electrical, mechanical  # noqa: F401 - fill KINDS
from drake_leg.simulink.networks.assembly import KINDS, Assembly, Bench
from drake_leg.simulink.networks.linear import Linear, Quantity
from drake_leg.simulink.networks.ports import Layout, layout_of
from drake_leg.simulink.networks.reduction import Reduced, reduced
from drake_leg.simulink.wiring import join

BESIDE = (
    "Solver Configuration",
    "Connection Label",
    "Connection Port",
    "ConnectionLabel",
    "PMIOPort",
)


@dataclass(frozen=True, kw_only=True)
class Term:
    """A multiple of what comes from a port, or of its derivative; of 1 where there is no port."""

    factor: float
    port: str = ""
    order: int = 0  # how often it is differentiated


Row = tuple[Term, ...]


@dataclass(frozen=True, kw_only=True)
class Part:
    """What a block of a network computes, from what others of it put out."""

    block: Block
    states: tuple[tuple[str, float, Row], ...] = ()  # port, start, derivative
    laws: tuple[tuple[str, str, tuple[Row, ...]], ...] = ()  # port, code, arguments
    outputs: tuple[tuple[str, Row], ...] = ()  # port, value
    faults: tuple[InvalidValueError, ...] = ()  # why it is not computed

    @property
    def at_once(self) -> frozenset[str]:
        """Return the ports that what it puts out depends on at once."""
        own = {port for port, _, _ in self.states}
        rows = [row for _, _, rows in self.laws for row in rows]
        rows += [row for _, row in self.outputs]
        return frozenset(term.port for row in rows for term in row if term.port) - own

    @property
    def inputs(self) -> tuple[str, ...]:
        """Return all ports from which something comes."""
        rows = [row for _, _, row in self.states]
        found = dict.fromkeys(term.port for row in rows for term in row if term.port)
        return tuple(found | dict.fromkeys(sorted(self.at_once)))

    @property
    def gives(self) -> tuple[str, ...]:
        """Return the ports at which it puts something out."""
        named = [port for port, *_ in (*self.states, *self.laws)]
        return (*(port for port, _ in self.outputs), *named)


@dataclass(frozen=True, kw_only=True)
class Network:
    """Blocks that are connected, and why they are not computed, if they are not."""

    parts: tuple[Part, ...]
    reduced: Reduced | None = None

    @property
    def is_computed(self) -> bool:
        """Whether it has a solution."""
        return self.reduced is not None

    @property
    def poles(self) -> tuple[complex, ...]:
        """Return the eigenvalues of its linear part [1/s]."""
        if self.reduced is None:
            return ()
        places = {state.quantity: k for k, (state, _) in enumerate(self.reduced.states)}
        A = np.zeros((len(places), len(places)))
        for row, (_, rate) in enumerate(self.reduced.states):
            for quantity, factor in rate.items():
                if quantity in places:
                    A[row, places[quantity]] = factor
        return tuple(np.linalg.eigvals(A).tolist())


@dataclass(eq=False)
class _Network:
    blocks: dict[str, Block] = field(default_factory=dict)
    nets: list[Sequence[str]] = field(default_factory=list)


def networks_of(
    blocks: Mapping[str, Block], nets: Iterable[Sequence[str]], drivers: Mapping[str, str]
) -> list[Network]:
    """Find all networks; ``drivers`` tells which port drives an input."""
    layouts = {sid: layout for sid, block in blocks.items() if (layout := layout_of(block))}
    ends = {
        f"{sid}#{port}": sid for sid, layout in layouts.items() for port in layout.ends.values()
    }
    mine = [net for net in nets if any(port in ends for port in net)]
    held = [[ends[port] for port in net if port in ends] for net in mine]
    found: dict[str, _Network] = {}
    for group in (*((sid,) for sids in held for sid in sids), *join(held)):
        one = _Network({sid: blocks[sid] for sid in blocks if sid in group})
        found |= dict.fromkeys(group, one)
    for net in mine:
        found[next(ends[port] for port in net if port in ends)].nets.append(net)
    return [
        _read(one.blocks, one.nets, layouts, blocks, drivers)
        for one in dict.fromkeys(found.values())
    ]


def _read(
    own: Mapping[str, Block],
    nets: Sequence[Sequence[str]],
    layouts: Mapping[str, Layout],
    blocks: Mapping[str, Block],
    drivers: Mapping[str, str],
) -> Network:
    assembly, faults = Assembly(), {}
    strangers = _strangers(own, nets, layouts, blocks)
    at = {port: node for net in nets for node in [assembly.connect(net)] for port in net}
    for sid, block in own.items():
        ends = {name: at[f"{sid}#{port}"] for name, port in layouts[sid].ends.items()
                if f"{sid}#{port}" in at}  # fmt: skip
        bench = Bench(assembly, block, layouts[sid], ends)
        try:
            KINDS[block.kind](bench)
            bench.finish()
        except InvalidValueError as error:
            faults[sid] = error
    result = None
    if not (faults or strangers):
        assembly.balance()
        try:
            result = reduced(assembly, blocks)
        except InvalidValueError as error:
            strangers = [error]
    if result is None:
        return Network(parts=tuple(_failed(own, layouts, faults, strangers)))
    return Network(parts=tuple(_parts(own, result, drivers)), reduced=result)


def _strangers(
    own: Mapping[str, Block],
    nets: Sequence[Sequence[str]],
    layouts: Mapping[str, Layout],
    blocks: Mapping[str, Block],
) -> list[InvalidValueError]:
    """Say which blocks of a network are not computed."""
    held = dict.fromkeys(split_port(port)[0] for net in nets for port in net)
    others = [blocks[sid] for sid in held if sid not in own and sid in blocks]
    others = [block for block in others if block.kind not in BESIDE]
    return [
        InvalidValueError(
            block.unknown
            or f"block {block.name!r} (SID {block.sid}) is {with_article(block.kind)}, which is "
            "not computed in a network: replace it"
        )
        for block in others
    ]


def _failed(
    own: Mapping[str, Block],
    layouts: Mapping[str, Layout],
    faults: Mapping[str, InvalidValueError],
    others: Sequence[InvalidValueError],
) -> Iterator[Part]:
    """Let what a network would put out tell why it does not."""
    for sid, block in own.items():
        outputs = tuple((f"{sid}#{port}", ()) for port in layouts[sid].outputs.values())
        if outputs or sid in faults:
            mine = [faults[sid]] if sid in faults else []
            yield Part(block=block, outputs=outputs, faults=(*mine, *others, *faults.values()))


def _parts(own: Mapping[str, Block], result: Reduced, drivers: Mapping[str, str]) -> Iterator[Part]:
    counted: Counter[tuple[str, str]] = Counter()
    ports: dict[Quantity, str] = {}
    made = [state.quantity for state, _ in result.states]
    for quantity in (*made, *(law.quantity for law, _ in result.laws)):
        counted[quantity.owner, quantity.role] += 1
        number = counted[quantity.owner, quantity.role]
        ports[quantity] = f"{quantity.owner}#{quantity.role}:{number}"

    def row(value: Linear) -> Row:
        terms = []
        for quantity, factor in value.items():
            port = "" if quantity.role == "one" else ports.get(quantity)
            if port is None:
                port = drivers.get(quantity.owner)
            if port is not None:  # nothing comes in where nothing drives
                terms.append(Term(factor=factor, port=port, order=quantity.order))
        return tuple(terms)

    for sid, block in own.items():
        states = [pair for pair in result.states if pair[0].quantity.owner == sid]
        laws = [pair for pair in result.laws if pair[0].quantity.owner == sid]
        outputs = {
            port: value for port, value in result.outputs.items() if split_port(port)[0] == sid
        }
        if states or laws or outputs:
            yield Part(
                block=block,
                states=tuple((ports[s.quantity], s.start, row(rate)) for s, rate in states),
                laws=tuple(
                    (ports[law.quantity], law.code, tuple(row(each) for each in arguments))
                    for law, arguments in laws
                ),
                outputs=tuple((port, row(value)) for port, value in outputs.items()),
            )
