"""Joint torques along a recorded motion, by Drake's inverse dynamics and by the mass matrix."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces

from drake_leg.kinematics.joint_stop import limit_force
from drake_leg.kinematics.khalil import Array
from drake_leg.models.plant import build_plant
from drake_leg.robot.robot import Robot
from drake_leg.simulation.run import Run
from drake_leg.systems.prescribed_motion import A_MOTION, require_actuators


def torques_along(robot: Robot, gravity: float, run: Run) -> Array:
    """Torques that move the joints along a run: Drake's inverse dynamics, (rows, n) [N*m or N].

    They overcome inertia, gravity, springs and dampers, and the force of joint stops.
    """
    plant = kept_plant(robot, gravity)
    context, forces = plant.CreateDefaultContext(), MultibodyForces(plant)
    q, qdot, qddot = (
        run.scopes[f"joint {name}"] for name in ("positions", "velocities", "accelerations")
    )
    torques = np.empty_like(q)
    for row, state in enumerate(np.hstack([q, qdot])):
        plant.SetPositionsAndVelocities(context, state)
        plant.CalcForceElementsContribution(context, forces)
        torques[row] = plant.CalcInverseDynamics(context, qddot[row], forces)
    for index, segment in enumerate(robot.moving):
        torques[:, index] -= limit_force(segment.mechanics, q[:, index], qdot[:, index])
    return torques


def torques_by_equation(robot: Robot, gravity: float, run: Run) -> Array:
    """The same torques by the equation of motion, from the mass matrix, (rows, n) [N*m or N].

    ``M qddot + C qdot - tau_g + d qdot + k (q - q_0)``, less the force of joint stops.
    """
    plant = kept_plant(robot, gravity)
    context = plant.CreateDefaultContext()
    q, qdot, qddot = (
        run.scopes[f"joint {name}"] for name in ("positions", "velocities", "accelerations")
    )
    torques = np.empty_like(q)
    for row, state in enumerate(np.hstack([q, qdot])):
        plant.SetPositionsAndVelocities(context, state)
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        torques[row] = plant.CalcMassMatrix(context) @ qddot[row] + bias
    for index, segment in enumerate(robot.moving):
        acting, at, rate = segment.mechanics, q[:, index], qdot[:, index]
        spring = acting.spring_stiffness * (at - acting.equilibrium_position)
        torques[:, index] += acting.damping * rate + spring - limit_force(acting, at, rate)
    return torques


def kept_plant(robot: Robot, gravity: float) -> MultibodyPlant:
    """A robot's plant, kept for the next run unless the robot has an inertia in an array."""
    try:
        hash(robot)
    except TypeError:
        return _new_plant(robot, gravity)
    return _kept_plant(robot, gravity)


def _new_plant(robot: Robot, gravity: float) -> MultibodyPlant:
    plant = build_plant(robot, gravity=gravity)
    if not any(segment.mechanics.stops for segment in robot.moving):
        require_actuators(plant, A_MOTION)
    return plant


_kept_plant = lru_cache(maxsize=8)(_new_plant)
