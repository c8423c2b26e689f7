"""Loads of planned walks: against Drake, closed forms, energy, and least squares."""

import math
from dataclasses import replace

import numpy as np
import pytest
from bodies import FORK, robot_of
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.tree import MultibodyForces

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.kinematics.walking.gaits import Attitude, Command, Motion, Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.loads import (
    FADING,
    outwards_on,
    planned_forces,
    planned_loads,
    planned_torques,
    spread,
)
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.kinematics.walking.weights import link_motions, pseudo_inertias, total_mass
from drake_leg.models.plant import build_plant
from drake_leg.robot.ground import Ground
from drake_leg.robot.hexapods import HEXABOT, PHANTOMX
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.servos import IDEAL, XL430
from drake_leg.units import STANDARD_GRAVITY

ARC = Command(forward=0.08, sideways=0.02, turning=0.25, start=1.0)
LEANING = Attitude(roll=0.04, pitch=-0.05, shift=(0.01, 0.0, 0.005), start=1.2)
CREEPING = Command(forward=1e-9, start=1.0)  # with no lift: three feet stand, the others hover
R_WG = RotationMatrix.MakeYRotation(math.radians(-10.0)).matrix()  # x of G is uphill
ON_SLOPE = tuple(R_WG.T @ [0.0, 0.0, -STANDARD_GRAVITY])
ROBOTS = {"hexabot": HEXABOT, "phantomx": PHANTOMX}
each_robot = pytest.mark.parametrize("robot", ROBOTS.values(), ids=list(ROBOTS))


def walking(robot, *commands, attitudes=(), gait="tripod", **others):
    feet = Legs.of(robot).feet(np.reshape(starting_posture(robot), (-1, 3)))
    standing = Attitude(shift=(0.0, 0.0, -float(feet[:, 2].mean())), start=-1.0)
    feet[:, 2] = 0.0
    return Walk(
        gait=GAITS[gait], period=1.0, neutral=feet, commands=commands,
        attitudes=(standing, *attitudes), **others,
    )  # fmt: skip


def planned(robot, times, *commands, gravity=(0.0, 0.0, -STANDARD_GRAVITY), outwards=0.0, **others):
    return PlannedWalk(
        robot=robot, legs=Legs.of(robot), walk=walking(robot, *commands, **others),
        times=np.asarray(times), gravity=gravity, outwards=outwards,
    )  # fmt: skip


def servo_torques(plan, servo):
    qdot, qddot = (part.reshape(len(plan.times), -1) for part in plan.joints[1:])
    return servo.back_emf_damping * qdot + servo.rotor_inertia * qddot


def of_spin(M):
    return np.array([M[2, 1], M[0, 2], M[1, 0]])


@each_robot
def test_drake_needs_the_planned_torques_and_nothing_at_the_floating_base(robot):
    # In the overlap of the tripods, while all feet take over load, and on three feet; on a slope.
    times = [1.93, 2.02, 2.31, 2.77]
    plan = planned(robot, times, ARC, attitudes=[LEANING], gravity=ON_SLOPE, outwards=0.2)
    forces, torques = planned_loads(plan, IDEAL)
    own = torques - servo_torques(plan, IDEAL)
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    body = plant.GetBodyByName(robot.base_name)
    tips = [plant.GetFrameByName(f"frame_{row}") for row in robot.tips.values()]
    for row in range(len(plan.times)):
        X, dX, ddX = (R_WG @ part[row, :3] for part in plan.body)
        q, qdot, qddot = (part[row].ravel() for part in plan.joints)
        R = RotationMatrix.ProjectToRotationMatrix(X[:, :3])
        plant.SetFreeBodyPose(context, body, RigidTransform(R, X[:, 3]))
        plant.SetPositions(context, [*plant.GetPositions(context)[:7], *q])
        spin, turning = (part[:, :3] @ X[:, :3].T for part in (dX, ddX))
        plant.SetVelocities(context, [*of_spin(spin), *dX[:, 3], *qdot])
        vdot = [*of_spin((turning - turning.T) / 2), *ddX[:, 3], *qddot]
        applied = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, applied)
        for tip, force in zip(tips, forces[row], strict=True):
            at = tip.GetFixedPoseInBodyFrame().translation()
            pushed = SpatialForce(np.zeros(3), R_WG @ force)
            tip.body().AddInForce(context, at, pushed, plant.world_frame(), applied)
        needed = plant.CalcInverseDynamics(context, vdot, applied)
        assert needed[:6] == pytest.approx(np.zeros(6), abs=1e-12)
        assert needed[6:] == pytest.approx(own[row], abs=1e-12)


@each_robot
def test_at_rest_on_three_feet_torques_are_levers_of_vertical_forces(robot):
    plan = planned(robot, [1.75], CREEPING, lift=0.0)
    forces, torques = (part[0] for part in planned_loads(plan, IDEAL, inertia=False))
    down = plan.down[0]
    assert down.sum() == 3
    # Three vertical forces follow from the moments of the weight.
    feet, weight = plan.walk.feet_in_world(1.75).value, total_mass(robot) * STANDARD_GRAVITY
    center = plan.centres[0]
    levers = np.vstack([np.ones(3), feet[down, :2].T])
    assert forces[down, 2] == pytest.approx(weight * np.linalg.solve(levers, [1.0, *center[:2]]))
    assert forces[:, :2] == pytest.approx(np.zeros((6, 2)), abs=1e-9)
    # About a horizontal axis, a vertical force has the lever of its distance along the ground.
    X = plan.links.value[0]
    masses = pseudo_inertias(robot)[:, :, 3] * STANDARD_GRAVITY
    pushes = (X @ masses[..., np.newaxis])[:, :2, 0]  # weights times their places
    expected = []
    for tip, foot, force in zip(robot.tips.values(), feet, forces, strict=True):
        path = robot.path(tip)
        for number, row in enumerate(path):
            if robot.rows[row - 1].joint == "fixed":
                continue
            beyond = list(path[number:])
            axis, place = X[row, :3, 2], X[row, :2, 3]
            lifted = pushes[beyond].sum(axis=0) - masses[beyond, 3].sum() * place
            moment = force[2] * (foot[:2] - place) - lifted
            expected.append(-(axis[0] * moment[1] - axis[1] * moment[0]))
    assert torques == pytest.approx(expected, abs=1e-8)
    assert np.abs(torques[::3]).max() < 1e-8  # the hips' axes are vertical


def test_the_phantomx_stands_on_three_feet_with_84_percent_of_its_servos_torque():
    plan = planned(PHANTOMX, [1.25, 1.75], CREEPING, lift=0.0)
    worst = np.abs(planned_loads(plan, XL430, inertia=False).torques).max()
    assert worst == pytest.approx(1.26, abs=0.01)


def test_joints_work_what_the_robot_gains_in_energy():
    def energy(plan):
        J, dX = pseudo_inertias(HEXABOT), plan.links.rate
        moving = 0.5 * np.einsum("tlij,ljk,tlik->t", dX, J, dX)
        return moving - total_mass(HEXABOT) * plan.centres @ np.array(ON_SLOPE)

    times, h = np.linspace(1.1, 3.0, 12), 1e-4
    before, plan, after = (
        planned(HEXABOT, times + step, ARC, attitudes=[LEANING], gravity=ON_SLOPE)
        for step in (-h, 0.0, h)
    )
    torques = planned_loads(plan, IDEAL).torques - servo_torques(plan, IDEAL)
    power = (torques * plan.joints.rate.reshape(len(times), -1)).sum(axis=1)
    assert np.abs(power).max() > 0.1
    assert power == pytest.approx((energy(after) - energy(before)) / (2.0 * h), abs=1e-5)


@pytest.mark.parametrize("gait", list(GAITS))
def test_forces_go_over_smoothly_from_foot_to_foot(gait):
    times = np.arange(1.0, 3.0, 0.002)
    command = Command(forward=0.02, start=1.0)
    plan = planned(HEXABOT, times, command, gait=gait)
    forces = planned_loads(plan, IDEAL).forces
    assert np.abs(forces[~plan.down]).max() == 0.0
    # Of 21 N in all, a foot takes at most 13 in 50 ms, and no faster than twice their mean rate.
    assert np.abs(np.diff(forces, axis=0)).max() < 2.0 * 13.0 * 0.002 / FADING
    # Legs that swing push the whole up and down by a tenth of its weight.
    weight = total_mass(HEXABOT) * STANDARD_GRAVITY
    assert forces.sum(axis=1)[:, 2] == pytest.approx(weight, rel=0.15)


def test_where_no_foot_is_down_for_long_the_new_ones_take_over_at_once():
    gait = replace(GAITS["tripod"], duty=0.5)
    walk = replace(walking(HEXABOT, Command(forward=0.02, start=1.0)), gait=gait)
    forces = planned_forces(HEXABOT, walk, [2.0, 2.0 - 1e-12])
    weight = total_mass(HEXABOT) * STANDARD_GRAVITY
    assert forces[..., 2].sum(axis=1) == pytest.approx([weight, weight], rel=1e-2)
    assert (forces[0, ::2, 2] > 5.0).all()
    assert (forces[1, 1::2, 2] > 5.0).all()


def test_firmness_fades_at_steps_and_nowhere_else():
    walk = walking(HEXABOT, Command(forward=0.1, start=1.0, end=4.0))
    fine = np.linspace(0.0, 8.0, 8001)
    firm = walk.firmness(fine, FADING)
    assert ((firm > 0.0) <= walk.down(fine)).all()
    assert firm.min() == 0.0
    assert firm.max() == 1.0
    assert np.abs(np.diff(firm, axis=0)).max() < 1.9 * 0.001 / FADING
    # The left front foot stands from 2.0 to 2.55 s.
    at = walk.firmness([2.0, 2.025, 2.05, 2.5, 2.525, 2.55, 2.6], FADING)[:, 0]
    assert at == pytest.approx([0.0, 0.5, 1.0, 1.0, 0.5, 0.0, 0.0], abs=1e-12)
    assert (walk.firmness([0.0, 0.5, 7.5], FADING) == 1.0).all()
    with pytest.raises(InvalidValueError, match=r"firmness fades is 0\.0 s; it must be a positive"):
        walk.firmness(1.0, 0.0)


def test_forces_are_the_least_that_make_up_a_wrench():
    rng = np.random.default_rng(15)
    feet, weights = rng.normal(size=(4, 6, 3)), rng.uniform(0.1, 2.0, (4, 6))
    weights[1, [0, 2]] = 0.0
    moment, force = rng.normal(size=(2, 4, 3))
    found = spread(feet, weights, moment, force)
    assert found.sum(axis=1) == pytest.approx(force)
    assert np.cross(feet, found).sum(axis=1) == pytest.approx(moment)
    for p, w, M, F, f in zip(feet, weights, moment, force, found, strict=True):
        zero, x, y, z = np.zeros(6), *p.T
        crosses = np.moveaxis(np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]), 2, 0)
        grasp = np.hstack([np.vstack([np.eye(3), one]) for one in crosses])
        root = np.sqrt(np.repeat(w, 3))
        least, *_ = np.linalg.lstsq(grasp * root, np.r_[F, M], rcond=None)
        assert f.ravel() == pytest.approx(root * least)


@each_robot
def test_feet_that_press_outwards_spare_the_knees(robot):
    down, feet, loads = [], [], []
    for outwards in (0.0, 0.2):
        plan = planned(robot, [1.75], CREEPING, lift=0.0, outwards=outwards)
        loads.append([part[0] for part in planned_loads(plan, IDEAL, inertia=False)])
        down, feet = plan.down[0], plan.feet.value[0]
    (flat, before), (arched, after) = loads
    assert arched[:, 2] == pytest.approx(flat[:, 2])  # no leg carries another one's part
    assert (arched[~down] == 0.0).all()
    out = (feet - Legs.of(robot).hips)[:, :2]
    inwards = -(arched[:, :2] * out).sum(axis=1)[down] / np.hypot(*out.T)[down]
    assert inwards == pytest.approx(0.2 * arched[down, 2], rel=0.15)  # less what they leave over
    assert np.abs(after[1::3]).max() < 0.95 * np.abs(before[1::3]).max()


def test_a_slope_leaves_less_friction_to_press_outwards_with():
    level = outwards_on(Ground())
    assert level == pytest.approx(0.125 * 0.8)
    assert outwards_on(Ground(slope=math.radians(10.0))) == pytest.approx(
        level - 0.125 * math.tan(math.radians(10.0))
    )
    assert outwards_on(Ground(friction=0.1, slope=math.radians(10.0))) == 0.0
    assert outwards_on(Ground(friction=9.0)) == 0.125


def test_two_feet_carry_no_moment_about_their_line_and_none_carry_nothing():
    feet = np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]])
    found = spread(feet, [1.0, 1.0], [0.3, 0.2, 0.0], [0.0, 0.0, 10.0])
    assert found == pytest.approx(np.array([[0.0, 0.0, 4.0], [0.0, 0.0, 6.0]]), abs=1e-12)
    assert (spread(feet, [0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 10.0]) == 0.0).all()


def test_servo_and_joints_add_what_they_take():
    times = np.array([2.1, 2.3])
    plan = planned(HEXABOT, times, ARC)
    rigid = replace(XL430, rotor_inertia=0.0)
    qddot = plan.joints.acceleration.reshape(2, -1)
    both = planned_loads(plan, XL430).torques - planned_loads(plan, rigid).torques
    assert both == pytest.approx(0.012 * qddot, abs=1e-12)
    quick = replace(XL430, no_load_speed=2.0 * XL430.no_load_speed)
    qdot, q = plan.joints.rate.reshape(2, -1), plan.joints.value.reshape(2, -1)
    for inertia in (True, False):
        less = planned_loads(plan, quick, inertia=inertia).torques
        more = planned_loads(plan, XL430, inertia=inertia).torques
        assert more - less == pytest.approx(0.5 * XL430.back_emf_damping * qdot, abs=1e-12)
    smooth = planned_loads(plan, replace(XL430, friction=0.0)).torques
    rubbing = planned_loads(plan, XL430).torques - smooth
    assert rubbing == pytest.approx(XL430.friction * np.sign(qdot), abs=1e-12)
    segments = [
        s if s.row.joint == "fixed" else replace(
            s, mechanics=replace(
                s.mechanics, damping=0.2, spring_stiffness=0.5, equilibrium_position=0.1
            )
        )
        for s in HEXABOT.segments
    ]  # fmt: skip
    sprung = planned(replace(HEXABOT, segments=tuple(segments)), times, ARC)
    added = planned_loads(sprung, XL430).torques - planned_loads(plan, XL430).torques
    assert added == pytest.approx(0.2 * qdot + 0.5 * (q - 0.1), abs=1e-12)


def test_torques_and_forces_of_a_walk_are_those_of_its_plan():
    plan = planned(HEXABOT, [0.5, 2.2], ARC, gravity=ON_SLOPE)
    loads = planned_loads(plan, IDEAL)
    torques = planned_torques(HEXABOT, plan.walk, [0.5, 2.2], IDEAL, gravity=ON_SLOPE)
    assert torques == pytest.approx(loads.torques, abs=0.0)
    forces = planned_forces(HEXABOT, plan.walk, [0.5, 2.2], gravity=ON_SLOPE)
    assert forces == pytest.approx(loads.forces, abs=0.0)
    level = planned_forces(HEXABOT, plan.walk, [0.0], gravity=10.0, inertia=False)
    assert level.sum(axis=1) == pytest.approx(np.array([[0.0, 0.0, 10.0 * total_mass(HEXABOT)]]))
    assert planned_forces(HEXABOT, plan.walk, []).shape == (0, 6, 3)


def test_what_makes_no_sense_is_refused_and_what_is_out_of_reach_is_not_a_number():
    walk = walking(HEXABOT, Command(forward=1.0, start=1.0))
    with pytest.raises(InvalidValueError, match=r"at 8\.2 s the foot right_rear is out of reach"):
        planned_torques(HEXABOT, walk, [0.0, 8.2], IDEAL)
    with pytest.raises(InvalidValueError, match="out of reach; plan a walk with shorter steps"):
        planned_forces(HEXABOT, walk, [0.0, 8.2])
    plan = planned(HEXABOT, [0.0, 8.2], Command(forward=1.0, start=1.0))
    loads = planned_loads(plan, IDEAL)
    assert np.isfinite(loads.torques[0]).all()
    assert np.isnan(loads.torques[1]).all()
    with pytest.raises(InvalidValueError, match="the servo is 'ideal'; it must be a Servo"):
        planned_torques(HEXABOT, walk, [0.0], "ideal")
    with pytest.raises(InvalidValueError, match="the walk is 'tripod'; it must be a Walk"):
        planned_torques(HEXABOT, "tripod", [0.0], IDEAL)
    with pytest.raises(InvalidValueError, match="gravity has shape"):
        planned_forces(HEXABOT, walk, [0.0], gravity=(0.0, 1.0))
    with pytest.raises(InvalidValueError, match="the times is 'now'; it must be real numbers"):
        planned_forces(HEXABOT, walk, "now")


def test_motions_of_links_turn_and_slide():
    rng = np.random.default_rng(7)
    robot = robot_of(FORK, rng, floating=True)
    rates, bends = rng.normal(size=(2, 5))

    def at(t):
        q = 0.3 + rates * t + 0.5 * bends * t**2
        still = np.zeros((4, 4))
        return link_motions(
            robot, Motion(np.eye(4), still, still), Motion(q, rates + bends * t, bends)
        ), q

    (before, _), (here, q), (after, _) = (at(t) for t in (-1e-4, 0.0, 1e-4))
    assert here.value[1:] == pytest.approx(base_transforms(robot.rows, q), abs=1e-14)
    assert here.rate == pytest.approx((after.value - before.value) / 2e-4, abs=1e-6)
    assert here.acceleration == pytest.approx((after.rate - before.rate) / 2e-4, abs=1e-6)
