"""Limits the speed of a commanded velocity."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context

from drake_leg.kinematics.motions import limited_speed
from drake_leg.kinematics.movable import Floats
from drake_leg.systems.block import Block
from drake_leg.units import require_positive


class SpeedLimit(Block):
    """Limits the magnitude of a velocity and keeps its direction.

    ================ ===== ===== ======= ==========================================
    port             kind  size  unit    meaning
    ================ ===== ===== ======= ==========================================
    ``v``            in    n     m/s     commanded velocity
    ``a``            in    n     m/s^2   its derivative
    ``velocity``     out   n     m/s     ``v``, or ``top v / |v|`` where that is less
    ``acceleration`` out   n     m/s^2   its derivative
    ================ ===== ===== ======= ==========================================

    Parameters
    ----------
    top : float
        Maximum speed [m/s].
    lengths : (n,) sequence of float
        Factors that make each component a velocity in m/s, 1 where it is one [m/unit].

    Raises
    ------
    InvalidValueError
        If the speed is not positive.
    """

    def __init__(self, top: float, lengths: Floats = (1.0, 1.0, 1.0)) -> None:
        Block.__init__(self, top, lengths)
        require_positive("the greatest speed", top, "m/s")
        self._top, self._lengths = top, lengths
        n = len(lengths)
        self._v = self.DeclareVectorInputPort("v", n)
        self._a = self.DeclareVectorInputPort("a", n)
        v, a = self._v.ticket(), self._a.ticket()
        self.DeclareVectorOutputPort("velocity", n, self._calc_velocity, {v})
        self.DeclareVectorOutputPort("acceleration", n, self._calc_acceleration, {v, a})

    def _calc_velocity(self, context: Context, velocity: BasicVector) -> None:
        v = self._v.Eval(context).tolist()
        velocity.SetFromVector(limited_speed(v, v, self._top, self._lengths)[0])

    def _calc_acceleration(self, context: Context, acceleration: BasicVector) -> None:
        v, a = self._v.Eval(context).tolist(), self._a.Eval(context).tolist()
        acceleration.SetFromVector(limited_speed(v, a, self._top, self._lengths)[1])
