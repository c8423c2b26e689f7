"""Orders the blocks and lanes of every column so that few wires cross."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_leg.pictures.columns import Columns, End
from drake_leg.pictures.svg import Picture

CROSSING = 100  # what a crossing costs
ABOVE_A_BLOCK = 15  # a loop's lane: it is below the blocks where that costs nothing
DISORDER = 1  # of blocks against the order in which the diagram lists them
SWEEPS = 8
MOST_TRIED = 5000  # spots at all places of their columns; larger pictures are less tidy
ACROSS = 1e6  # more than there are places in a column
Numbers = NDArray[Any]
_Found = tuple[int, list[list[int]], list[list[int]], list[list[int]]]


@dataclass
class Order:
    """The order of the spots in each column, and of the ports on each side of a block."""

    members: list[list[int]]  # spots of every column, from the top
    inputs: list[list[int]]  # ports of every spot, from the top
    outputs: list[list[int]]


def order_of(picture: Picture, columns: Columns) -> Order:
    """Order blocks, lanes and loose ports so that few wires cross.

    Barycenters first; then every spot is tried at every place in its column until the cost stops
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
        if search.tried >= MOST_TRIED:
            break
        search.sweep(rightward=sweep % 2 == 0)
        best = min(best, search.improved(), key=lambda found: found[0])
    _, members, inputs, outputs = best
    return Order(members=members, inputs=inputs, outputs=outputs)


def sifted(
    passing: Numbers, more: Callable[[int, Sequence[int]], Numbers] | None = None
) -> list[int]:
    """Move every item of a row once to its best place; return the new order.

    ``passing[i, j]`` is the cost of item i passing item j, from above to below. ``more`` returns
    the further cost of an item that passes each other one, in their current order.
    """
    order = list(range(len(passing)))
    for item in range(len(passing)):
        here = order.index(item)
        others = order[:here] + order[here + 1 :]
        costs = passing[item] + more(item, order) if more else passing[item]
        at_place = np.concatenate([[0], np.cumsum(costs[others])])
        best = int(np.argmin(at_place))
        if at_place[best] < at_place[here]:
            order = [*others[:best], item, *others[best:]]
    return order


_Item = int | End  # a spot of a column, or a port of a side


class _Hook(NamedTuple):
    """One end of a chord, which is a net's way through a channel from its source to a target."""

    end: End
    other: End
    net: int

    @property
    def turns_back(self) -> bool:
        """Whether both ends of the chord are on one side of the channel."""
        return self.end.left == self.other.left


class _Turning:
    """The hooks at one side of a channel, some of whose chords turn back.

    Places on the way around the channel count from the top of this side downwards.
    """

    def __init__(self, hooks: Sequence[_Hook], items: Sequence[int]) -> None:
        self.hooks, self.item = hooks, np.array(items)
        self.net = np.array([hook.net for hook in hooks])
        self.turns_back = np.array([hook.turns_back for hook in hooks])
        self.spot = np.array([hook.end.spot for hook in hooks])
        self.other_spot = np.array([hook.other.spot for hook in hooks])

    def note(self, position: Callable[[End], float]) -> None:
        """Note where all ends are now."""
        self.at = np.array([position(hook.end) for hook in self.hooks])
        other = np.array([position(hook.other) for hook in self.hooks])
        self.other = np.where(self.turns_back, other, ACROSS - other)

    def crossed(self, item: int, count: int) -> Numbers:
        """Count crossings that come less those that go as an item passes each of ``count``.

        Of two chords one or both turn back. They cross if, on the way around from where their ends
        meet, the chord that passes is the first to end.
        """
        mine = np.flatnonzero(self.item == item)[:, np.newaxis]
        among = self.turns_back | self.turns_back[mine].any()
        passed = np.flatnonzero(among & (self.item != item))
        meet = self.at[passed]

        def around(hooks: Numbers) -> Numbers:
            above = self.turns_back[hooks] & (self.other[hooks] < meet)
            places: Numbers = self.other[hooks] + 2 * ACROSS * above
            return places

        beside = np.where(self.other[passed] > self.at[mine], -1.0, 3 * ACROSS)
        own = self.turns_back[passed] & (self.other_spot[passed] == self.spot[mine])
        crosses = around(mine) < np.where(own, beside, around(passed))
        differ = self.net[passed] != self.net[mine]
        counts = differ & (self.turns_back[passed] | self.turns_back[mine])
        come = np.where(counts, np.where(crosses, -1, 1), 0).sum(axis=0)
        return np.bincount(self.item[passed], come, minlength=count)


class _Search:
    """A search for a better order, which it changes in place.

    When two neighbors change places, only crossings of their own chords come or go. So all places
    of an item are rated at once, by adding up what it gains by passing the others.
    """

    def __init__(self, picture: Picture, columns: Columns, order: Order) -> None:
        self.columns, self.order = columns, order
        self.loose = [s.block >= 0 and picture.blocks[s.block].loose for s in columns.spots]
        self.channels = columns.channels
        self.hooks: dict[tuple[int, bool], list[_Hook]] = {}  # by spot and side
        for track in columns.tracks:
            source, *targets = track.ends
            for target in targets:
                for end, other in ((source, target), (target, source)):
                    hook = _Hook(end, other, track.net)
                    self.hooks.setdefault((end.spot, end.left), []).append(hook)
        self.place: dict[_Item, float] = {}  # of a spot in its column, of a port on its side
        for members in order.members:
            self._note(members)
            for spot in members:
                for left in (False, True):
                    self._note(self._sides_ports(spot, left))
        self.visits = self.tried = 0
        self.last_visit = [-1] * len(order.members)
        self.last_change = [0] * len(order.members)

    def _note(self, items: Sequence[_Item]) -> None:
        """Note where the items of a row are: spots by their places, ports between two places."""
        count = len(items) + 1
        for place, item in enumerate(items):
            self.place[item] = place if isinstance(item, int) else (place + 1) / count

    def _sides_ports(self, spot: int, left: bool) -> list[End]:
        """Return the ports on one side of a spot, from the top."""
        ports = (self.order.outputs if left else self.order.inputs)[spot]
        return [End(spot, left, port) for port in ports]

    def total(self) -> int:
        """Return the whole cost."""
        cost = CROSSING * sum(map(self._crossings, range(len(self.channels))))
        for column, members in enumerate(self.order.members):
            cost += int(np.triu(self._penalties(members), 1).sum())
            for ports in self._loose_ports(column):
                cost += int(np.triu(_disorder(ports), 1).sum())
        return cost

    def improved(self) -> _Found:
        """Improve the order until the cost stops falling; return cost and order, copied."""
        order = self.order
        better = True
        while better and self.tried < MOST_TRIED:
            better = False
            for column in range(len(order.members)):
                better |= self._improve_column(column)
        copies = [
            [list(row) for row in rows] for rows in (order.members, order.inputs, order.outputs)
        ]
        return self.total(), copies[0], copies[1], copies[2]

    def _improve_column(self, column: int) -> bool:
        """Improve a column, unless nothing changed there since that last failed."""
        if self.last_visit[column] > max(self.last_change[max(column - 1, 0) : column + 2]):
            return False
        self.visits += 1
        self.last_visit[column] = self.visits
        members = self.order.members[column]
        self.tried += len(members)
        sides = [
            [hook for spot in members for hook in self.hooks.get((spot, left), ())]
            for left in (False, True)
        ]
        better = self._improve(members, members, self._penalties(members), sides, _spot_of)
        for spot in members:
            if self.loose[spot]:
                for left, ports in (
                    (False, self.order.inputs[spot]),
                    (True, self.order.outputs[spot]),
                ):
                    hooks = self.hooks.get((spot, left), [])
                    ends = self._sides_ports(spot, left)
                    better |= self._improve(ports, ends, _disorder(ports), [hooks], _itself)
        if better:
            self.last_change[column] = self.visits
        return better

    def _improve(
        self,
        row: list[int],
        named: Sequence[_Item],
        penalties: Numbers,
        sides: Sequence[Sequence[_Hook]],
        item_of: Callable[[End], _Item],
    ) -> bool:
        """Move every item of a row to its best place; ``named`` are its spots or ports.

        ``penalties[i, j]`` is the cost of item i above item j, in addition to their crossings.
        """
        if len(row) < 2:
            return False
        numbers, items = list(row), list(named)
        index = {item: number for number, item in enumerate(items)}
        costs = penalties.T - penalties  # of item i passing item j, downwards
        for hooks in sides:
            costs = costs + CROSSING * self._crossed(hooks, index, item_of)
        turning = [
            _Turning(hooks, [index[item_of(hook.end)] for hook in hooks])
            for hooks in sides
            if any(hook.turns_back for hook in hooks)
        ]
        noted: list[int] = []

        def by_turns(item: int, order: Sequence[int]) -> Numbers:
            if noted != order:
                noted[:] = order
                self._note([items[other] for other in order])
                for hooks in turning:
                    hooks.note(self._position)
            found: Numbers = np.sum([h.crossed(item, len(items)) for h in turning], axis=0)
            return CROSSING * found

        order = sifted(costs, by_turns if turning else None)
        row[:] = [numbers[item] for item in order]
        self._note([items[item] for item in order])
        return row != numbers

    def _crossed(
        self, hooks: Sequence[_Hook], index: Mapping[_Item, int], item_of: Callable[[End], _Item]
    ) -> Numbers:
        """Count crossings that come less those that go as item i passes item j, downwards.

        Chords that turn back do not count here.
        """
        straight = [hook for hook in hooks if not hook.turns_back]
        items = np.array([index[item_of(hook.end)] for hook in straight], dtype=int)
        far = np.array([self._position(hook.other) for hook in straight])
        nets = np.array([hook.net for hook in straight])
        come = np.sign(far[np.newaxis, :] - far[:, np.newaxis])
        come[nets[np.newaxis, :] == nets[:, np.newaxis]] = 0.0
        count = len(index)
        pairs = (items[:, np.newaxis] * count + items[np.newaxis, :]).ravel()
        return np.bincount(pairs, come.ravel(), minlength=count * count).reshape(count, count)

    def sweep(self, *, rightward: bool) -> None:
        """Sort every column by the mean place of its neighbors in the previous column."""
        columns = list(range(len(self.order.members)))
        for column in columns if rightward else reversed(columns):
            channel = column if rightward else column + 1
            means = self._means(channel, near_is_right=rightward)
            members = self.order.members[column]
            keyed = [
                (means.get(spot, float(place)), place, spot) for place, spot in enumerate(members)
            ]
            members[:] = [spot for _, _, spot in sorted(keyed)]
            self._note(members)
            self.last_change[column] = self.visits

    def _means(self, channel: int, *, near_is_right: bool) -> dict[int, float]:
        places: dict[int, list[float]] = {}
        for track in self.channels[channel]:
            far = [self._position(end) for end in track.ends if end.left == near_is_right]
            for end in track.ends:
                if end.left != near_is_right:
                    places.setdefault(end.spot, []).extend(far)
        return {spot: sum(found) / len(found) for spot, found in places.items() if found}

    def _position(self, end: End) -> float:
        """Vertical position of an end, counted from the top of its column."""
        return self.place[end.spot] + self.place[end]

    def _crossings(self, channel: int) -> int:
        """Count crossings: pairs of chords whose ends alternate around the channel."""
        chords = [
            (*sorted(map(self._around_channel, (track.ends[0], end))), track.net)
            for track in self.channels[channel]
            for end in track.ends[1:]
        ]
        if not chords:
            return 0
        first, last, net = (np.array(part) for part in zip(*chords, strict=True))
        begins = (first[:, np.newaxis] < first) & (first < last[:, np.newaxis])
        alternate = begins & (last[:, np.newaxis] < last) & (net[:, np.newaxis] != net)
        return int(alternate.sum())

    def _around_channel(self, end: End) -> float:
        """Place of an end on the way down the left side and up the right one."""
        at = self._position(end)
        return at if end.left else ACROSS - at

    def _loose_ports(self, column: int) -> list[list[int]]:
        loose = [spot for spot in self.order.members[column] if self.loose[spot]]
        return [ports[spot] for ports in (self.order.inputs, self.order.outputs) for spot in loose]

    def _penalties(self, members: Sequence[int]) -> Numbers:
        """Cost of each spot above each other one: loops above blocks, blocks out of order."""
        spots = [self.columns.spots[spot] for spot in members]
        block = np.array([spot.block for spot in spots])
        backward = np.array([spot.backward for spot in spots])
        out_of_order = DISORDER * (block[:, np.newaxis] > block)
        cost = np.where(backward[:, np.newaxis], ABOVE_A_BLOCK, out_of_order)
        return cost * (block >= 0)


def _disorder(ports: Sequence[int]) -> Numbers:
    """Cost of each port above each other one."""
    order = np.array(ports, dtype=int)
    return DISORDER * (order[:, np.newaxis] > order)


def _spot_of(end: End) -> _Item:
    return end.spot


def _itself(end: End) -> _Item:
    return end
