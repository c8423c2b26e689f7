"""The order of the nets' vertical lines in a channel between two columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from drake_leg.drawings.columns import End, Track

NEAR = 6.0  # [px], lines nearer than this seem to be one
OF_OVERLAP = 1000.0  # in crossings


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
