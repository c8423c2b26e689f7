"""Lays out a block diagram: columns, order, heights, and channels for the wires."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from drake_leg.pictures.columns import Columns, End, Track, columns_of
from drake_leg.pictures.heights import Heights, Programme
from drake_leg.pictures.order import Order, order_of
from drake_leg.pictures.routing import NEAR, Trunk, divergence, lanes_of, simplified, trunks_of
from drake_leg.pictures.svg import LINE, SIZE, SMALL, Box, Picture, Point, size_of, text_width

PITCH = 9.0  # [px], between vertical lines of a channel
BEFORE, AFTER = 10.0, 16.0  # [px], free at a channel's sides; an arrow's head is at the right one
NARROWEST = 26.0  # [px], of a channel
ROUNDS = 12  # of separating lines that overlap


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
    programme = Programme(picture, columns, order)
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
