"""Robots with random bodies, and Drake's dynamics of robots."""

import math
from dataclasses import dataclass

import numpy as np

from drake_leg import build_plant
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.solids import Inertial
from drake_leg.units import STANDARD_GRAVITY

RX_90 = (
    Row(joint="revolute"),
    Row(joint="revolute", alpha=math.pi / 2),
    Row(joint="revolute", d=0.45),
    Row(joint="revolute", alpha=-math.pi / 2, r=0.45),
    Row(joint="revolute", alpha=math.pi / 2),
    Row(joint="revolute", alpha=-math.pi / 2),
)
ODD = (
    Row(joint="prismatic", d=0.1, alpha=0.3, r=-0.2, theta=1.1),
    Row(joint="fixed", d=-0.4, alpha=-2.0, r=0.05, theta=math.pi / 3),
    Row(joint="revolute", alpha=math.pi / 4, theta=-0.7),
    Row(joint="prismatic", d=0.25, theta=-math.pi / 2),
    Row(joint="revolute", d=0.3, r=0.1, alpha=0.5),
    Row(joint="fixed", alpha=math.pi, r=0.2),
)
FORK = (
    Row(joint="revolute", alpha=0.4, r=0.2),
    Row(joint="revolute", d=0.1, alpha=1.1, gamma=0.5, b=0.03),
    Row(joint="prismatic", d=0.09, alpha=-0.7, gamma=-0.8, antecedent=1),
    Row(joint="revolute", alpha=math.pi / 2, d=0.1),
    Row(joint="revolute", alpha=0.2, d=0.2, antecedent=0),
)


def body(rng, name):
    """A link with mass, its inertia about tilted axes."""
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    inertia = axes @ np.diag(rng.uniform(1.0, 2.0, 3)) @ axes.T
    return Link(
        name=name,
        inertial=Inertial(
            mass=rng.uniform(1.0, 3.0),
            centre=tuple(rng.normal(size=3)),
            moments=tuple(np.diag(inertia)),
            products=(inertia[0, 1], inertia[0, 2], inertia[1, 2]),
        ),
    )


def robot_of(rows, rng, **base):
    """A robot with random bodies and friction, from its table."""
    segments = []
    for number, row in enumerate(rows, start=1):
        damping = 0.0 if row.joint == "fixed" else rng.uniform(0.0, 1.0)
        segments.append(
            Segment(
                row=row,
                joint=f"joint_{number}",
                link=body(rng, f"link_{number}"),
                mechanics=JointMechanics(damping=damping),
            )
        )
    if base.get("floating"):
        base["base_link"] = body(rng, "trunk")
    return Robot(name="robot", title="a robot", source="a test", segments=tuple(segments), **base)


@dataclass
class InDrake:
    """What Drake's plant says about a random state, a floating base's six numbers in frame 0."""

    motion: tuple  # inputs of an inverse model
    mass_matrix: np.ndarray
    bias: np.ndarray
    gravity: np.ndarray
    torques: np.ndarray  # of everything, friction included
    accelerations: np.ndarray


def in_drake(robot, rng):
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    q = rng.uniform(-2.0, 2.0, plant.num_positions())
    v, a = rng.uniform(-2.0, 2.0, (2, plant.num_velocities()))
    if robot.floating:
        q[:4] /= np.linalg.norm(q[:4])
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    joints = plant.num_velocities() - len(robot.moving)
    X = np.eye(plant.num_velocities())
    motion = (q[-len(robot.moving) :], v[joints:], a[joints:])
    if robot.floating:
        R_W0 = plant.GetFrameByName("frame_0").CalcPoseInWorld(context).rotation().matrix()
        X[:3, :3] = X[3:6, 3:6] = R_W0.T
        w0, wd0, vd0 = R_W0.T @ v[:3], R_W0.T @ a[:3], R_W0.T @ a[3:6]
        motion += (w0, wd0, vd0, R_W0.T @ [0, 0, -STANDARD_GRAVITY])
    M = X @ plant.CalcMassMatrix(context) @ X.T
    bias = X @ plant.CalcBiasTerm(context)
    gravity = -X @ plant.CalcGravityGeneralizedForces(context)
    friction = np.zeros(len(v))
    friction[joints:] = [s.mechanics.damping for s in robot.moving] * v[joints:]
    return InDrake(
        motion=motion,
        mass_matrix=M,
        bias=bias,
        gravity=gravity,
        torques=M @ X @ a + bias + gravity + friction,
        accelerations=X @ a,
    )
