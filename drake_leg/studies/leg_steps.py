"""Straight steps of many legs at once: strokes, nearness, rates, static torques.

What is greatest along a step is found on samples and then by parabolas; where that is not sure, on
finer samples, and what is still not sure is left to a simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.studies.leg_places import QUANTITIES, Booleans, LegSteps, Place, Quantity

SAMPLES = (32, 128, 512, 2048, 8192)  # of a step, each level for what was not sure on the last one
POINTS = 2**17  # of the samples of a block, which bound the memory
FREED = 31 << 20  # bytes of an array; glibc learns from those of less than 32 MB
RESOLVED = 2.0  # samples in whatever is narrow
ALIKE = 0.03  # of a maximum: another one that is lower by less may have its top between samples
WINDOWS = (1 / 16, 1 / 256)  # of two samples: around a top, where it is computed again
FLAT = 1e-9  # of a maximum: what changes by less around it is not looked at more closely
NEWTON = 80  # steps to a crossing, at most
TOUCH = 1e-12  # of the leg's length: a step that comes nearer to a singularity meets it
UNSURE = 1e-9  # of the leg's length: one that comes nearer, but not that near, may or may not
SINGULAR = 1e-6  # of its greatest determinant: a leg that starts nearer is left to a simulation


@dataclass(kw_only=True)
class Answers:
    """What n steps come to, (n,)."""

    met: Booleans  # a singularity
    at_hip: Booleans  # that one is on the hip axis
    stop: Array  # part of the line where it is met; NaN if there is none
    sure: Booleans  # whether all this is known
    greatest: dict[str, Array]  # along the step, by what is wanted; NaN where a singularity is met

    def fill(self, rows: NDArray[np.intp], other: Answers) -> None:
        """Replace some rows."""
        for name in ("met", "at_hip", "stop", "sure"):
            getattr(self, name)[rows] = getattr(other, name)
        for name, values in other.greatest.items():
            self.greatest[name][rows] = values


def answers(
    steps: LegSteps,
    wanted: Mapping[str, Sequence[str]],
    in_turn: Callable[..., Iterable[Answers]] = map,
    report: Callable[[int], None] = lambda _done: None,
) -> Answers:
    """Follow steps from their start to their end, or to the first singularity.

    ``wanted`` names ``QUANTITIES`` of which the greatest is asked for. Blocks of steps are computed
    by ``in_turn``, a map that may use threads; ``report`` is called with the number of steps that
    are sure.
    """
    count = len(steps)
    found = Answers(
        met=np.zeros(count, dtype=bool),
        at_hip=np.zeros(count, dtype=bool),
        stop=np.full(count, np.nan),
        sure=np.zeros(count, dtype=bool),
        greatest={name: np.full(count, np.nan) for name in wanted},
    )
    left = np.arange(count)
    _keep_freed_memory()
    for samples in SAMPLES:
        size = max(POINTS // samples, 1)
        blocks = [left[start : start + size] for start in range(0, len(left), size)]

        def follow(rows: NDArray[np.intp], samples: int = samples) -> Answers:
            with np.errstate(all="ignore"):
                return _on_samples(steps.of_rows(rows), wanted, samples)

        for rows, part in zip(blocks, in_turn(follow, blocks), strict=True):
            found.fill(rows, part)
            report(int(found.sure.sum()))
        left = left[~found.sure[left]]
    return found


def _keep_freed_memory() -> None:
    """Let glibc keep what a block frees, or each block would get all of its pages anew.

    It keeps up to twice the size of the greatest array that was ever freed.
    """
    np.empty(FREED, dtype=np.uint8)


def _on_samples(steps: LegSteps, wanted: Mapping[str, Sequence[str]], samples: int) -> Answers:
    parts = _parts(steps, samples)
    place = Place(steps, parts)
    found = _first_singularity(steps, parts, place)
    for name, quantities in wanted.items():
        top = _greatest_of(steps, [QUANTITIES[one] for one in quantities], parts, place)
        found.greatest[name] = np.where(found.met, np.nan, top.value)
        found.sure &= top.sure | found.met
    return found


def _parts(steps: LegSteps, samples: int) -> Array:
    """Sample the lines, closer at their ends; one sample is where a line passes the hip axis."""
    turns = np.sin(np.linspace(0.0, np.pi / 2.0, samples + 1)) ** 2
    parts: Array = np.multiply.outer(turns, steps.end)
    passes = np.flatnonzero((steps.past_hip > 0.0) & (steps.past_hip < steps.end))
    there = (steps.past_hip / steps.end)[passes]
    after = np.clip(np.searchsorted(turns, there), 1, samples - 1)
    nearest = np.where(there - turns[after - 1] < turns[after] - there, after - 1, after)
    parts[np.clip(nearest, 1, samples - 1), passes] = steps.past_hip[passes]
    return parts


def _first_singularity(steps: LegSteps, parts: Array, place: Place) -> Answers:
    """Find the first singularity of each step, if there is one."""
    size, width = steps.size, _width(steps, parts)
    met, stop, sure = _first_without_room(steps, parts, np.minimum(*place.room))
    hip, end = steps.past_hip, np.where(met, stop, steps.end)
    near_hip = np.where((hip > 0.0) & (hip <= end), steps.from_hip, np.inf)
    at_hip = near_hip <= TOUCH * size
    sure &= at_hip | ((near_hip >= width) & (near_hip >= UNSURE * size))
    sure &= 2.0 * np.minimum(steps.l2, steps.l3) >= width
    sure &= np.abs(place.bent[0]) >= SINGULAR * (steps.l2 * steps.l3)
    sure &= (place.hip_distance[0] >= SINGULAR * size) & (steps.length > 0.0)
    stop = np.where(at_hip, hip, stop)
    return Answers(met=met | at_hip, at_hip=at_hip, stop=stop, sure=sure, greatest={})


def _width(steps: LegSteps, parts: Array) -> Array:
    """What is narrower than some samples may be missed by them, (n,) [m]."""
    width: Array = RESOLVED * steps.length * 0.5 * np.pi / (len(parts) - 1)
    return width


def _first_without_room(
    steps: LegSteps, parts: Array, room: Array
) -> tuple[Booleans, Array, Booleans]:
    """Whether and where each leg is first stretched or folded, and whether that is sure, (n,).

    ``room`` (m, n) is what is left of r^2 at each sample [m^2].
    """
    count = len(steps)
    met, stop, sure = np.zeros(count, dtype=bool), np.full(count, np.nan), np.ones(count, bool)
    enough = np.maximum(_width(steps, parts) ** 2, UNSURE * steps.size**2)
    near = np.flatnonzero(~(room.min(axis=0) >= enough))
    if not len(near):
        return met, stop, sure
    steps, parts, room = steps.of_rows(near), parts[:, near], room[:, near]
    beyond, last = room <= 0.0, len(parts) - 1
    crosses = beyond.any(axis=0)
    first = np.where(crosses, beyond.argmax(axis=0), last)
    turns = (room[1:-1] < room[:-2]) & (room[1:-1] <= room[2:]) & ~beyond[1:-1]
    turns &= np.arange(1, last)[:, np.newaxis] < first
    least = np.where(turns, room[1:-1], np.inf).min(axis=0, initial=np.inf)
    least = np.where(crosses, least, np.minimum(least, np.minimum(room[0], room[last])))
    met[near], sure[near] = crosses, least >= enough[near]
    crossing = np.flatnonzero(crosses)
    if len(crossing):
        before, after = parts[first[crossing] - 1, crossing], parts[first[crossing], crossing]
        at, found = _crossing(steps.of_rows(crossing), before, after)
        stop[near[crossing]] = at
        sure[near[crossing]] &= found
    return met, stop, sure


def _crossing(steps: LegSteps, low: Array, high: Array) -> tuple[Array, Booleans]:
    """Part of each line (n,) at which there is no room left, and whether it is sure.

    Newton's method, kept between a part with room and one without by bisection.
    """
    at = high
    which = np.argmin(Place(steps, at).room, axis=0)
    change = high - low
    for _ in range(NEWTON):
        place = Place(steps, at)
        room = np.choose(which, place.room)
        slope = np.where(which == 0, -1.0, 1.0) * place.slope
        low, high = np.where(room > 0.0, at, low), np.where(room > 0.0, high, at)
        ahead = at - room / slope
        ahead = np.where((ahead >= low) & (ahead <= high), ahead, 0.5 * (low + high))
        change, at = np.abs(ahead - at), ahead
        if (change <= UNSURE).all():
            break
    return at, change <= UNSURE


class Top(NamedTuple):
    """The greatest value along each step (n,), and whether it is sure."""

    value: Array
    sure: Booleans


def _greatest_of(
    steps: LegSteps, quantities: Sequence[Quantity], parts: Array, place: Place
) -> Top:
    """Find the greatest value of some quantities along each step.

    One whose samples are all much lower than those of another one is not looked at more closely.
    """
    series = [of(place) for of in quantities]
    if len(series) == 1:
        return _greatest(steps, quantities[0], parts, series[0])
    peaks = [heights.max(axis=0) for heights in series]
    value = np.fmax.reduce(peaks)
    low, sure = value - ALIKE * np.abs(value), np.ones(len(steps), dtype=bool)
    for of, heights, peak in zip(quantities, series, peaks, strict=True):
        rows = np.flatnonzero(~(peak < low))
        top = _greatest(steps.of_rows(rows), of, parts[:, rows], heights[:, rows])
        value[rows] = np.fmax(value[rows], top.value)
        sure[rows] &= top.sure
    return Top(value, sure)


def _greatest(steps: LegSteps, of: Quantity, parts: Array, heights: Array) -> Top:
    """Find the greatest value along each step from its samples (m, n)."""
    rises = heights[1:] > heights[:-1]
    best = rises.sum(axis=0, dtype=np.int16).astype(np.intp)  # where it only rises, then falls
    others = np.flatnonzero((rises[1:] > rises[:-1]).any(axis=0))
    best[others] = heights[:, others].argmax(axis=0)
    value, sure = _top(steps, of, parts, heights, best)
    # Another maximum, not next to the first one, may be higher than its samples.
    heights, rows, last = heights[:, others], np.arange(len(others)), len(heights) - 1
    for shift in (-1, 0, 1):
        heights[np.clip(best[others] + shift, 0, last), rows] = -np.inf
    second = heights.argmax(axis=0)
    height = heights[second, rows]
    is_rival = height > value[others] - ALIKE * np.abs(value[others])
    for shift in (-1, 1):
        beside = heights[np.clip(second + shift, 0, last), rows]
        is_rival &= (height >= beside) & (beside > -np.inf)
    rivals = others[is_rival]
    if len(rivals):
        near = parts[:, rivals], heights[:, is_rival], second[is_rival]
        rival = _top(steps.of_rows(rivals), of, *near)
        value[rivals] = np.fmax(value[rivals], rival.value)
        sure[rivals] &= rival.sure
    return Top(value, sure)


def _top(
    steps: LegSteps, of: Quantity, parts: Array, heights: Array, best: NDArray[np.intp]
) -> Top:
    """Climb to the top near a sample, by parabolas through ever closer points."""
    rows, last = np.arange(len(steps)), len(parts) - 1
    middle = np.clip(best, 1, last - 1)
    around = middle + np.array([[-1], [0], [1]])
    near, closer = parts[around, rows], heights[around, rows]
    low, high = near[0], near[2]
    value = heights[best, rows]
    for share in WINDOWS:
        window = share * (high - low)
        at = np.clip(_vertex(near, closer), low + window, high - window)
        near = np.stack([at - window, at, at + window])
        closer = of(Place(steps, near))
        value = np.fmax(value, closer.max(axis=0))
    slope = 0.5 * (closer[2] - closer[0])
    curvature = closer[2] - 2.0 * closer[1] + closer[0]
    is_inside = np.abs(slope) <= -curvature
    value = np.where(is_inside, np.fmax(value, closer[1] - 0.5 * slope**2 / curvature), value)
    is_flat = np.abs(slope) + np.abs(curvature) <= FLAT * np.abs(value)
    at_end = ((best == 0) | (best == last)) & (value == heights[best, rows])
    return Top(value, is_inside | is_flat | at_end)


def _vertex(near: Array, heights: Array) -> Array:
    """Highest point of the parabola through three points; the middle one where there is none."""
    (a, b, c), (fa, fb, fc) = near, heights
    left, right = (b - a) * (fb - fc), (b - c) * (fb - fa)
    found: Array = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right)
    return np.where(np.isfinite(found), found, b)
