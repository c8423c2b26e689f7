"""What is measured in a recording before a figure states it."""

from __future__ import annotations

import numpy as np

from drake_leg.recording import Recording

LIKE_A_SINE = 0.02  # of the greatest value: how far a motion may be from a sine to be called one
NEAR_SINGULAR = (
    0.05  # of the greatest smallest singular value: where torques say nothing about a leg
)
FAR_HIGHER = 3.0  # times the torques elsewhere: what would hide them


def step_frequency(recording: Recording) -> float | None:
    """Find the frequency of a step that begins at rest: half a period is over where it turns.

    In rad/s; None if the run ends before that.
    """
    v, time = recording["vx"], recording["time"]
    turns = np.flatnonzero(v[1:-1] * v[2:] < 0.0) + 1
    if not len(turns):
        return None
    i = turns[0]
    return float(np.pi / (time[i] + (time[i + 1] - time[i]) * v[i] / (v[i] - v[i + 1])))


def sine_frequency(recording: Recording) -> float | None:
    """Find the frequency of a foot that moves as a sine, a quarter period behind its velocity.

    In rad/s; None if velocity or position is no such sine: damped, limited, pushed, late.
    """
    frequency = step_frequency(recording)
    if frequency is None:
        return None
    time, x, v = (recording[name] for name in ("time", "x", "vx"))
    phase = frequency * time
    sine, way = np.sin(phase), 1.0 - np.cos(phase)
    speed = float(v @ sine / (sine @ sine))
    off_speed = np.abs(v - speed * sine).max() / abs(speed)
    off_way = np.abs(x - x[0] - speed / frequency * way).max() / abs(2.0 * speed / frequency)
    return frequency if max(off_speed, off_way) < LIKE_A_SINE else None


def torques_away(recording: Recording, columns: list[str]) -> tuple[float, float] | None:
    """Find the greatest torques away from a singularity and near it [N*m].

    None if one axis shows both well. The recording has sigma_min and these columns.
    """
    sigma = recording["sigma_min"]
    near = sigma < NEAR_SINGULAR * sigma.max()
    torques = np.abs(recording.stack(*columns)).max(axis=1)
    if not near.any() or near.all():
        return None
    away, there = float(torques[~near].max()), float(torques[near].max())
    return (away, there) if there > FAR_HIGHER * away else None
