"""The Jacobian inverse as a block: the reports' MATLAB Function ``inverseJacobian``."""

from __future__ import annotations

import math
from collections.abc import Callable

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.task import Floats, Task

STEP_OF_KINK, SHORTEST_AT_KINK = 2e-3, 2e-4  # [s], of steps in which a rate may have a kink
PART_AT_KINK = 0.04  # of a rate, by which it may change in such a step


class LookAhead:
    """How far a step would go, from the joints' rates and, where known, their accelerations.

    Parameters
    ----------
    determinant : callable
        Of a posture.
    q, qdot : (n,) sequence of float
        [rad or m], and per second.
    qddot : (n,) sequence of float or None
        [rad/s^2 or m/s^2].
    """

    def __init__(
        self,
        determinant: Callable[[Floats], float],
        q: Floats,
        qdot: Floats,
        qddot: Floats | None,
    ) -> None:
        self._determinant = determinant
        self._q, self._qdot, self._qddot = q, qdot, qddot
        self._now = determinant(q)
        self._fastest = max(map(abs, qdot))
        self._hardest = max(map(abs, qddot)) if qddot else 0.0

    def __call__(self, step: float) -> tuple[float, float]:
        """Tell how far a step would go.

        What rates and accelerations do is counted apart: it may cancel at the end of the step, but
        not within it.

        Parameters
        ----------
        step : float
            [s].

        Returns
        -------
        float, float
            Greatest change of a joint [rad or m], and of the determinant relative to its value.
        """
        half = 0.5 * step * step
        drift = abs(self._moved(step, self._qdot) - self._now)
        if self._qddot:
            drift += abs(self._moved(half, self._qddot) - self._now)
        turn = step * self._fastest + half * self._hardest
        return turn, drift / abs(self._now) if self._now else math.inf

    def time_left(self, step: float) -> float:
        """Return the determinant over the rate at which it falls.

        Where it falls linearly in time, that is when it becomes zero; where it falls like the
        root of the time that is left, it becomes zero at half of that.

        Parameters
        ----------
        step : float
            So small that the determinant changes little in it [s].

        Returns
        -------
        float
            [s]; infinite where it grows.
        """
        change = self._moved(step, self._qdot) / self._now - 1.0
        return -step / change if change < 0.0 else math.inf

    def _moved(self, step: float, change: Floats) -> float:
        moved = [q + step * part for q, part in zip(self._q, change, strict=True)]
        return self._determinant(moved)


class InverseJacobian(LeafSystem):
    """Joint rates and accelerations that give the foot its commanded motion.

    ========== ===== ===== ============ ===========================================
    port       kind  size  unit         meaning
    ========== ===== ===== ============ ===========================================
    ``q``      in    n     rad          joint positions, as sensed
    ``v``      in    m     m/s          commanded task velocity, base frame
    ``a``      in    m     m/s^2        commanded task acceleration; may be left open
    ``w``      in    n     rad/s        joint rates, as sensed; may be left open
    ``qdot``   out   n     rad/s        ``J^-1 v``
    ``qddot``  out   n     rad/s^2      its derivative, J changing along ``w``
    ``det_j``  out   1     m^3          determinant of J: the singularity check
    ========== ===== ===== ============ ===========================================

    With as many joints n as commanded velocities m, ``qddot`` is ``J^-1 (a - dJ/dt qdot)``. With
    more, ``qdot`` is the least of all rates that give v, and ``det_j`` is ``sqrt(det(J J^T))``.

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

    def __init__(self, task: Task) -> None:
        super().__init__()
        self._task = task
        n, m = task.joints, task.size
        self._q = self.DeclareVectorInputPort("q", n)
        self._v = self.DeclareVectorInputPort("v", m)
        self._a = self.DeclareVectorInputPort("a", m)
        q, v, a = self._q.ticket(), self._v.ticket(), self._a.ticket()
        self._w = self.DeclareVectorInputPort("w", n)
        sources = {q, v, a, self._w.ticket()}
        self._qdot = self.DeclareVectorOutputPort("qdot", n, self._calc_qdot, {q, v})
        self._qddot = self.DeclareVectorOutputPort("qddot", n, self._calc_qddot, sources)
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

    @property
    def twists(self) -> Array:
        """Turning, then translation of the foot, that each part of ``v`` is, (6, m)."""
        return self._task.twists

    @property
    def is_exact(self) -> bool:
        """Whether the inverse does not exist where J is singular."""
        return self._task.stiffness is None

    def stiffness(self, context: Context) -> tuple[float, float]:
        """Tell how fast the rates of an inverse that is not exact change with the posture.

        Parameters
        ----------
        context : Context
            This system's own.

        Returns
        -------
        float, float
            The most that it may become for the present command, and what it is now [1/s].
        """
        if self._task.stiffness is None:
            return 0.0, 0.0
        return self._task.stiffness(self._q.Eval(context), self._v.Eval(context))

    def step_at_kink(self, context: Context, step: float) -> float:
        """Tell how long a step may be in which something else comes to bound the joints' rates.

        Across the kink an integrator errs by a part of what the rate changes in the step: that is
        less than the headroom before a greatest rate, and than the margin before a limit.

        Parameters
        ----------
        context : Context
            This system's own.
        step : float
            To be taken [s].

        Returns
        -------
        float
            [s]; infinite where the rates have no kink in it.
        """
        if self._task.regime is None or not self._a.HasValue(context):
            return math.inf
        q, v, rates = self._q.Eval(context), self._v.Eval(context), self._qdot.Eval(context)
        w = self._w.Eval(context) if self._w.HasValue(context) else rates
        later = q + step * w, v + step * self._a.Eval(context)
        now, then = (self._task.regime(*map(list, pair)) for pair in ((q, v), later))
        if now == then:
            return math.inf
        least = STEP_OF_KINK
        for before, after, rate, change in zip(
            now, then, rates, self._qddot.Eval(context), strict=True
        ):
            if before != after and change:
                least = min(least, PART_AT_KINK * abs(rate / change))
        return max(least, SHORTEST_AT_KINK)

    def look_ahead(self, context: Context, *, disturbed: bool = False) -> LookAhead:
        """Take the present rates and, if ``a`` is wired, accelerations.

        Parameters
        ----------
        context : Context
            This system's own.
        disturbed : bool
            Whether the joints may move otherwise than commanded, so that sensed rates count.

        Returns
        -------
        LookAhead
        """
        determinant, q = self._task.determinant, self._q.Eval(context).tolist()
        if disturbed and self._w.HasValue(context):
            return LookAhead(determinant, q, self._w.Eval(context).tolist(), None)
        accelerations = self._qddot.Eval(context).tolist() if self._a.HasValue(context) else None
        return LookAhead(determinant, q, self._qdot.Eval(context).tolist(), accelerations)

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
        q = self._q.Eval(context).tolist()
        return SingularConfigurationError(
            q=q, sigma_min=self._task.sigma_min(q), time=context.get_time()
        )

    def _calc_qdot(self, context: Context, qdot: BasicVector) -> None:
        q, v = self._q.Eval(context).tolist(), self._v.Eval(context).tolist()
        try:
            qdot.SetFromVector(self._task.rates(q, v))
        except SingularConfigurationError:
            raise self.singular(context) from None

    def _calc_qddot(self, context: Context, qddot: BasicVector) -> None:
        q, qdot = self._q.Eval(context).tolist(), self._qdot.Eval(context).tolist()
        a, v = self._a.Eval(context).tolist(), self._v.Eval(context).tolist()
        w = self._w.Eval(context).tolist() if self._w.HasValue(context) else qdot
        qddot.SetFromVector(self._task.accelerations(q, qdot, a, v, w))

    def _calc_det_j(self, context: Context, det_j: BasicVector) -> None:
        det_j.SetFromVector([self._task.determinant(self._q.Eval(context).tolist())])
