"""The physical connections of a Simulink model, and what its blocks are called in a picture."""

from __future__ import annotations

from collections import Counter
from drake_leg.pictures.svg import wrapped
from drake_leg.simulink.listing import block_paths, printable
from drake_leg.simulink.model import Model
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from drake_leg.simulink.model import Block, Model, split_port

_LONGEST = 24  # characters of a line
_MOST_LINES = 3


def unique_names(model: Model) -> dict[str, str]:
    """Name every block, by its SID, after its path; with the SID if two paths are the same."""
    paths = block_paths(model)
    count = Counter(paths.values())
    return {sid: path if count[path] == 1 else f"{path} (SID {sid})" for sid, path in paths.items()}


def name_lines(name: str, width: float) -> tuple[str, ...]:
    """Write a block's own name in at most three lines; what does not fit is cut off."""
    lines = wrapped(printable(name), width)
    if len(lines) > _MOST_LINES:
        lines = (*lines[: _MOST_LINES - 1], f"{lines[_MOST_LINES - 1]} …")
    return tuple(map(cut, lines))


def cut(text: str) -> str:
    """Cut a line of text off after 24 characters, and leave out what cannot be printed."""
    text = printable(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


TO_PHYSICAL, TO_SIGNAL = "Simulink-PS Converter", "PS-Simulink Converter"
_SIGNAL_KINDS = (TO_PHYSICAL, TO_SIGNAL, "Spectrum Analyzer", "Probe")
_LIBRARIES = ("sm_lib", "nesl_utility", "nesl_utility_internal", "fl_lib")

Node = tuple[str, ...]  # ports that one connection joins


@dataclass(frozen=True, kw_only=True)
class Network:
    """The physical connections of a flattened model, and the blocks at them."""

    signals: tuple[Node, ...]  # the port that puts the signal out comes first
    frames: tuple[Node, ...]
    physical: frozenset[str]  # SIDs of all blocks that are drawn as Simscape's
    mechanical: frozenset[str]  # those of them that are more than signals
    sensed: frozenset[str]  # mechanical blocks that signals reach or leave


def network_of(model: Model) -> Network:
    """Sort the physical connections of a model.

    A connection carries a signal where one of its ends is a converter, a block of physical
    signals, or a port of a joint or a sensor beyond its two frames.
    """
    blocks = {block.sid: block for block in model.blocks}
    signals = [node for node in model.nodes if any(_has_signal(port, blocks) for port in node)]
    frames = [node for node in model.nodes if node not in signals]
    ends = {split_port(port)[0] for node in model.nodes for port in node}
    physical = {sid for sid, block in blocks.items() if _is_of_simscape(block)} | ends
    mechanical = {sid for sid in physical if not _is_signal(blocks[sid])}
    reached = {split_port(port)[0] for node in signals for port in node}
    return Network(
        signals=tuple(
            tuple(sorted(node, key=lambda port: not _puts_out(port, blocks))) for node in signals
        ),
        frames=tuple(frames),
        physical=frozenset(physical),
        mechanical=frozenset(mechanical),
        sensed=frozenset(mechanical & reached),
    )


def ports_by_block(ports: Iterable[str]) -> dict[str, list[str]]:
    """Gather ports by the SIDs of their blocks, in the order of sides and numbers."""
    found: dict[str, list[str]] = {}
    for port in sorted(ports, key=lambda port: split_port(port)[1:]):
        found.setdefault(split_port(port)[0], []).append(port)
    return found


def _is_of_simscape(block: Block) -> bool:
    return block.source.split("/", 1)[0] in _LIBRARIES or block.type == "PMIOPort"


def _is_signal(block: Block) -> bool:
    return block.kind in _SIGNAL_KINDS or block.kind.startswith("PS ")


def _has_signal(port: str, blocks: Mapping[str, Block]) -> bool:
    sid, _, number = split_port(port)
    block = blocks[sid]
    two_frames = block.kind.endswith("Joint") or block.kind == "Transform Sensor"
    return _is_signal(block) or (two_frames and number > 1)


def _puts_out(port: str, blocks: Mapping[str, Block]) -> bool:
    """Whether a signal comes out of a port: right ports do so, except a converter's."""
    sid, side, _ = split_port(port)
    kind = blocks[sid].kind
    return kind == TO_PHYSICAL or (side == "rconn" and kind != TO_SIGNAL)
