"""What of a robot reaches Drake's plant."""

import logging
import math
from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.models.plant import build_plant, sdf_folder
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, ROBOTS, SCARA, pendulum, scara
from drake_leg.robot.solids import Inertial, mass_properties
from drake_leg.units import STANDARD_GRAVITY

each_robot = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def with_mechanics(robot, mechanics):
    segments = (
        replace(s, mechanics=mechanics) if s.row.joint != "fixed" else s for s in robot.segments
    )
    return replace(robot, segments=tuple(segments))


@each_robot
def test_masses_centres_and_inertias_are_those_of_the_solids(robot, posed):
    plant, context = posed(robot, np.full(len(robot.moving), 0.3))
    for link in (s.link for s in robot.segments if s.link):
        body = plant.GetBodyByName(link.name)
        if link.solid is None:
            assert body.get_mass(context) == 0.0
            continue
        own = mass_properties(link.solid)
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        about_centre = inertia.Shift(inertia.get_com()).CalcRotationalInertia()
        assert inertia.get_mass() == pytest.approx(own.mass, rel=1e-13)
        np.testing.assert_allclose(inertia.get_com(), link.solid.centre, rtol=0, atol=1e-15)
        np.testing.assert_allclose(about_centre.get_moments(), own.moments, rtol=1e-9)
        np.testing.assert_allclose(about_centre.get_products(), 0.0, atol=1e-18)


@each_robot
def test_potential_energy_is_the_weight_of_the_chains_solids(rng, robot, posed):
    q = rng.uniform(-3.0, 3.0, len(robot.moving))
    X_B = base_transforms(robot.rows, q)
    weight = 0.0
    for segment, X_BL in zip(robot.segments, X_B, strict=True):
        if segment.link and segment.link.solid:
            solid = segment.link.solid
            height = (X_BL @ [*solid.centre, 1.0])[2]
            weight += mass_properties(solid).mass * STANDARD_GRAVITY * height
    plant, context = posed(robot, q)
    assert plant.CalcPotentialEnergy(context) == pytest.approx(weight, rel=1e-12, abs=1e-15)


@each_robot
def test_the_plant_is_continuous_and_welded_with_the_tables_joints_in_order(robot):
    plant = build_plant(robot)
    assert plant.is_finalized()
    assert plant.time_step() == 0.0
    assert plant.get_name() == robot.name
    assert plant.HasModelInstanceNamed(robot.name)
    starts = [plant.GetJointByName(s.joint).position_start() for s in robot.moving]
    assert starts == list(range(plant.num_positions())) == list(range(len(robot.moving)))
    kinds = [plant.GetJointByName(s.joint).type_name() for s in robot.moving]
    assert kinds == [s.row.joint for s in robot.moving]


@each_robot
def test_no_joint_has_limits(robot):
    plant = build_plant(robot)
    assert np.isinf(plant.GetPositionLowerLimits()).all()
    assert np.isinf(plant.GetPositionUpperLimits()).all()


def test_every_joint_has_a_motor_but_the_pendulums():
    assert [build_plant(robot).num_actuators() for robot in ROBOTS] == [0, 3, 3, 4]


@pytest.mark.parametrize("robot", [LEG_A, SCARA], ids=["leg_a", "scara"])
def test_damping_reaches_drake(robot):
    plant = build_plant(with_mechanics(robot, JointMechanics(damping=0.125)))
    for segment in robot.moving:
        assert plant.GetJointByName(segment.joint).default_damping_vector() == [0.125]


def test_limits_reach_drake():
    limits = JointMechanics(lower=-0.5, upper=0.75, velocity=3.0, effort=2.0)
    plant = build_plant(with_mechanics(SCARA, limits))
    assert set(plant.GetPositionLowerLimits()) == {-0.5}
    assert set(plant.GetPositionUpperLimits()) == {0.75}
    assert set(plant.GetVelocityUpperLimits()) == {3.0}
    assert set(plant.GetEffortUpperLimits()) == {2.0}


def test_mass_properties_said_outright_reach_drake_in_place_of_the_solids():
    said = Inertial(
        mass=0.2, centre=(0.1, -0.02, 0.03), moments=(3e-4, 4e-4, 5e-4), products=(1e-5, 2e-5, 3e-5)
    )
    hinge = PENDULUM.segments[0]
    robot = replace(PENDULUM, segments=(replace(hinge, link=replace(hinge.link, inertial=said)),))
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    inertia = plant.GetBodyByName("link").CalcSpatialInertiaInBodyFrame(context)
    about_centre = inertia.Shift(inertia.get_com()).CalcRotationalInertia()
    assert inertia.get_mass() == said.mass
    np.testing.assert_allclose(inertia.get_com(), said.centre, rtol=1e-14)
    np.testing.assert_allclose(about_centre.get_moments(), said.moments, rtol=1e-11)
    np.testing.assert_allclose(about_centre.get_products(), said.products, rtol=1e-10)
    cog = plant.GetFrameByName("link_cog").CalcPose(context, plant.GetFrameByName("link"))
    np.testing.assert_allclose(cog.translation(), said.centre, rtol=1e-14)


@pytest.mark.parametrize("robot", [LEG_B, SCARA, PENDULUM], ids=["leg_b", "scara", "pendulum"])
@pytest.mark.parametrize("stiffness", [5.0, 1e-9])
def test_springs_reach_drake_at_revolute_and_prismatic_joints(rng, robot, stiffness):
    rest = 0.25
    mechanics = JointMechanics(spring_stiffness=stiffness, equilibrium_position=rest)
    plant = build_plant(with_mechanics(robot, mechanics), gravity=0.0)
    context = plant.CreateDefaultContext()
    q = rng.uniform(-1.0, 1.0, plant.num_positions())
    plant.SetPositions(context, q)
    stored = stiffness * ((q - rest) ** 2).sum() / 2
    assert plant.CalcPotentialEnergy(context) == pytest.approx(stored, rel=1e-12)


@each_robot
def test_without_springs_gravity_is_the_only_force_element(robot):
    assert build_plant(robot).num_force_elements() == 1


@pytest.mark.parametrize("gravity", [0.0, 1.62, STANDARD_GRAVITY])
def test_gravity_points_down_with_the_wanted_strength(gravity):
    vector = build_plant(PENDULUM, gravity=gravity).gravity_field().gravity_vector()
    np.testing.assert_array_equal(vector, [0.0, 0.0, -gravity])
    default = build_plant(PENDULUM).gravity_field().gravity_vector()
    np.testing.assert_array_equal(default, [0.0, 0.0, -9.80665])


@pytest.mark.parametrize("gravity", [-9.81, math.nan, math.inf])
def test_gravity_that_makes_no_sense_is_refused(gravity):
    with pytest.raises(InvalidValueError, match=f"gravity is {gravity!r}"):
        build_plant(PENDULUM, gravity=gravity)


@pytest.mark.parametrize(
    "robot",
    [*ROBOTS, pendulum(size=(2.0, 1e-3, 1e-4)), scara(l1=1e-3, l2=9.0, density=1e-3)],
    ids=lambda robot: robot.name,
)
def test_the_strict_parser_has_nothing_to_say(robot, caplog, capfd):
    with caplog.at_level(logging.DEBUG, logger="drake"):
        build_plant(robot)
    assert [r.getMessage() for r in caplog.records if r.levelno >= logging.WARNING] == []
    assert capfd.readouterr().err == ""


@each_robot
def test_the_file_and_the_data_make_the_same_plant(robot):
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(sdf_folder() / f"{robot.name}.sdf"))
    plant.Finalize()
    q = np.full(len(robot.moving), 0.3)
    masses = []
    for built in (plant, build_plant(robot)):
        context = built.CreateDefaultContext()
        built.SetPositions(context, q)
        masses.append(built.CalcMassMatrix(context))
    np.testing.assert_array_equal(*masses)


def test_two_legs_stand_in_one_plant_under_prefixes():
    plant = MultibodyPlant(0.0)
    feet = []
    for prefix in ("L0", "L1"):
        parser = Parser(plant, prefix)
        parser.SetStrictParsing()
        parser.package_map().AddPackageXml(str(sdf_folder() / "package.xml"))
        (instance,) = parser.AddModelsFromUrl("package://drake_leg/leg_b.sdf")
        assert plant.GetModelInstanceName(instance) == f"{prefix}::leg_b"
        feet.append(plant.GetFrameByName("frame_4", instance))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    plant.SetPositions(context, q)
    for foot, own in zip(feet, (q[:3], q[3:]), strict=True):
        expected = base_transforms(LEG_B.rows, own)[-1]
        pose = foot.CalcPoseInWorld(context).GetAsMatrix4()
        np.testing.assert_allclose(pose, expected, rtol=0, atol=1e-12)
