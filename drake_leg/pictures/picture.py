"""What a block diagram's picture shows, as data: blocks with ports, and the nets between them."""

from __future__ import annotations

from dataclasses import dataclass

from drake_leg.errors import InvalidValueError

SIGNALS, MECHANISM, ALL = "signals", "mechanism", "all"  # what can be asked for


@dataclass(frozen=True, kw_only=True)
class DrawnBlock:
    """One block; its inputs are on its left side, its outputs on its right."""

    name: str  # unique; for what reads the picture
    caption: tuple[str, ...] = ()  # lines under the block
    glyph: str = "box"  # one of ``glyphs.GLYPHS``
    text: tuple[str, ...] = ()  # lines inside
    inputs: tuple[str, ...] = ()  # labels of the ports, "" for a port without one
    outputs: tuple[str, ...] = ()
    physical: bool = False  # drawn as Simscape's blocks are
    loose: bool = False  # whether its ports may be in any order: they are labelled


@dataclass(frozen=True, kw_only=True)
class Net:
    """All that leaves one output: a line with branches."""

    source: tuple[int, int]  # index of the block, and of its output
    targets: tuple[tuple[int, int], ...]  # index of the block, and of its input
    label: str = ""
    physical: bool = False  # drawn in the colour of Simscape's lines
    arrow: bool = True  # a mechanical connection has no direction
    wide: bool = False  # a vector


@dataclass(frozen=True, kw_only=True)
class Picture:
    """Blocks and nets, not yet laid out."""

    title: str
    blocks: tuple[DrawnBlock, ...]
    nets: tuple[Net, ...]

    def __post_init__(self) -> None:
        names = [block.name for block in self.blocks]
        if len(set(names)) != len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise InvalidValueError(f"two blocks of {self.title!r} are named {twice!r}; rename one")
        ends = [end for net in self.nets for end in net.targets]
        if len(set(ends)) != len(ends):
            raise InvalidValueError(f"an input of {self.title!r} has two wires; it may have one")
