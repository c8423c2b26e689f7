"""The inverse Jacobian block: the reports' MATLAB Function ``inverseJacobian``."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.loop import Instant
from drake_leg.kinematics.movable import Movable, require_movable
from drake_leg.systems.block import Block


class InverseJacobian(Block):
    """Computes the joint rates and accelerations that make the foot follow its command.

    ========== ===== ===== ============ ===========================================
    port       kind  size  unit         meaning
    ========== ===== ===== ============ ===========================================
    ``q``      in    n     rad          joint positions, as sensed
    ``v``      in    m     m/s          commanded task velocity, base frame
    ``a``      in    m     m/s^2        commanded task acceleration (optional)
    ``w``      in    n     rad/s        joint rates, as sensed (optional)
    ``qdot``   out   n     rad/s        ``J^-1 v``
    ``qddot``  out   n     rad/s^2      its derivative, J changing along ``w``
    ``det_j``  out   1     m^3          determinant of J: the singularity check
    ========== ===== ===== ============ ===========================================

    With as many joints n as commanded velocities m, ``qddot`` is ``J^-1 (a - dJ/dt qdot)``. With
    more, ``qdot`` is the smallest of all rates that produce ``v``, and ``det_j`` is
    ``sqrt(det(J J^T))``.

    Parameters
    ----------
    robot : Movable
        Supplies the Jacobian and its inverse, be it exact or damped.

    Raises
    ------
    SingularConfigurationError
        While simulating, where J has no inverse; it carries the time.

    References
    ----------
    Report A, eq. 19 and figure 10; report B, figure 4.

    Examples
    --------
    >>> from drake_leg import LEG_B, InverseJacobian, movable
    >>> block = InverseJacobian(movable(LEG_B))
    >>> context = block.CreateDefaultContext()
    >>> for name, value in (("q", [1.57, -0.87, -1.57]), ("v", [0.05, 0.0, 0.0])):
    ...     _ = block.GetInputPort(name).FixValue(context, value)
    >>> block.GetOutputPort("qdot").Eval(context)[0].round(2)  # the hip turns [rad/s]
    np.float64(-1.31)
    """

    def __init__(self, robot: Movable) -> None:
        require_movable(robot)
        Block.__init__(self, robot)
        self.robot = robot
        n, m = robot.joints, robot.size
        self._q = self.DeclareVectorInputPort("q", n)
        self._v = self.DeclareVectorInputPort("v", m)
        self._a = self.DeclareVectorInputPort("a", m)
        q, v, a = self._q.ticket(), self._v.ticket(), self._a.ticket()
        self._w = self.DeclareVectorInputPort("w", n)
        sources = {q, v, a, self._w.ticket()}
        self._qdot = self.DeclareVectorOutputPort("qdot", n, self._calc_qdot, {q, v})
        self._qddot = self.DeclareVectorOutputPort("qddot", n, self._calc_qddot, sources)
        self.DeclareVectorOutputPort("det_j", 1, self._calc_det_j, {q})

    def posture(self, context: Context) -> list[float]:
        """Joint positions at the block's input in its own context, (n,) [rad or m]."""
        q: list[float] = self._q.Eval(context).tolist()
        return q

    def instant(self, context: Context) -> Instant:
        """Inputs and outputs in the block's own context; ``a`` and ``w`` only where connected."""
        has_a, has_w = self._a.HasValue(context), self._w.HasValue(context)
        return Instant(
            q=self._q.Eval(context).tolist(),
            v=self._v.Eval(context).tolist(),
            a=self._a.Eval(context).tolist() if has_a else None,
            w=self._w.Eval(context).tolist() if has_w else None,
            qdot=self._qdot.Eval(context).tolist(),
            qddot=self._qddot.Eval(context).tolist() if has_a else None,
        )

    def _calc_qdot(self, context: Context, qdot: BasicVector) -> None:
        q, v = self._q.Eval(context).tolist(), self._v.Eval(context).tolist()
        try:
            qdot.SetFromVector(self.robot.rates(q, v))
        except SingularConfigurationError:
            raise self.robot.singular(q, context.get_time()) from None

    def _calc_qddot(self, context: Context, qddot: BasicVector) -> None:
        q, qdot = self._q.Eval(context).tolist(), self._qdot.Eval(context).tolist()
        v, a = self._v.Eval(context).tolist(), self._a.Eval(context).tolist()
        w = self._w.Eval(context).tolist() if self._w.HasValue(context) else None
        qddot.SetFromVector(self.robot.accelerations(q, qdot, a, v, w))

    def _calc_det_j(self, context: Context, det_j: BasicVector) -> None:
        det_j.SetFromVector([self.robot.determinant(self._q.Eval(context).tolist())])
