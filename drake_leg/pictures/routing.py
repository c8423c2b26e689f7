"""Wires: the order of their vertical lines in a channel, and their paths with rounded corners."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.columns import End, Track
from drake_leg.pictures.order import sifted
from drake_leg.pictures.svg import Point

RADIUS = 5.0  # [px], of a corner
NEAR = 6.0  # [px], lines nearer than this seem to be one
OF_OVERLAP = 1000  # in crossings


def simplified(points: Sequence[Point]) -> tuple[Point, ...]:
    """Leave out the points in the middle of straight pieces."""
    kept: list[Point] = []
    for point in points:
        if kept and math.dist(kept[-1], point) < 1e-6:
            continue
        if len(kept) > 1 and _turn(kept[-2], kept[-1], point) == 0.0:
            kept.pop()
        kept.append(point)
    return tuple(kept)


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def divergence(
    points: tuple[Point, ...], earlier: Sequence[tuple[Point, ...]]
) -> tuple[Point, ...]:
    """The part of a line that none of the earlier lines has, from the branch to the end.

    All lines are simplified and begin at one point.
    """
    rests = [_rest(points, other) for other in earlier]
    return min(rests, key=length, default=points)


def length(points: Sequence[Point]) -> float:
    """Length of a line [px]."""
    return sum(math.dist(a, b) for a, b in pairwise(points))


def _rest(points: tuple[Point, ...], other: tuple[Point, ...]) -> tuple[Point, ...]:
    mine, theirs = list(points), list(other)
    while len(mine) > 1 and len(theirs) > 1:
        a, b = (_step(line[0], line[1]) for line in (mine, theirs))
        if a[:2] != b[:2]:
            break
        near = mine[1] if a[2] <= b[2] else theirs[1]
        for line in (mine, theirs):
            line[0] = near
            if math.dist(near, line[1]) < 1e-6:
                line.pop(0)
    return tuple(mine)


def _step(start: Point, end: Point) -> tuple[int, int, float]:
    x, y = end[0] - start[0], end[1] - start[1]
    return (x > 0) - (x < 0), (y > 0) - (y < 0), abs(x) + abs(y)


def rounded(points: Sequence[Point], sharp: Collection[Point] = ()) -> str:
    """Write a simplified line as the data of an SVG path.

    ``sharp`` corners are not rounded, because another line begins there.
    """
    parts = [f"M{_at(points[0])}"]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        radius = min(RADIUS, math.dist(before, corner) / 2, math.dist(corner, after) / 2)
        if corner in sharp:
            parts.append(f"L{_at(corner)}")
            continue
        start, end = _towards(corner, before, radius), _towards(corner, after, radius)
        parts.append(f"L{_at(start)}Q{_at(corner)} {_at(end)}")
    return "".join([*parts, f"L{_at(points[-1])}"])


def _towards(start: Point, end: Point, distance: float) -> Point:
    share = distance / math.dist(start, end)
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def _at(point: Point) -> str:
    return f"{point[0]:.1f} {point[1]:.1f}"


@dataclass(frozen=True)
class Trunk:
    """A net's vertical line in a channel."""

    track: Track
    left: tuple[float, ...]  # heights of its ends on the channel's left side [px]
    right: tuple[float, ...]

    @property
    def low(self) -> float:
        """Its least height."""
        return min(self.left + self.right)

    @property
    def high(self) -> float:
        """Its greatest height."""
        return max(self.left + self.right)

    @property
    def straight(self) -> bool:
        """Whether the net goes straight through, without a vertical line."""
        return self.high - self.low < 0.01


def trunks_of(tracks: Sequence[Track], heights: Mapping[End, float]) -> list[Trunk]:
    """Find the vertical lines of a channel."""
    return [
        Trunk(
            track,
            tuple(heights[end] for end in track.ends if end.left),
            tuple(heights[end] for end in track.ends if not end.left),
        )
        for track in tracks
    ]


def lanes_of(trunks: Sequence[Trunk]) -> tuple[dict[int, int], list[tuple[Trunk, Trunk]]]:
    """Find the lane of every vertical line of a channel, and pairs that cannot be kept apart.

    Lanes, by net, are counted from the left; straight nets have none. Of a pair, the first would
    lie on the second whichever way they are ordered.
    """
    bent = sorted(
        (t for t in trunks if not t.straight),
        key=lambda t: (-max(t.left, default=t.low), t.track.net),
    )
    if not bent:
        return {}, []
    low, high = (np.array(ends) for ends in zip(*((t.low, t.high) for t in bent), strict=True))
    crossings, overlaps = _costs(bent, low, high)
    order = _ordered(crossings + OF_OVERLAP * overlaps)
    beside = low[:, np.newaxis] < high + 2 * NEAR
    beside &= beside.T
    lane = np.zeros(len(bent), dtype=int)
    for place, trunk in enumerate(order):
        taken = lane[order[:place]][beside[trunk, order[:place]]]
        lane[trunk] = taken.max(initial=-1) + 1
    pairs = np.argwhere(np.triu(overlaps[np.ix_(order, order)], 1))
    return (
        {bent[trunk].track.net: int(lane[trunk]) for trunk in order},
        [(bent[order[a]], bent[order[b]]) for a, b in pairs],
    )


def _ordered(costs: Array) -> list[int]:
    """Try every line at every place until nothing gets better.

    ``costs[a, b]`` is the cost of line a left of line b.
    """
    order = list(range(len(costs)))
    while True:
        ordered = costs[np.ix_(order, order)]
        places = sifted(ordered.T - ordered)
        order = [order[place] for place in places]
        if places == sorted(places):
            return order


def _costs(trunks: Sequence[Trunk], low: Array, high: Array) -> tuple[Array, Array]:
    """Count crossings of each line, left of each other one; tell where it would lie on it.

    It would where it leaves to the right at a height at which the other comes from the left.
    """
    of_left, left = _ends([trunk.left for trunk in trunks])
    of_right, right = _ends([trunk.right for trunk in trunks])
    count = len(trunks)
    crossings = np.zeros((count, count), dtype=int)
    overlaps = np.zeros((count, count), dtype=bool)
    for trunk, y in zip(of_left, left, strict=True):
        crossings[:, trunk] += (low < y) & (y < high)
    for trunk, y in zip(of_right, right, strict=True):
        crossings[trunk] += (low < y) & (y < high)
        overlaps[trunk, of_left[np.abs(y - left) < NEAR]] = True
    return crossings, overlaps


def _ends(heights: Sequence[Sequence[float]]) -> tuple[Array, Array]:
    """Number the line of every end, and give the end's height."""
    lines = [number for number, of_line in enumerate(heights) for _ in of_line]
    return np.array(lines, dtype=int), np.array([y for of_line in heights for y in of_line])
