"""The kinematic loop as one block: command, inverse Jacobian and integrators, without a plant."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake import symbolic
from pydrake.systems.framework import BasicVector_, Context
from pydrake.systems.primitives import SymbolicVectorSystem

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.loop import Instant, KinematicEquation
from drake_leg.systems.block import Block


class KinematicLoop(Block):
    """Integrates the joint rates that make the foot follow its command.

    ========= ==== ==== ======== ======================================================
    port      kind size unit     meaning
    ========= ==== ==== ======== ======================================================
    ``state`` out  n    rad or m joint positions q
    ========= ==== ==== ======== ======================================================

    With input filters at the joints the state has 3 n numbers: q, its derivative, and the
    filters' input.

    Parameters
    ----------
    equation : KinematicEquation
        The robot, the motion of its foot, and how the joints follow it.
    start : (n,) sequence of float
        Joint positions at the start [rad or m].

    Raises
    ------
    SingularConfigurationError
        While simulating, where the Jacobian has no inverse; it carries the time.
    """

    def __init__(self, equation: KinematicEquation, start: Sequence[float]) -> None:
        Block.__init__(self, equation, start)
        self.equation = equation
        self.robot = equation.robot
        numbers = [self.scalar(each) for each in equation.start(start)]
        state = self.DeclareContinuousState(BasicVector_[self.scalar](numbers))
        self.DeclareStateOutputPort("state", state)

    def posture(self, context: Context) -> list[float]:
        """Joint positions in the block's own context, (n,) [rad or m]."""
        return list(self.instant(context).q)

    def instant(self, context: Context) -> Instant:
        """Command and joints in the block's own context."""
        return self.equation.instant(context.get_time(), _state(context))

    def DoCalcTimeDerivatives(self, context: Context, derivatives: object) -> None:
        """Compute the derivative of the state."""
        time, state = context.get_time(), _state(context)
        try:
            derivatives.SetFromVector(self.equation.derivative(time, state))  # type: ignore[attr-defined]
        except SingularConfigurationError as error:
            raise self.robot.singular(error.q, time) from None


def compiled_loop(
    equation: KinematicEquation, start: Sequence[float]
) -> SymbolicVectorSystem | None:
    """Make the same block of Drake's symbols, which needs no Python while it is simulated.

    None where the robot has no closed form. It does not refuse a singular posture.
    """
    time = symbolic.Variable("t")
    state = [symbolic.Variable(f"x{i}") for i in range(len(equation.start(start)))]
    derivative = equation.formula(time, state, (symbolic.cos, symbolic.sin))
    if derivative is None:
        return None
    return SymbolicVectorSystem(time=time, state=state, dynamics=list(derivative), output=state)


def _state(context: Context) -> list[float]:
    state: list[float] = context.get_continuous_state_vector().CopyToVector().tolist()
    return state
