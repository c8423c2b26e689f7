"""Assigns blocks and nets to columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from drake_leg.pictures.svg import Picture

MANY = 2000  # spots, from which on loops are cut where the diagram's order tells


@dataclass(frozen=True)
class Spot:
    """A place in a column: a block, or a lane for a net that passes the column."""

    column: int
    block: int = -1  # -1: a lane
    net: int = -1  # of a lane
    backward: bool = False  # a lane that is passed from right to left


class End(NamedTuple):
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
    columns = _columns(picture, _forward_edges(picture))
    if len(columns.spots) < MANY:
        return columns
    listed = {(net.source[0], target) for net in picture.nets for target, _ in net.targets}
    return _columns(picture, sorted(edge for edge in listed if edge[0] < edge[1]))


def _columns(picture: Picture, forward: Sequence[tuple[int, int]]) -> Columns:
    column = _layers(picture, forward)
    spots = [Spot(column=c, block=block) for block, c in enumerate(column)]
    tracks: list[Track] = []
    for index, net in enumerate(picture.nets):
        tracks += _tracks_of_net(index, net.source, net.targets, column, spots)
    members: list[list[int]] = [[] for _ in range(max(column, default=-1) + 1)]
    for number, spot in enumerate(spots):
        members[spot.column].append(number)
    return Columns(tuple(spots), tuple(map(tuple, members)), tuple(tracks))


def _layers(picture: Picture, forward: Sequence[tuple[int, int]]) -> list[int]:
    """Longest paths from the sources; then sources move right, to where they are needed."""
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
