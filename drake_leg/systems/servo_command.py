"""What the servos of a walking robot are told."""

from __future__ import annotations

import numpy as np
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.units import require_positive


class ServoCommand(LeafSystem):
    """Tells the servos where the joints are to be at the end of a time step, and how fast.

    ============ ==== ==== ============ ====================================================
    port         kind size unit         meaning
    ============ ==== ==== ============ ====================================================
    ``q``        in   n    rad          joint positions at the beginning of the step
    ``qdot``     in   n    rad/s        joint rates, held for the step
    ``desired``  out  2 n  rad, rad/s   ``q + qdot h``, and ``qdot``
    ============ ==== ==== ============ ====================================================

    Parameters
    ----------
    joints : int
        n.
    time_step : float
        h [s], of the plant, whose controllers act at the end of its steps.
    """

    def __init__(self, joints: int, time_step: float) -> None:
        LeafSystem.__init__(self)
        require_positive("the time step", time_step, "s")
        self._time_step = time_step
        self._q = self.DeclareVectorInputPort("q", joints)
        self._qdot = self.DeclareVectorInputPort("qdot", joints)
        self.DeclareVectorOutputPort("desired", 2 * joints, self._calc_desired)

    def _calc_desired(self, context: Context, desired: BasicVector) -> None:
        q, qdot = self._q.Eval(context), self._qdot.Eval(context)
        desired.SetFromVector(np.concatenate((q + self._time_step * qdot, qdot)))
