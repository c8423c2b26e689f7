"""All legs of a walking robot, for one inverse Jacobian block of the lab's leg."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.movable import TRANSLATION, Floats, Functions, Movable, Values
from drake_leg.kinematics.walking.leg_on_body import LegOnBody


class LegsTogether(Movable):
    """Legs side by side: joints and feet one leg after the other, each leg in closed form.

    The Jacobian has those of the legs on its diagonal. As its determinant counts that of the leg
    that is nearest to a singularity, over its scale and in its own angles, and so the sign does not
    change with the direction of an axis.
    """

    determinant_scale = 1.0

    def __init__(self, legs: Sequence[LegOnBody]) -> None:
        self.legs = tuple(legs)
        count = len(self.legs)
        self.turning = (True,) * (3 * count)
        self.twists = np.tile(TRANSLATION, count)
        self.row_lengths = (1.0,) * (3 * count)
        self.length = min(leg.length for leg in self.legs)

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
        for leg, first in zip(self.legs, range(0, len(q), 3), strict=True):
            found += leg.rates(q[first : first + 3], v[first : first + 3])
        return found

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Positions of the feet in the body's frame, (3 n,) [m]."""
        found: list[Values] = []
        for leg, own in self._each(q):
            found += leg.task_position(own, functions)
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
