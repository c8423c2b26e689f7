"""Bodies, joints and loops that a model's blocks make."""

import numpy as np
import pytest
from mechanism_models import MechanismBuilder, four_bar, pendulum

from drake_leg.errors import InvalidValueError


def names(joints):
    return [joint.name for joint in joints]


def test_a_pendulum_is_one_body_at_its_joint(tmp_path):
    found = pendulum().mechanism(tmp_path)
    assert [body.name for body in found.bodies] == ["world", "Rod"]
    (joint,) = found.joints
    assert (joint.base, joint.follower, joint.reversed) == (0, 1, False)
    np.testing.assert_allclose(joint.X_CF, np.eye(4), atol=1e-15)
    rod = found.bodies[1].properties
    assert rod.mass == pytest.approx(1000.0 * 0.02 * 0.02)
    np.testing.assert_allclose(rod.center, [0.0, 0.5, 0.0], atol=1e-15)


def test_a_joint_towards_the_world_is_reversed(tmp_path):
    built = MechanismBuilder()
    built.body("Brick Solid", "Rod", BrickDimensions="[1 1 1]")
    built.transform("Out", offset="[2 0 0]")
    built.joint("Prismatic", "Slide")
    built.meet("Rod", "Out lconn:1")
    built.meet("Out", "Slide lconn:1")
    built.meet("Slide", "World")
    (joint,) = built.mechanism(tmp_path).joints
    assert joint.reversed
    assert (joint.base, joint.follower) == (1, 0)


def test_a_loop_is_cut_at_its_last_joint_and_never_at_a_driven_one(tmp_path):
    assert names(four_bar().mechanism(tmp_path).loops) == ["D"]
    built = four_bar().set("D", TorqueActuationMode="InputTorque")
    assert names(built.mechanism(tmp_path).loops) == ["C"]


def test_a_6_dof_joint_is_a_base_or_a_sensor(tmp_path):
    built = pendulum()
    built.joint("6-DOF", "Six")
    built.physical(f"{built.sid('Six')}#lconn:1", f"{built.sid('World')}#rconn:1")
    built.lines[0].ports.append(f"{built.sid('Six')}#lconn:1")
    built.lines[-1].ports[:] = [f"{built.sid('Six')}#rconn:1", f"{built.sid('Rod')}#rconn:1"]
    measured = built.mechanism(tmp_path)
    assert names(measured.sensors) == ["Six"]
    assert names(measured.joints) == ["Pivot"]
    floating = built.remove("Pivot").mechanism(tmp_path)
    assert names(floating.joints) == ["Six"]
    assert not floating.sensors


def test_what_no_joint_holds_floats(tmp_path):
    built = pendulum()
    built.body("Spherical Solid", "Ball", SphereRadius="1")
    built.transform("Beside")
    built.meet("Ball", "Beside lconn:1")
    found = built.mechanism(tmp_path)
    assert [found.bodies[number].name for number in found.floating] == ["Ball"]


def test_a_chain_that_floats_begins_at_its_base(tmp_path):
    found = pendulum().remove("World").mechanism(tmp_path)
    (joint,) = found.joints
    assert not joint.reversed
    assert found.floating == (joint.base,)


def test_a_weld_makes_one_body_of_two(tmp_path):
    built = MechanismBuilder()
    built.body("Brick Solid", "Rod", BrickDimensions="[1 1 1]")
    built.joint("Weld", "Weld")
    built.meet("World", "Weld lconn:1")
    built.meet("Weld", "Rod")
    (world,) = built.mechanism(tmp_path).bodies
    assert [solid.block.name for solid, _ in world.solids] == ["Rod"]


def test_bodies_are_named_by_the_subsystem_that_holds_them(tmp_path):
    built = MechanismBuilder()
    for leg in ("Left leg", "Right leg"):
        system = built.add_block("SubSystem", leg)
        for name in ("a", "b"):
            built.add_library("sm_lib/Body Elements/Inertia", name, {}, system=system)
        a, b = (sid for sid, block in built.blocks.items() if block.system == system)
        built.physical(f"{a}#rconn:1", f"{b}#rconn:1")
    found = built.mechanism(tmp_path)
    assert [body.name for body in found.bodies[1:]] == ["Left_leg", "Right_leg"]


def test_all_that_is_missing_is_listed_at_once(tmp_path):
    built = pendulum(SpringStiffness="stiff").set("Rod", Density="heavy")
    built.set("Down", TranslationCartesianOffset="[0 L/2 0]")
    with pytest.raises(InvalidValueError, match="3 things are missing") as caught:
        built.mechanism(tmp_path)
    assert all(word in str(caught.value) for word in ("'stiff'", "'heavy'", "'[0 L/2 0]'"))


def test_all_values_that_a_block_lacks_are_listed_at_once(tmp_path):
    built = MechanismBuilder()
    built.body("Spherical Solid", "Ball", SphereRadius="r", Density="rho")
    built.body("Cylindrical Solid", "Rod", CylinderRadius="d", CylinderLength="l", Density="rho")
    built.meet("Ball", "Rod")
    with pytest.raises(InvalidValueError, match="4 things are missing") as caught:
        built.mechanism(tmp_path)
    assert all(f"give a value of {name}" in str(caught.value) for name in ("r", "rho", "d", "l"))


def test_a_colour_that_is_not_known_is_no_obstacle(tmp_path):
    built = pendulum().set("Rod", GraphicDiffuseColor="paint", GraphicOpacity="shine")
    ((solid, _),) = built.mechanism(tmp_path).bodies[1].solids
    assert solid.colour == (0.5, 0.5, 0.5, 1.0)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"BrickDimensions": "[1 1]"}, "'Rod'.*BrickDimensions.*3 numbers"),
        ({"BrickDimensions": "[1 0 1]"}, "'Rod'.*must be positive"),
        (
            {"InertiaType": "Custom", "MomentsOfInertia": "[1 1 5]"},
            "nothing can have .* 'Rod', 1, 1, 5 .* correct the inertia of 'Rod'",
        ),
        (
            {"InertiaType": "Custom", "ProductsOfInertia": "[2 0 0]"},
            "nothing can have .* 'Rod', -1, 1, 3",
        ),
        ({"InertiaType": "Custom", "Mass": "-1"}, "'Rod'.*Mass.*at least 0"),
    ],
)
def test_a_solid_that_is_none_is_named(tmp_path, changes, said):
    with pytest.raises(InvalidValueError, match=said):
        pendulum().set("Rod", **changes).mechanism(tmp_path)


def test_blocks_that_are_not_built_are_named(tmp_path):
    built = pendulum()
    beam = built.body("Flexible I Beam", "Beam")
    built.physical(f"{beam}#lconn:1", f"{built.sid('Down')}#lconn:1")
    with pytest.raises(
        InvalidValueError, match=r"'Beam'.*is a Flexible I Beam, which is not built"
    ):
        built.mechanism(tmp_path)


def test_an_inertia_of_another_domain_is_no_body(tmp_path):
    built = pendulum()
    for name in ("Fly", "Wheel"):
        built.add_library("fl_lib/Mechanical/Rotational Elements/Inertia", name, {"inertia": "x"})
    built.meet("Fly lconn:1", "Wheel lconn:1")
    assert len(built.mechanism(tmp_path).bodies) == 2


def test_a_block_of_a_library_that_is_not_there_is_named_where_it_meets_frames(tmp_path):
    built = pendulum()
    leg = built.add_library("my_lib/Leg", "Leg")
    built.add_library("my_lib/Controller", "Controller")
    built.physical(f"{leg}#lconn:1", f"{built.sid('Down')}#lconn:1")
    with pytest.raises(InvalidValueError, match=r"'Leg' \(SID \d+\) comes from 'my_lib/Leg'"):
        built.mechanism(tmp_path)


def test_transforms_that_contradict_each_other_are_refused(tmp_path):
    built = pendulum()
    built.transform("Other", offset="[0 0.6 0]")
    for port in ("lconn:1", "rconn:1"):
        built.physical(f"{built.sid('Down')}#{port}", f"{built.sid('Other')}#{port}")
    with pytest.raises(InvalidValueError, match="rigid loop that does not close"):
        built.mechanism(tmp_path)


def test_a_model_without_a_mechanism_says_so(tmp_path):
    with pytest.raises(InvalidValueError, match="'m' holds no mechanism"):
        MechanismBuilder().mechanism(tmp_path)


def test_a_belt_connects_no_frames(tmp_path):
    built = MechanismBuilder()
    for number in (1, 2):
        built.transform(f"At{number}", offset=f"[{number} 0 0]")
        built.joint("Revolute", f"Axle{number}")
        built.body("Cylindrical Solid", f"Wheel{number}")
        pulley = "sm_lib/Belts and Cables/Pulley"
        built.add_library(pulley, f"Pulley{number}", {"SenseWrapAngle": "on"})
        built.meet("World", f"At{number} lconn:1")
        built.meet(f"At{number}", f"Axle{number} lconn:1")
        built.meet(f"Axle{number}", f"Wheel{number}", f"Pulley{number} lconn:1")
    built.add_library("sm_lib/Belts and Cables/Belt-Cable Properties", "Belt")
    built.meet("Pulley1", "Pulley2", "Belt lconn:1")
    built.meet("Pulley1 rconn:2", "Pulley2 rconn:2")
    built.add_library("nesl_utility/PS-Simulink Converter", "Angle")
    built.meet("Pulley1 rconn:3", "Angle lconn:1")
    found = built.mechanism(tmp_path)
    assert [body.name for body in found.bodies] == ["world", "Wheel1", "Wheel2"]
    assert names(found.joints) == ["Axle1", "Axle2"]
    assert found.connections.left_out == {
        "Pulley": ("Pulley1", "Pulley2"),
        "Belt-Cable Properties": ("Belt",),
    }
