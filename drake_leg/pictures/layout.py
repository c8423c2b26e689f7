"""Lays out a block diagram: columns, order, heights, and channels for the wires.

Heights minimize the bends of the wires by a linear program, after Gansner, Koutsofios, North and
Vo, "A technique for drawing directed graphs", 1993, section 4: bends are charged by their height,
so that most wires become straight. Ports of bars and boxes slide along their sides.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array

from drake_leg.pictures.columns import Columns, End, Order, Track, columns_of, order_of
from drake_leg.pictures.routing import NEAR, Trunk, divergence, lanes_of, simplified, trunks_of
from drake_leg.pictures.svg import (
    LINE,
    PORT_PAD,
    PORT_PITCH,
    SIZE,
    SMALL,
    Box,
    Picture,
    Point,
    size_of,
    text_width,
)

PITCH = 9.0  # [px], between vertical lines of a channel
BEFORE, AFTER = 10.0, 16.0  # [px], free at a channel's sides; an arrow's head is at the right one
NARROWEST = 26.0  # [px], of a channel
ROUNDS = 12  # of separating lines that overlap
ROW = 1400.0  # [px], width that a row should not exceed
BETWEEN = 36.0  # [px], two parts
GAP = 16.0  # [px], between blocks, their captions included
LANE_GAP = 13.0  # [px], to a lane
# Cost of a pixel: of a bend, by what it joins; of a block's growth; of the picture's height.
OF_BLOCKS, OF_LANE_AND_BLOCK, OF_LANES = 3.0, 4.0, 8.0
OF_SINK, OF_SOURCE, BACKWARD = 0.3, 1.3, 0.1  # times that, at ends and beginnings, and of a loop
OF_BAR_END = 0.8  # the same, to a bar
BARS = ("mux", "demux")
OF_GROWTH, OF_BAR, OF_HEIGHT = 1.5, 0.2, 0.2
Terms = dict[int, float]


@dataclass(frozen=True)
class Label:
    """A line of text and its box."""

    text: str
    box: Box


@dataclass(frozen=True)
class Route:
    """One wire from an output to an input."""

    net: int
    source: tuple[int, int]
    target: tuple[int, int]
    points: tuple[Point, ...]  # from port to port [px]
    drawn: tuple[Point, ...]  # the part that no earlier wire of its net has drawn


@dataclass(frozen=True)
class Layout:
    """A picture with the positions of everything in it [px]."""

    picture: Picture
    boxes: tuple[Box, ...]  # of the blocks
    captions: tuple[tuple[Label, ...], ...]  # of the blocks, line by line
    inputs: Mapping[tuple[int, int], Point]  # block and port to place
    outputs: Mapping[tuple[int, int], Point]
    routes: tuple[Route, ...]
    labels: tuple[Label, ...]  # of the nets
    width: float
    height: float


def lay_out(picture: Picture) -> Layout:
    """Lay out a picture from left to right; the result is deterministic."""
    columns = columns_of(picture)
    order = order_of(picture, columns)
    heights, lanes = _without_overlaps(picture, columns, order)
    return _Placing(picture, columns, heights, lanes).layout()


def _without_overlaps(
    picture: Picture, columns: Columns, order: Order
) -> tuple[Heights, list[dict[int, int]]]:
    """Move ends apart until no two nets overlap."""
    programme = _Programme(picture, columns, order)
    apart: list[tuple[End, End, float]] = []
    for _ in range(ROUNDS):
        heights = programme.solve(apart)
        found = [lanes_of(trunks_of(t, heights.ends)) for t in columns.channels]
        pairs = [pair for _, conflicts in found for pair in conflicts]
        if not pairs:
            break
        apart += [_parted(a, b, heights) for a, b in pairs]
    return heights, [lanes for lanes, _ in found]


def _parted(a: Trunk, b: Trunk, heights: Heights) -> tuple[End, End, float]:
    """Require a distance between the two ends that overlap."""
    y = heights.ends
    out, into = min(
        ((o, i) for o in a.track.ends if not o.left for i in b.track.ends if i.left),
        key=lambda ends: abs(y[ends[0]] - y[ends[1]]),
    )
    lower, upper = (out, into) if y[out] >= y[into] else (into, out)
    return lower, upper, NEAR + 2.0


class _Placing:
    """Converts columns and heights into positions."""

    def __init__(
        self, picture: Picture, columns: Columns, heights: Heights, lanes: list[dict[int, int]]
    ) -> None:
        self.picture, self.columns, self.heights, self.lanes = picture, columns, heights, lanes
        self.spot_of_block = {s.block: n for n, s in enumerate(columns.spots) if s.block >= 0}
        self.sizes = [size_of(block) for block in picture.blocks]
        self.left, self.right, self.trunk_start = self._columns()
        self.boxes = [self._box(index) for index in range(len(picture.blocks))]

    def _columns(self) -> tuple[list[float], list[float], list[float]]:
        """Left and right edges of the columns, and where every channel's vertical lines begin."""
        left: list[float] = []
        right: list[float] = []
        starts: list[float] = []
        x = 0.0
        for column in range(len(self.columns.members) + 1):
            count = max(self.lanes[column].values(), default=-1) + 1
            label = self._label_room(column - 1)
            starts.append(x + label + BEFORE)
            outermost = column in (0, len(self.columns.members))
            if count:
                x += label + BEFORE + PITCH * (count - 1) + AFTER
            elif not outermost:
                x += max(NARROWEST, label + AFTER)
            if column < len(self.columns.members):
                left.append(x)
                x += self._column_width(column)
                right.append(x)
        self.width = x
        return left, right, starts

    def _column_width(self, column: int) -> float:
        widths = [0.0]
        for index in self._blocks_in(column):
            lines = self.picture.blocks[index].caption
            widths += [self.sizes[index].width, *(text_width(text) for text in lines)]
        return max(widths)

    def _blocks_in(self, column: int) -> list[int]:
        if not 0 <= column < len(self.columns.members):
            return []
        spots = [self.columns.spots[spot] for spot in self.columns.members[column]]
        return [spot.block for spot in spots if spot.block >= 0]

    def _label_room(self, column: int) -> float:
        """Room right of a column for the labels of the nets that begin there."""
        room = 0.0
        for index in self._blocks_in(column):
            stub = (self._column_width(column) - self.sizes[index].width) / 2
            for net in self.picture.nets:
                if net.source[0] == index and net.label:
                    room = max(room, text_width(net.label, SMALL) + 6.0 - stub)
        return room

    def _box(self, index: int) -> Box:
        spot = self.spot_of_block[index]
        column = self.columns.spots[spot].column
        width = self.sizes[index].width
        x = (self.left[column] + self.right[column] - width) / 2
        top, bottom = self.heights.top[spot], self.heights.bottom[spot]
        return Box(x, top, width, bottom - top)

    def _point(self, end: End) -> Point:
        spot = self.columns.spots[end.spot]
        y = self.heights.ends[end]
        if spot.block >= 0:
            box = self.boxes[spot.block]
            return (box.right if end.left else box.x), y
        return (self.right if end.left else self.left)[spot.column], y

    def layout(self) -> Layout:
        """Return the layout."""
        blocks = self.picture.blocks
        inputs, outputs = (
            {
                (index, port): self._point(End(self.spot_of_block[index], left, port))
                for index, block in enumerate(blocks)
                for port in range(len(block.outputs if left else block.inputs))
            }
            for left in (False, True)
        )
        routes = tuple(self._routes())
        return Layout(
            picture=self.picture,
            boxes=tuple(self.boxes),
            captions=tuple(map(self._caption, range(len(blocks)))),
            inputs=inputs,
            outputs=outputs,
            routes=routes,
            labels=tuple(self._labels(outputs)),
            width=max([self.width, *(x for route in routes for x, _ in route.points)]),
            height=self.heights.total,
        )

    def _caption(self, index: int) -> tuple[Label, ...]:
        box = self.boxes[index]
        labels = []
        for row, text in enumerate(self.picture.blocks[index].caption):
            width = text_width(text)
            x, y = box.middle[0] - width / 2, box.bottom + 3.0 + LINE * row
            labels.append(Label(text, Box(x, y, width, LINE)))
        return tuple(labels)

    def _labels(self, outputs: Mapping[tuple[int, int], Point]) -> Iterator[Label]:
        for net in self.picture.nets:
            if net.label:
                x, y = outputs[net.source]
                width = text_width(net.label, SMALL)
                yield Label(net.label, Box(x + 4.0, y - SIZE - 2.0, width, SIZE))

    def _routes(self) -> Iterator[Route]:
        tracks = {(track.net, track.channel): track for track in self.columns.tracks}
        for index, net in enumerate(self.picture.nets):
            spot = self.spot_of_block[net.source[0]]
            start = self.columns.spots[spot].column + 1
            ways = dict(self._ways(index, tracks[index, start], tracks))
            drawn: list[tuple[Point, ...]] = []
            for target in net.targets:
                points = simplified(ways[target])
                new = divergence(points, drawn)
                drawn.append(points)
                yield Route(index, net.source, target, points, new)

    def _ways(
        self, net: int, track: Track, tracks: Mapping[tuple[int, int], Track]
    ) -> Iterator[tuple[tuple[int, int], list[Point]]]:
        """Follow a net from its entry into a channel to all of its targets."""
        first = self._point(track.ends[0])
        lane = self.lanes[track.channel].get(net)
        x = None if lane is None else self.trunk_start[track.channel] + PITCH * lane
        for end in track.ends[1:]:
            last = self._point(end)
            bend = [] if x is None else [(x, first[1]), (x, last[1])]
            way = [first, *bend, last]
            spot = self.columns.spots[end.spot]
            if spot.block >= 0:
                yield (spot.block, end.port), way
                continue
            following = tracks[net, track.channel + (-1 if end.left else 1)]
            for target, rest in self._ways(net, following, tracks):
                yield target, way + rest


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


@dataclass(frozen=True)
class Heights:
    """Vertical positions of all spots and of all ends of nets [px]."""

    top: tuple[float, ...]  # of every spot
    bottom: tuple[float, ...]  # without the caption
    ends: Mapping[End, float]
    total: float


def caption_height(lines: int) -> float:
    """Return the height of a block's caption [px]."""
    return LINE * lines + 3.0 if lines else 0.0


class _Programme:
    """The linear program of one picture: variables, constraints and costs."""

    def __init__(self, picture: Picture, columns: Columns, order: Order) -> None:
        self.columns = columns
        self.costs: list[float] = []
        self.rows: list[tuple[Terms, float]] = []  # sum of the terms is at least the number
        self.end: dict[End, int] = {}
        self.total = self._variable(OF_HEIGHT)
        self.top: list[int] = []
        self.bottom: list[int] = []
        self.margins: list[float] = []
        for number, spot in enumerate(columns.spots):
            if spot.block < 0:
                self._add_lane(number)
            else:
                self._add_block(picture, order, number, spot.block)
        for members in order.members:
            self._stack(members)
        self._charge_bends(picture)

    def _variable(self, cost: float = 0.0) -> int:
        self.costs.append(cost)
        return len(self.costs) - 1

    def _at_least(self, high: int, low: int, distance: float) -> None:
        """Require ``high >= low + distance``."""
        self.rows.append(({high: 1.0, low: -1.0}, distance))

    def _add_lane(self, spot: int) -> None:
        y = self._variable()
        self.top.append(y)
        self.bottom.append(y)
        self.margins.append(0.0)
        self.end[End(spot, True, 0)] = self.end[End(spot, False, 0)] = y

    def _add_block(self, picture: Picture, order: Order, spot: int, index: int) -> None:
        block = picture.blocks[index]
        size = size_of(block)
        growth = OF_BAR if block.glyph in BARS else OF_GROWTH
        top, bottom = self._variable(-growth), self._variable(growth)
        self.top.append(top)
        self.bottom.append(bottom)
        self.margins.append(caption_height(len(block.caption)))
        self._at_least(bottom, top, size.height)
        if not size.elastic:
            self._at_least(top, bottom, -size.height)
        for left, ports in ((False, order.inputs[spot]), (True, order.outputs[spot])):
            ends = [self._variable() for _ in ports]
            self.end.update({End(spot, left, port): y for port, y in zip(ports, ends, strict=True)})
            if len(ends) == 1 and size.centered:
                for sign in (1.0, -1.0):
                    self.rows.append(({ends[0]: 2 * sign, top: -sign, bottom: -sign}, 0.0))
                continue
            pad = min(PORT_PAD, (size.height - PORT_PITCH * (len(ends) - 1)) / 2)
            for upper, lower in zip([top, *ends], [*ends, bottom], strict=True):
                inner = upper != top and lower != bottom
                if ends:
                    self._at_least(lower, upper, PORT_PITCH if inner else pad)

    def _stack(self, members: list[int]) -> None:
        """Keep a column's order, inside the picture."""
        spots = self.columns.spots
        if not members:
            return
        self.rows.append(({self.top[members[0]]: 1.0}, 0.0))
        for upper, lower in pairwise(members):
            blocks = (spots[upper].block >= 0) + (spots[lower].block >= 0)
            gap = GAP if blocks == 2 else LANE_GAP
            self._at_least(self.top[lower], self.bottom[upper], self.margins[upper] + gap)
        self._at_least(self.total, self.bottom[members[-1]], self.margins[members[-1]])

    def _charge_bends(self, picture: Picture) -> None:
        spots = self.columns.spots
        for track in self.columns.tracks:
            first = track.ends[0]
            for other in track.ends[1:]:
                lanes = (spots[first.spot].block < 0) + (spots[other.spot].block < 0)
                cost = (OF_BLOCKS, OF_LANE_AND_BLOCK, OF_LANES)[lanes]
                if spots[first.spot].backward or spots[other.spot].backward:
                    cost *= BACKWARD
                cost *= self._share(picture, spots[first.spot].block, spots[other.spot].block)
                bend = self._variable(cost)
                a, b = self.end[first], self.end[other]
                for sign in (1.0, -1.0):
                    if a != b:
                        self.rows.append(({bend: 1.0, a: sign, b: -sign}, 0.0))

    @staticmethod
    def _share(picture: Picture, source: int, target: int) -> float:
        """Scale a bend's cost: wires into scopes and bars bend first, those from sources last."""
        block = picture.blocks[target]
        ends = target >= 0 and not block.outputs and len(block.inputs) == 1
        begins = source >= 0 and not picture.blocks[source].inputs
        bar = target >= 0 and block.glyph in BARS
        share = (OF_SINK if ends else 1.0) * (OF_SOURCE if begins else 1.0)
        return share * (OF_BAR_END if bar else 1.0)

    def solve(self, apart: Iterable[tuple[End, End, float]]) -> Heights:
        """Place blocks, lanes and ports.

        For each (first, second, distance) in ``apart`` the first end is at least that far below
        the second [px].
        """
        rows = [*self.rows]
        for low, high, distance in apart:
            rows.append(({self.end[low]: 1.0, self.end[high]: -1.0}, distance))
        entries = [(r, c, v) for r, (terms, _) in enumerate(rows) for c, v in terms.items()]
        row, column, value = (np.array(part) for part in zip(*entries, strict=True))
        matrix = coo_array((value, (row, column)), shape=(len(rows), len(self.costs))).tocsr()
        found = linprog(
            self.costs,
            A_ub=-matrix,
            b_ub=[-least for _, least in rows],
            bounds=(0, None),
            method="highs-ds",
        )
        y = np.round(found.x, 3).tolist()
        return Heights(
            top=tuple(y[v] for v in self.top),
            bottom=tuple(y[v] for v in self.bottom),
            ends={end: y[v] for end, v in self.end.items()},
            total=y[self.total],
        )
