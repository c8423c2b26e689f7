"""How a command is followed: which inverse of the Jacobian, which correction, from which start."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.units import require_angle, require_non_negative
from drake_leg.singularity.inverse import Inverse

TOP_SPEED = 1.25  # of a corrected command, times the greatest speed of the uncorrected one
OF_KINKS = 400.0  # [1/s^2], stiffness of a motion within limits: 20 rad/s
LEAST_TOP = 0.5  # [1/s], of the arm's length: the limit of a corrected command at least
EXACT_INVERSE = Inverse()


@dataclass(frozen=True, kw_only=True)
class Control:
    """Which inverse of the Jacobian, which correction, and how wrongly the joints start."""

    inverse: Inverse = EXACT_INVERSE
    correction: float = 0.0  # K, of the drift correction [1/s]; 0 is no correction
    q0_error: tuple[float, ...] = ()  # [rad or m], start minus q0; empty: none

    def __post_init__(self) -> None:
        require_non_negative("the gain of the drift correction", self.correction, "1/s")
        for error in self.q0_error:
            require_angle("an error of q0", error)

    def start(self, q0: tuple[float, ...]) -> tuple[float, ...]:
        """Return where the joints really start if the command believes them at q0 [rad or m]."""
        if not self.q0_error:
            return q0
        return tuple(q + error for q, error in zip(q0, self.q0_error, strict=True))

    def pull(self, disturbance: Disturbance) -> float:
        """Return how stiffly the joints are pulled onto their motion [1/s^2].

        Firmly where limits put kinks into the motion: what the integration errs by at a kink is
        gone before a joint comes to its limit.
        """
        chosen = disturbance.stiffness is not None or disturbance.acts
        if self.inverse.method == "limited" and not chosen:
            return OF_KINKS
        return disturbance.pull

    def top_speed(self, commanded: float, length: float) -> float:
        """Return how fast a corrected command may be [m/s].

        A foot that waits at its boundary for a command far outside is not pushed against it ever
        harder. An exact inverse has no limit, so that an error falls exponentially from the start.
        ``commanded`` is the greatest speed of the uncorrected command [m/s], ``length`` that of the
        stretched arm [m].
        """
        if self.inverse.is_exact:
            return math.inf
        return max(TOP_SPEED * commanded, LEAST_TOP * length)


EXACT = Control()
