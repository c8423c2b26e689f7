"""The Jacobian inverse as a block: the reports' MATLAB Function ``inverseJacobian``."""

from __future__ import annotations

import numpy as np
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.task import Task, singular_posture


class InverseJacobian(LeafSystem):
    """Joint rates and accelerations that give the foot its commanded motion.

    ========== ===== ===== ============ ===========================================
    port       kind  size  unit         meaning
    ========== ===== ===== ============ ===========================================
    ``q``      in    n     rad          joint positions, as sensed
    ``v``      in    n     m/s          commanded task velocity, base frame
    ``a``      in    n     m/s^2        commanded task acceleration; may be left open
    ``qdot``   out   n     rad/s        ``J^-1 v``
    ``qddot``  out   n     rad/s^2      ``J^-1 (a - dJ/dt qdot)``
    ``det_j``  out   1     m^3          determinant of J: the singularity check
    ========== ===== ===== ============ ===========================================

    Parameters
    ----------
    task : Task
        The Jacobian and how it is inverted.

    Raises
    ------
    SingularConfigurationError
        While simulating, where J has no inverse; it carries the time.

    References
    ----------
    Report A, eq. 19 and figure 10; report B, figure 4.
    """

    def __init__(self, task: Task) -> None:
        super().__init__()
        self._task = task
        n = task.size
        self._q = self.DeclareVectorInputPort("q", n)
        self._v = self.DeclareVectorInputPort("v", n)
        self._a = self.DeclareVectorInputPort("a", n)
        q, v, a = self._q.ticket(), self._v.ticket(), self._a.ticket()
        self._qdot = self.DeclareVectorOutputPort("qdot", n, self._calc_qdot, {q, v})
        self._qddot = self.DeclareVectorOutputPort("qddot", n, self._calc_qddot, {q, v, a})
        self._det_j = self.DeclareVectorOutputPort("det_j", 1, self._calc_det_j, {q})

    def normalised_determinant(self, context: Context) -> float:
        """Determinant over its scale, in about -1 ... 1: zero where the Jacobian is singular.

        Parameters
        ----------
        context : Context
            This system's own.

        Returns
        -------
        float
            Dimensionless.
        """
        return float(self._det_j.Eval(context)[0]) / self._task.determinant_scale

    def look_ahead(self, context: Context, step: float) -> tuple[float, float]:
        """Tell how far a step would go, from the joints' rates and, if ``a`` is wired, theirs.

        The parts of rates and of accelerations are counted apart: they may cancel at the end of
        the step, but not within it.

        Parameters
        ----------
        context : Context
            This system's own.
        step : float
            How far [s].

        Returns
        -------
        float, float
            Greatest change of a joint [rad or m], and of the determinant relative to its value.
        """
        q, changes = self._q.Eval(context), [step * self._qdot.Eval(context)]
        if self._a.HasValue(context):
            changes.append(0.5 * step**2 * self._qddot.Eval(context))
        now = self._task.determinant(q)
        drift = sum(abs(self._task.determinant(q + change) - now) for change in changes)
        turn = sum(float(np.abs(change).max()) for change in changes)
        return turn, drift / abs(now)

    def singular(self, context: Context) -> SingularConfigurationError:
        """Describe the present posture as singular.

        Parameters
        ----------
        context : Context
            This system's own.

        Returns
        -------
        SingularConfigurationError
            To be raised; it carries q, sigma_min and the time.
        """
        return singular_posture(self._task.jacobian, self._q.Eval(context), context.get_time())

    def _calc_qdot(self, context: Context, qdot: BasicVector) -> None:
        q, v = self._q.Eval(context).tolist(), self._v.Eval(context).tolist()
        try:
            qdot.SetFromVector(self._task.rates(q, v))
        except SingularConfigurationError:
            raise self.singular(context) from None

    def _calc_qddot(self, context: Context, qddot: BasicVector) -> None:
        q, qdot = self._q.Eval(context).tolist(), self._qdot.Eval(context).tolist()
        a = self._a.Eval(context).tolist()
        qddot.SetFromVector(self._task.accelerations(q, qdot, a))

    def _calc_det_j(self, context: Context, det_j: BasicVector) -> None:
        det_j.SetFromVector([self._task.determinant(self._q.Eval(context))])
