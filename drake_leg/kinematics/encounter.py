"""A meeting of a commanded motion with a singularity, or a passing close by one, as data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from drake_leg.kinematics.arms import Arm, loses_turning, lost_direction
from drake_leg.kinematics.edges import Family
from drake_leg.quantities import joint_entries


@dataclass(frozen=True, kw_only=True)
class Encounter:
    """A meeting with a singular family."""

    time: float  # [s]
    family: Family | None  # None where families have no names
    q: tuple[float, ...]  # [rad or m]
    foot: tuple[float, ...]  # base frame [m]
    lost_direction: tuple[float, ...]  # unit vector, base frame
    loses_turning: bool = False  # about that direction, not translation along it
    greatest_amplitude: float | None  # [m/s], below which the motion stays inside; None: unknown
    grazing: bool = False  # the command leaves the workspace by less than forecast.GRAZE
    numerical: bool = False  # found by small steps, not in closed form
    turning: tuple[bool, ...] = (True, True, True)  # joint by joint: revolute, not prismatic

    def describe(self) -> str:
        """Say it in the middle of a sentence."""
        family = f" ({self.family} family)" if self.family else ""
        about = "about " if self.numerical else ""
        at = f"{self.time:.{6 if self.numerical else 9}f}"
        joints = ", ".join(
            f"{_listed([math.degrees(value)], 4)} deg" if turns else f"{_listed([value], 6)} m"
            for value, turns in zip(self.q, self.turning, strict=True)
        )
        lost = "turning left about" if self.loses_turning else "motion left along"
        amplitude = self.greatest_amplitude
        inside = f"; an amplitude below {amplitude:.9g} m/s stays inside" if amplitude else ""
        return (
            f"singular{family} at t = {about}{at} s, with the foot at ({_listed(self.foot, 6)}) m, "
            f"the joints at ({joints}) and no {lost} "
            f"({_listed(self.lost_direction, 4)}){inside}"
        )

    def as_json(self) -> dict[str, Any]:
        """Return its numbers, with the joint positions in deg, or m where a joint slides."""
        return {
            "family": self.family,
            "time_s": self.time,
            "foot_m": list(self.foot),
            **joint_entries("q", self.q, [not turns for turns in self.turning]),
            "lost_direction": list(self.lost_direction),
            "loses_turning": self.loses_turning,
            "greatest_amplitude_m_s": self.greatest_amplitude,
            "grazing": self.grazing,
        }


@dataclass(frozen=True, kw_only=True)
class Graze:
    """A passing close by an edge of the workspace."""

    time: float  # [s]
    family: Family
    clearance: float  # [m]

    def describe(self) -> str:
        """Say it in a sentence."""
        return (
            f"the command passes within {self.clearance:.3g} m of the {self.family} family "
            f"at t = {self.time:.9f} s"
        )


@dataclass(frozen=True, kw_only=True)
class Forecast:
    """What a motion will meet."""

    encounter: Encounter | None = None
    graze: Graze | None = None


def encounter_at(
    arm: Arm, q: Sequence[float], time: float, greatest_amplitude: float | None = None
) -> Encounter:
    """Describe a singular posture that a run has come to.

    Parameters
    ----------
    q : (n,) sequence of float
        [rad or m].
    time : float
        [s].
    greatest_amplitude : float, optional
        What would have stayed inside [m/s].
    """
    posture = tuple(float(value) for value in q)
    return Encounter(
        time=time,
        family=arm.family(posture),
        q=posture,
        foot=tuple(arm.foot(posture).tolist()),
        lost_direction=lost_direction(arm, posture),
        loses_turning=loses_turning(arm, posture),
        greatest_amplitude=greatest_amplitude,
        turning=arm.turning,
    )


def _listed(values: Sequence[float], digits: int) -> str:
    return ", ".join(f"{round(value, digits) + 0.0:.{digits}f}" for value in values)
