"""The leg of three thighs moves as the leg in one piece does."""

import dataclasses
import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from pydrake.geometry import Box, Role
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import DiagramBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import row_transform
from drake_leg.kinematics.leg import LegGeometry, foot_position
from drake_leg.models.plant import build_plant, sdf_folder, thigh_leg
from drake_leg.models.sdf import thigh_leg_text, thigh_text
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA, hexabot_leg
from drake_leg.robot.solids import Brick, Inertial, Solid
from drake_leg.units import STANDARD_GRAVITY


def changed(robot, index, **changes):
    segments = list(robot.segments)
    segments[index] = dataclasses.replace(segments[index], **changes)
    return dataclasses.replace(robot, segments=tuple(segments))


def with_a_frame_between(robot):
    """The coxa's end as a row of its own, without a link."""
    coxa, femur, *others = robot.segments
    end = Segment(row=Row(joint="fixed", d=femur.row.d))
    femur = dataclasses.replace(femur, row=dataclasses.replace(femur.row, d=0.0))
    return dataclasses.replace(robot, segments=(coxa, end, femur, *others))


SPRING = JointMechanics(damping=0.003, spring_stiffness=0.2, equilibrium_position=0.4)
LOPSIDED = Inertial(
    mass=0.03, centre=(0.02, 0.003, -0.001), moments=(2e-6, 9e-6, 8e-6), products=(1e-7, 0.0, 2e-7)
)
LEGS = pytest.mark.parametrize(
    "robot",
    [
        LEG_B,
        LEG_A,
        hexabot_leg("A", l1=0.04, l2=0.123, l3=1 / 7, density=812.0, damping=0.01),
        changed(LEG_B, 1, mechanics=SPRING),
        changed(LEG_B, 1, link=dataclasses.replace(LEG_B.segments[1].link, inertial=LOPSIDED)),
        changed(LEG_B, 3, joint=None, link=None),
        changed(LEG_B, 2, row=Row(joint="revolute", d=0.1, alpha=math.pi / 2, theta=math.pi / 2)),
        changed(LEG_B, 2, row=Row(joint="revolute", d=0.1, alpha=0.3, theta=-0.8)),
        with_a_frame_between(LEG_B),
    ],
    ids=["B", "A", "lengths", "spring", "inertial", "no foot", "quaternion", "turned", "frame"],
)


def bar(name, length, end=None):
    solid = Solid(
        shape=Brick(length=length, width=0.01, height=0.01),
        density=1000.0,
        centre=(length / 2, 0.0, 0.0),
        colour=(0.5, 0.5, 0.5),
    )
    return Link(name=name, solid=solid, end=end or (length, 0.0, 0.0))


def two_bars(second_row, *, end=None):
    return Robot(
        name="arm",
        title="An arm",
        source="a test",
        segments=(
            Segment(row=Row(joint="revolute"), joint="one", link=bar("first", 0.2, end)),
            Segment(row=second_row, joint="two", link=bar("second", 0.1)),
        ),
    )


def from_file():
    plant = MultibodyPlant(time_step=0.0)
    parser = Parser(plant)
    parser.package_map().AddPackageXml(str(sdf_folder() / "package.xml"))
    parser.AddModels(str(sdf_folder() / "hexabot_leg_of_thighs.sdf"))
    return finished(plant)


def from_package():
    plant = MultibodyPlant(time_step=0.0)
    parser = Parser(plant)
    parser.package_map().AddPackageXml(str(sdf_folder() / "package.xml"))
    parser.AddModelsFromUrl("package://drake_leg/hexabot_leg_of_thighs.sdf")
    return finished(plant)


def finished(plant):
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -STANDARD_GRAVITY])
    plant.Finalize()
    return plant


def dynamics(plant, state):
    """Everything that decides how a leg moves, and where its frames and its foot are."""
    context = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, state)
    plant.get_actuation_input_port().FixValue(context, [0.01, -0.02, 0.03])
    frames = [
        plant.GetFrameByName(f"frame_{i}") for i in range(5) if plant.HasFrameNamed(f"frame_{i}")
    ]
    W = plant.world_frame()
    return {
        "mass matrix": plant.CalcMassMatrix(context) * 1e3,
        "gravity": plant.CalcGravityGeneralizedForces(context),
        "bias": plant.CalcBiasTerm(context),
        "acceleration": plant.get_generalized_acceleration_output_port().Eval(context),
        "poses": np.array([frame.CalcPoseInWorld(context).GetAsMatrix4() for frame in frames]),
        "Jacobian": plant.CalcJacobianSpatialVelocity(
            context, JacobianWrtVariable.kV, frames[-1], np.zeros(3), W, W
        ),
        "mass": plant.CalcTotalMass(context),
    }


def assert_moves_alike(plant, other, rng):
    for state in rng.uniform(-3.0, 3.0, (10, 6)):
        expected = dynamics(other, state)
        for name, value in dynamics(plant, state).items():
            scale = max(1.0, np.abs(expected[name]).max())
            np.testing.assert_allclose(
                value, expected[name], rtol=0.0, atol=1e-12 * scale, err_msg=name
            )


@LEGS
def test_it_moves_as_the_leg_in_one_piece(robot, rng):
    assert_moves_alike(thigh_leg(robot), build_plant(robot), rng)


@pytest.mark.parametrize("parsed", [from_file, from_package])
def test_the_committed_file_does_too_with_a_plain_parser(parsed, rng):
    assert_moves_alike(parsed(), build_plant(LEG_B), rng)


def test_its_foot_is_the_closed_forms(rng):
    plant = thigh_leg(LEG_B)
    context = plant.CreateDefaultContext()
    geometry = LegGeometry.from_robot(LEG_B)
    for q in rng.uniform(-3.0, 3.0, (10, 3)):
        plant.SetPositions(context, q)
        p_WF = plant.GetFrameByName("frame_4").CalcPoseInWorld(context).translation()
        np.testing.assert_allclose(p_WF, foot_position(geometry, q), atol=1e-15)


def test_every_thigh_is_an_instance_with_its_four_frames(rng):
    plant, whole = thigh_leg(LEG_B), build_plant(LEG_B)
    context, other = plant.CreateDefaultContext(), whole.CreateDefaultContext()
    q = rng.uniform(-3.0, 3.0, 3)
    plant.SetPositions(context, q)
    whole.SetPositions(other, q)
    ends = {"coxa": "frame_2", "femur": "frame_3", "tibia": "frame_4"}
    for name, following in ends.items():
        instance = plant.GetModelInstanceByName(f"hexabot_leg_of_thighs::{name}")
        X_W = {
            frame: plant.GetFrameByName(frame, instance).CalcPoseInWorld(context)
            for frame in ("base", "cog", "end", "solid")
        }
        for frame in ("base", "cog", "end"):
            place = whole.GetFrameByName(f"{name}_{frame}").CalcPoseInWorld(other)
            np.testing.assert_allclose(X_W[frame].translation(), place.translation(), atol=1e-15)
        assert X_W["solid"].IsExactlyEqualTo(X_W["cog"])
        # The end of one is the base of the next, up to the joint's rotation about z.
        axis = whole.GetFrameByName(following).CalcPoseInWorld(other).rotation().col(2)
        np.testing.assert_allclose(X_W["end"].rotation().col(2), axis, atol=1e-15)
    assert [plant.GetJointByName(joint).position_start() for joint in ("hip", "knee", "ankle")] == [
        0,
        1,
        2,
    ]
    assert plant.GetJointByName("knee").frame_on_child().body().model_instance() == (
        plant.GetModelInstanceByName("hexabot_leg_of_thighs::femur")
    )


OFFSET = Row(joint="revolute", d=0.2, alpha=math.pi / 2, r=0.05, theta=0.3)


@pytest.mark.parametrize(
    "robot",
    [
        LEG_A,
        LEG_B,
        hexabot_leg("B", l1=0.03, l2=0.07, l3=0.11),
        two_bars(OFFSET, end=(0.2, -0.05, 0.0)),
        two_bars(Row(joint="revolute", d=0.2)),
    ],
)
def test_a_thighs_end_is_the_next_row_of_the_table_and_its_cog_is_the_bricks(robot):
    plant = thigh_leg(robot)
    context = plant.CreateDefaultContext()
    rows = [*robot.rows[1:], Row(joint="fixed", d=0.1)]  # the end of a last link without a foot
    for segment, row in zip(robot.moving, rows, strict=False):
        name = f"hexabot_leg_of_thighs::{segment.link.name}"
        instance = plant.GetModelInstanceByName(name)
        base, cog, end = (plant.GetFrameByName(frame, instance) for frame in ("base", "cog", "end"))
        X = plant.CalcRelativeTransform(context, base, end).GetAsMatrix4()
        np.testing.assert_allclose(X, row_transform(row), atol=1e-15)
        p = plant.CalcRelativeTransform(context, base, cog).translation()
        np.testing.assert_allclose(p, segment.link.solid.centre, atol=1e-15)


def test_the_file_sets_only_what_differs_from_the_femur():
    includes = ET.fromstring(thigh_leg_text(LEG_B)).findall("model/include")
    assert [include.findtext("uri") for include in includes] == [
        "package://drake_leg/thigh.sdf"
    ] * 3
    masks = [
        [
            setting.get("element_id")
            for params in include
            if "params" in params.tag
            for setting in params
        ]
        for include in includes
    ]
    assert masks == [["link", "link::brick", "cog", "end"], [], ["link::brick"]]


def bricks(name):
    """Every visual of a file: its size, its color, and where its body is."""
    builder = DiagramBuilder()
    plant, scene = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    parser = Parser(plant)
    parser.package_map().AddPackageXml(str(sdf_folder() / "package.xml"))
    parser.AddModels(str(sdf_folder() / name))
    plant.Finalize()
    inspector = scene.model_inspector()
    seen = []
    for geometry in inspector.GetAllGeometryIds(Role.kIllustration):
        shape = inspector.GetShape(geometry)
        size = shape.size().tolist() if isinstance(shape, Box) else [shape.radius()]
        properties = inspector.GetIllustrationProperties(geometry)
        colour = properties.GetProperty("phong", "diffuse")
        centre = inspector.GetPoseInFrame(geometry).translation().tolist()
        seen.append((size, centre, [colour.r(), colour.g(), colour.b()]))
    return seen


def test_it_looks_like_the_leg_in_one_piece():
    assert sorted(bricks("hexabot_leg_of_thighs.sdf")) == sorted(bricks("leg_b.sdf"))


def test_the_thigh_stands_alone():
    plant = MultibodyPlant(time_step=0.0)
    parser = Parser(plant)
    parser.SetStrictParsing()
    parser.AddModelsFromString(thigh_text(), "sdf")
    plant.Finalize()
    assert (plant.num_positions(), plant.num_velocities()) == (7, 6)  # free in space
    assert plant.GetModelInstanceByName("thigh")


def test_bad_input_is_refused():
    with pytest.raises(InvalidValueError, match="'quill' of 'scara' is not a brick"):
        thigh_leg(SCARA)
    with pytest.raises(InvalidValueError, match=r"'first' of 'arm' ends at .* next row begins at"):
        thigh_leg(two_bars(Row(joint="revolute", d=0.25)))
    with pytest.raises(InvalidValueError, match="'femur' of 'leg_b' is not a brick"):
        thigh_leg(changed(LEG_B, 1, link=Link(name="femur")))
    with pytest.raises(InvalidValueError, match=r"gravity is -1\.0"):
        thigh_leg(LEG_B, gravity=-1.0)
