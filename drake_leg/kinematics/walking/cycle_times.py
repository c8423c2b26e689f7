"""Times at which a walk is looked at, so that nothing of a cycle is missed."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.gaits import Walk

PER_SWING = 40  # times at which a swing is looked at
JUST = 1e-9  # of a period: how near to a touch-down or a lift-off it is looked at


def times_of(walk: Walk, duration: float) -> Array:
    """Times at which a walk is looked at: all of its changes, and steady cycles between them."""
    period = walk.period
    windows = [(walk.begins, walk.begins + period)]
    for command in walk.commands:
        windows.append((command.start - period, command.start + command.ramp + 3.0 * period))
        if math.isfinite(command.end):
            windows.append((command.end - 2.0 * period, command.end + command.ramp + 2.0 * period))
    windows += [
        (one.start, one.start + one.lasting + period)
        for one in walk.attitudes
        if one.start + one.lasting > walk.begins
    ]
    inside = [(max(begin, walk.begins), min(end, duration)) for begin, end in windows]
    return times_within([(begin, end) for begin, end in inside if begin < end], walk)


def times_within(windows: Iterable[tuple[float, float]], walk: Walk) -> Array:
    """Times within windows, close in every swing, and at both sides of touch-downs and lift-offs.

    Cycles have the same times, so that overlapping windows add none twice.
    """
    gait, period, first = walk.gait, walk.period, walk.begins
    count = math.ceil(PER_SWING / (1.0 - gait.duty))
    events = [(phase + part) % 1.0 for phase in gait.phases for part in (0.0, gait.duty)]
    beside = [event + side * JUST for event in events for side in (-1.0, 1.0)]
    even = np.arange(count) / count
    apart = np.abs((even[:, np.newaxis] - events + 0.5) % 1.0 - 0.5).min(axis=1)
    cycle = np.unique([*even[apart > JUST], *beside])
    found = []
    for begin, end in windows:
        low, high = (begin - first) / period, (end - first) / period
        numbers = np.arange(math.floor(low) - 1, math.ceil(high) + 1)
        times = first + period * (numbers[:, np.newaxis] + cycle).ravel()
        found.append(times[(times >= begin) & (times <= end)])
    return np.unique(np.concatenate(found))


def attitudes_end(walk: Walk) -> float:
    """When the last change of attitude is over [s]; 0 without one."""
    return max((one.start + one.lasting for one in walk.attitudes), default=0.0)
