"""A push in the course of time: half a wave of a sine, so that it begins and ends gently."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.units import MOST, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True)
class Push:
    """The force ``F sin(pi (t - at) / lasting)`` from ``at`` on for ``lasting``, else none."""

    force: tuple[float, float, float]  # F, its greatest value, base frame [N]
    at: float  # [s]
    lasting: float  # [s]

    def __post_init__(self) -> None:
        if len(self.force) != 3 or not all(abs(part) <= MOST for part in self.force):
            raise InvalidValueError(
                f"the push is {list(self.force)}; it must be three finite numbers in N, as 0,0,0.1"
            )
        require_non_negative("the instant of the push", self.at, "s")
        require_positive("the time that the push lasts", self.lasting, "s")

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.at + self.lasting

    @property
    def impulse(self) -> Array:
        """Integral of the force over time, ``2 F lasting / pi`` (3,) [N*s]."""
        impulse: Array = 2.0 * self.lasting / math.pi * np.array(self.force)
        return impulse

    def at_time(self, time: ArrayLike) -> Array:
        """Return the force.

        Parameters
        ----------
        time : (...) array_like
            [s].

        Returns
        -------
        (..., 3) ndarray
            Base frame [N].
        """
        part = np.clip((np.asarray(time) - self.at) / self.lasting, 0.0, 1.0)
        force: Array = np.multiply.outer(np.sin(np.pi * part), np.array(self.force))
        return force
