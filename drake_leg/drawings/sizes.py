"""How big every kind of block is."""

from __future__ import annotations

from dataclasses import dataclass

from drake_leg.drawings.picture import DrawnBlock
from drake_leg.drawings.svg import SMALL
from drake_leg.drawings.text import LINE, text_width

PORT_PITCH = 17.0  # [px], between ports of one side
LABELLED = ("box", "plant", "sum")  # whose ports' labels are inside
PORT_PAD = 12.0  # [px], from the first and last port to the block's edge


_FIXED = {
    "sine": (40.0, 40.0),
    "constant": (34.0, 30.0),
    "gain": (44.0, 42.0),
    "integrator": (40.0, 40.0),
    "scope": (36.0, 36.0),
    "connection": (30.0, 18.0),
    "converter": (40.0, 34.0),
    "transform": (52.0, 40.0),
}


@dataclass(frozen=True)
class Box:
    """A rectangle [px]; y points down, as in SVG."""

    x: float
    y: float
    width: float
    height: float

    @property
    def right(self) -> float:
        """Of the right edge."""
        return self.x + self.width

    @property
    def bottom(self) -> float:
        """Of the lower edge."""
        return self.y + self.height

    @property
    def middle(self) -> tuple[float, float]:
        """The centre."""
        return self.x + self.width / 2, self.y + self.height / 2


@dataclass(frozen=True)
class Size:
    """What a block needs."""

    width: float  # [px]
    height: float  # [px], at least
    elastic: bool = False  # whether it may be higher
    centred: bool = True  # whether a single port is at half its height


def size_of(block: DrawnBlock) -> Size:
    """How much room a block needs."""
    sides = [ports for ports in (block.inputs, block.outputs) if ports]
    ports = 2 * PORT_PAD + PORT_PITCH * (max(map(len, sides), default=1) - 1)
    if block.glyph in ("mux", "demux"):
        return Size(7.0, max(36.0, ports), elastic=True)
    if block.glyph == "sum":
        return Size(44.0, max(40.0, ports))
    if block.glyph == "converter":
        return Size(*_FIXED["converter"])
    if block.glyph not in LABELLED:
        width, height = _FIXED.get(block.glyph, (44.0, 40.0))
        inside = max((text_width(text) for text in block.text), default=0.0)
        if block.glyph == "gain":
            inside *= 1.55
        return Size(max(width, inside + 14.0), max(height, ports if len(sides) else 0.0))
    left = max((text_width(label, SMALL) for label in block.inputs), default=0.0)
    right = max((text_width(label, SMALL) for label in block.outputs), default=0.0)
    middle = max((text_width(text) for text in block.text), default=0.0)
    beside = 2 * max(left, right) if middle else left + right  # the text stays in the middle
    least = 96.0 if block.glyph == "plant" else 60.0
    width = max(least, beside + middle + 24.0)
    height = max(40.0, ports, LINE * len(block.text) + 14.0)
    return Size(width, max(height, 74.0 if block.glyph == "plant" else 0.0), True, False)
