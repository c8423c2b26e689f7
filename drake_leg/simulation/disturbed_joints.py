"""The equation of motion of joints that something keeps from following their motion.

It is what the diagrams of legs and arms compute with their blocks between the command and the
plant: the inverse Jacobian at the sensed joints, the integrators, the pull of the joints onto their
motion, the torque limit, the push, and the plant's dynamics.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, JacobianWrtVariable, MultibodyForces
from scipy.linalg.lapack import dposv

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.kinematic_loop import equation_of
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.movable import Floats
from drake_leg.simulation.torques import kept_plant
from drake_leg.singularity.look_ahead import LookAhead

LOOK = 1e-4  # [rad or m] of the fastest joint: shows where the determinant goes
AT_ORIGIN = np.zeros(3)


class Driven(NamedTuple):
    """Accelerations and torques of the joints at one instant, (n,) each."""

    vdot: Array  # [rad/s^2 or m/s^2]
    asked: Array  # [N*m or N], for the masses that are believed
    given: Array  # [N*m or N], after the torque limit


class DisturbedJoints:
    """``M(q) vdot + C(q, v) = tau + J^T F`` of n joints that are pulled onto their motion.

    The state is x = (prescribed positions, positions, velocities), (3 n,).

    A torque at its limit has a side, 1 or -1, and one below it has 0. Between two ``flip``, the
    equation is smooth.

    Parameters
    ----------
    config : HexabotLegConfig, EllipseConfig or ScaraConfig
        Its joints have actuators, no stops and no input filters, and are fed back as sensed.
    """

    def __init__(self, config: HexabotLegConfig | ScaraConfig) -> None:
        robot, disturbance = config.robot, config.disturbance
        self.equation = equation_of(config)
        self._n = len(robot.moving)
        self.sides, self._is_limited = np.zeros(self._n), False
        self._limit = math.inf if disturbance.torque_limit is None else disturbance.torque_limit
        self._push = disturbance.push
        self.has_limit = self._limit < math.inf
        self._true = self._believed = _Dynamics(kept_plant(robot, config.gravity))
        if disturbance.mass_error:
            self._believed = _Dynamics(kept_plant(disturbance.believed(robot), config.gravity))
        self._knows = self._believed is self._true
        self._foot = self._true.plant.GetFrameByName(f"frame_{len(robot.segments)}")
        self._pull = config.control.pull(disturbance)
        self._brake = 2.0 * math.sqrt(self._pull)
        self._at_rest = [config.lift] if isinstance(config, ScaraConfig) else []
        self._still = [0.0] * len(self._at_rest)
        q = [*config.start, *self._at_rest]
        qdot = self.equation.sensed(0.0, config.start).qdot
        self._determinant = self.equation.robot.determinant(config.start)
        self.start = np.array([*q, *q, *qdot, *self._still])

    def rates(self, time: float, x: Array) -> Array:
        """Derivative of the state; no numbers where the state has none.

        Raises
        ------
        SingularConfigurationError
            Where J has no inverse.
        """
        numbers = x.tolist()
        if not math.isfinite(sum(numbers)):
            return np.full_like(x, math.nan)
        qdot, wanted = self._wanted(time, numbers)
        v = numbers[2 * self._n :]
        if self._knows and not self._is_limited and not self._is_pushed(time):
            return np.array([*qdot, *v, *wanted])
        qv = x[self._n :]
        given = self._given(self._believed.at(qv).torques(wanted), self.sides)
        return np.array([*qdot, *v, *self._accelerations(time, qv, given)])

    def driven(self, time: float, x: Array) -> Driven:
        """Accelerations and torques."""
        qv, wanted = x[self._n :], np.array(self._wanted(time, x.tolist())[1])
        asked = self._believed.at(qv).torques(wanted)
        sides = np.sign(asked) * (np.abs(asked) > self._limit)
        if self._knows and not sides.any() and not self._is_pushed(time):
            return Driven(wanted, asked, asked)
        given = self._given(asked, sides)
        return Driven(self._accelerations(time, qv, given), asked, given)

    def asked(self, time: float, x: Array) -> Array:
        """Torques for the masses that are believed, (n,) [N*m or N]."""
        return self._believed.at(x[self._n :]).torques(self._wanted(time, x.tolist())[1])

    def next_sides(self, asked: Array) -> Array:
        """Sides to which torques that are asked for have come, or come next, (n,)."""
        sides = np.sign(asked) * (np.abs(asked) > self._limit)
        return np.where(sides * self.sides < 0.0, 0.0, sides)

    def may_change(self, before: Array, after: Array) -> bool:
        """Whether a torque may change its side between two instants at which it is asked for.

        Where it is nearer to an edge than it is from one instant to the other, it may.
        """
        near = np.abs(after - before)
        at_edge = np.minimum(np.abs(after - self._limit), np.abs(after + self._limit)) < near
        return bool(at_edge.any() or (self.next_sides(after) != self.sides).any())

    def excess(self, asked: float, joint: int, side: float) -> float:
        """How far a torque is on the way to another side, from where it changes to it."""
        at = self.sides[joint]
        return side * asked - self._limit if side else self._limit - float(at) * asked

    def put(self, joint: int, side: float) -> None:
        """Let a torque reach its limit, or leave it."""
        self.sides[joint] = side
        self._is_limited = bool(self.sides.any())

    def time_left(self, x: Array) -> float:
        """Time until the determinant would be zero if it went on as it does [s].

        Raises
        ------
        SingularConfigurationError
            Where it has changed its sign.
        """
        robot = self.equation.robot
        _, q, v = (part[: robot.joints].tolist() for part in self.parts(x))
        if robot.determinant(q) * self._determinant <= 0.0:
            raise robot.singular(q)
        fastest = max(map(abs, v))
        ahead = LookAhead(robot.determinant, q, v, None)
        return ahead.time_left(LOOK / fastest) if fastest else math.inf

    def singular(self, time: float, x: Array) -> SingularConfigurationError:
        """Say that a state is singular."""
        robot = self.equation.robot
        return robot.singular(self.parts(x)[1][: robot.joints].tolist(), time)

    def parts(self, x: Array) -> tuple[Array, Array, Array]:
        """Prescribed positions, positions and velocities, (n,) or (n, rows) each."""
        n = self._n
        return x[:n], x[n : 2 * n], x[2 * n :]

    def _wanted(self, time: float, x: Floats) -> tuple[list[float], list[float]]:
        """Rates of the prescribed positions, and accelerations that are asked for, (n,) each."""
        n, m, pull, brake = self._n, self.equation.joints, self._pull, self._brake
        prescribed, q, v = x[:n], x[n : 2 * n], x[2 * n :]
        at = self.equation.sensed(time, q[:m], v[:m])
        qdot, qddot = [*at.qdot, *self._still], [*(at.qddot or ()), *self._still]
        return qdot, [
            qddot[i] + brake * (qdot[i] - v[i]) + pull * (prescribed[i] - q[i]) for i in range(n)
        ]

    def _given(self, asked: Array, sides: Array) -> Array:
        """Torques of which those with a side are at their limit, (n,)."""
        return np.where(sides, sides * self._limit, asked) if self.has_limit else asked

    def _is_pushed(self, time: float) -> bool:
        return self._push is not None and self._push.at < time < self._push.end

    def _accelerations(self, time: float, qv: Array, torques: Array) -> Array:
        at = self._true.at(qv)
        if self._push is not None and self._is_pushed(time):
            torques = torques + at.torques_of(self._foot, self._push.at_time(time))
        return at.accelerations(torques)


class _Dynamics:
    """A plant's dynamics, in a context of its own."""

    def __init__(self, plant: MultibodyPlant) -> None:
        self.plant = plant
        self._context, self._forces = plant.CreateDefaultContext(), MultibodyForces(plant)
        self._still = np.zeros(plant.num_velocities())

    def at(self, qv: Array) -> _Dynamics:
        """Set positions and velocities (2 n,), and return this object."""
        self.plant.SetPositionsAndVelocities(self._context, qv)
        self.plant.CalcForceElementsContribution(self._context, self._forces)
        return self

    def torques(self, vdot: Array | list[float]) -> Array:
        """Torques that accelerate the joints so, beside springs, dampers and gravity, (n,)."""
        torques: Array = self.plant.CalcInverseDynamics(self._context, vdot, self._forces)
        return torques

    def accelerations(self, torques: Array) -> Array:
        """Accelerations that torques cause, (n,); no numbers where nothing has mass."""
        M = self.plant.CalcMassMatrix(self._context)
        _, vdot, info = dposv(M, torques - self.torques(self._still))
        return np.full_like(torques, math.nan) if info else vdot

    def torques_of(self, frame: Frame, force: Array) -> Array:
        """Torques of a force at the origin of a frame, both in the world, (n,)."""
        world = self.plant.world_frame()
        Jv = self.plant.CalcJacobianTranslationalVelocity(
            self._context, JacobianWrtVariable.kV, frame, AT_ORIGIN, world, world
        )
        torques: Array = Jv.T @ force
        return torques
