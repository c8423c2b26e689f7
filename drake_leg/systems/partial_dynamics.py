"""Inverse dynamics of some joints of a plant while its other joints move freely."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from pydrake.autodiffutils import AutoDiffXd
from pydrake.math import inv
from pydrake.multibody.plant import MultibodyPlant, MultibodyPlant_
from pydrake.multibody.tree import Joint, Joint_, MultibodyForces_
from pydrake.systems.framework import BasicVector, Context

from drake_leg.arguments import require_kind, shown
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.systems.block import Block

_ONE_AXIS = ("revolute", "prismatic")


def require_plant(plant: MultibodyPlant) -> None:
    """Require a finalized plant.

    Raises
    ------
    InvalidValueError
        If it is not a plant, or not finalized.
    """
    if not isinstance(plant, MultibodyPlant_[AutoDiffXd]):
        require_kind("the plant", plant, MultibodyPlant)
    if not plant.is_finalized():
        raise InvalidValueError(
            f"the plant {plant.get_name()!r} is not finalized; call its Finalize() before"
        )


def joints_of_one_axis(plant: MultibodyPlant, joints: Iterable[str | Joint]) -> list[Joint]:
    """Look up revolute and prismatic joints by name, in the given order.

    A name is ``instance::joint`` where two models have joints of the same name.

    Raises
    ------
    InvalidValueError
        If no joint is named or one is named twice, if a name fits no joint or several, or if a
        joint is neither revolute nor prismatic.
    """
    require_plant(plant)
    if not isinstance(joints, Iterable):
        raise InvalidValueError(
            f"the joints are {shown(joints)}; they must be a list of joints or of their names"
        )
    named = [joints] if isinstance(joints, str) else list(joints)
    found = [_joint(plant, joint) if isinstance(joint, str) else joint for joint in named]
    for joint in found:
        if not isinstance(joint, Joint | Joint_[AutoDiffXd]) or joint.GetParentPlant() is not plant:
            raise InvalidValueError(
                f"{shown(joint)} is not a joint of the plant {plant.get_name()!r}; give its joints "
                "or their names"
            )
    if not found:
        raise InvalidValueError("no joint is named; name at least one revolute or prismatic joint")
    for index, joint in enumerate(found):
        if joint.type_name() not in _ONE_AXIS:
            raise InvalidValueError(
                f"joint {joint.name()!r} is of the type {joint.type_name()}; only revolute and "
                "prismatic joints may be named here"
            )
        if joint.index() in [other.index() for other in found[:index]]:
            raise InvalidValueError(f"joint {joint.name()!r} is named twice; name it once")
    return found


def _joint(plant: MultibodyPlant, name: str) -> Joint:
    instance, _, own = name.rpartition("::")
    every = [plant.get_joint(index) for index in plant.GetJointIndices()]
    named = [
        joint
        for joint in every
        if joint.name() == own
        and instance in ("", plant.GetModelInstanceName(joint.model_instance()))
    ]
    if len(named) == 1:
        return named[0]
    if named:
        first = plant.GetModelInstanceName(named[0].model_instance())
        raise InvalidValueError(
            f"there are {len(named)} joints {name!r}; say which, as {f'{first}::{own}'!r}"
        )
    names = ", ".join(joint.name() for joint in every if joint.type_name() in _ONE_AXIS)
    raise InvalidValueError(f"there is no joint {name!r}; those of one axis are {names or 'none'}")


class PartialInverseDynamics(Block):
    """Computes the forces that give some joints D their accelerations, the others U being free.

    ``M_UU a_U = f_U - C_U - M_UD a_D`` and ``tau_D = M_DD a_D + M_DU a_U + C_D - f_D``, where
    f sums gravity, springs, dampers and the forces at the inputs.

    ============================= ===== ======== ============================================
    port                          kind  size     meaning
    ============================= ===== ======== ============================================
    ``state``                     in    nq + nv  the plant's state
    ``acceleration``              in    n        of the joints D [rad/s^2 or m/s^2]
    ``actuation``                 in    nu       the same signal as at the plant's port
    ``applied_generalized_force`` in    nv       of other blocks, passed on to the plant
    ``applied_spatial_force``     in    abstract the same signal as at the plant's port
    ``contact_force``             in    nv       from the plant's generalized contact forces
    ``torque``                    out   n        tau_D [N*m or N], in the order of ``joints``
    ``generalized_force``         out   nv       tau_D and ``applied_generalized_force``, for the
                                                 plant's ``applied_generalized_force``
    ============================= ===== ======== ============================================

    All inputs but the first two are optional. Actuation is clipped to the actuators' effort limits,
    as in the plant. The block computes in a scratch context of the plant; nothing in it outlives a
    call.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized, continuous, with default parameters.
    joints : sequence of Joint
        D, each of one axis.

    Raises
    ------
    InvalidValueError
        If the plant has constraints; while simulating, if the joints U have no mass to move.
    """

    def __init__(self, plant: MultibodyPlant, joints: Sequence[Joint]) -> None:
        Block.__init__(self, plant, joints)
        if plant.num_constraints():
            raise InvalidValueError(
                f"{plant.get_name()!r} has {plant.num_constraints()} constraints between its "
                "joints; a motion can drive joints of a plant without constraints only"
            )
        self._plant = plant
        self._scratch = plant.CreateDefaultContext()
        self._forces = MultibodyForces_(plant)  # scratch, too
        nv = plant.num_velocities()
        self._driven = [joint.velocity_start() for joint in joints]
        self._others = [index for index in range(nv) if index not in self._driven]
        self._actuation_matrix = plant.MakeActuationMatrix()
        self._efforts = np.array(
            [plant.get_joint_actuator(i).effort_limit() for i in plant.GetJointActuatorIndices()]
        )
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self._acceleration = self.DeclareVectorInputPort("acceleration", len(joints))
        self._actuation = self.DeclareVectorInputPort("actuation", plant.num_actuators())
        self._applied = self.DeclareVectorInputPort("applied_generalized_force", nv)
        self._spatial = self.DeclareAbstractInputPort(
            "applied_spatial_force",
            plant.AllocateInputAbstract(plant.get_applied_spatial_force_input_port()),
        )
        self._contact = self.DeclareVectorInputPort("contact_force", nv)
        inputs = (
            self._state,
            self._acceleration,
            self._actuation,
            self._applied,
            self._spatial,
            self._contact,
        )
        used = {port.ticket() for port in inputs}
        self._torque = self.DeclareVectorOutputPort("torque", len(joints), self._calc_torque, used)
        self.DeclareVectorOutputPort("generalized_force", nv, self._calc_generalized_force, used)

    def _calc_torque(self, context: Context, torque: BasicVector) -> None:
        plant, scratch, driven, others = self._plant, self._scratch, self._driven, self._others
        plant.SetPositionsAndVelocities(scratch, self._state.Eval(context))
        acceleration = self._acceleration.Eval(context)
        vdot = np.zeros(plant.num_velocities(), dtype=acceleration.dtype)
        vdot[driven] = acceleration
        self._set_forces(context)
        tau = plant.CalcInverseDynamics(scratch, vdot, self._forces) - self._generalized(context)
        if others:
            M = plant.CalcMassMatrix(scratch)
            tau = tau + M[:, others] @ self._solved(M[np.ix_(others, others)], -tau[others])
        torque.SetFromVector(tau[driven])

    def _calc_generalized_force(self, context: Context, force: BasicVector) -> None:
        torque = self._torque.Eval(context)
        total = np.zeros(force.size(), dtype=torque.dtype)
        total[self._driven] = torque
        if self._applied.HasValue(context):
            total += self._applied.Eval(context)
        force.SetFromVector(total)

    def _set_forces(self, context: Context) -> None:
        """Sum gravity, springs, dampers and spatial forces in ``self._forces``."""
        plant, scratch, forces = self._plant, self._scratch, self._forces
        plant.CalcForceElementsContribution(scratch, forces)
        if self._spatial.HasValue(context):
            for applied in self._spatial.Eval(context):
                body = plant.get_body(applied.body_index)
                p_BoBq_W = body.EvalPoseInWorld(scratch).rotation() @ applied.p_BoBq_B
                body.AddInForce(scratch, p_BoBq_W, applied.F_Bq_W, plant.world_frame(), forces)

    def _generalized(self, context: Context) -> Array:
        """Sum the generalized forces at the inputs, (nv,)."""
        total: Array = np.zeros(self._plant.num_velocities())
        for port in (self._applied, self._contact):
            if port.HasValue(context):
                total = total + port.Eval(context)
        if self._actuation.HasValue(context):
            actuation = np.clip(self._actuation.Eval(context), -self._efforts, self._efforts)
            total = total + self._actuation_matrix @ actuation
        return total

    def _solved(self, M_UU: Array, forces: Array) -> Array:
        if M_UU.dtype == object:  # AutoDiffXd
            solution: Array = inv(M_UU) @ forces
            return solution
        try:
            return np.asarray(np.linalg.solve(M_UU, forces), dtype=np.float64)
        except np.linalg.LinAlgError:
            raise InvalidValueError(
                f"the joints of {self._plant.get_name()!r} that no motion drives move nothing that "
                "has mass; give it a mass, or drive them too"
            ) from None
