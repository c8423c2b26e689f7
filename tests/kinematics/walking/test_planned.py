"""What planned walks ask for: against Drake and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pydrake.math import RigidTransform

from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Attitude, Command, Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.margins import support_margin
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.kinematics.walking.weights import pseudo_inertias, total_mass
from drake_leg.models.plant import build_plant
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.solids import Inertial

ARC = Command(forward=0.08, sideways=0.02, turning=0.25, start=1.0)
LEANING = Attitude(roll=0.04, pitch=-0.05, shift=(0.01, 0.0, 0.005), start=1.2)


def planned(times, *commands, attitudes=(), gait="tripod", period=1.0, robot=HEXABOT, **others):
    legs = Legs.of(robot)
    feet = legs.feet(np.reshape(starting_posture(robot), (-1, 3)))
    height = -feet[:, 2].mean()
    feet[:, 2] = 0.0
    standing = Attitude(shift=(0.0, 0.0, height), start=-1.0)
    walk = Walk(
        gait=GAITS[gait], period=period, neutral=feet, commands=commands,
        attitudes=(standing, *attitudes),
    )  # fmt: skip
    return PlannedWalk(robot=robot, legs=legs, walk=walk, times=np.asarray(times), **others)


def test_the_tripod_of_the_hexabot_keeps_78_mm_of_static_margin():
    plan = planned(np.linspace(3.0, 5.0, 401), Command(forward=0.1, start=1.0))
    assert plan.static_margins.min() == pytest.approx(0.078, abs=5e-4)
    assert plan.dynamic_margins.min() == pytest.approx(0.078, abs=5e-4)


def test_standing_both_margins_are_that_of_the_center_of_mass():
    plan = planned(np.zeros(1))
    X_B = base_transforms(HEXABOT.rows, plan.joints.value.reshape(1, -1))[0]
    # By symmetry the center of mass is in the middle of the body.
    assert plan.centres[0, :2] == pytest.approx([0.0, 0.0], abs=1e-15)
    feet = X_B[3::4, :2, 3]
    margin = float(support_margin(feet, (0.0, 0.0)))
    assert plan.static_margins == pytest.approx([margin], abs=1e-14)
    assert plan.dynamic_margins == pytest.approx([margin], abs=1e-14)
    # Edges are between the front feet and between a middle foot and a front one.
    (x, y), (_, far) = feet[0], feet[1]
    assert margin == pytest.approx(min(x, far * x / math.hypot(x, far - y)), abs=1e-14)


def test_on_a_slope_the_margin_is_that_of_the_point_below_along_gravity():
    angle = math.radians(10.0)
    gravity = (-9.81 * math.sin(angle), 0.0, -9.81 * math.cos(angle))  # x is uphill
    flat, steep = planned(np.zeros(1)), planned(np.zeros(1), gravity=gravity)
    height = flat.centres[0, 2]
    assert steep.ground_points[0] == pytest.approx([-height * math.tan(angle), 0.0], abs=1e-15)
    assert steep.zero_moment_points == pytest.approx(steep.ground_points, abs=1e-15)
    assert steep.static_margins < flat.static_margins


def test_wrenches_of_inertia_and_centers_of_mass_are_those_of_drake():
    """Drake's momentum of the floating plant, differentiated over time, and its center of mass."""
    plant = build_plant(HEXABOT)
    context = plant.CreateDefaultContext()
    body = plant.GetBodyByName(HEXABOT.base_name)
    arc = planned(np.array([2.13, 2.41, 2.87]), ARC, attitudes=[LEANING])
    h = 1e-3
    offsets = (-2, -1, 0, 1, 2)
    near = planned(
        (arc.times[:, np.newaxis] + h * np.array(offsets)).ravel(), ARC, attitudes=[LEANING]
    )
    momenta, centres = [], []
    for X, dX, q, qdot in zip(*near.body[:2], *near.joints[:2], strict=True):
        plant.SetFreeBodyPose(context, body, RigidTransform(X))
        spin = dX[:3, :3] @ X[:3, :3].T
        w = [spin[2, 1], spin[0, 2], spin[1, 0]]
        joints = [plant.GetJointByName(name) for leg in near.legs.joint_names for name in leg]
        v = np.zeros(plant.num_velocities())
        v[:6] = [*w, *dX[:3, 3]]
        for joint, angle, rate in zip(joints, q.ravel(), qdot.ravel(), strict=True):
            joint.set_angle(context, angle)
            v[joint.velocity_start()] = rate
        plant.SetVelocities(context, v)
        L = plant.CalcSpatialMomentumInWorldAboutPoint(context, np.zeros(3))
        momenta.append([*L.rotational(), *L.translational()])
        centres.append(plant.CalcCenterOfMassPositionInWorld(context))
    assert near.centres == pytest.approx(np.array(centres), abs=1e-14)
    L = np.reshape(momenta, (3, 5, 6))
    rates = (8.0 * (L[:, 3] - L[:, 1]) - (L[:, 4] - L[:, 0])) / (12.0 * h)
    moment, force = arc.rates_of_momentum
    assert np.hstack([moment, force]) == pytest.approx(rates, abs=2e-8)
    # The ground's force at the zero-moment point balances weight and inertia but about z.
    mass = plant.CalcTotalMass(context)
    assert total_mass(HEXABOT) == pytest.approx(mass, abs=1e-12)
    resultant = mass * np.array(arc.gravity) - rates[:, 3:]
    about = np.cross(arc.centres, mass * np.array(arc.gravity)) - rates[:, :3]
    at = np.column_stack([arc.zero_moment_points, np.zeros(3)])
    assert (about - np.cross(at, resultant))[:, :2] == pytest.approx(np.zeros((3, 2)), abs=2e-8)


def test_pseudo_inertias_of_given_mass_properties_have_the_moments():
    given = Inertial(
        mass=0.5,
        centre=(0.02, -0.03, 0.01),
        moments=(0.002, 0.003, 0.004),
        products=(1e-4, -2e-4, 3e-4),
    )
    robot = replace(HEXABOT, base_link=replace(HEXABOT.base_link, inertial=given))
    J = pseudo_inertias(robot)[0]
    c = np.array(given.centre)
    assert J[3] == pytest.approx([*(0.5 * c), 0.5])
    second = J[:3, :3] - 0.5 * np.outer(c, c)
    inertia = np.trace(second) * np.eye(3) - second
    expected = [[2e-3, 1e-4, -2e-4], [1e-4, 3e-3, 3e-4], [-2e-4, 3e-4, 4e-3]]
    assert inertia == pytest.approx(np.array(expected), abs=1e-15)


def test_legs_stay_apart_and_regular_along_the_walk():
    plan = planned(np.linspace(2.0, 4.0, 81), Command(forward=0.1, start=1.0))
    assert 0.05 < plan.gaps.min() < 0.08
    J = plan.legs.jacobians(plan.joints.value)
    assert plan.sigma_mins == pytest.approx(np.linalg.svd(J, compute_uv=False)[..., -1], abs=1e-14)


def test_what_is_out_of_reach_has_no_margin():
    plan = planned(np.array([0.0, 8.2]), Command(forward=1.0, start=1.0))
    assert plan.static_margins[0] > 0.0
    assert np.isnan(plan.static_margins[1])
