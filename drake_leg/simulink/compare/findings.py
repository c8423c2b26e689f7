"""The verdicts of a comparison, which its steps pass on as values, and the report of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

from drake_leg.diagrams.wiring import LiveWire
from drake_leg.simulink.compare.signals import close
from drake_leg.simulink.model import Block

Item = dict[str, Any]
Quantity = float | str | tuple[float, ...]  # of a parameter, in SI


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Every block, wire and parameter of the model, and what became of it.

    The items are plain dictionaries, ready for JSON. ``what`` tells what they are about:
    ``block``, ``wire``, ``node`` (a physical connection), ``parameter``, ``scale`` (one factor of
    all lengths).
    """

    matched: list[Item] = field(default_factory=list)
    missing: list[Item] = field(default_factory=list)
    extra: list[Item] = field(default_factory=list)
    different: list[Item] = field(default_factory=list)
    tolerated: list[Item] = field(default_factory=list)  # different, but counted only if strict

    @property
    def agrees(self) -> bool:
        """Whether everything in the model has its counterpart, with equal values."""
        return not (self.missing or self.different)

    def as_json(self) -> dict[str, list[Item]]:
        """Return the lists under their names."""
        return dict(vars(self))


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """One thing that was found: an item, and the list of the report that it belongs to."""

    list: Literal["matched", "missing", "extra", "different", "tolerated"]
    item: Item
    block: str = ""  # SID of the block that it settles; the first verdict on a block counts
    live: tuple[str, ...] = ()  # blocks of the diagram that stand for this block
    wires: tuple[LiveWire, ...] = ()  # connections of the diagram that stand for this wire
    wrong: str = ""  # the model's input that takes another signal than its counterpart


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """The verdicts on blocks, put together."""

    settled: frozenset[str]  # SIDs
    missing: dict[str, str]  # SID -> why
    counterparts: dict[str, set[str]]  # SID -> blocks of the diagram
    wrong: frozenset[str]  # the model's inputs that take another signal


def matched(block: Block, counterpart: str, live: Iterable[str] = (), **more: Any) -> Verdict:  # noqa: ANN401 - an item's values
    """State the counterpart of a block; ``more`` are further keys of the item."""
    item = {**_about(block), "counterpart": counterpart, **more}
    return Verdict(list="matched", item=item, block=block.sid, live=tuple(live))


def missing(block: Block, why: str) -> Verdict:
    """State that a block has no counterpart."""
    return Verdict(list="missing", item={**_about(block), "why": why}, block=block.sid)


def different(
    sid: str,
    name: str,
    parameter: str,
    simulink: object,
    drake: object,
    *,
    unit: str = "",
    what: str = "parameter",
    counts: bool = True,
    wrong: str = "",
) -> Verdict:
    """State that a value differs; ``counts`` tells whether it counts without ``strict``."""
    item = {
        "what": what,
        "sid": sid,
        "name": name,
        "parameter": parameter,
        "simulink": simulink,
        "drake": drake,
        "unit": unit,
    }
    return Verdict(list="different" if counts else "tolerated", item=item, wrong=wrong)


def unreadable(block: Block, why: str, counterpart: str) -> Verdict:
    """State that a block's code could not be read."""
    verdict = different(
        block.sid, block.name, "code", f"could not be read: {why}", counterpart, what="block"
    )
    return Verdict(list="different", item={**verdict.item, "why": verdict.item["simulink"]})


def extra(what: str, **more: str) -> Verdict:
    """State that the diagram has something that the model lacks."""
    return Verdict(list="extra", item={"what": what, **more})


@dataclass(frozen=True, kw_only=True)
class Check:
    """A parameter with both values, and the difference between them, if there is one."""

    item: Item
    difference: Verdict | None


def check(
    block: Block,
    parameter: str,
    simulink: Quantity,
    drake: Quantity,
    *,
    unit: str = "",
    counts: bool = True,
) -> Check:
    """Compare a parameter, both values in SI."""
    item = {"parameter": parameter, "simulink": simulink, "drake": drake, "unit": unit}
    if _same(simulink, drake):
        return Check(item=item, difference=None)
    verdict = different(block.sid, block.name, parameter, simulink, drake, unit=unit, counts=counts)
    return Check(item=item, difference=verdict)


def differences(*checks: Check) -> Iterator[Verdict]:
    """List the differences that checks have found."""
    return (each.difference for each in checks if each.difference is not None)


def put_together(verdicts: Iterable[Verdict]) -> Blocks:
    """Tell what is known of the model's blocks after some verdicts."""
    settled: set[str] = set()
    lost: dict[str, str] = {}
    counterparts: dict[str, set[str]] = {}
    wrong: set[str] = set()
    for verdict in verdicts:
        wrong |= {verdict.wrong} - {""}
        if verdict.live:
            counterparts.setdefault(verdict.block, set()).update(verdict.live)
        if verdict.block and verdict.block not in settled:
            settled.add(verdict.block)
            if verdict.list == "missing":
                lost[verdict.block] = verdict.item["why"]
    return Blocks(
        settled=frozenset(settled),
        missing=lost,
        counterparts=counterparts,
        wrong=frozenset(wrong),
    )


def report(verdicts: Iterable[Verdict], *, strict: bool) -> Comparison:
    """Sort verdicts into the lists of a comparison: one verdict a block, no difference twice."""
    found = Comparison()
    lists = found.as_json()
    settled: set[str] = set()
    said: set[tuple[object, ...]] = set()
    for verdict in verdicts:
        if verdict.block in settled:
            continue
        settled |= {verdict.block} - {""}
        counts = strict and verdict.list == "tolerated"
        into = lists["different" if counts else verdict.list]
        if verdict.list in ("different", "tolerated"):
            words = (id(into), *verdict.item.items())
            if words in said:
                continue
            said.add(words)
        into.append(verdict.item)
    return found


def listed(names: Iterable[str]) -> str:
    """Write names one after the other."""
    return ", ".join(repr(name) for name in names)


def _about(block: Block) -> Item:
    return {"what": "block", "sid": block.sid, "name": block.name, "kind": block.kind}


def _same(a: Quantity, b: Quantity) -> bool:
    if isinstance(a, str) or isinstance(b, str):
        return a == b
    if isinstance(a, tuple) or isinstance(b, tuple):
        if not (isinstance(a, tuple) and isinstance(b, tuple)) or len(a) != len(b):
            return False
        scale = max(map(abs, (*a, *b)), default=0.0)
        return all(close(x, y) or abs(x - y) <= 1e-9 * scale for x, y in zip(a, b, strict=True))
    return close(a, b)
