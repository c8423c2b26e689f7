"""Limits of joint rates and of the foot's speed."""

from __future__ import annotations

import math
from typing import NamedTuple

from drake_leg.kinematics.movable import Floats

# A joint stops this far before its limit: where its rate has a kink, an integration step errs by
# about 1e-5 rad, which would carry a joint that stopped exactly at its limit across it.
MARGIN = 5e-4  # [rad or m], at most
PART = 0.1  # of the distance between the limits, at most
RETREAT = 2.0  # [s] in which a joint that starts nearer than that moves back
HEADROOM = 0.02  # part of the greatest rate that is left for the same errors

FREE, FASTEST, BRAKING = range(3)  # what bounds a rate


class _Joint(NamedTuple):
    low: float  # [rad or m], where it comes to rest
    high: float
    most: float  # [rad/s or m/s]
    settling: float  # [s]

    def allowed(self, room: float) -> float:
        """Return the greatest rate towards a limit that is ``room`` away."""
        rate = room / (self.settling if room >= 0.0 else RETREAT)
        return min(max(rate, -self.most), self.most)

    def bounds(self, q: float) -> tuple[float, float]:
        up = self.allowed(self.high - q)
        return min(-self.allowed(q - self.low), up - 1e-9 * self.most), up

    def kind(self, bound: float) -> int:
        """Tell which kind of bound limits the rate."""
        return FASTEST if bound >= self.most else BRAKING


class RateBox:
    """Bounds of the joint rates at every posture.

    With ``room = upper - margin - q``, a rate is at most ``room / settling`` if the room is
    positive, and ``room / RETREAT`` if it is not: a joint approaches a point just before its limit
    exponentially, and does not cross it. The lower limit is treated alike.

    Parameters
    ----------
    lower, upper : (n,) sequence of float
        Limits of the positions [rad or m]; they may be infinite.
    fastest : (n,) sequence of float
        Limits of the rates [rad/s or m/s].
    settling : float
        [s].
    """

    def __init__(self, lower: Floats, upper: Floats, fastest: Floats, settling: float) -> None:
        self._joints = []
        for low, high, most in zip(lower, upper, fastest, strict=True):
            margin = min(MARGIN, PART * (high - low))
            joint = _Joint(low + margin, high - margin, (1.0 - HEADROOM) * most, settling)
            self._joints.append(joint)

    def bounds(self, q: Floats) -> tuple[list[float], list[float]]:
        """Lowest and highest rates (n,) in a posture [rad/s or m/s]; the first ones are less."""
        pairs = [joint.bounds(position) for joint, position in zip(self._joints, q, strict=True)]
        return [low for low, _ in pairs], [high for _, high in pairs]

    def holds(self, q: Floats, qdot: Floats) -> bool:
        """Tell whether rates (n,) in a posture are within their bounds."""
        low, high = self.bounds(q)
        return all(a <= rate <= b for a, rate, b in zip(low, qdot, high, strict=True))

    def regime(self, q: Floats, qdot: Floats) -> tuple[int, ...]:
        """Tell what bounds each joint's rate: where that changes, the rates have a kink.

        FREE, FASTEST or BRAKING, negative at a lower bound, (n,), for rates within the bounds.
        """
        bounds = zip(self._joints, qdot, *self.bounds(q), strict=True)
        return tuple(
            joint.kind(high) if rate >= high else -joint.kind(-low) if rate <= low else FREE
            for joint, rate, low, high in bounds
        )


def limited_speed(
    v: Floats, a: Floats, top: float, lengths: Floats
) -> tuple[list[float], list[float]]:
    """Shorten a velocity v and its derivative a to a greatest speed [m/s], the direction kept.

    Where ``|v| > top``, the velocity is ``top v / |v|`` and its derivative
    ``(top / |v|) (a - n (n . a))`` with ``n = v / |v|``; elsewhere both are what they were.
    ``lengths`` make each part of the velocity a length [m/unit].
    """
    weights = [length * length for length in lengths]
    square = sum(w * part * part for w, part in zip(weights, v, strict=True))
    if square <= top * top:
        return list(v), list(a)
    along = sum(w * x * y for w, x, y in zip(weights, v, a, strict=True)) / square
    factor = top / math.sqrt(square)
    return [factor * x for x in v], [factor * (y - along * x) for x, y in zip(v, a, strict=True)]
