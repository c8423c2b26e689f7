"""Wires: the order of their vertical lines in a channel, and their paths with rounded corners."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from drake_leg.pictures.columns import End, Track
from drake_leg.pictures.svg import Point

RADIUS = 5.0  # [px], of a corner
NEAR = 6.0  # [px], lines nearer than this seem to be one
OF_OVERLAP = 1000.0  # in crossings


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
    bent = sorted((t for t in trunks if not t.straight), key=lambda t: t.track.net)
    order = _ordered(bent)
    lanes: dict[int, int] = {}
    for place, trunk in enumerate(order):
        taken = [
            lanes[other.track.net]
            for other in order[:place]
            if trunk.low < other.high + 2 * NEAR and other.low < trunk.high + 2 * NEAR
        ]
        lanes[trunk.track.net] = max(taken, default=-1) + 1
    pairs = [(a, b) for place, a in enumerate(order) for b in order[place + 1 :]]
    return lanes, [(a, b) for a, b in pairs if _overlaps(a, b)]


def _ordered(trunks: list[Trunk]) -> list[Trunk]:
    """Try every line at every place until nothing gets better."""
    order = sorted(trunks, key=lambda t: (-max(t.left, default=t.low), t.track.net))
    cost = _cost(order)
    better = True
    while better:
        better = False
        for trunk in list(order):
            for place in range(len(order)):
                trial = [other for other in order if other is not trunk]
                trial.insert(place, trunk)
                trial_cost = _cost(trial)
                if trial_cost < cost - 1e-9:
                    order, cost, better = trial, trial_cost, True
    return order


def _cost(order: Sequence[Trunk]) -> float:
    return sum(
        _crossings(a, b) + OF_OVERLAP * _overlaps(a, b)
        for place, a in enumerate(order)
        for b in order[place + 1 :]
    )


def _crossings(a: Trunk, b: Trunk) -> int:
    """Count crossings where ``a`` is left of ``b``."""
    return sum(a.low < y < a.high for y in b.left) + sum(b.low < y < b.high for y in a.right)


def _overlaps(a: Trunk, b: Trunk) -> bool:
    """Tell whether ``a``, left of ``b``, leaves to the right where ``b`` comes from the left."""
    return any(abs(out - into) < NEAR for out in a.right for into in b.left)
