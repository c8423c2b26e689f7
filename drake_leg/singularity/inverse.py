"""How the Jacobian is inverted: exactly, damped, or within the joints' limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.movable import Movable
from drake_leg.quantities import require_positive
from drake_leg.robot import Segment
from drake_leg.singularity.damped import Damped
from drake_leg.singularity.limits import RateBox

METHODS = ("exact", "damped", "limited")
DAMPED_BELOW = 0.03  # of the arm's length: singular value at which damping begins
FASTEST = 2.0 * math.pi  # [rad/s or m/s] of a joint without a limit of its own
SETTLING = 0.1  # [s] in which a joint comes to its limit
LAGS = 8.0  # time constants of its filters in which it does, at least: from 27/4 it does not swing


@dataclass(frozen=True, kw_only=True)
class Inverse:
    """Which inverse, and its numbers."""

    method: str = "exact"
    damped_below: float | None = None  # [m]; None: DAMPED_BELOW of the arm's length
    rate_limit: float | None = None  # [rad/s] of turning joints; None: their own, or FASTEST

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise InvalidValueError(
                f"the inverse is {self.method!r}; it must be one of {', '.join(METHODS)}"
            )
        rate = None if self.rate_limit is None else math.degrees(self.rate_limit)
        for name, value, unit, methods in (
            ("the singular value at which damping begins", self.damped_below, "m", METHODS[1:]),
            ("the rate limit", rate, "deg/s", METHODS[2:]),
        ):
            if value is None:
                continue
            require_positive(name, value, unit)
            if self.method not in methods:
                raise InvalidValueError(
                    f"{name} is {value:.9g} {unit}, which means nothing to the inverse "
                    f"{self.method!r}",
                    advice="leave it out, or choose `inverse='damped'` or `'limited'`"
                    if len(methods) > 1
                    else "leave it out, or choose `inverse='limited'`",
                )

    @property
    def is_exact(self) -> bool:
        """Whether the robot must stop where it is singular."""
        return self.method == METHODS[0]

    def of(self, exact: Movable, joints: tuple[Segment, ...], lag: float = 0.0) -> Movable:
        """Invert a robot's Jacobian this way.

        ``joints`` are the moving ones, with their limits; ``lag`` is the time constant [s] of two
        lags in series that the joints are behind their rates.
        """
        if self.is_exact:
            return exact
        below = DAMPED_BELOW * exact.length if self.damped_below is None else self.damped_below
        if self.method == "damped":
            return Damped(exact, below)
        mechanics = [segment.mechanics for segment in joints]
        lower, upper = zip(*(joint.bounds for joint in mechanics), strict=True)
        box = RateBox(
            lower,
            upper,
            [self._fastest(segment) for segment in joints],
            max(SETTLING, LAGS * lag),
        )
        return Damped(exact, below, box)

    def _fastest(self, segment: Segment) -> float:
        own = segment.mechanics.velocity
        if self.rate_limit is not None and segment.row.joint == "revolute":
            return self.rate_limit
        return FASTEST if own is None else own
