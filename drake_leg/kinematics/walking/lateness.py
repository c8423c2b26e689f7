"""Feet that come late to their places, where servos are short of torque: they lose way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.servos import Servo

IN_PLACE = 5e-4  # [m], how far from its plan a foot may be that counts as in its place
LATE = 0.2  # of a period, for which feet may stand out of place: more loses 2 to 7 % of the way
GAP = 10.0  # median steps; a longer one is a gap between times


def position_errors(times: Array, torques: Array, stall: Array, servo: Servo) -> Array:
    """How far joints are behind their plan, (rows, ...) [rad], at planned torques (rows, ...).

    The planned torque is fed forward, and a position controller adds to it; together they are at
    most the ``stall`` torque. Where more is planned, the rotor lags, and the controller brings it
    back later. Time begins without an error, and again after each gap.
    """
    error = np.zeros_like(torques)
    if not (np.abs(torques) > stall).any():
        return error
    inertia, emf, p, d = (
        servo.rotor_inertia,
        servo.back_emf_damping,
        servo.stiffness,
        servo.damping,
    )
    rate = np.zeros_like(torques[0])
    for row, h in enumerate(_steps(times).tolist()):
        before = error[row]
        if h == 0.0:
            rate = np.zeros_like(rate)
            continue
        free = (inertia * rate - h * p * before) / (inertia + h * (d + emf) + h * h * p)
        drive = torques[row + 1] + p * (before + h * free) + d * free
        full = (inertia * rate + h * (torques[row + 1] - np.sign(drive) * stall)) / (
            inertia + h * emf
        )
        rate = np.where(np.abs(drive) <= stall, free, full)
        error[row + 1] = before + h * rate
    return error


def late_times(times: Array, off: Array, down: NDArray[np.bool_]) -> Array:
    """For how long each foot has been out of its place in its stance, (rows, n) [s].

    ``off`` is how far feet are from their plan, (rows, n) [m]; ``down`` whether they stand.
    """
    found = np.zeros_like(off)
    late = down & (off > IN_PLACE)
    if late.any():
        for row, step in enumerate(_steps(times).tolist()):
            found[row + 1] = down[row + 1] * (found[row] + step * late[row])
    return found


def _steps(times: Array) -> Array:
    """From each time to the next [s]; 0 over a gap."""
    steps = np.diff(times)
    return np.where(steps > GAP * np.median(steps), 0.0, steps) if len(steps) else steps
