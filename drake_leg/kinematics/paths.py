"""The exact motion that the sine sources command: a straight step and an ellipse."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array

UP = np.array([0.0, 0.0, 1.0])


class CommandedMotion(NamedTuple):
    """Where a point goes, seen from where it starts."""

    displacement: Array  # (n, 3), [m]
    velocity: Array  # (n, 3), [m/s]


def straight_path(
    time: ArrayLike, *, amplitude: float, frequency: float, direction: ArrayLike
) -> CommandedMotion:
    """Integrate ``v = A sin(w t) d``: ``p = (A / w) (1 - cos w t) d``, a line of length 2 A / w.

    Parameters
    ----------
    time : (n,) array_like
        [s].
    amplitude : float
        A [m/s].
    frequency : float
        w [rad/s].
    direction : (3,) array_like
        Unit vector d.

    Returns
    -------
    CommandedMotion
        In the frame of the direction.

    References
    ----------
    Report A, section 2.4; report B, section 3.4.
    """
    along = np.asarray(direction, dtype=np.float64)
    phase = frequency * np.asarray(time, dtype=np.float64)
    advance = amplitude / frequency * (1.0 - np.cos(phase))
    return CommandedMotion(np.outer(advance, along), np.outer(amplitude * np.sin(phase), along))


def elliptic_path(
    time: ArrayLike, *, amplitude: float, frequency: float, direction: ArrayLike, lift: float
) -> CommandedMotion:
    """Add ``(h / 2) sin(w t)`` upwards to the straight path: an ellipse, from its rear end.

    Parameters
    ----------
    time : (n,) array_like
        [s].
    amplitude : float
        A, greatest speed along the direction [m/s].
    frequency : float
        w [rad/s].
    direction : (3,) array_like
        Horizontal unit vector.
    lift : float
        h, height of the ellipse [m].

    Returns
    -------
    CommandedMotion
        In the frame of the direction.

    References
    ----------
    Report A, section 2.1.
    """
    along = straight_path(time, amplitude=amplitude, frequency=frequency, direction=direction)
    phase = frequency * np.asarray(time, dtype=np.float64)
    rise = lift / 2.0 * np.sin(phase)
    climb = lift / 2.0 * frequency * np.cos(phase)
    return CommandedMotion(
        along.displacement + np.outer(rise, UP), along.velocity + np.outer(climb, UP)
    )
