"""Plants of mechanisms: proved against their blocks, and against closed forms."""

import math

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, four_bar, pendulum

from drake_leg.simulink.multibody.meshes import write_meshes
from drake_leg.simulink.multibody.plant import (
    mechanism_plant,
    mechanism_scene,
    prove_mechanism,
)
from drake_leg.simulink.multibody.sdf import mechanism_sdf

GRAVITY = 9.80665
KINDS = (
    "Revolute", "Prismatic", "Spherical", "Cylindrical", "Universal", "Planar", "Rectangular",
    "Cartesian", "Gimbal", "Pin Slot", "6-DOF", "Telescoping", "Bushing", "Bearing", "Lead Screw",
)  # fmt: skip


def with_gravity(built):
    built.add_library("sm_lib/Utilities/Mechanism Configuration", "Gravity")
    built.physical(f"{built.sid('Gravity')}#rconn:1", f"{built.sid('World')}#rconn:1")
    return built


def two_joints(kind, *, reverse):
    """A joint of a kind on the world, another one on its body, each out of line."""
    built = MechanismBuilder()
    before = "World"
    for number in (1, 2):
        built.joint(kind, f"J{number}")
        built.transform(f"T{number}", offset="[0.3 -0.2 0.5]", axis="+X", angle="35")
        built.body("Ellipsoidal Solid", f"E{number}", EllipsoidRadii="[0.1 0.2 0.3]", Density="800")
        near, far = ("rconn:1", "lconn:1") if reverse else ("lconn:1", "rconn:1")
        built.meet(before, f"J{number} {near}")
        built.meet(f"J{number} {far}", f"T{number} lconn:1")
        built.meet(f"T{number}", f"E{number}")
        before = f"T{number}"
    return built


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_every_joint_moves_as_its_blocks(tmp_path, kind, reverse):
    built = two_joints(kind, reverse=reverse)
    mechanism = built.mechanism(tmp_path)
    proof = prove_mechanism(mechanism, mechanism_plant(mechanism))
    assert proof.holds
    assert (proof.frames, proof.solids) == (8, 2)


def test_a_wrong_plant_is_found(tmp_path):
    mechanism = pendulum().mechanism(tmp_path)
    right = mechanism_sdf(mechanism)
    for old, new in (
        ("<mass>0.4</mass>", "<mass>0.4001</mass>"),
        ("<xyz>0 0 1</xyz>", "<xyz>0 0 -1</xyz>"),
        (">0 0.5 0", ">0 0.5001 0"),
    ):
        assert old in right
        wrong = mechanism_plant(mechanism, right.replace(old, new))
        assert not prove_mechanism(mechanism, wrong).holds, new


def test_the_torque_that_holds_a_pendulum_is_that_of_its_weight(tmp_path):
    built = with_gravity(pendulum(PositionTargetSpecify="on", PositionTargetValue="30"))
    plant = mechanism_plant(built.mechanism(tmp_path))
    context = plant.CreateDefaultContext()
    assert plant.GetPositions(context) == pytest.approx([math.pi / 6])
    torque = plant.CalcGravityGeneralizedForces(context)
    assert abs(torque) == pytest.approx([0.4 * GRAVITY * 0.5 * math.sin(math.pi / 6)])


def test_springs_dampers_and_actuators_are_the_plants(tmp_path):
    texts = {
        "SpringStiffness": "2", "SpringStiffnessUnits": "N*m/rad",
        "EquilibriumPosition": "0.5", "EquilibriumPositionUnits": "rad",
        "DampingCoefficient": "3", "DampingCoefficientUnits": "N*m/(rad/s)",
    }  # fmt: skip
    plant = mechanism_plant(pendulum(**texts).mechanism(tmp_path))
    context = plant.CreateDefaultContext()
    plant.SetVelocities(context, [0.1])
    derivative = plant.EvalTimeDerivatives(context).CopyToVector()[1]
    about_end = 0.4 * (1.0**2 + 0.02**2) / 12.0 + 0.4 * 0.5**2
    assert derivative * about_end == pytest.approx(2 * 0.5 - 3 * 0.1)
    assert plant.num_actuators() == 0
    driven = pendulum(TorqueActuationMode="InputTorque").mechanism(tmp_path)
    assert mechanism_plant(driven).num_actuators() == 1


def test_a_point_mass_and_a_thin_plate_are_bodies(tmp_path):
    for texts in (
        {"InertiaType": "PointMass", "Mass": "2"},
        {"InertiaType": "Custom", "MomentsOfInertia": "[1 2 3]", "ProductsOfInertia": "[0 0 0]"},
        {
            "InertiaType": "Custom",
            "MomentsOfInertia": "[2 2 2]",
            "ProductsOfInertia": "[0.5 0.5 0.5]",
        },
    ):
        mechanism = pendulum().set("Rod", **texts).mechanism(tmp_path)
        assert prove_mechanism(mechanism, mechanism_plant(mechanism)).holds


def test_a_loop_leaves_its_two_frames_which_meet_at_the_start(tmp_path):
    texts = {"PositionTargetSpecify": "on", "PositionTargetValue": "60"}
    mechanism = four_bar(**texts).mechanism(tmp_path)
    plant = mechanism_plant(mechanism)
    assert prove_mechanism(mechanism, plant).holds
    context = plant.CreateDefaultContext()
    base, follower = (
        plant.GetFrameByName(f"D_{end}").CalcPoseInWorld(context).translation()
        for end in ("base", "follower")
    )
    np.testing.assert_allclose(base, follower, atol=1e-9)
    assert plant.GetPositions(context)[0] == pytest.approx(math.pi / 3)


def test_a_scene_shows_every_shape(tmp_path):
    built = pendulum()
    shapes = {
        "Cylindrical": {"CylinderRadius": "0.1", "CylinderLength": "0.2"},
        "Spherical": {"SphereRadius": "0.1"},
        "Ellipsoidal": {"EllipsoidRadii": "[0.1 0.2 0.3]"},
        "Extruded": {
            "ExtrusionCrossSection": "[0 0; 1 0; 1 1; 0.5 0.2; 0 1]",
            "ExtrusionCrossSectionUnits": "m",
            "ExtrusionLength": "0.1", "ExtrusionLengthUnits": "m",
        },
        "Revolved": {
            "RevolutionCrossSection": "[1 0; 2 0; 2 1; 1 1]",
            "RevolutionCrossSectionUnits": "m",
        },
    }  # fmt: skip
    for kind, texts in shapes.items():
        built.body(f"{kind} Solid", kind, **texts)
    built.meet("Down", *shapes)
    built.lines.pop(-2)
    mechanism = built.mechanism(tmp_path)
    meshes = write_meshes(mechanism, tmp_path)
    paths = {solid: tmp_path / name for solid, name in meshes.names.items()}
    scene = mechanism_scene(mechanism, paths)
    (graph,) = [s for s in scene.GetSystems() if s.get_name() == "scene_graph"]
    assert graph.model_inspector().num_geometries() == len(shapes)


def test_what_is_fixed_to_the_world_may_have_any_inertia(tmp_path):
    built = pendulum()
    built.body("Brick Solid", "Wall", BrickDimensions="[1 1 1]", InertiaType="Custom",
               MomentsOfInertia="[1 1 5]")  # fmt: skip
    built.meet("World", "Wall")
    mechanism = built.mechanism(tmp_path)
    plant = mechanism_plant(mechanism)
    proof = prove_mechanism(mechanism, plant)
    assert (proof.holds, proof.solids) == (True, 1)
    assert plant.num_positions() == 1
