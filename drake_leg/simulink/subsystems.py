"""Parts of a model: its blocks by name or path, and one of its subsystems as a model."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TypeVar

from drake_leg.arguments import some_of
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.simulink.diagram import DrawnBlock
from drake_leg.simulink.model import Block, Model, split_port
from drake_leg.simulink.wiring import is_leaf, is_open

SHOWN = 5  # paths in a sentence

AnyBlock = TypeVar("AnyBlock", Block, DrawnBlock)

_LISTED = "`drake-leg inspect` with `blocks` lists them"


def block_named(name: str, *, among: Iterable[AnyBlock], aim: str) -> AnyBlock:
    """Find the block of a path, or of a name that only one block has.

    Raises
    ------
    InvalidValueError
        If none, or several, have it; ``aim`` says what the block is wanted for.
    """
    blocks = tuple(among)
    named = [block for block in blocks if block.path == name]
    named = named or [block for block in blocks if block.name == name]
    if not named:
        names = dict.fromkeys(each for block in blocks for each in (block.name, block.path))
        raise InvalidValueError(
            f"there is no {aim.partition(' ')[0]} {name!r} {aim.partition(' ')[2]}",
            advice=did_you_mean(name, filter(None, names), _LISTED),
        )
    if len(named) > 1:
        paths = some_of([repr(block.path) for block in named], SHOWN)
        raise InvalidValueError(
            f"{len(named)} blocks are called {name!r}: {paths}",
            advice=f"write the path of the one {aim.partition(' ')[2]}",
        )
    return named[0]


def inside(model: Model, systems: frozenset[str]) -> frozenset[str]:
    """SIDs of the blocks inside systems, at any depth."""
    above = {block.sid: block.system for block in model.blocks}
    return frozenset(sid for sid in above if not systems.isdisjoint(_holders(above, sid)))


def _holders(above: Mapping[str, str], sid: str) -> Iterator[str]:
    while sid := above.get(sid, ""):
        yield sid


def subsystem(model: Model, name: str) -> Model:
    """Return a subsystem as a model of its own, its ports at the top.

    A From whose Goto is outside becomes an Inport with the name of its tag.

    Raises
    ------
    InvalidValueError
        If no subsystem, or several, have the name or path.
    """
    held = block_named(name, among=filter(is_open, model.blocks), aim="subsystem to draw")
    kept = inside(model, frozenset((held.sid,)))
    blocks = [block for block in model.blocks if block.sid in kept]
    given = {_tag(block) for block in blocks if block.type == "Goto"}
    return replace(
        model,
        name=held.name,
        blocks=tuple(_at_top(_opened(block, given), held.sid) for block in blocks),
        wires=tuple(w for w in model.wires if {_sid(w.source), _sid(w.target)} <= kept),
        nodes=tuple(
            ports
            for node in model.nodes
            if len(ports := tuple(port for port in node if _sid(port) in kept)) > 1
        ),
        functions=tuple(each for each in model.functions if each.sid in kept),
    )


def largest_subsystems(model: Model, most: int) -> list[tuple[str, int]]:
    """List the subsystems of at most so many blocks that lie in none such: paths and counts."""
    above = {block.sid: block.system for block in model.blocks}
    count = Counter(
        system for block in model.blocks if is_leaf(block) for system in _holders(above, block.sid)
    )
    small = {sid for sid, blocks in count.items() if blocks <= most}
    found = [
        (block.path, count[block.sid])
        for block in model.blocks
        if block.sid in small and is_open(block) and small.isdisjoint(_holders(above, block.sid))
    ]
    return sorted(found, key=lambda each: -each[1])


def _sid(port: str) -> str:
    return split_port(port)[0]


def _tag(block: Block) -> str:
    return str(block.parameters.get("GotoTag"))


def _opened(block: Block, given: set[str]) -> Block:
    """Let a From whose Goto is elsewhere stay as a port with the name of its tag."""
    if block.type != "From" or _tag(block) in given:
        return block
    return replace(block, type="Inport", name=f"[{_tag(block)}]", system="", parameters={})


def _at_top(block: Block, system: str) -> Block:
    return replace(block, system="") if block.system == system else block
