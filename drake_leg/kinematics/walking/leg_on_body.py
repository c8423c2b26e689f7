"""One leg of a walking robot, for the inverse Jacobian block of the lab's leg."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.leg import LegGeometry, MovableLeg
from drake_leg.kinematics.movable import Floats, Functions, Values


class LegOnBody(MovableLeg):
    """The reports' leg with its hip on a body: its foot moves in the body's frame.

    The leg's own angles are ``offsets + signs * q``. Femur and tibia are lifted by positive ones.
    """

    def __init__(
        self, leg: LegGeometry, hip: Sequence[float], signs: Floats, offsets: Floats
    ) -> None:
        MovableLeg.__init__(self, leg)
        self.hip, self.signs, self.offsets = tuple(hip), tuple(signs), tuple(offsets)
        self.lengths = leg.l1, leg.l2, leg.l3
        self._sign = signs[0] * signs[1] * signs[2]

    def _own(self, q: Values) -> list[Values]:
        (a, b, c), (s1, s2, s3), (q1, q2, q3) = self.offsets, self.signs, q
        return [a + s1 * q1, b + s2 * q2, c + s3 * q3]

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the body's frame, (3,) [m]."""
        return np.array(self.hip) + MovableLeg.foot(self, self._own(q))

    def jacobian(self, q: Floats) -> Array:
        """Translational Jacobian, (3, 3) [m/rad]."""
        return np.asarray(MovableLeg.jacobian(self, self._own(q)) * np.array(self.signs))

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (3,) [m/s^2]."""
        own = [sign * rate for sign, rate in zip(self.signs, qdot, strict=True)]
        return MovableLeg.bias(self, self._own(q), own)

    def determinant(self, q: Floats) -> float:
        """Det J, factored [m^3]."""
        return self._sign * MovableLeg.determinant(self, self._own(q))

    def own_determinant(self, q: Floats) -> float:
        """Determinant of the leg's own angles over its scale [-]."""
        return MovableLeg.determinant(self, self._own(q)) / self.determinant_scale

    def rates(self, q: Floats, v: Floats) -> Floats:
        """``J^-1 v``."""
        (s1, s2, s3), (u1, u2, u3) = self.signs, MovableLeg.rates(self, self._own(q), v)
        return [s1 * u1, s2 * u2, s3 * u3]

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Position of the foot in the body's frame, (3,) [m]."""
        x, y, z = MovableLeg.task_position(self, self._own(q), functions)
        x0, y0, z0 = self.hip
        return x0 + x, y0 + y, z0 + z
