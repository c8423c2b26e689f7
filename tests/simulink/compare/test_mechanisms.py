"""Mechanisms are matched by what they are: branches, sensors anywhere, frames on solids, loops."""

import pytest
from model_changes import add_leg, drawn_first_last, rewired
from slx_models import (
    BRICK,
    RIGID_TRANSFORM,
    SPHERE,
    WORLD,
    published_leg,
    published_pendulum,
)

LEG = ("Revolute Joint", "Revolute Joint1", "Revolute Joint2")
BUSHING, TRANSFORM_SENSOR = (
    "sm_lib/Joints/Bushing Joint",
    ("sm_lib/Frames and Transforms/Transform Sensor"),
)


def counterparts(found):
    return {item["name"]: item["counterpart"] for item in found.matched if "sid" in item}


def changed(found):
    return sorted((item["name"], item["parameter"]) for item in found.different)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("legs", "order"), [(1, lambda model: model), (5, drawn_first_last)], ids=["after", "before"]
)
def test_further_legs_are_missing_and_the_one_leg_is_compared(compared, legs, order):
    model = published_leg()
    for leg in range(legs):
        add_leg(model, f"leg {leg}", f"[{0.1 * leg} 0.2 0]")
    found = compared(order(model))
    assert not found.different
    lost = {item["name"]: item["why"] for item in found.missing}
    assert len(lost) == legs * 9
    branch = "it is on the branch of 'leg 0 joint 0'"
    assert lost["leg 0 joint 0"].startswith("Drake has only 3 joints")
    assert {why[: len(branch)] for name, why in lost.items() if name[:7] == "leg 0 b"} == {branch}
    assert [counterparts(found)[name] for name in LEG] == [
        f"joint '{joint}'" for joint in ("hip", "knee", "ankle")
    ]
    model.set("Brick Solid1", Density="7850")
    assert changed(compared(model)) == [("Brick Solid1", "Density")]


def test_a_pendulum_is_found_beside_legs(compared):
    model = published_pendulum()
    for leg in range(2):
        add_leg(model, f"leg {leg}", f"[{leg} 0 0]")
    found = compared(model, "pendulum")
    assert not found.different
    assert counterparts(found)["Revolute Joint"].startswith("joint ")


def without_reference(model, brick):
    """Let a solid's ports be at frames of its own at both ends, F1 and F2, in place of R."""
    frame = (
        "<Frame><Name>{}</Name><Origin><Source>GeometricFeature</Source>"
        "<FeatureName>{}x surface</FeatureName></Origin>"
        "<PrimaryAxis><Source>ReferenceFrame</Source><SourceDirection>+X</SourceDirection>"
        "<DefinedDirection>+X</DefinedDirection></PrimaryAxis>"
        "<SecondaryAxis><Source>ReferenceFrame</Source><SourceDirection>+Y</SourceDirection>"
        "<DefinedDirection>+Y</DefinedDirection></SecondaryAxis></Frame>"
    )
    both = frame.format("F1", "-") + frame.format("F2", "+")
    model.set(brick, SerializedFrames=f"<Frames>{both}</Frames>", DoExposeReferenceFrame="off")


@pytest.mark.slow
def test_a_link_between_frames_of_its_solids_own(compared):
    model = published_leg()
    near, far = model.sid("Rigid Transform2"), model.sid("Rigid Transform3")
    brick = model.sid("Brick Solid1")
    without_reference(model, "Brick Solid1")
    rewired(model, f"{near}#lconn:1", f"{brick}#lconn:1")
    rewired(model, f"{far}#rconn:1", f"{brick}#rconn:1")
    model.remove("Rigid Transform2").remove("Rigid Transform3")
    model.lines = [
        line for line in model.lines if f"{brick}#rconn:1" not in line.ports or len(line.ports) > 1
    ]
    assert compared(model).agrees, (compared(model).different, compared(model).missing)
    model.set("Brick Solid1", BrickDimensions="[90 1 1]")
    found = compared(model)
    assert {name for name, _ in changed(found)} == {"Brick Solid1"}
    assert ("Brick Solid1", "length") in changed(found)


def test_a_center_of_mass_apart_from_the_frame_is_where_the_solid_is(compared):
    model = published_pendulum().set("Frame 2", TranslationStandardOffset="15")
    moments = "0.04/12*[.01^2+.01^2 .4^2+.01^2 .4^2+.01^2]"
    custom = {"InertiaType": "Custom", "Mass": "0.04", "MomentsOfInertia": moments}
    model.set("Brick Solid", CenterOfMass="[0.05 0 0]", CenterOfMassUnits="m", **custom)
    assert compared(model, "pendulum").agrees
    model.set("Brick Solid", CenterOfMass="[0.04 0 0]")
    assert changed(compared(model, "pendulum")) == [("Frame 2", "TranslationStandardOffset")]


def test_products_of_inertia_are_compared(compared):
    model = published_pendulum()
    moments = "0.04/12*[.01^2+.01^2 .4^2+.01^2 .4^2+.01^2]"
    custom = {"InertiaType": "Custom", "Mass": "0.04", "MomentsOfInertia": moments}
    model.set("Brick Solid", ProductsOfInertia="[1e-4 0 0]", **custom)
    assert changed(compared(model, "pendulum")) == [("Brick Solid", "ProductsOfInertia")]


def test_a_foot_drawn_as_another_shape_is_no_tibia(compared):
    model = published_leg().remove("Brick Solid2")
    model.blocks[model.sid("Spherical Solid")].source = BRICK
    model.set("Spherical Solid", BrickDimensions="[5 5 5]", BrickDimensionsUnits="mm")
    found = compared(model)
    assert counterparts(found)["Spherical Solid"] == "body 'foot'"
    assert ("Spherical Solid", "shape") in changed(found)
    assert ("Revolute Joint2", "solid on its follower") in changed(found)


@pytest.mark.parametrize("factor", ["1000", "100", "0.001"])
def test_a_pendulum_in_another_unit_is_one_difference(compared, factor):
    model = published_pendulum()
    model.set("Frame 2", TranslationStandardOffset=f"20*{factor}")
    model.set("Brick Solid", BrickDimensions=f"[0.4 0.01 0.01]*{factor}")
    (one,) = compared(model, "pendulum").different
    assert (one["what"], one["simulink"]) == ("scale", pytest.approx(float(factor)))


def test_one_wrong_length_beside_another_unit(compared):
    """Six lengths of seven in millimeters typed as meters: one factor, and one difference."""
    model = published_leg()
    for block in model.blocks.values():
        for key in ("TranslationCartesianOffset", "BrickDimensions", "SphereRadius"):
            if key in block.parameters:
                block.parameters[key] = f"1000*{block.parameters[key]}"
    model.set("Brick Solid1", BrickDimensions="1000*[90 1 1]")
    found = compared(model)
    assert [item["what"] for item in found.different] == ["scale", "parameter"]
    assert changed(found)[1] == ("Brick Solid1", "length")


def with_sensor(model, source, base="", **sensed):
    """Take another block for the sensor of the foot; its base may be at another port."""
    old = model.sid("6-DOF Joint")
    sensor = model.blocks[old]
    sensor.source = source
    for name in [name for name in sensor.parameters if "Sense" in name]:
        del sensor.parameters[name]
    sensor.parameters.update(sensed)
    if base:
        rewired(model, f"{old}#lconn:1", "nothing")
        model.lines = [line for line in model.lines if "nothing" not in line.ports]
        model.physical(f"{old}#lconn:1", base)
    return model


def without_rotation(model):
    return model.remove("PS-Simulink Q").remove("Q")


POSITIONS = {
    f"{axis}Sense{what}": "on" for axis in ("Px", "Py", "Pz") for what in ("Position", "Velocity")
}


@pytest.mark.slow
def test_a_bushing_joint_is_a_sensor(compared):
    model = without_rotation(with_sensor(published_leg(), BUSHING, **POSITIONS))
    found = compared(model)
    assert found.agrees, (found.different, found.missing)
    assert counterparts(found)["6-DOF Joint"] == "'6-DOF Joint'"
    model.set("6-DOF Joint", RzSpringStiffness="2")
    assert changed(compared(model)) == [("6-DOF Joint", "RzSpringStiffness")]


@pytest.mark.parametrize("source", ["sm_lib/Joints/6-DOF Joint", BUSHING])
def test_a_sensor_on_a_moving_link_is_one_difference(compared, source):
    model = published_leg()
    base = f"{model.sid('Revolute Joint')}#rconn:1"
    model = without_rotation(with_sensor(model, source, base, **POSITIONS))
    found = compared(model)
    assert changed(found) == [("6-DOF Joint", "link that it measures from")]
    assert found.different[0]["simulink"] == "the link of joint 'Revolute Joint'"
    assert not found.missing


def test_a_sensor_of_another_link(compared):
    model = published_leg()
    sensor = model.sid("6-DOF Joint")
    rewired(model, f"{sensor}#rconn:1", "nothing")
    model.lines = [line for line in model.lines if "nothing" not in line.ports]
    model.physical(f"{sensor}#rconn:1", f"{model.sid('Revolute Joint1')}#rconn:1")
    assert ("6-DOF Joint", "link that is sensed") in changed(compared(without_rotation(model)))


def test_a_sensor_whose_base_is_not_at_the_world_frame(compared):
    model = published_leg()
    sensor = model.sid("6-DOF Joint")
    moved = {"TranslationMethod": "Cartesian", "TranslationCartesianOffset": "[0 0 .1]"}
    transform = model.add_library(RIGID_TRANSFORM, "Stand", moved, ports={"lconn": 1, "rconn": 1})
    rewired(model, f"{sensor}#lconn:1", f"{transform}#lconn:1")
    model.physical(f"{transform}#rconn:1", f"{sensor}#lconn:1")
    assert changed(compared(model)) == [("Stand", "TranslationCartesianOffset")]


def test_a_joint_that_closes_a_loop_is_named_as_that(compared):
    model = published_leg()
    pin = model.add_library("sm_lib/Joints/Spherical Joint", "Pin", ports={"lconn": 1, "rconn": 1})
    world = model.add_library(WORLD, "World Frame2", ports={"rconn": 1})
    model.physical(f"{world}#rconn:1", f"{pin}#lconn:1")
    model.physical(f"{pin}#rconn:1", f"{model.sid('Spherical Solid')}#rconn:1")
    (one,) = compared(model).missing
    assert (one["name"], one["why"]) == ("Pin", "it closes a loop, which Drake does not have")


def with_a_joint_before(model, name, joint="sm_lib/Joints/Prismatic Joint"):
    """Put a joint between another one and its base."""
    old = f"{model.sid(name)}#lconn:1"
    lift = model.add_library(joint, "Lift", ports={"lconn": 1, "rconn": 1})
    rewired(model, old, f"{lift}#lconn:1")
    model.physical(f"{lift}#rconn:1", old)
    return model


@pytest.mark.slow
@pytest.mark.parametrize("before", LEG)
def test_a_joint_too_many_is_one_finding(compared, before):
    found = compared(with_a_joint_before(published_leg(), before))
    (one,) = found.missing
    assert (one["name"], one["why"][:23]) == ("Lift", "it is a joint too many:")
    assert [counterparts(found)[name] for name in LEG] == [
        f"joint '{joint}'" for joint in ("hip", "knee", "ankle")
    ]
    model = with_a_joint_before(published_leg(), before).set("Brick Solid2", Density="7850")
    assert ("Brick Solid2", "Density") in changed(compared(model))


def test_a_joint_too_few_is_a_difference(compared):
    model = published_leg()
    model.blocks[model.sid("Revolute Joint1")].source = "sm_lib/Joints/Weld Joint"
    found = compared(model)
    assert ("Revolute Joint2", "joint before it") in changed(found)
    assert counterparts(found)["Revolute Joint2"] == "joint 'ankle'"


def test_a_ball_on_the_world_has_no_counterpart(compared):
    model = published_leg()
    ball = model.add_library(SPHERE, "Ball", ports={"rconn": 1})
    model.physical(f"{ball}#rconn:1", f"{model.sid('World Frame')}#rconn:1")
    (one,) = compared(model).missing
    assert (one["name"], one["why"]) == ("Ball", "the world has no such solid in Drake")
