"""The order of the blocks and lanes in every column, with few crossings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from drake_leg.drawings.columns import Columns, End, Track
from drake_leg.drawings.picture import Picture

# In crossings. A loop's lane is below the blocks where that costs nothing.
ABOVE_A_BLOCK = 0.15
DISORDER = 0.01  # of blocks against the order in which the diagram lists them
SWEEPS = 8

T = TypeVar("T")


@dataclass
class Order:
    """The order in the columns, and of the ports on both sides of every block."""

    members: list[list[int]]  # spots of every column, from the top
    inputs: list[list[int]]  # ports of every spot, from the top
    outputs: list[list[int]]

    def ports(self, end: End) -> list[int]:
        """The ports on the side of its spot that an end is on."""
        return self.outputs[end.spot] if end.left else self.inputs[end.spot]


def order_of(picture: Picture, columns: Columns) -> Order:
    """Order blocks, lanes and loose ports so that few wires cross.

    Barycentres first; then every spot is tried at every other place of its column, until nothing
    gets better.
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


_Found = tuple[float, list[list[int]], list[list[int]], list[list[int]]]


class _Search:
    """A search for a better order; changes ``order`` in place."""

    def __init__(self, picture: Picture, columns: Columns, order: Order) -> None:
        self.columns, self.order = columns, order
        self.loose = [s.block >= 0 and picture.blocks[s.block].loose for s in columns.spots]
        self.channels: list[list[Track]] = [[] for _ in range(len(columns.members) + 1)]
        for track in columns.tracks:
            self.channels[track.channel].append(track)

    def cost(self, column: int) -> float:
        """Return what depends on the order in one column."""
        crossings = sum(self._crossings(channel) for channel in (column, column + 1))
        return crossings + self._disorder(column)

    def total(self) -> float:
        """Return the whole cost."""
        crossings = sum(map(self._crossings, range(len(self.channels))))
        return crossings + sum(map(self._disorder, range(len(self.order.members))))

    def improved(self) -> _Found:
        """Improve until nothing gets better; copy what was found."""
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
        """Sort every column by the mean place of what it is wired to in the column before."""
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
        """Number the ends from the top, on either side."""
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
        """Count pairs of chords whose ends alternate round the channel."""
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
        """Charge for loops above blocks, and for blocks and ports out of their order."""
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
