"""A commanded velocity of the foot, as far as a singularity and the joints let it act."""

from __future__ import annotations

from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from drake_leg.kinematics.movable import Movable
from drake_leg.singularity.look_ahead import Braked, braked


class FootBrake(LeafSystem):
    """Shortens a commanded velocity near a singularity, and where a joint would be too fast.

    ============ ===== ===== ========= ==============================================
    port         kind  size  unit      meaning
    ============ ===== ===== ========= ==============================================
    ``q``        in    n     rad or m  joint positions
    ``v``        in    3     m/s       commanded velocity of the foot, base frame
    ``velocity`` out   3     m/s       share of it that acts, held during a step
    ``share``    out   1     1         0 ... 1, held during a step
    ============ ===== ===== ========= ==============================================

    At the beginning of every step of the simulation the share is found anew, as
    ``singularity.driving.braked`` has it.

    Parameters
    ----------
    robot : Movable
        Whose foot is driven.
    """

    def __init__(self, robot: Movable) -> None:
        super().__init__()
        self._robot = robot
        self._q = self.DeclareVectorInputPort("q", robot.joints)
        self._v = self.DeclareVectorInputPort("v", 3)
        self._held = self.DeclareAbstractState(Value(Braked(1.0, "")))
        self.DeclarePerStepUnrestrictedUpdateEvent(self._find)
        held = self.abstract_state_ticket(self._held)
        sources = {self._v.ticket(), held}
        self.DeclareVectorOutputPort("velocity", 3, self._calc_velocity, sources)
        self.DeclareVectorOutputPort("share", 1, self._calc_share, {held})

    def held(self, context: Context) -> Braked:
        """Share of the command that acts in this step, and why not all of it."""
        braked: Braked = context.get_abstract_state(self._held).get_value()
        return braked

    def _find(self, context: Context, state: State) -> EventStatus:
        q = self._q.Eval(context).tolist()
        robot = self._robot.at(q)
        command = robot.command(self._v.Eval(context)).tolist()
        state.get_mutable_abstract_state(self._held).set_value(braked(robot, q, command))
        return EventStatus.Succeeded()

    def _calc_velocity(self, context: Context, velocity: BasicVector) -> None:
        velocity.SetFromVector(self.held(context).share * self._v.Eval(context))

    def _calc_share(self, context: Context, share: BasicVector) -> None:
        share.SetFromVector([self.held(context).share])
