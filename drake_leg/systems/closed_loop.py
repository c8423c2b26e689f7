"""Robots with closed loops as blocks: driven by their active joints, or free to move.

A continuous plant of Drake takes no constraints. The blocks therefore take the plant of the cut
tree, and close the loops themselves, by Newton's method, in every evaluation: an integrator's error
moves the robot along its closed postures, but never opens a loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces
from pydrake.systems.framework import BasicVector, Context, ContinuousState, LeafSystem

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.kinematics.khalil import Array, one_vector
from drake_leg.models.plant import build_plant
from drake_leg.units import STANDARD_GRAVITY


class TreeDynamics:
    """The dynamics of a robot's cut tree by Drake, in the order of the robot's joints.

    ``M qddot + C - f = tau``, with f the forces of gravity, springs and dampers. It computes in a
    scratch context; nothing in it outlives a call.
    """

    def __init__(self, plant: MultibodyPlant, joints: Sequence[str]) -> None:
        found = [plant.GetJointByName(name) for name in joints]
        self._positions = [joint.position_start() for joint in found]
        self._velocities = [joint.velocity_start() for joint in found]
        if plant.num_positions() != len(found):
            raise InvalidValueError(
                f"{plant.get_name()!r} has {plant.num_positions()} positions and "
                f"{len(found)} joints; a robot with closed loops must stand on a fixed base"
            )
        self._plant = plant
        self._scratch = plant.CreateDefaultContext()
        self._forces = MultibodyForces(plant)

    def set(self, q: Array, qdot: Array) -> None:
        """Set positions and velocities of the joints."""
        positions, velocities = np.empty(len(q)), np.empty(len(q))
        positions[self._positions], velocities[self._velocities] = q, qdot
        self._plant.SetPositions(self._scratch, positions)
        self._plant.SetVelocities(self._scratch, velocities)

    def forces(self, qddot: Array) -> Array:
        """Forces tau that accelerate the joints by qddot, (n,) [N*m or N]."""
        acceleration = np.empty(len(qddot))
        acceleration[self._velocities] = qddot
        self._plant.CalcForceElementsContribution(self._scratch, self._forces)
        tau = self._plant.CalcInverseDynamics(self._scratch, acceleration, self._forces)
        ordered: Array = tau[self._velocities]
        return ordered

    def mass_matrix(self) -> Array:
        """M, (n, n)."""
        M = self._plant.CalcMassMatrix(self._scratch)
        ordered: Array = M[np.ix_(self._velocities, self._velocities)]
        return ordered

    def energy(self) -> float:
        """Kinetic and potential energy [J]."""
        kinetic = self._plant.EvalKineticEnergy(self._scratch)
        return float(kinetic + self._plant.EvalPotentialEnergy(self._scratch))


class _LoopBlock(LeafSystem):
    """What both blocks have: the loops, the plant of the cut tree, and the ports of a motion."""

    def __init__(self, loops: ClosedLoops, gravity: float) -> None:
        LeafSystem.__init__(self)
        self.loops = loops
        self.tree = build_plant(loops.robot, gravity=gravity)
        self._dynamics = TreeDynamics(self.tree, loops.joints)

    def _declare_motion(self, used: set[Any]) -> None:
        """Declare the motion, computed once, and the ports that are parts of it."""
        n, cuts = len(self.loops.joints), len(self.loops.cuts)
        self._motion = self.DeclareVectorOutputPort("motion", 3 * n, self._calc_motion, used)
        for index, name in enumerate(("q", "qdot", "qddot")):
            part = slice(index * n, (index + 1) * n)

            def calc(context: Context, output: BasicVector, part: slice = part) -> None:
                output.SetFromVector(self._motion.Eval(context)[part])

            self.DeclareVectorOutputPort(name, n, calc, used)
        self.DeclareVectorOutputPort("cut", cuts, self._calc_cut, used)
        self.DeclareVectorOutputPort("closure", 1, self._calc_closure, used)
        self.DeclareVectorOutputPort("energy", 1, self._calc_energy, used)

    def _calc_motion(self, context: Context, motion: BasicVector) -> None:
        motion.SetFromVector(np.concatenate(self._solved(context)))

    def _solved(self, context: Context) -> tuple[Array, Array, Array]:
        raise NotImplementedError

    def _parts(self, context: Context) -> tuple[Array, Array, Array]:
        q, qdot, qddot = self._motion.Eval(context).reshape(3, -1)
        return q, qdot, qddot

    def _calc_cut(self, context: Context, cut: BasicVector) -> None:
        cut.SetFromVector(self.loops.cut_motion(self._parts(context)[0]).position)

    def _calc_closure(self, context: Context, closure: BasicVector) -> None:
        closure.SetFromVector([float(self.loops.gap(self._parts(context)[0]))])

    def _calc_energy(self, context: Context, energy: BasicVector) -> None:
        q, qdot, _ = self._parts(context)
        self._dynamics.set(q, qdot)
        energy.SetFromVector([self._dynamics.energy()])


class DrivenLoops(_LoopBlock):
    """Moves a robot with closed loops by its active joints, and computes their torques.

    The passive joints follow, without a jump to another assembly: their positions are a state that
    is integrated, and Newton's method closes the loops from there. ``torque`` is ``W' tau``, with
    tau the forces that would move the joints of the cut tree.

    =========== ===== ===== ============= ==================================================
    port        kind  size  unit          meaning
    =========== ===== ===== ============= ==================================================
    ``q_a``     in    a     rad, m        prescribed positions of the active joints
    ``qdot_a``  in    a     /s            their first derivative
    ``qddot_a`` in    a     /s^2          their second derivative
    ``motion``  out   3 n   rad, m, /s    the next three, together
    ``q``       out   n     rad, m        positions of all joints of the cut tree
    ``qdot``    out   n     /s            their velocities
    ``qddot``   out   n     /s^2          their accelerations
    ``cut``     out   loops rad, m        positions of the joints at which the loops are cut
    ``closure`` out   1     m             how far the loops are from closed
    ``energy``  out   1     J             kinetic and potential energy
    ``torque``  out   a     N*m, N        of the active joints
    =========== ===== ===== ============= ==================================================

    Parameters
    ----------
    loops : ClosedLoops
        Of a robot.
    start : (n,) array_like
        A posture near that in which the motion starts.
    gravity : float
        Along -z [m/s^2].

    Examples
    --------
    >>> from drake_leg.kinematics.closed_loops import ClosedLoops
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> loops = ClosedLoops(FOUR_BAR)
    >>> block = DrivenLoops(loops, loops.position([1.0]))
    >>> context = block.CreateDefaultContext()
    >>> for name, value in (("q_a", 1.0), ("qdot_a", 2.0), ("qddot_a", 0.0)):
    ...     _ = block.GetInputPort(name).FixValue(context, [value])
    >>> bool(block.GetOutputPort("closure").Eval(context)[0] < 1e-12)
    True
    """

    def __init__(
        self, loops: ClosedLoops, start: Sequence[float], *, gravity: float = STANDARD_GRAVITY
    ) -> None:
        _LoopBlock.__init__(self, loops, gravity)
        posture = one_vector("the start", start, len(loops.joints))
        a = len(loops.active)
        self._q_a = self.DeclareVectorInputPort("q_a", a)
        self._qdot_a = self.DeclareVectorInputPort("qdot_a", a)
        self._qddot_a = self.DeclareVectorInputPort("qddot_a", a)
        self.DeclareContinuousState(BasicVector(posture[loops.passive_columns]))
        inputs = {port.ticket() for port in (self._q_a, self._qdot_a, self._qddot_a)}
        used = {self.all_state_ticket(), *inputs}
        self._declare_motion(used)
        self.DeclareVectorOutputPort("torque", a, self._calc_torque, used)

    def _solved(self, context: Context) -> tuple[Array, Array, Array]:
        loops = self.loops
        guess = np.empty(len(loops.joints))
        guess[loops.active_columns] = self._q_a.Eval(context)
        guess[loops.passive_columns] = context.get_continuous_state_vector().CopyToVector()
        q = loops.closed_from(guess)
        W, bias = loops.rates_and_bias(q, self._qdot_a.Eval(context))
        return q, W @ self._qdot_a.Eval(context), W @ self._qddot_a.Eval(context) + bias

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Let the passive joints follow."""
        _, qdot, _ = self._parts(context)
        derivatives.SetFromVector(qdot[self.loops.passive_columns])

    def _calc_torque(self, context: Context, torque: BasicVector) -> None:
        q, qdot, qddot = self._parts(context)
        self._dynamics.set(q, qdot)
        torque.SetFromVector(self.loops.W(q).T @ self._dynamics.forces(qddot))


class FreeLoops(_LoopBlock):
    """Lets a robot with closed loops move under gravity, springs, dampers and given forces.

    All joints of the cut tree are states. In every evaluation the posture q nearest to them that
    closes the loops, and the velocities that keep them closed, take their place. There, with N the
    motions that keep the loops closed, ``J N = 0``, the accelerations are

    ``qddot = N z - J^+ dJ/dt qdot``, where ``N' (M qddot + C - f - tau) = 0``.

    No joint is preferred, so that the robot also moves through assemblies which its active joints
    do not determine.

    =========== ===== ===== ============= ==================================================
    port        kind  size  unit          meaning
    =========== ===== ===== ============= ==================================================
    ``force``   in    n     N*m, N        tau, at the joints of the cut tree; 0 if not wired
    ``motion``  out   3 n   rad, m, /s    the next three, together
    ``q``       out   n     rad, m        positions of all joints of the cut tree
    ``qdot``    out   n     /s            their velocities
    ``qddot``   out   n     /s^2          their accelerations
    ``cut``     out   loops rad, m        positions of the joints at which the loops are cut
    ``closure`` out   1     m             how far the loops are from closed
    ``energy``  out   1     J             kinetic and potential energy
    =========== ===== ===== ============= ==================================================

    Parameters
    ----------
    loops : ClosedLoops
        Of a robot.
    start : (n,) array_like
        The posture in which it is released, at rest.
    gravity : float
        Along -z [m/s^2].

    Examples
    --------
    >>> from drake_leg.kinematics.closed_loops import ClosedLoops
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> loops = ClosedLoops(FOUR_BAR)
    >>> block = FreeLoops(loops, loops.position([1.0]))
    >>> context = block.CreateDefaultContext()
    >>> qddot = block.GetOutputPort("qddot").Eval(context)
    >>> bool(abs(loops.jacobian(loops.position([1.0])) @ qddot).max() < 1e-9)  # at rest
    True
    """

    def __init__(
        self, loops: ClosedLoops, start: Sequence[float], *, gravity: float = STANDARD_GRAVITY
    ) -> None:
        _LoopBlock.__init__(self, loops, gravity)
        posture = one_vector("the start", start, len(loops.joints))
        n = len(posture)
        self._force = self.DeclareVectorInputPort("force", n)
        self.DeclareContinuousState(BasicVector(np.concatenate([posture, np.zeros(n)])), n, n, 0)
        self._declare_motion({self.all_state_ticket(), self._force.ticket()})

    def _solved(self, context: Context) -> tuple[Array, Array, Array]:
        loops, dynamics = self.loops, self._dynamics
        given, moving = context.get_continuous_state_vector().CopyToVector().reshape(2, -1)
        q, N, inverse = loops.nearest(given)
        qdot = loops.units * (N @ (N.T @ (moving / loops.units)))
        N = loops.units[:, np.newaxis] * N
        drift = -(inverse @ loops.drift(q, qdot))
        dynamics.set(q, qdot)
        missing = -dynamics.forces(drift)
        if self._force.HasValue(context):
            missing = missing + self._force.Eval(context)
        z = np.linalg.solve(N.T @ dynamics.mass_matrix() @ N, N.T @ missing)
        return q, qdot, N @ z + drift

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Integrate velocities and accelerations of the closed robot."""
        _, qdot, qddot = self._parts(context)
        derivatives.SetFromVector(np.concatenate([qdot, qddot]))
