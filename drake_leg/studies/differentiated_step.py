"""A straight step simulated in AutoDiffXd: its state, and what follows from it, with derivatives.

The loop of the leg's diagram, command, inverse Jacobian and integrator, is built for AutoDiffXd and
stepped as the run was. Torques are those of inverse dynamics along the motion, in a plant whose
lengths, masses and damping are parameters of its Context.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from pydrake.autodiffutils import AutoDiffXd
from pydrake.math import RigidTransform_
from pydrake.multibody.tree import MultibodyForces_, SpatialInertia_
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator_
from pydrake.systems.framework import BasicVector, Context, DiagramBuilder_
from pydrake.systems.primitives import Integrator_

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.differentiable import value_of
from drake_leg.kinematics.joint_stop import limit_force
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.leg import DifferentiableLeg, LegGeometry, MovableLeg
from drake_leg.kinematics.movable import Movable
from drake_leg.models.plant import build_plant
from drake_leg.robot.solids import Brick, Sphere
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.systems.block import Block, differentiable
from drake_leg.systems.inverse_jacobian import InverseJacobian

Scalar = Any  # AutoDiffXd, which has no stub
REPEATED = 1e-9  # of the greatest singular value: two that are nearer count as one


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """What a step depends on, in SI units; every number is an AutoDiffXd."""

    amplitude: Scalar  # [m/s]
    frequency: Scalar  # [rad/s]
    direction: list[Scalar]  # not necessarily of length 1
    start: list[Scalar]  # of the joints [rad or m]
    gravity: Scalar  # [m/s^2]
    lengths: list[Scalar]  # l1, l2, l3 of the reports' leg [m]; empty for other robots
    density: Scalar  # of its solids [kg/m^3]
    damping: Scalar  # of its joints [N*m*s/rad]

    @property
    def along(self) -> Array:
        """The direction with length 1, (3,)."""
        d = np.array(self.direction)
        along: Array = d / (d @ d) ** 0.5
        return along


class State(NamedTuple):
    """The joints at an instant, (n,) each."""

    time: float  # [s]
    q: list[Scalar]  # [rad or m]
    qdot: list[Scalar]
    qddot: list[Scalar]


class _Command(Block):
    """The command ``A sin(w t) d``: a Sine block whose parameters carry derivatives."""

    def __init__(self, numbers: Numbers, task: Array) -> None:
        Block.__init__(self, numbers, task)
        self._numbers, self._along = numbers, task @ numbers.along
        self.DeclareVectorOutputPort("velocity", len(self._along), self._calc, {self.time_ticket()})

    def at(self, time: Scalar) -> tuple[Array, Array]:
        """Velocity and acceleration at an instant."""
        amplitude, frequency = self._numbers.amplitude, self._numbers.frequency
        phase = frequency * time
        v, a = amplitude * phase.sin(), amplitude * frequency * phase.cos()
        return v * self._along, a * self._along

    def _calc(self, context: Context, velocity: BasicVector) -> None:
        velocity.SetFromVector(self.at(context.get_time())[0])


class DifferentiatedStep:
    """The step of a diagram's config, undisturbed and exactly inverted, for given numbers."""

    def __init__(
        self, config: HexabotLegConfig, numbers: Numbers, settings: IntegratorSettings
    ) -> None:
        self._config, self._numbers, self._settings = config, numbers, settings
        self.moved = _moved(config.movable, numbers)
        self._command = self._new_command()
        self._lengths = np.array(config.movable.row_lengths)
        self._torques: _Torques | None = None

    def states(self, rows: Sequence[float], times: Sequence[float]) -> Iterator[State]:
        """Simulate, and yield the state at some ascending times [s].

        ``rows`` are the run's own instants, so that the steps are the run's.
        """
        builder = DiagramBuilder_[AutoDiffXd]()
        command = builder.AddSystem(self._new_command())
        inverse = builder.AddSystem(differentiable(InverseJacobian)(self.moved))
        integrator = builder.AddSystem(Integrator_[AutoDiffXd](len(self._numbers.start)))
        builder.Connect(command.get_output_port(), inverse.GetInputPort("v"))
        builder.Connect(inverse.GetOutputPort("qdot"), integrator.get_input_port())
        builder.Connect(integrator.get_output_port(), inverse.GetInputPort("q"))
        simulator = Simulator_[AutoDiffXd](builder.Build())
        ResetIntegratorFromFlags(simulator, self._settings.scheme, self._settings.max_step)
        simulator.get_mutable_integrator().set_fixed_step_mode(True)
        context = simulator.get_mutable_context()
        context.SetContinuousState(self._numbers.start)
        simulator.Initialize()
        wanted = set(times)
        for time in sorted({*rows, *times}):
            simulator.AdvanceTo(time)
            if time in wanted:
                yield self.state(
                    time, context.get_continuous_state_vector().CopyToVector().tolist()
                )
            if time >= max(times):
                return

    def _new_command(self) -> Any:  # noqa: ANN401 - a system of another scalar type
        return differentiable(_Command)(self._numbers, self._config.movable.twists[3:].T)

    def state(self, time: float, q: list[Scalar]) -> State:
        """Return the state at a time [s] with the joints at q (n,)."""
        v, a = self._command.at(AutoDiffXd(time))
        qdot = self.moved.rates(q, v.tolist())
        qddot = self.moved.accelerations(q, qdot, a.tolist())
        return State(time, q, list(qdot), list(qddot))

    def turning(self, scalars: Sequence[Scalar] | Array) -> Array:
        """Choose those of the joints that turn."""
        turning: Array = np.asarray(scalars)[np.array(self.moved.turning)]
        return turning

    def foot(self, state: State) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""
        return self.moved.foot(state.q)

    def along(self, state: State) -> Scalar:
        """Coordinate of the foot along the direction of the step [m]."""
        return (self.foot(state) - self.moved.foot(self._numbers.start)) @ self._numbers.along

    def determinant(self, state: State) -> Scalar:
        """Det J."""
        return self.moved.determinant(state.q)

    def sigma_min(self, state: State) -> Scalar:
        """Smallest singular value of J, its rows scaled to lengths [m]: ``u^T J v``.

        u and v are its singular vectors, which contribute nothing to first order.
        """
        J = self._lengths[:, np.newaxis] * self.moved.jacobian(state.q)
        U, sigma, Vt = np.linalg.svd(np.vectorize(value_of)(J), full_matrices=False)
        if len(sigma) > 1 and sigma[-2] - sigma[-1] <= REPEATED * sigma[0]:
            raise InvalidValueError(
                f"at {state.time:g} s the two smallest singular values are both {sigma[-1]:.6g} m; "
                "the smallest one has no derivative there",
                advice="choose other values of the options",
            )
        return U[:, -1] @ J @ Vt[-1]

    def torques(self, state: State) -> Array:
        """Torques of the joints, (n,) [N*m or N]."""
        if self._torques is None:
            self._torques = _Torques(self._config, self._numbers)
        return self._torques.at(state)


class _Torques:
    """Inverse dynamics of a plant with parameters that carry derivatives."""

    def __init__(self, config: HexabotLegConfig, numbers: Numbers) -> None:
        self._gravity = numbers.gravity
        self._mechanics = [segment.mechanics for segment in config.robot.moving]
        self._plant = build_plant(config.robot, gravity=1.0).ToAutoDiffXd()
        self._context = self._plant.CreateDefaultContext()
        self._forces = MultibodyForces_[AutoDiffXd](self._plant)
        if numbers.lengths:
            self._set_parameters(config, numbers)

    def at(self, state: State) -> Array:
        """Torques for a state; gravity, 1 m/s^2 in the plant, acts linearly."""
        plant, context = self._plant, self._context
        plant.SetPositions(context, state.q)
        plant.SetVelocities(context, state.qdot)
        plant.CalcForceElementsContribution(context, self._forces)
        torques = plant.CalcInverseDynamics(context, np.array(state.qddot), self._forces)
        weights = plant.CalcGravityGeneralizedForces(context)
        stops = np.array(
            [
                limit_force(*joint)
                for joint in zip(self._mechanics, state.q, state.qdot, strict=True)
            ]
        )
        total: Array = torques + (1.0 - self._gravity) * weights - stops
        return total

    def _set_parameters(self, config: HexabotLegConfig, numbers: Numbers) -> None:
        """Give the reports' leg its lengths, masses and damping."""
        plant, context = self._plant, self._context
        links = [segment.link for segment in config.robot.segments]
        for length, joint in zip(numbers.lengths, config.robot.segments[1:], strict=True):
            frame = plant.GetFrameByName(f"{joint.joint}_parent")
            R_PF = frame.GetPoseInParentFrame(context).rotation()
            p_PF = np.array([length, AutoDiffXd(0.0), AutoDiffXd(0.0)])
            frame.SetPoseInParentFrame(context, RigidTransform_[AutoDiffXd](R_PF, p_PF))
        for link, length in zip(links, [*numbers.lengths, None], strict=True):
            if link is not None and link.solid is not None:
                inertia = _inertia(link.solid.shape, numbers.density, length)
                plant.GetBodyByName(link.name).SetSpatialInertiaInBodyFrame(context, inertia)
        for segment in config.robot.moving:
            plant.GetJointByName(segment.joint).SetDamping(context, numbers.damping)


def _moved(movable: Movable, numbers: Numbers) -> Movable:
    if isinstance(movable, MovableLeg) and isinstance(movable.geometry, LegGeometry):
        return DifferentiableLeg(movable.geometry, numbers.lengths)
    return movable.differentiable()


def _inertia(shape: object, density: Scalar, length: Scalar) -> Scalar:
    """Inertia of a brick that begins at the body's origin, or of a sphere around it."""
    inertia = SpatialInertia_[AutoDiffXd]
    if isinstance(shape, Brick):
        width, height = AutoDiffXd(shape.width), AutoDiffXd(shape.height)
        zero = AutoDiffXd(0.0)
        brick = inertia.SolidBoxWithDensity(density, length, width, height)
        return brick.Shift(np.array([-0.5 * length, zero, zero]))
    assert isinstance(shape, Sphere)
    return inertia.SolidSphereWithDensity(density, AutoDiffXd(shape.radius))
