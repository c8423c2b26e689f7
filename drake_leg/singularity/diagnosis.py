"""The results of an examination of a posture: as numbers, in words, as JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from drake_leg.kinematics.feet import Feet, Solution, limits_of
from drake_leg.robot.robot import Segment, html_table
from drake_leg.singularity.families import Nearness
from drake_leg.singularity.rank import LostTwist, RankReport, WholeRank
from drake_leg.singularity.stroke import Stroke


@dataclass(frozen=True, kw_only=True)
class Outside:
    """A joint outside its limits."""

    segment: Segment
    position: float  # [rad or m]

    @property
    def sentence(self) -> str:
        """The joint, its position and its limits, in words."""
        turning = self.segment.row.joint == "revolute"
        ((low, high),) = limits_of([self.segment])
        position, low, high = (
            math.degrees(value) if turning else value for value in (self.position, low, high)
        )
        unit = "deg" if turning else "m"
        return (
            f"joint {self.segment.joint} is at {position:.6g} {unit}, outside its limits "
            f"{low:.6g} ... {high:.6g} {unit}"
        )


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """All results of an examination of a posture; lengths in m, angles in rad."""

    position: tuple[float, float, float | None]  # of the foot; the height is None without the lift
    orientation: tuple[float, float, float]  # of the foot: roll, pitch, yaw about x, y, z
    moved: str  # the motion that the rank refers to: the foot's translation, or part of it
    rank: RankReport
    most_rank: int  # in any posture
    whole: WholeRank | None  # of the whole Jacobian; None where there are at most three joints
    nearness: tuple[Nearness, ...]  # nearest first; empty for a chain without named families
    outside: tuple[Outside, ...]
    holds_orientation: bool  # along the stroke
    forward: Stroke | None  # None where the posture is singular already
    backward: Stroke | None
    greatest_amplitude: float | None  # [m/s], at the given frequency
    feet: Feet | None  # the inverse kinematics; None if not requested

    @property
    def solutions(self) -> tuple[Solution, ...] | None:
        """Joint positions that put the foot at the requested point; None without one."""
        return None if self.feet is None else self.feet.solutions

    @property
    def entries(self) -> list[tuple[str, str]]:
        """Its results in words, each with its name, which is empty where the last one goes on."""
        lost = () if self.whole is None else self.whole.lost
        return [
            *_pose_entries(self),
            *_rank_entries(self),
            *((near.family, near.meaning + self._mark(near)) for near in self.nearness),
            *(("lost direction", _vector(row)) for row in self.rank.lost_directions),
            *(("lost twist", _twist(twist)) for twist in lost),
            *(("outside limits", outside.sentence) for outside in self.outside),
            *_stroke_entries(self),
        ]

    def _mark(self, near: Nearness) -> str:
        several = len(self.nearness) > 1
        return "   (nearest)" if several and near is self.nearness[0] else ""

    def __repr__(self) -> str:
        rank = f"rank {self.rank.rank} of {self.rank.full_rank}"
        nearest = f", nearest to {self.nearness[0].family}" if self.nearness else ""
        return f"<Diagnosis: {rank}{nearest}>"

    def _repr_html_(self) -> str:
        feet = [] if self.feet is None else feet_entries(self.feet)
        return html_table(
            ("result", "value"), [*self.entries, *feet], title="Examination of a posture"
        )

    def as_json(self) -> dict[str, Any]:
        """Return the numbers under the command line's keys, with angles in degrees."""
        lost = self.rank.lost_directions
        return {
            "foot_m": list(self.position),
            "foot_rpy_deg": [math.degrees(angle) for angle in self.orientation],
            "rank": self.rank.rank,
            "full_rank": self.rank.full_rank,
            "greatest_rank": self.most_rank,
            "sigma_min_m": self.rank.sigma_min,
            "manipulability": self.rank.manipulability,
            "whole_jacobian": self.whole and _whole_json(self.whole),
            "nearest_family": self.nearness[0].family if self.nearness else None,
            "lost_direction": lost[-1].tolist() if len(lost) else None,
            "outside_limits": [outside.sentence for outside in self.outside],
            "stroke_holds_orientation": self.holds_orientation,
            "stroke_forward_m": _finite(self.forward.length if self.forward else None),
            "stroke_forward_ends": _end(self.forward),
            "stroke_backward_m": _finite(self.backward.length if self.backward else None),
            "stroke_backward_ends": _end(self.backward),
            "max_amplitude_m_s": _finite(self.greatest_amplitude),
            **feet_json(self.feet),
        }


def feet_json(found: Feet | None) -> dict[str, Any]:
    """The inverse kinematics under the command line's keys, in degrees; empty lists for None."""
    solutions = found.solutions if found else ()
    units = list(found.units) if found else []
    turning = all(unit == "deg" for unit in units)
    return {
        "branches_heading": found and found.heading,
        "units": units,
        **({"branches_deg": [_typed(s.q, units) for s in solutions if s.q]} if turning else {}),
        "branches": [
            {
                "name": s.name,
                "q_deg" if turning else "q": _typed(s.q, units),
                "within_limits": s.within_limits,
            }
            for s in solutions
        ],
    }


def feet_entries(found: Feet) -> list[tuple[str, str]]:
    """The inverse kinematics in words, each solution with its name."""
    entries = [("inverse", found.heading)]
    for solution in found.solutions:
        where = "out of reach"
        if solution.q is not None:
            where = _shown(solution.q, found.units)
            where += "" if solution.within_limits else "   (outside the joints' limits)"
        entries.append((solution.name, where))
    return entries


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _end(stroke: Stroke | None) -> str | None:
    """What ends a stroke, in words."""
    if stroke is None or not math.isfinite(stroke.length):
        return None
    if stroke.joint is not None:
        return f"the limit of joint {stroke.joint}"
    return f"the {stroke.family} family" if stroke.family else None


def _typed(q: Sequence[float] | None, units: Sequence[str]) -> list[float] | None:
    if q is None:
        return None
    return [
        math.degrees(value) if unit == "deg" else value
        for value, unit in zip(q, units, strict=True)
    ]


def _whole_json(whole: WholeRank) -> dict[str, Any]:
    def listed(twist: LostTwist) -> dict[str, Any]:
        turning, moving = twist.turning, twist.moving
        return {
            "turning": None if turning is None else turning.tolist(),
            "moving": None if moving is None else moving.tolist(),
        }

    return {
        "rank": whole.rank,
        "full_rank": whole.full_rank,
        "sigma_min": whole.sigma_min,
        "lost_twists": [listed(twist) for twist in whole.lost],
    }


def _pose_entries(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    x, y, z = diagnosis.position
    height = "z unknown: give the lift as a fourth number" if z is None else _rounded(z)
    roll, pitch, yaw = (_rounded(math.degrees(angle)) for angle in diagnosis.orientation)
    return [
        ("foot", f"({_rounded(x)}, {_rounded(y)}, {height}) m"),
        ("orientation", f"roll {roll}, pitch {pitch}, yaw {yaw} deg, about the base's x, y, z"),
    ]


def _rounded(value: float) -> str:
    return f"{round(value, 12) + 0.0:.9g}"


def _rank_entries(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    rank, whole = diagnosis.rank, diagnosis.whole
    most = ""
    if rank.rank == diagnosis.most_rank < rank.full_rank:
        most = ", and no posture of this table has more"
    of = "" if whole is None else f" of {diagnosis.moved}"
    entries = [("rank", f"{rank.rank} of {rank.full_rank}{of}{most}")]
    if whole is not None:
        entries.append(("", f"{whole.rank} of {whole.full_rank} of the whole Jacobian"))
    return [
        *entries,
        ("sigma_min", f"{rank.sigma_min:.6g} m"),
        ("manipulability", f"{rank.manipulability:.6g}"),
    ]


def _twist(twist: LostTwist) -> str:
    parts = []
    if twist.turning is not None:
        parts.append(f"held in place, the foot cannot turn about {_vector(twist.turning)}")
    if twist.moving is not None:
        parts.append(f"its orientation held, it cannot move along {_vector(twist.moving)}")
    return "; ".join(parts)


def _vector(values: Iterable[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"


def _stroke_entries(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    if diagnosis.forward is None or diagnosis.backward is None:
        held = ", the foot's orientation held" if diagnosis.holds_orientation else ""
        return [("stroke", f"none: the posture is singular already{held}")]
    entries = [
        ("stroke forward", _stroke(diagnosis.forward)),
        ("stroke backward", _stroke(diagnosis.backward)),
    ]
    if diagnosis.whole is not None:
        held = "held" if diagnosis.holds_orientation else "left free"
        entries.append(("", f"with the foot's orientation {held}"))
    if diagnosis.forward.length > 0.0:
        entries.append(("amplitude", _amplitude(diagnosis.greatest_amplitude)))
    return entries


def _stroke(stroke: Stroke) -> str:
    if stroke.joint is not None:
        if stroke.length == 0.0:
            return f"none: joint {stroke.joint} is at its limit, or outside"
        return f"{stroke.length:.9g} m, where joint {stroke.joint} reaches its limit"
    if stroke.length == 0.0:
        return "none: the foot cannot go straight along it"
    if math.isinf(stroke.length):
        return "without end"
    family = f", where it meets the {stroke.family} family" if stroke.family else ""
    return f"{stroke.length:.9g} m{family}"


def _amplitude(greatest: float | None) -> str:
    if greatest is None or math.isinf(greatest):
        return "any: nothing is in the way"
    return f"below {greatest:.6g} m/s stays inside"


def _shown(q: Sequence[float], units: Sequence[str]) -> str:
    """Write joint positions as the command line takes them, and their units."""
    if all(unit == "deg" for unit in units):
        return ", ".join(f"{math.degrees(value):.6f}" for value in q) + " deg"
    return ", ".join(
        f"{math.degrees(value) if unit == 'deg' else value:.6f} {unit}"
        for value, unit in zip(q, units, strict=True)
    )
