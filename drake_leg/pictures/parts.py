"""Lays out the connected parts of a picture one by one, and arranges them in rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from drake_leg.pictures.layout import Label, Layout, Route, lay_out
from drake_leg.pictures.svg import Box, Picture, Point

ROW = 1400.0  # [px], width that a row should not exceed
BETWEEN = 36.0  # [px], two parts


def lay_out_parts(picture: Picture) -> Layout:
    """Lay out the connected parts of a picture, and arrange them in rows."""
    parts = _parts(picture)
    if len(parts) < 2:
        return lay_out(picture)
    layouts = [lay_out(_part(picture, blocks)) for blocks in parts]
    moved = [_moved(layout, place) for layout, place in zip(layouts, _places(layouts), strict=True)]
    return _joined(picture, parts, moved)


def _parts(picture: Picture) -> list[list[int]]:
    """Find the connected components, ordered by their first blocks."""
    parts = {index: [index] for index in range(len(picture.blocks))}
    for net in picture.nets:
        for other, _ in net.targets:
            near, far = parts[net.source[0]], parts[other]
            if near is not far:
                near += far
                parts.update(dict.fromkeys(far, near))
    return [sorted(blocks) for index, blocks in parts.items() if index == min(blocks)]


def _part(picture: Picture, blocks: Sequence[int]) -> Picture:
    """Make a picture of one component."""
    place = {block: index for index, block in enumerate(blocks)}
    return Picture(
        title=picture.title,
        blocks=tuple(picture.blocks[block] for block in blocks),
        nets=tuple(
            replace(
                net,
                source=(place[net.source[0]], net.source[1]),
                targets=tuple((place[block], port) for block, port in net.targets),
            )
            for net in picture.nets
            if net.source[0] in place
        ),
    )


def _places(layouts: Sequence[Layout]) -> Iterable[Point]:
    """Place parts side by side until a row is full."""
    widest = max(ROW, *(layout.width for layout in layouts))
    x = y = height = 0.0
    for layout in layouts:
        if x > 0.0 and x + layout.width > widest:
            x, y, height = 0.0, y + height + BETWEEN, 0.0
        yield x, y
        x, height = x + layout.width + BETWEEN, max(height, layout.height)


def _moved(layout: Layout, place: Point) -> Layout:
    """Move a layout right and down; its size still counts from the origin."""
    dx, dy = place

    def point(old: Point) -> Point:
        return old[0] + dx, old[1] + dy

    def box(old: Box) -> Box:
        return replace(old, x=old.x + dx, y=old.y + dy)

    def labels(old: Iterable[Label]) -> tuple[Label, ...]:
        return tuple(replace(label, box=box(label.box)) for label in old)

    def route(old: Route) -> Route:
        return replace(
            old, points=tuple(map(point, old.points)), drawn=tuple(map(point, old.drawn))
        )

    return replace(
        layout,
        boxes=tuple(map(box, layout.boxes)),
        captions=tuple(map(labels, layout.captions)),
        inputs={end: point(at) for end, at in layout.inputs.items()},
        outputs={end: point(at) for end, at in layout.outputs.items()},
        routes=tuple(map(route, layout.routes)),
        labels=labels(layout.labels),
        width=layout.width + dx,
        height=layout.height + dy,
    )


def _joined(picture: Picture, parts: Sequence[Sequence[int]], layouts: Sequence[Layout]) -> Layout:
    """Join the layouts of all parts, numbered as in the whole picture."""
    found = {
        block: (layout.boxes[index], layout.captions[index])
        for blocks, layout in zip(parts, layouts, strict=True)
        for index, block in enumerate(blocks)
    }
    inputs: dict[tuple[int, int], Point] = {}
    outputs: dict[tuple[int, int], Point] = {}
    routes: list[Route] = []
    nets = {net.source: index for index, net in enumerate(picture.nets)}
    for blocks, layout in zip(parts, layouts, strict=True):
        inputs |= {(blocks[block], port): at for (block, port), at in layout.inputs.items()}
        outputs |= {(blocks[block], port): at for (block, port), at in layout.outputs.items()}
        for route in layout.routes:
            (block, port), (target, into) = route.source, route.target
            source = (blocks[block], port)
            routes.append(
                replace(route, net=nets[source], source=source, target=(blocks[target], into))
            )
    return Layout(
        picture=picture,
        boxes=tuple(found[block][0] for block in range(len(picture.blocks))),
        captions=tuple(found[block][1] for block in range(len(picture.blocks))),
        inputs=inputs,
        outputs=outputs,
        routes=tuple(routes),
        labels=tuple(label for layout in layouts for label in layout.labels),
        width=max(layout.width for layout in layouts),
        height=max(layout.height for layout in layouts),
    )
