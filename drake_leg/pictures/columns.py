"""Assigns blocks and nets to columns, and orders every column."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from drake_leg.pictures.svg import Picture

# In crossings. A loop's lane is below the blocks where that costs nothing.
ABOVE_A_BLOCK = 0.15
DISORDER = 0.01  # of blocks against the order in which the diagram lists them
SWEEPS = 8
T = TypeVar("T")
_Found = tuple[float, list[list[int]], list[list[int]], list[list[int]]]


@dataclass(frozen=True)
class Spot:
    """A place in a column: a block, or a lane for a net that passes the column."""

    column: int
    block: int = -1  # -1: a lane
    net: int = -1  # of a lane
    backward: bool = False  # a lane that is passed from right to left


@dataclass(frozen=True)
class End:
    """Where a net meets a channel between two columns."""

    spot: int
    left: bool  # on the left side of the channel: right of its spot
    port: int  # of the spot's block


@dataclass(frozen=True)
class Track:
    """A net's part in one channel; channel c lies left of column c."""

    net: int
    channel: int
    ends: tuple[End, ...]  # its source first, then its targets


@dataclass(frozen=True)
class Columns:
    """A picture with its blocks in columns."""

    spots: tuple[Spot, ...]
    members: tuple[tuple[int, ...], ...]  # spots of every column, in the picture's order
    tracks: tuple[Track, ...]

    @property
    def channels(self) -> list[list[Track]]:
        """The tracks of every channel."""
        channels: list[list[Track]] = [[] for _ in range(len(self.members) + 1)]
        for track in self.tracks:
            channels[track.channel].append(track)
        return channels


def columns_of(picture: Picture) -> Columns:
    """Assign every block to a column, and lanes to the nets that pass columns.

    Every wire goes from left to right, except those that close a loop. They pass lanes, too, so
    that no wire crosses a block. After Sugiyama, Tagawa and Toda, "Methods for visual understanding
    of hierarchical system structures", 1981, with nets instead of single edges.
    """
    column = _layers(picture)
    spots = [Spot(column=c, block=block) for block, c in enumerate(column)]
    tracks: list[Track] = []
    for index, net in enumerate(picture.nets):
        tracks += _tracks_of_net(index, net.source, net.targets, column, spots)
    members: list[list[int]] = [[] for _ in range(max(column, default=-1) + 1)]
    for number, spot in enumerate(spots):
        members[spot.column].append(number)
    return Columns(tuple(spots), tuple(map(tuple, members)), tuple(tracks))


def _layers(picture: Picture) -> list[int]:
    """Longest paths from the sources; then sources move right, to where they are needed."""
    forward = _forward_edges(picture)
    count = len(picture.blocks)
    after: list[list[int]] = [[] for _ in range(count)]
    before: list[list[int]] = [[] for _ in range(count)]
    for source, target in forward:
        after[source].append(target)
        before[target].append(source)
    column = [0] * count
    for block in _topological(after, before):
        column[block] = max((column[other] + 1 for other in before[block]), default=0)
    for block in reversed(_topological(after, before)):
        if after[block] and not before[block]:
            column[block] = min(column[other] for other in after[block]) - 1
    return column


def _forward_edges(picture: Picture) -> list[tuple[int, int]]:
    """Leave out the edges that close a loop: back edges of a depth-first search."""
    after: list[list[int]] = [[] for _ in picture.blocks]
    for net in picture.nets:
        for target, _ in net.targets:
            if target not in after[net.source[0]]:
                after[net.source[0]].append(target)
    fed = {target for targets in after for target in targets}
    starts = sorted(range(len(after)), key=lambda block: block in fed)
    state = ["new"] * len(after)
    forward: list[tuple[int, int]] = []

    def visit(block: int) -> None:
        state[block] = "on the way"
        for target in after[block]:
            if state[target] == "new":
                visit(target)
            if state[target] == "done":
                forward.append((block, target))
        state[block] = "done"

    for block in starts:
        if state[block] == "new":
            visit(block)
    return forward


def _topological(after: list[list[int]], before: list[list[int]]) -> list[int]:
    waiting = [len(sources) for sources in before]
    ready = [block for block, sources in enumerate(before) if not sources]
    order = []
    while ready:
        block = ready.pop(0)
        order.append(block)
        for target in after[block]:
            waiting[target] -= 1
            if not waiting[target]:
                ready.append(target)
    return order


def _tracks_of_net(
    net: int,
    source: tuple[int, int],
    targets: tuple[tuple[int, int], ...],
    column: list[int],
    spots: list[Spot],
) -> list[Track]:
    """Route a net from its source through lanes to its targets; append the lanes to ``spots``."""
    start = column[source[0]]
    last = max((column[block] for block, _ in targets if column[block] > start), default=start)
    first = min(
        (column[block] for block, _ in targets if column[block] <= start), default=start + 1
    )

    def lane(at: int) -> int:
        spots.append(Spot(column=at, net=net, backward=at <= start))
        return len(spots) - 1

    def reached(at: int) -> list[End]:
        return [End(block, False, port) for block, port in targets if column[block] == at]

    back = {at: lane(at) for at in range(first, start + 1)}
    on = {at: lane(at) for at in range(start + 1, last)}
    tracks = []
    for channel in range(first, max(last, start + 1) + 1):
        ends = reached(channel)
        if channel in on:
            ends.append(End(on[channel], False, 0))
        if channel - 1 in back:
            ends.append(End(back[channel - 1], True, 0))
        if channel <= start:
            ends.insert(0, End(back[channel], False, 0))
        elif channel == start + 1:
            ends.insert(0, End(source[0], True, source[1]))
        else:
            ends.insert(0, End(on[channel - 1], True, 0))
        tracks.append(Track(net=net, channel=channel, ends=tuple(ends)))
    return tracks


@dataclass
class Order:
    """The order of the spots in each column, and of the ports on each side of a block."""

    members: list[list[int]]  # spots of every column, from the top
    inputs: list[list[int]]  # ports of every spot, from the top
    outputs: list[list[int]]

    def ports(self, end: End) -> list[int]:
        """The ports on an end's side of its spot."""
        return self.outputs[end.spot] if end.left else self.inputs[end.spot]


def order_of(picture: Picture, columns: Columns) -> Order:
    """Order blocks, lanes and loose ports so that few wires cross.

    Barycentres first; then every spot is tried at every place in its column until the cost stops
    falling.
    """
    sides = [
        (range(len(picture.blocks[s.block].inputs)), range(len(picture.blocks[s.block].outputs)))
        if s.block >= 0
        else (range(1), range(1))
        for s in columns.spots
    ]
    order = Order(
        members=[list(members) for members in columns.members],
        inputs=[list(inputs) for inputs, _ in sides],
        outputs=[list(outputs) for _, outputs in sides],
    )
    search = _Search(picture, columns, order)
    best = search.improved()
    for sweep in range(SWEEPS):
        search.sweep(rightward=sweep % 2 == 0)
        best = min(best, search.improved(), key=lambda found: found[0])
    _, members, inputs, outputs = best
    return Order(members=members, inputs=inputs, outputs=outputs)


class _Search:
    """A search for a better order; changes ``order`` in place."""

    def __init__(self, picture: Picture, columns: Columns, order: Order) -> None:
        self.columns, self.order = columns, order
        self.loose = [s.block >= 0 and picture.blocks[s.block].loose for s in columns.spots]
        self.channels = columns.channels

    def cost(self, column: int) -> float:
        """Return the part of the cost that depends on one column's order."""
        crossings = sum(self._crossings(channel) for channel in (column, column + 1))
        return crossings + self._disorder(column)

    def total(self) -> float:
        """Return the whole cost."""
        crossings = sum(map(self._crossings, range(len(self.channels))))
        return crossings + sum(map(self._disorder, range(len(self.order.members))))

    def improved(self) -> _Found:
        """Improve the order until the cost stops falling; return cost and order, copied."""
        better = True
        while better:
            better = False
            for column, members in enumerate(self.order.members):
                better |= self._improve(members, column)
                for spot in members:
                    if self.loose[spot]:
                        better |= self._improve(self.order.inputs[spot], column)
                        better |= self._improve(self.order.outputs[spot], column)
        order = self.order
        copies = [
            [list(row) for row in rows] for rows in (order.members, order.inputs, order.outputs)
        ]
        return self.total(), copies[0], copies[1], copies[2]

    def _improve(self, row: list[int], column: int) -> bool:
        """Try every element of a row at every place."""
        improved = False
        best = self.cost(column)
        for item in list(row):
            here = row.index(item)
            at = here
            for place in range(len(row)):
                row.remove(item)
                row.insert(place, item)
                cost = self.cost(column)
                if cost < best - 1e-9:
                    best, at, improved = cost, place, True
            row.remove(item)
            row.insert(at, item)
        return improved

    def sweep(self, *, rightward: bool) -> None:
        """Sort every column by the mean place of its neighbours in the previous column."""
        columns = list(range(len(self.order.members)))
        for column in columns if rightward else reversed(columns):
            channel = column if rightward else column + 1
            means = self._means(channel, near_is_right=rightward)
            members = self.order.members[column]
            keyed = [
                (means.get(spot, float(place)), place, spot) for place, spot in enumerate(members)
            ]
            members[:] = [spot for _, _, spot in sorted(keyed)]

    def _means(self, channel: int, *, near_is_right: bool) -> dict[int, float]:
        places: dict[int, list[float]] = {}
        position = self._positions(channel)
        for track in self.channels[channel]:
            far = [position[end] for end in track.ends if end.left == near_is_right]
            for end in track.ends:
                if end.left != near_is_right:
                    places.setdefault(end.spot, []).extend(far)
        return {spot: sum(found) / len(found) for spot, found in places.items() if found}

    def _positions(self, channel: int) -> dict[End, float]:
        """Vertical position of each end of a channel, counted from the top."""
        position: dict[End, float] = {}
        for left in (True, False):
            ends = [e for track in self.channels[channel] for e in track.ends if e.left == left]
            column = channel - 1 if left else channel
            if not ends:
                continue
            places = {spot: place for place, spot in enumerate(self.order.members[column])}
            for end in ends:
                ports = self.order.ports(end)
                position[end] = places[end.spot] + (ports.index(end.port) + 1) / (len(ports) + 1)
        return position

    def _crossings(self, channel: int) -> float:
        """Count crossings: pairs of chords whose ends alternate around the channel."""
        position = self._positions(channel)
        # Down the left side, then up the right one.
        around = {end: at if end.left else 1e6 - at for end, at in position.items()}
        chords = [
            (*sorted((around[track.ends[0]], around[end])), track.net)
            for track in self.channels[channel]
            for end in track.ends[1:]
        ]
        return sum(
            a[2] != b[2] and (a[0] < b[0] < a[1] < b[1] or b[0] < a[0] < b[1] < a[1])
            for a, b in _pairs(chords)
        )

    def _disorder(self, column: int) -> float:
        """Penalise loops above blocks, and blocks and ports out of order."""
        spots = self.columns.spots
        row = self.order.members[column]
        cost = 0.0
        for upper, lower in _pairs(row):
            if spots[lower].block >= 0:
                if spots[upper].backward:
                    cost += ABOVE_A_BLOCK
                elif spots[upper].block > spots[lower].block:
                    cost += DISORDER
        for spot in row:
            for ports in (self.order.inputs[spot], self.order.outputs[spot]):
                cost += DISORDER * sum(a > b for a, b in _pairs(ports))
        return cost


def _pairs(items: list[T]) -> Iterator[tuple[T, T]]:
    for place, first in enumerate(items):
        for second in items[place + 1 :]:
            yield first, second
