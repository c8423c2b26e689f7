"""Lines of horizontal and vertical pieces: made simple, told apart, drawn with rounded corners."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from itertools import pairwise

from drake_leg.drawings.svg import Point

RADIUS = 5.0  # [px], of a corner


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
