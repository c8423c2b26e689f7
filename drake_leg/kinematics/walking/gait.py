"""When the feet of a walking robot are down: gaits as tables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.units import require_finite

SWING = 0.5  # [s], about as long as a swing lasts by default
LEGS = ("left_front", "left_middle", "left_rear", "right_front", "right_middle", "right_rear")


@dataclass(frozen=True, kw_only=True)
class Gait:
    """When each foot is down, as parts of a period.

    Parameters
    ----------
    name : str
        As on the command line.
    phases : tuple of float
        Of each leg: when its stance begins, 0 to 1.
    duty : float
        How long a stance lasts, 0 to 1.
    source : str
        Who published it.

    Raises
    ------
    InvalidValueError
        If a number is outside of its range.
    """

    name: str
    phases: tuple[float, ...]
    duty: float
    source: str

    def __post_init__(self) -> None:
        require_kind("the phases of a gait", self.phases, tuple, list)
        if not self.phases:
            raise InvalidValueError(f"the gait {self.name!r} has no leg")
        for phase in self.phases:
            require_finite("a phase", phase)
            if not 0.0 <= phase < 1.0:
                raise InvalidValueError(
                    f"a phase of the gait {self.name!r} is {phase!r}; it must be at least 0 and "
                    "less than 1"
                )
        require_finite("the duty factor", self.duty)
        if not 0.0 < self.duty < 1.0:
            raise InvalidValueError(
                f"the duty factor of the gait {self.name!r} is {self.duty!r}; it must be between 0 "
                "and 1"
            )

    @cached_property
    def fewest_down(self) -> int:
        """Smallest number of feet that are down together at any time."""
        ends = [*self.phases, *((phase + self.duty) % 1.0 for phase in self.phases)]
        just_after = [end + 1e-9 for end in ends]
        return min(
            sum((time - phase) % 1.0 < self.duty for phase in self.phases) for time in just_after
        )


_THIRD, _SIXTH = 1.0 / 3.0, 1.0 / 6.0

# Legs in the order of LEGS. Both ripple gaits are published under that name: in the first, legs
# follow one another and overlap; in the second, two legs swing together.
GAITS = {
    gait.name: gait
    for gait in (
        Gait(
            name="tripod",
            phases=(0.0, 0.5, 0.0, 0.5, 0.0, 0.5),
            duty=0.55,
            source="two groups of three; the duty factor makes them overlap",
        ),
        Gait(
            name="ripple",
            phases=(5 * _SIXTH, 3 * _SIXTH, _SIXTH, 2 * _SIXTH, 0.0, 4 * _SIXTH),
            duty=2 * _THIRD,
            source="OpenSHC's ripple gait: one leg after the other, two in the air",
        ),
        Gait(
            name="ripple-pairs",
            phases=(0.0, 2 * _THIRD, _THIRD, _THIRD, 2 * _THIRD, 0.0),
            duty=2 * _THIRD,
            source="OpenSHC's amble gait, elsewhere called ripple or tetrapod: legs in pairs",
        ),
        Gait(
            name="wave",
            phases=(2 * _SIXTH, _SIXTH, 0.0, 5 * _SIXTH, 4 * _SIXTH, 3 * _SIXTH),
            duty=5 * _SIXTH,
            source="the metachronal wave, from rear to front on each side",
        ),
    )
}


def usual_period(gait: Gait) -> float:
    """Period of a gait [s]: whole half seconds, in which swings last about ``SWING``."""
    return max(1.0, round(2.0 * SWING / (1.0 - gait.duty)) / 2.0)
