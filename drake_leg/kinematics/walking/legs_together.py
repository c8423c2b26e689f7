"""All legs of a walking robot, for one inverse Jacobian block of the lab's leg."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.movable import (
    SINGULAR_BELOW,
    TRANSLATION,
    Floats,
    Functions,
    Movable,
    Values,
)
from drake_leg.kinematics.walking.leg_on_body import LegOnBody

_OF_FLOATS = (cos, sin)
# Of a leg in the vertical plane through its hip's axis: cosine and sine of the hip, of the tibia
# over the horizontal, and sine of the ankle [-]; how far the foot is from the hip's axis, and out
# and up from the knee [m].
Plane = tuple[float, float, float, float, float, float, float, float]


class LegsTogether(Movable):
    """Legs side by side: joints and feet one leg after the other, each leg in closed form.

    The Jacobian has those of the legs on its diagonal. As its determinant counts that of the leg
    that is nearest to a singularity, over its scale and in its own angles, and so the sign does not
    change with the direction of an axis.

    At every time step a gait asks for the feet, and an inverse Jacobian for the rates, at the same
    posture. So the legs' formulas are written out for floats, and what they share is kept.
    """

    determinant_scale = 1.0

    def __init__(self, legs: Sequence[LegOnBody]) -> None:
        self.legs = tuple(legs)
        count = len(self.legs)
        self.turning = (True,) * (3 * count)
        self.twists = np.tile(TRANSLATION, count)
        self.row_lengths = (1.0,) * (3 * count)
        self.length = min(leg.length for leg in self.legs)
        self._placed = [(leg.hip, leg.signs, leg.offsets, leg.lengths) for leg in self.legs]
        self._last: tuple[tuple[float, ...], list[Plane]] = ((), [])

    def foot(self, q: Floats) -> Array:
        """Positions of the feet in the body's frame, (3 n,) [m]."""
        return np.concatenate([leg.foot(own) for leg, own in self._each(q)])

    def jacobian(self, q: Floats) -> Array:
        """Translational Jacobians on a diagonal, (3 n, 3 n) [m/rad]."""
        J = np.zeros((len(q), len(q)))
        for number, (leg, own) in enumerate(self._each(q)):
            J[3 * number : 3 * number + 3, 3 * number : 3 * number + 3] = leg.jacobian(own)
        return J

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (3 n,) [m/s^2]."""
        legs = zip(self._each(q), self._each(qdot), strict=True)
        return np.concatenate([leg.bias(own, rates) for (leg, own), (_, rates) in legs])

    def determinant(self, q: Floats) -> float:
        """Least determinant of a leg's Jacobian over its scale [-]."""
        return min((leg.own_determinant(own) for leg, own in self._each(q)), key=abs)

    def rates(self, q: Floats, v: Floats) -> Floats:
        """``J^-1 v``."""
        found: list[float] = []
        feet = iter(v)
        for (_, (s1, s2, s3), _, (l1, l2, l3)), plane, x, y, z in zip(
            self._placed, self._planes(q), feet, feet, feet, strict=True
        ):
            c_hip, s_hip, c_tibia, s_tibia, s_ankle, far, out, up = plane
            if abs(s_ankle) <= SINGULAR_BELOW or abs(far) <= SINGULAR_BELOW * (l1 + l2 + l3):
                raise self.singular(q)
            radial = c_hip * x + s_hip * y
            found += (
                s1 * ((c_hip * y - s_hip * x) / far),
                s2 * ((c_tibia * radial + s_tibia * z) / (l2 * s_ankle)),
                -s3 * ((out * radial + up * z) / (l2 * l3 * s_ankle)),
            )
        return found

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Positions of the feet in the body's frame, (3 n,) [m]."""
        found: list[Values] = []
        if functions != _OF_FLOATS:
            for leg, own in self._each(q):
                found += leg.task_position(own, functions)
            return tuple(found)
        for ((x, y, z), *_), (c_hip, s_hip, _, _, _, far, _, up) in zip(
            self._placed, self._planes(q), strict=True
        ):
            found += (x + c_hip * far, y + s_hip * far, z + up)
        return tuple(found)

    def sigma_min(self, q: Floats) -> float:
        """Smallest singular value of all legs' Jacobians [m]."""
        return min(leg.sigma_min(own) for leg, own in self._each(q))

    def singular(self, q: Floats, time: float | None = None) -> SingularConfigurationError:
        """Make the error of the leg that is nearest to a singularity."""
        leg, own = min(self._each(q), key=lambda each: each[0].sigma_min(each[1]))
        return leg.singular(own, time)

    def _each(self, values: Values) -> list[tuple[LegOnBody, Values]]:
        """Every leg, and its three values."""
        return [(leg, values[3 * number : 3 * number + 3]) for number, leg in enumerate(self.legs)]

    def _planes(self, q: Floats) -> list[Plane]:
        """Every leg in its plane."""
        posture = tuple(q)
        if posture == self._last[0]:
            return self._last[1]
        found: list[Plane] = []
        joints = iter(posture)
        for (_, (s1, s2, s3), (a, b, c), (l1, l2, l3)), q1, q2, q3 in zip(
            self._placed, joints, joints, joints, strict=True
        ):
            hip, femur, ankle = a + s1 * q1, b + s2 * q2, c + s3 * q3
            c_tibia, s_tibia = cos(femur + ankle), sin(femur + ankle)
            out, up = l2 * cos(femur) + l3 * c_tibia, l2 * sin(femur) + l3 * s_tibia
            found.append((cos(hip), sin(hip), c_tibia, s_tibia, sin(ankle), l1 + out, out, up))
        self._last = posture, found
        return found
