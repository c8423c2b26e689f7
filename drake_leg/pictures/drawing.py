"""Writes laid-out pictures as SVG, one below the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape

from drake_leg.colours import Background
from drake_leg.files import write_text
from drake_leg.pictures.glyphs import draw_block
from drake_leg.pictures.layout import Layout
from drake_leg.pictures.parts import lay_out_parts
from drake_leg.pictures.routing import rounded
from drake_leg.pictures.svg import (
    LABELLED,
    SMALL,
    DrawnBlock,
    Picture,
    Point,
    document,
    element,
    text_at,
    text_width,
)

MARGIN = 18.0  # [px]
HEADING = 15.0  # [px], size of a title
BOLD = 1.18  # width of a title's bold letters, relative to plain ones
BELOW_HEADING = 26.0  # [px]
BETWEEN = 30.0  # [px], two pictures
ARROW = 8.0  # [px]
LEAST_SCALE = 0.7  # at which a notebook shows it: texts of 7.7 px


@dataclass(frozen=True)
class Drawing:
    """An SVG document; a notebook shows it as a picture."""

    svg: str = field(repr=False)
    layouts: tuple[Layout, ...] = field(repr=False)
    width: float  # [px]

    def write(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Write an SVG file, whole or not at all.

        Raises
        ------
        OutputError
            If it cannot be written, or is there and may not be replaced.
        """
        write_text(path, self.svg, ending=".svg", overwrite=overwrite)

    def _repr_html_(self) -> str:
        """Let a wide picture be moved sideways, rather than make its texts too small to read."""
        least = f"min-width:{LEAST_SCALE * self.width:.0f}px"
        return f'<div style="overflow-x:auto"><div style="{least}">{self.svg}</div></div>'

    def _repr_svg_(self) -> str:
        return self.svg

    def __str__(self) -> str:
        return self.svg


def draw(*pictures: Picture, background: Background = "auto") -> Drawing:
    """Lay out pictures and draw them, one below the other; the output is deterministic.

    ``background`` is white or dark as the reader's system is, always white, or none.
    """
    layouts = tuple(map(lay_out_parts, pictures))
    parts = []
    y = MARGIN
    for layout in layouts:
        heading = text_at(
            layout.picture.title,
            MARGIN,
            y + HEADING,
            size=HEADING,
            anchor="start",
            classes="heading",
        )
        y += HEADING + BELOW_HEADING
        content = "\n".join(_elements(layout))
        parts += [
            heading,
            element("g", f"\n{content}\n", transform=f"translate({MARGIN:g} {y:.1f})"),
        ]
        y += layout.height + BETWEEN
    titles = [BOLD * text_width(layout.picture.title, HEADING) for layout in layouts]
    width = max([layout.width for layout in layouts] + titles) + 2 * MARGIN
    return Drawing(
        svg=document(
            "\n".join(parts),
            title="; ".join(picture.title for picture in pictures),
            description=" ".join(map(_description, pictures)),
            width=width,
            height=y - BETWEEN + MARGIN,
            background=background,
        ),
        layouts=layouts,
        width=width,
    )


def _description(picture: Picture) -> str:
    """Describe the wires in words."""
    wires = [
        f"{picture.blocks[net.source[0]].name} to "
        f"{', '.join(picture.blocks[block].name for block, _ in net.targets)}"
        for net in picture.nets
    ]
    return f"{picture.title}: {len(picture.blocks)} blocks. Wires: {'; '.join(wires)}."


def _elements(layout: Layout) -> Iterator[str]:
    for index in range(len(layout.picture.nets)):
        yield _net(layout, index)
    for index, block in enumerate(layout.picture.blocks):
        yield _block(layout, index, block)
    for label in layout.labels:
        yield text_at(label.text, label.box.x, label.box.bottom - 2.5, size=SMALL, anchor="start")


def _net(layout: Layout, index: int) -> str:
    """Draw a net: its wires, each from its branch point, arrowheads, and dots at the branches."""
    net = layout.picture.nets[index]
    routes = [route for route in layout.routes if route.net == index]
    branches = dict.fromkeys(r.drawn[0] for r in routes if r.drawn[0] != r.points[0])
    wire = "wire wide" if net.wide else "wire"
    parts = []
    for route in routes:
        tip = route.drawn[-1]
        points = (*route.drawn[:-1], (tip[0] - ARROW / 2, tip[1])) if net.arrow else route.drawn
        parts.append(element("path", classes=wire, d=rounded(points, branches)))
        parts.append(_arrow(tip) if net.arrow else _square(tip))
    if not net.arrow:
        parts.append(_square(routes[0].points[0]))
    parts += [element("circle", classes="dot", cx=x, cy=y, r=2.8) for x, y in branches]
    return element("g", "".join(parts), classes="net physical" if net.physical else "net")


def _arrow(tip: Point) -> str:
    x, y = tip
    points = f"{x:.1f},{y:.1f} {x - ARROW:.1f},{y - 3.5:.1f} {x - ARROW:.1f},{y + 3.5:.1f}"
    return element("polygon", classes="head", points=points)


def _square(place: Point) -> str:
    x, y = place
    return element("rect", classes="dot", x=x - 2.5, y=y - 2.5, width=5, height=5)


def _block(layout: Layout, index: int, block: DrawnBlock) -> str:
    """Draw a block, the labels of its ports, and its caption."""
    parts = [element("title", escape(block.name)), draw_block(block, layout.boxes[index])]
    if block.glyph in LABELLED:
        for port, label in enumerate(block.inputs):
            x, y = layout.inputs[index, port]
            parts.append(text_at(label, x + 5, y, 3.5, size=SMALL, anchor="start"))
        for port, label in enumerate(block.outputs):
            x, y = layout.outputs[index, port]
            parts.append(text_at(label, x - 5, y, 3.5, size=SMALL, anchor="end"))
    for line in layout.captions[index]:
        parts.append(text_at(line.text, line.box.middle[0], line.box.bottom - 3.0))
    return element(
        "g",
        "".join(part for part in parts if part),
        classes="block physical" if block.physical else "block",
    )
