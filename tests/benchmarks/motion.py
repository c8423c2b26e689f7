"""The step that all contenders make: leg B, 70 mm/s, 1 rad/s, in Python's math and in NumPy."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from pydrake.multibody.tree import MultibodyForces

from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.kinematics.motions import SineStep
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_B, LEG_B_POSTURE

LEG = LegGeometry.from_robot(LEG_B)
Q0 = tuple(map(math.radians, LEG_B_POSTURE))
STEP = SineStep()
DURATION = 20.0  # [s]
ROW = 0.040  # [s], of a classical Runge-Kutta step and of a table of torques

A, W = STEP.amplitude, STEP.frequency
L1, L2, L3, SIGN = LEG.l1, LEG.l2, LEG.l3, LEG.sign
AHEAD = np.array(STEP.direction)


def rates_at(v, q1, q2, q3):
    """Joint rates for a speed of the foot along x, as lean as Python allows."""
    c23 = math.cos(q2 + q3)
    across = L2 * math.cos(q2) + L3 * c23
    radial, s3 = math.cos(q1) * v, math.sin(q3)
    return (
        -math.sin(q1) * v / (L1 + across),
        c23 * radial / (L2 * s3),
        -across * radial / (L2 * L3 * s3),
    )


def rates(t, q):
    """Right side of the loop: sine, then inverse Jacobian, in math."""
    q1, q2, q3 = q.tolist()
    return rates_at(A * math.sin(W * t), q1, q2, q3)


def accelerations_at(a, q1, q2, q3, w1, w2, w3):
    """Joint accelerations for an acceleration of the foot along x, as lean as Python allows."""
    w23, q23, c1, s1, s3 = w2 + w3, q2 + q3, math.cos(q1), math.sin(q1), math.sin(q3)
    c23, s23 = math.cos(q23), math.sin(q23)
    x2, z2, x3, z3 = L2 * math.cos(q2), L2 * math.sin(q2), L3 * c23, L3 * s23
    reach = L1 + x2 + x3
    radial = c1 * a + x2 * w2 * w2 + x3 * w23 * w23 + reach * w1 * w1
    vertical = z2 * w2 * w2 + z3 * w23 * w23
    return (
        (2.0 * (z2 * w2 + z3 * w23) * w1 - s1 * a) / reach,
        (c23 * radial + s23 * vertical) / (L2 * s3),
        -((x2 + x3) * radial + (z2 + z3) * vertical) / (L2 * L3 * s3),
    )


def jacobian(q):
    """Jacobian in NumPy, (3, 3)."""
    c1, s1 = np.cos(q[0]), np.sin(q[0])
    x3, z3 = L3 * np.cos(q[1] + q[2]), L3 * np.sin(q[1] + q[2])
    x, z = L2 * np.cos(q[1]) + x3, L2 * np.sin(q[1]) + z3
    reach = L1 + x
    return np.array(
        [
            [-s1 * reach, -c1 * z, -c1 * z3],
            [c1 * reach, -s1 * z, -s1 * z3],
            [0.0, SIGN * x, SIGN * x3],
        ]
    )


def bias(q, w):
    """``dJ/dt qdot`` in NumPy, (3,)."""
    c1, s1, w23 = np.cos(q[0]), np.sin(q[0]), w[1] + w[2]
    x2, z2 = L2 * np.cos(q[1]), L2 * np.sin(q[1])
    x3, z3 = L3 * np.cos(q[1] + q[2]), L3 * np.sin(q[1] + q[2])
    radial = -x2 * w[1] ** 2 - x3 * w23**2 - (L1 + x2 + x3) * w[0] ** 2
    tangential = -2.0 * (z2 * w[1] + z3 * w23) * w[0]
    vertical = -SIGN * (z2 * w[1] ** 2 + z3 * w23**2)
    return np.array([c1 * radial - s1 * tangential, s1 * radial + c1 * tangential, vertical])


def rates_numpy(t, q):
    """Right side of the loop as many would write it."""
    return np.linalg.solve(jacobian(q), AHEAD * (A * np.sin(W * t)))


def accelerations(t, q, qdot):
    """Joint accelerations ``J^-1 (a - dJ/dt qdot)``, (3,)."""
    a = AHEAD * (A * W * math.cos(W * t))
    return np.linalg.solve(jacobian(q), a - bias(q, qdot))


def foot_error(time, q):
    """Greatest distance of the foot from its exact path [m]; q is (rows, 3)."""
    off = foot_position(LEG, q) - foot_position(LEG, Q0) - STEP.displacement(time)
    return float(np.linalg.norm(off, axis=1).max())


def exact_positions(time):
    """Closed-form joint angles along the path, (rows, 3) [rad]."""
    return inverse_kinematics(LEG, foot_position(LEG, Q0) + STEP.displacement(time), like=Q0)


def torque_error(time, torques):
    """Greatest difference from Drake's inverse dynamics along the exact motion [N m]."""
    return float(np.abs(torques - _exact_torques(tuple(time))).max())


@cache
def _exact_torques(time):
    """Torques at the exact positions, rates and accelerations, (rows, 3) [N m]."""
    plant = build_plant(LEG_B)
    context = plant.CreateDefaultContext()
    forces = MultibodyForces(plant)
    positions = exact_positions(np.array(time))
    found = np.empty_like(positions)
    for row, (t, q) in enumerate(zip(time, positions, strict=True)):
        qdot = rates_numpy(t, q)
        plant.SetPositions(context, q)
        plant.SetVelocities(context, qdot)
        plant.CalcForceElementsContribution(context, forces)
        found[row] = plant.CalcInverseDynamics(context, accelerations(t, q, qdot), forces)
    return found
