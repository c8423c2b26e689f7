"""Examines a robot with closed loops: its freedoms, assemblies, rates and singular assemblies."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.assemblies import Assemblies, assemblies
from drake_leg.kinematics.chain import joint_positions
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot, html_table
from drake_leg.singularity.singular_assemblies import (
    ACTUATION,
    DEAD_CENTER,
    SingularAssembly,
    singular_assemblies,
)

SAME = 1e-6  # [rad, or parts of the size]: postures that differ by less are one


@dataclass(frozen=True, kw_only=True)
class LoopDiagnosis:
    """All results of an examination of closed loops; lengths in m, angles in rad."""

    loops: ClosedLoops
    q: tuple[float, ...]  # the closed posture, all joints of the cut tree
    moved: float  # how far that is from the posture that was given [rad, or parts of the size]
    cut: tuple[float, ...]  # positions of the joints at which loops are cut
    gap: float  # [m]
    assemblies: Assemblies  # with the active joints there
    here: str | None  # the name of this one; None if it was not found
    sigma_min: float  # smallest singular value of J_p, the size being the unit of length
    rates: Array | None  # W_c (p, a); None in a singular assembly
    singular: tuple[SingularAssembly, ...]  # the nearest first
    searched: str

    @property
    def entries(self) -> list[tuple[str, str]]:
        """Its results in words, each with its name, which is empty where the last one goes on."""
        loops = self.loops
        count = len(loops.cuts)
        return [
            (
                "closed loops",
                f"{count}, cut at {', '.join(loops.cuts)}; {loops.rank} independent equations, "
                f"{loops.frames} frames (NF = 2 NJ - NL)",
            ),
            (
                "freedom",
                f"{loops.freedom}: active {', '.join(loops.active)}; passive "
                f"{', '.join(loops.passive)}",
            ),
            ("posture", self._posture(self.q, self.cut)),
            ("closure", f"{self.gap:.1e} m{self._remark}"),
            *self._assemblies(),
            ("sigma_min", f"{self.sigma_min:.6g} of J_p{' (singular)' * (self.rates is None)}"),
            *self._rates(),
            *self._singular(),
        ]

    @property
    def _remark(self) -> str:
        if self.moved < SAME:
            return ""
        return f", after the passive joints were moved by up to {self.moved:.3g} rad or sizes"

    def _assemblies(self) -> Iterable[tuple[str, str]]:
        found = self.assemblies
        known = "all" if found.complete else "perhaps not all"
        yield "assemblies", f"{len(found.found)}, {known}: {found.how}"
        for one in found.found:
            this = "   (this one)" if one.name == self.here else ""
            yield "", f"{one.name}: {self._posture(one.q, one.cut)}{this}"

    def _rates(self) -> Iterable[tuple[str, str]]:
        if self.rates is None:
            return
        name = "rates"
        for joint, row in zip(self.loops.passive, self.rates, strict=True):
            parts = [
                f"{rate:+.6g} {active}'"
                for rate, active in zip(row.tolist(), self.loops.active, strict=True)
                if abs(rate) > 1e-12
            ]
            yield name, f"{joint}' = {' '.join(parts) or '0'}"
            name = ""

    def _singular(self) -> Iterable[tuple[str, str]]:
        others = ", the other active joints held" if len(self.loops.active) > 1 else ""
        searched = f"searched along {self.searched}{others}"
        if not self.singular:
            yield "singular", f"no assembly; {searched}"
            return
        yield "singular", searched
        for one in self.singular:
            yield "", f"{_kind_in_words(one)}: {self._posture(one.q, one.cut)}"

    def _posture(self, q: Sequence[float], cut: Sequence[float]) -> str:
        robot = self.loops.robot
        kinds = [segment.row.joint for segment in robot.moving]
        kinds += [robot.segments[loop.cut - 1].row.joint for loop in robot.loops]
        names = [*self.loops.joints, *self.loops.cuts]
        return ", ".join(
            f"{name} {_number(math.degrees(value) if kind == 'revolute' else value)} "
            f"{'deg' if kind == 'revolute' else 'm'}"
            for name, kind, value in zip(names, kinds, [*q, *cut], strict=True)
        )

    def __repr__(self) -> str:
        return (
            f"<LoopDiagnosis: {self.loops.freedom} degrees of freedom, "
            f"{len(self.assemblies.found)} assemblies, {len(self.singular)} singular ones>"
        )

    def _repr_html_(self) -> str:
        return html_table(
            ("result", "value"), self.entries, title="Examination of a robot with closed loops"
        )

    def as_json(self) -> dict[str, Any]:
        """Return the numbers, in rad and m."""
        loops = self.loops
        return {
            "joints": list(loops.joints),
            "active": list(loops.active),
            "passive": list(loops.passive),
            "cut": list(loops.cuts),
            "freedom": loops.freedom,
            "independent_equations": loops.rank,
            "frames": loops.frames,
            "q_rad_or_m": list(self.q),
            "cut_rad_or_m": list(self.cut),
            "closure_m": self.gap,
            "assembly": self.here,
            "assemblies": [asdict(one) for one in self.assemblies.found],
            "assemblies_complete": self.assemblies.complete,
            "assemblies_how": self.assemblies.how,
            "sigma_min": self.sigma_min,
            "passive_rates": None if self.rates is None else self.rates.tolist(),
            "singular_assemblies": [asdict(one) for one in self.singular],
            "searched_along": self.searched,
        }


def _number(value: float) -> str:
    return f"{0.0 if abs(value) < 5e-7 else value:.6g}"


def _kind_in_words(one: SingularAssembly) -> str:
    if one.kind == ACTUATION:
        return f"actuation, {one.joint} does not determine the passive joints"
    if one.kind == DEAD_CENTER:
        return f"dead center of {one.joint}, moving {one.along}"
    return f"branching, two assemblies meet, moving {one.along}"


def examine_loops(robot: Robot, q: Sequence[float] | None = None) -> LoopDiagnosis:
    """Examine a robot with closed loops in a posture.

    Parameters
    ----------
    robot : Robot
        With closed loops; its actuated joints are the active ones.
    q : sequence of float, optional
        Positions [rad or m] of all joints of the cut tree, or of the active joints alone. The
        passive ones are moved until the loops are closed. By default the starting posture.

    Raises
    ------
    InvalidValueError
        If there are no loops, they do not close, or the number of positions is wrong.

    Examples
    --------
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> found = examine_loops(FOUR_BAR)
    >>> [(one.kind, one.joint) for one in found.singular]
    [('dead center', 'rocker'), ('dead center', 'rocker')]
    """
    loops = ClosedLoops(robot)
    given = np.array(_given(loops, q))
    posture = loops.position(given[loops.active_columns], given)
    every = assemblies(loops, posture[loops.active_columns])
    here = [one.name for one in every.found if loops.distance(np.array(one.q), posture) < SAME]
    try:
        rates = loops.W(posture)[loops.passive_columns]
    except SingularConfigurationError:
        rates = None
    singular, searched = singular_assemblies(loops, posture)
    return LoopDiagnosis(
        loops=loops,
        q=tuple(posture.tolist()),
        moved=loops.distance(posture, given) if _is_whole(loops, q) else 0.0,
        cut=tuple(loops.cut_motion(posture).position.tolist()),
        gap=float(loops.gap(posture)),
        assemblies=every,
        here=here[0] if here else None,
        sigma_min=loops.sigma_min(posture),
        rates=rates,
        singular=tuple(singular),
        searched=searched,
    )


def _is_whole(loops: ClosedLoops, q: Sequence[float] | None) -> bool:
    return q is not None and len(q) == len(loops.joints)


def _given(loops: ClosedLoops, q: Sequence[float] | None) -> Sequence[float]:
    """Complete a posture with the starting positions of the passive joints."""
    start = list(starting_posture(loops.robot))
    if q is None:
        return start
    if len(q) not in (len(loops.active), len(loops.joints)):
        raise InvalidValueError(
            f"q has {len(q)} numbers; {loops.robot.name} has {len(loops.joints)} joint positions, "
            f"of which {len(loops.active)} are active"
        )
    if _is_whole(loops, q):
        return joint_positions("q", loops.robot, q)
    for column, value in zip(loops.active_columns, q, strict=True):
        start[column] = value
    return joint_positions("q", loops.robot, start)
