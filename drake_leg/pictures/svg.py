"""Pictures as SVG: blocks and nets, elements, the width of text, sizes of blocks, the document."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal
from xml.sax.saxutils import escape, quoteattr

from drake_leg.colours import Background
from drake_leg.errors import InvalidValueError

SIGNALS, MECHANISM, ALL = "signals", "mechanism", "all"  # what can be asked for
SIZE = 11.0  # [px], of captions, labels, and texts inside blocks
LINE = 13.0  # [px], from line to line
_NARROW, _WIDE = set("fijlrtI.,:;'|!()[]/- ·"), set("mwMW@%")
SMALL = 10.0  # [px], labels of ports and signals
PORT_PITCH = 17.0  # [px], between ports of one side
LABELLED = ("box", "plant", "sum")  # whose ports' labels are inside
PORT_PAD = 12.0  # [px], from the first and last port to the block's edge
Point = tuple[float, float]
_FONT = "Helvetica, Arial, 'Liberation Sans', sans-serif"
# Every kind of color-blind eyes can tell blue from black and gray; the mechanical
# blocks' lines are thicker, too.
_LIGHT = {
    "paper": "#ffffff",
    "ink": "#1a1a1a",
    "pale": "#8a8a8a",
    "face": "#ffffff",
    "screen": "#eef1f4",
    "blue": "#0060a8",
    "blue face": "#e3f0fa",
    "body": "#b9d9f0",
}
_DARK = {
    "paper": "#16181c",
    "ink": "#e8e8e8",
    "pale": "#8f959d",
    "face": "#212429",
    "screen": "#2d3238",
    "blue": "#6fbcf0",
    "blue face": "#10293d",
    "body": "#1f4c6e",
}


@dataclass(frozen=True, kw_only=True)
class DrawnBlock:
    """One block; its inputs are on its left side, its outputs on its right."""

    name: str  # unique; for what reads the picture
    caption: tuple[str, ...] = ()  # lines under the block
    glyph: str = "box"  # one of ``GLYPHS``
    text: tuple[str, ...] = ()  # lines inside
    inputs: tuple[str, ...] = ()  # labels of the ports, "" for a port without one
    outputs: tuple[str, ...] = ()
    physical: bool = False  # drawn as Simscape's blocks are
    loose: bool = False  # whether its ports may be in any order: they are labeled


@dataclass(frozen=True, kw_only=True)
class Net:
    """All that leaves one output: a line with branches."""

    source: tuple[int, int]  # index of the block, and of its output
    targets: tuple[tuple[int, int], ...]  # index of the block, and of its input
    label: str = ""
    physical: bool = False  # drawn in the color of Simscape's lines
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


def text_width(text: str, size: float = SIZE) -> float:
    """Estimate the width of a line in a sans-serif font [px], rather too much than too little."""
    return sum(map(_advance, text)) * size


def _advance(character: str) -> float:
    if unicodedata.combining(character):
        return 0.0
    if character in _NARROW:
        return 0.36
    if character in _WIDE:
        return 0.95
    return 0.74 if character.isupper() else 0.60


def wrapped(text: str, width: float) -> tuple[str, ...]:
    """Break text between words into lines of a width [px]; a longer word stands alone."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}") <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return tuple(lines)


def spaced(name: str) -> str:
    """Put spaces between the words of a name in capitals."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)


def element(
    tag: str, content: str | None = None, *, classes: str = "", **attributes: object
) -> str:
    """Write one element; ``content`` is SVG already.

    Numbers are rounded to a tenth; an underscore in an attribute's name stands for a hyphen.
    """
    words = [tag, f"class={quoteattr(classes)}"] if classes else [tag]
    for name, value in attributes.items():
        shown = _number(value) if isinstance(value, int | float) else str(value)
        words.append(f"{name.replace('_', '-')}={quoteattr(shown)}")
    start = " ".join(words)
    return f"<{start}/>" if content is None else f"<{start}>{content}</{tag}>"


def _number(value: float) -> str:
    return f"{value + 0.0:.1f}".removesuffix(".0")


def line(x1: float, y1: float, x2: float, y2: float, classes: str) -> str:
    """Draw a straight line [px]."""
    return element("line", classes=classes, x1=x1, y1=y1, x2=x2, y2=y2)


def polyline(points: Sequence[Point], classes: str) -> str:
    """Draw a line through points [px]."""
    shown = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return element("polyline", classes=classes, points=shown)


def text_at(
    text: str,
    x: float,
    y: float,
    baseline: float = 0.0,
    *,
    size: float = SIZE,
    anchor: Literal["start", "middle", "end"] = "middle",
    classes: str = "",
) -> str:
    """Write one line of text, ``baseline`` below y [px]; ``anchor`` tells which part is at x."""
    sized = {"font_size": size} if size != SIZE else {}
    return element(
        "text", escape(text), classes=classes, x=x, y=y + baseline, text_anchor=anchor, **sized
    )


# --- sizes of blocks -------------------------------------------------------------------------

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
        """X of the right edge."""
        return self.x + self.width

    @property
    def bottom(self) -> float:
        """Y of the lower edge."""
        return self.y + self.height

    @property
    def middle(self) -> tuple[float, float]:
        """The center."""
        return self.x + self.width / 2, self.y + self.height / 2


@dataclass(frozen=True)
class Size:
    """The space that a block needs."""

    width: float  # [px]
    height: float  # [px], at least
    elastic: bool = False  # whether it may be higher
    centered: bool = True  # whether a single port is at half its height


def size_of(block: DrawnBlock) -> Size:
    """Compute the space that a block needs."""
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


def document(
    content: str,
    *,
    title: str,
    description: str,
    width: float,
    height: float,
    background: Background,
) -> str:
    """Wrap drawn elements into a document; title and description are for those who do not see.

    ``background`` is white or dark as the reader's system is, always white, or none.
    """
    root = "drake-leg-drawing" if background == "auto" else "drake-leg-drawing-light"
    paper = element("rect", classes="paper", width=width, height=height)
    parts = [
        element("title", escape(title)),
        element("desc", escape(description)),
        element("style", _style(root, dark=background == "auto")),
        paper if background != "none" else "",
        content,
    ]
    return (
        element(
            "svg",
            "\n".join(part for part in parts if part) + "\n",
            xmlns="http://www.w3.org/2000/svg",
            classes=root,
            viewBox=f"0 0 {_number(width)} {_number(height)}",
            width=width,
            height=height,
            role="img",
            aria_label=title,
            font_family=_FONT,
            font_size=SIZE,
            style="max-width:100%;height:auto",
        )
        + "\n"
    )


def _style(root: str, *, dark: bool) -> str:
    shapes = f"""
.{root} polyline, .{root} path, .{root} .stroke, .{root} .thin, .{root} .trace {{fill: none}}
.{root} .face, .{root} .stroke, .{root} .body, .{root} .trace {{stroke-width: 1.3}}
.{root} .strong {{stroke-width: 2.2}}
.{root} .thin {{stroke-width: 0.9}}
.{root} .wire {{stroke-width: 1.2; stroke-linejoin: round}}
.{root} .wide {{stroke-width: 2.1}}
.{root} .heading {{font-weight: bold}}
"""
    style = shapes + _colours(root, _LIGHT)
    if dark:
        style += f"@media (prefers-color-scheme: dark) {{{_colours(root, _DARK)}}}\n"
    return style


def _colours(root: str, colour: dict[str, str]) -> str:
    signal = _colours_of(f".{root}", colour["ink"], colour["face"], colour["pale"])
    physical = _colours_of(
        f".{root} .physical", colour["blue"], colour["blue face"], colour["blue"]
    )
    return f"""
.{root} .paper {{fill: {colour["paper"]}}}
.{root} text {{fill: {colour["ink"]}}}
{signal}{physical}.{root} .screen {{fill: {colour["screen"]}; stroke: {colour["pale"]}}}
.{root} .trace {{stroke: {colour["blue"]}}}
.{root} .body {{fill: {colour["body"]}}}
"""


def _colours_of(scope: str, ink: str, face: str, pale: str) -> str:
    return f"""{scope} .face {{fill: {face}; stroke: {ink}}}
{scope} .stroke, {scope} .wire, {scope} .body {{stroke: {ink}}}
{scope} .thin {{stroke: {pale}}}
{scope} .bar, {scope} .dot, {scope} .head {{fill: {ink}}}
{scope} text {{fill: {ink}}}
"""
