"""Walks one after the other: the gait changes where all feet stand and the body rests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, real_numbers
from drake_leg.kinematics.walking.gait import Gait
from drake_leg.kinematics.walking.gaits import Motion, Walk

PAUSE = 0.1  # [s], in which the feet that stand last take their load
JOINED = 1e-9  # [m, or of a rotation]: two poses that differ by less are one

Found = TypeVar("Found", Motion, NDArray[np.bool_], Array)


def following(walk: Walk, gait: Gait, *, period: float, lift: float, at: float = 0.0) -> Walk:
    """Return a walk with another gait that begins, without a command, where one has stopped.

    It begins ``PAUSE`` after all feet stand, and not before the time ``at`` [s].

    Raises
    ------
    InvalidValueError
        If a number is invalid, the gait is for another number of legs, or the walk never stops.
    """
    begins = max(walk.stands_from + PAUSE, at)
    if np.isinf(begins):
        raise InvalidValueError(
            "the walk never stops, so that no other one follows it: give the `end` of its commands"
        )
    place = walk.level(begins).value
    return replace(
        walk, gait=gait, period=period, lift=lift, commands=(), begins=begins, place=place
    )


@dataclass(frozen=True)
class WalkSequence:
    """Walks one after the other, as one function of time.

    Parameters
    ----------
    parts : tuple of Walk
        Each begins where and when all feet of the one before stand, as ``following`` makes it.

    Raises
    ------
    InvalidValueError
        If there is no part, or one does not begin so.

    Examples
    --------
    >>> from drake_leg.kinematics.walking.gait import GAITS
    >>> from drake_leg.kinematics.walking.gaits import Command
    >>> from drake_leg.kinematics.walking.plan import walk_of
    >>> from drake_leg.kinematics.walking.sequence import WalkSequence, following
    >>> from drake_leg.robot.hexapods import HEXABOT
    >>> first = walk_of(HEXABOT, commands=[Command(forward=0.1, start=1.0, end=3.0)])
    >>> then = following(first, GAITS["wave"], period=3.0, lift=0.03)
    >>> sequence = WalkSequence((first, then))
    >>> then.begins, round(float(sequence.body(10.0).value[0, 3]), 12)  # [s], [m]
    (4.6, 0.2)
    """

    parts: tuple[Walk, ...]

    def __post_init__(self) -> None:
        require_kind("the parts of a sequence of walks", self.parts, tuple)
        for part in self.parts:
            require_kind("one of the parts of a sequence of walks", part, Walk)
        if not self.parts:
            raise InvalidValueError("a sequence of walks has no parts; give it one at least")
        for before, after in zip(self.parts[:-1], self.parts[1:], strict=True):
            _require_joined(before, after)

    @property
    def gait(self) -> Gait:
        """The first gait."""
        return self.parts[0].gait

    @property
    def begins(self) -> float:
        """When the first one begins [s]."""
        return self.parts[0].begins

    @property
    def period(self) -> float:
        """Of the first gait [s]."""
        return self.parts[0].period

    def level(self, time: ArrayLike) -> Motion:
        """Pose of the body's level frame in the world, (..., 4, 4) [-, m], with derivatives."""
        return self._merged(time, lambda part, times: part.level(times))

    def body(self, time: ArrayLike) -> Motion:
        """Pose X_WB of the body, (..., 4, 4) [-, m], with derivatives."""
        return self._merged(time, lambda part, times: part.body(times))

    def feet_in_world(self, time: ArrayLike) -> Motion:
        """Feet p_WF, (..., n, 3) [m], with velocities and accelerations in the world."""
        return self._merged(time, lambda part, times: part.feet_in_world(times))

    def feet(self, time: ArrayLike) -> Motion:
        """Feet p_BF in the body's frame, (..., n, 3) [m], with derivatives there."""
        return self._merged(time, lambda part, times: part.feet(times))

    def down(self, time: ArrayLike) -> NDArray[np.bool_]:
        """Whether each foot stands, (..., n) of bool."""
        return self._merged(time, lambda part, times: part.down(times))

    def swung(self, time: ArrayLike) -> Array:
        """How much of its swing each foot has done, (..., n), 0 to 1; 0 in its stance."""
        return self._merged(time, lambda part, times: part.swung(times))

    def firmness(self, time: ArrayLike, fading: float) -> Array:
        """How firmly each foot stands, (..., n): 0 in the air, 1 on the ground, smooth in time."""
        return self._merged(time, lambda part, times: part.firmness(times, fading))

    def _merged(self, time: ArrayLike, of: Callable[[Walk, Array], Found]) -> Found:
        """What each part has at its times, put together."""
        times = real_numbers("the time", time)
        begins = [part.begins for part in self.parts[1:]]
        number = np.searchsorted(begins, times, side="right")
        present = np.unique(number)
        if len(present) == 1:
            return of(self.parts[present[0]], times)
        found = [(number == one, of(self.parts[one], times[number == one])) for one in present]
        if isinstance(found[0][1], Motion):
            return Motion(
                *(_put([(at, values[k]) for at, values in found], times.shape) for k in range(3))
            )
        merged: Found = _put(found, times.shape)
        return merged


def _put(found: list[tuple[NDArray[np.bool_], Any]], shape: tuple[int, ...]) -> Any:  # noqa: ANN401
    """Values at times, of a shape, from those where masks are true."""
    first = found[0][1]
    whole = np.empty((*shape, *first.shape[1:]), dtype=first.dtype)
    for mask, values in found:
        whole[mask] = values
    return whole


def _require_joined(before: Walk, after: Walk) -> None:
    """Refuse a walk that does not begin where and when the one before it stands."""
    feet, others = np.asarray(before.neutral), np.asarray(after.neutral)
    if feet.shape != others.shape or np.abs(feet - others).max() > JOINED:
        raise InvalidValueError("two walks one after the other must have the same neutral feet")
    begins = after.begins
    if before.stands_from > begins + JOINED:
        raise InvalidValueError(
            f"a walk begins at {begins:.6g} s, and the feet of the one before stand from "
            f"{before.stands_from:.6g} s on: make it by `following`"
        )
    for one in ("level", "body"):
        poses = [getattr(walk, one)(begins).value for walk in (before, after)]
        off = float(np.abs(poses[1] - poses[0]).max())
        if off > JOINED:
            raise InvalidValueError(
                f"a walk begins at {begins:.6g} s off the place where the one before stands, by "
                f"{off:.3g}: make it by `following`"
            )
