"""Measure contenders in turn, and compare ours with each peer at equal or better accuracy."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

Clock = Callable[[], float]


class Sample(NamedTuple):
    """One repeat: how long it took [s], and how far it was from the exact answer."""

    seconds: float
    error: float


@dataclass(frozen=True, kw_only=True)
class Contender:
    """One way of doing the work of a contest."""

    name: str
    once: Callable[[], Sample]


@dataclass(frozen=True, kw_only=True)
class Contest:
    """The same work by us and by others."""

    name: str
    work: str  # what is done, for the table
    ours: Callable[[], Contender]
    peers: Sequence[Callable[[], Contender]]  # each raises ModuleNotFoundError where it is missing
    simulated: float | None = None  # [s]
    unit: str = ""  # of the error
    enough: float = 0.0  # errors below this one are equal
    allowed: float | None = None  # our greatest error
    repeats: int | None = None  # where the work is long


@dataclass(frozen=True, kw_only=True)
class Times:
    """What a contender needed in all repeats."""

    name: str
    seconds: tuple[float, ...]
    error: float  # the greatest

    @property
    def best(self) -> float:
        """Shortest time [s]."""
        return min(self.seconds)

    @property
    def spread(self) -> float:
        """How much longer the median repeat took than the best, as a part of the best."""
        return statistics.median(self.seconds) / self.best - 1.0


@dataclass(frozen=True, kw_only=True)
class Result:
    """A contest's times; what is missing says why."""

    contest: Contest
    ours: Times
    peers: tuple[Times, ...]
    missing: dict[str, str] = field(default_factory=dict)  # peer to reason

    def is_fair(self, peer: Times) -> bool:
        """Whether our answer is at least as accurate as the peer's."""
        return self.ours.error <= max(peer.error, self.contest.enough)

    def ratio(self, peer: Times) -> float | None:
        """Peer's best time over ours; None where we are less accurate."""
        return peer.best / self.ours.best if self.is_fair(peer) else None

    @property
    def inaccuracy(self) -> str | None:
        """Say that our error is greater than allowed, if it is."""
        allowed = self.contest.allowed
        if allowed is None or self.ours.error <= allowed:
            return None
        unit = f" {self.contest.unit}" if self.contest.unit else ""
        return (
            f"{self.contest.name}: our error is {self.ours.error:.2g}{unit}, "
            f"allowed are {allowed:.2g}{unit}"
        )


def timed(
    name: str,
    work: Callable[[Any], Any],
    *,
    error: Callable[[Any], float],
    prepare: Callable[[], Any] = lambda: None,
    clock: Clock = time.process_time,
) -> Contender:
    """Make a contender: ``error(work(prepare()))``, of which only the work is timed."""

    def once() -> Sample:
        prepared = prepare()
        gc.collect()
        began = clock()
        answer = work(prepared)
        seconds = clock() - began
        return Sample(seconds, float(error(answer)))

    return Contender(name=name, once=once)


def scaled(contender: Contender, factor: float) -> Contender:
    """Multiply the times of a contender that does only a part of the work."""

    def once() -> Sample:
        sample = contender.once()
        return Sample(factor * sample.seconds, sample.error)

    return Contender(name=contender.name, once=once)


def measure(contest: Contest, repeats: int) -> Result:
    """Warm up, then let all contenders take turns; each repeat's error counts."""
    ours = contest.ours()
    peers, missing = [], {}
    for make in contest.peers:
        try:
            peers.append(make())
        except ModuleNotFoundError as error:
            missing[make.__name__] = f"{error}; the extra bench brings it"
    everyone = [ours, *peers]
    samples: list[list[Sample]] = [[] for _ in everyone]
    for contender in everyone:
        contender.once()
    for _ in range(contest.repeats or repeats):
        for contender, found in zip(everyone, samples, strict=True):
            found.append(contender.once())
    first, *others = (
        Times(
            name=contender.name,
            seconds=tuple(sample.seconds for sample in found),
            error=max(sample.error for sample in found),
        )
        for contender, found in zip(everyone, samples, strict=True)
    )
    return Result(contest=contest, ours=first, peers=tuple(others), missing=missing)
