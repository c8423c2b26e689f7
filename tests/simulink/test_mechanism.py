"""Poses and solids of a model's bodies, its physical network, and the walk over its frames."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from slx_models import BRICK, REVOLUTE, RIGID_TRANSFORM, SIX_DOF, TO_SIMULINK, WORLD, published_leg
from slx_writer import ModelBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.robot.solids import Brick, Cylinder, Solid, Sphere, mass_properties
from drake_leg.robot.solids import volume as volume_of
from drake_leg.simulink.catalogue import MULTIBODY
from drake_leg.simulink.mechanism import (
    OTHER,
    SHAPES,
    SOLIDS,
    Walk,
    about,
    inverse,
    network_of,
    pose,
    read_solid,
    rigid_transform,
    rotation_text,
    volume,
)
from drake_leg.simulink.model import Block
from drake_leg.simulink.parameters import default_values
from drake_leg.simulink.reader import read_model
from drake_leg.simulink.wiring import flatten


def transform(**parameters):
    block = Block(
        sid="1",
        name="Rigid Transform",
        type="Reference",
        source="sm_lib/Frames and Transforms/Rigid Transform",
        system="",
        parameters=parameters,
    )
    return rigid_transform(block)


def quarter(axis):
    return Rotation.from_euler(axis, 90, degrees=True).as_matrix()


def test_nothing_is_the_identity():
    np.testing.assert_array_equal(transform(), np.eye(4))


@pytest.mark.parametrize("axis", ["+X", "-X", "+Y", "-Y", "+Z", "-Z"])
def test_standard_axis(axis):
    R = transform(
        RotationMethod="StandardAxis", RotationStandardAxis=axis, RotationAngle=math.pi / 2
    )[:3, :3]
    expected = quarter(axis[1].lower())
    np.testing.assert_allclose(R, expected if axis[0] == "+" else expected.T, atol=1e-15)
    along = transform(
        TranslationMethod="StandardAxis",
        TranslationStandardAxis=axis,
        TranslationStandardOffset=2.0,
    )
    assert along[:3, 3] @ np.eye(3)["XYZ".index(axis[1])] == (2.0 if axis[0] == "+" else -2.0)


def test_all_ways_to_say_a_quarter_turn_about_x_agree():
    ways = [
        {
            "RotationMethod": "StandardAxis",
            "RotationStandardAxis": "+X",
            "RotationAngle": math.pi / 2,
        },
        {
            "RotationMethod": "ArbitraryAxis",
            "RotationArbitraryAxis": (3.0, 0.0, 0.0),
            "RotationAngle": math.pi / 2,
        },
        {
            "RotationMethod": "AlignedAxes",
            "FollAlignAxisA": "+Z",
            "BaseAlignAxisA": "-Y",
            "FollAlignAxisB": "+X",
            "BaseAlignAxisB": "+X",
        },
        {
            "RotationMethod": "RotationSequence",
            "RotationSequence": "XYZ",
            "RotationSequenceAngles": (math.pi / 2, 0.0, 0.0),
        },
        {
            "RotationMethod": "RotationMatrix",
            "RotationMatrix": ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
        },
        {"RotationMethod": "Quaternion", "RotationQuaternion": (1.0, 1.0, 0.0, 0.0)},
    ]
    for way in ways:
        np.testing.assert_allclose(transform(**way)[:3, :3], quarter("x"), atol=1e-15)


def test_sequences_are_about_the_follower_or_the_base():
    angles = (0.3, -0.5, 0.9)
    common = {"RotationMethod": "RotationSequence", "RotationSequence": "ZYX"}
    common["RotationSequenceAngles"] = angles
    follower = transform(**common, RotationSequenceAxes="FollowerAxes")[:3, :3]
    base = transform(**common, RotationSequenceAxes="BaseAxes")[:3, :3]
    turns = [
        Rotation.from_euler(axis, angle).as_matrix()
        for axis, angle in zip("zyx", angles, strict=True)
    ]
    np.testing.assert_allclose(follower, turns[0] @ turns[1] @ turns[2], atol=1e-15)
    np.testing.assert_allclose(base, turns[2] @ turns[1] @ turns[0], atol=1e-15)


def test_cylindrical_translation():
    X = transform(
        TranslationMethod="Cylindrical",
        TranslationCylindricalRadius=2.0,
        TranslationCylindricalTheta=math.pi / 3,
        TranslationCylindricalZOffset=0.5,
    )
    np.testing.assert_allclose(X[:3, 3], [1.0, math.sqrt(3.0), 0.5], atol=1e-15)


def test_translation_comes_before_the_turn():
    X = transform(
        TranslationMethod="Cartesian",
        TranslationCartesianOffset=(1.0, 2.0, 3.0),
        RotationMethod="StandardAxis",
        RotationStandardAxis="+Z",
        RotationAngle=math.pi / 2,
    )
    np.testing.assert_array_equal(X[:3, 3], [1.0, 2.0, 3.0])


def test_inverse(rng):
    X = pose(Rotation.random(random_state=1).as_matrix(), rng.normal(size=3))
    np.testing.assert_allclose(inverse(X) @ X, np.eye(4), atol=1e-15)


def test_rotation_text():
    assert rotation_text(np.eye(3)) == "no rotation"
    assert rotation_text(about("y", -math.pi / 2)[:3, :3]) == "90 deg about -y"
    assert rotation_text(Rotation.from_rotvec([0.1, 0.1, 0]).as_matrix()).startswith("8.1")


@pytest.mark.parametrize(
    "parameters",
    [
        {"RotationMethod": "Telepathy"},
        {"TranslationMethod": "Telepathy"},
        {"RotationMethod": "StandardAxis", "RotationStandardAxis": "+W"},
        {
            "RotationMethod": "ArbitraryAxis",
            "RotationArbitraryAxis": (0.0, 0.0, 0.0),
            "RotationAngle": 0.1,
        },
        {"RotationMethod": "Quaternion", "RotationQuaternion": (0.0, 0.0, 0.0, 0.0)},
        {"RotationMethod": "RotationMatrix", "RotationMatrix": ((1.0, 0.0), (0.0, 1.0))},
        {"RotationMethod": "RotationSequence", "RotationSequence": "XQZ"},
        {"TranslationMethod": "Cartesian", "TranslationCartesianOffset": (1.0, 2.0)},
        {
            "RotationMethod": "AlignedAxes",
            "FollAlignAxisA": "+Z",
            "BaseAlignAxisA": "+Z",
            "FollAlignAxisB": "+Z",
            "BaseAlignAxisB": "+X",
        },
    ],
)
def test_what_makes_no_rotation_is_refused_by_name(parameters):
    if parameters.get("RotationMethod") == "RotationSequence":
        parameters = parameters | {"RotationSequenceAngles": (0.1, 0.2, 0.3)}
    with pytest.raises(InvalidValueError, match=r"'Rigid Transform' \(SID 1\)"):
        transform(**parameters)


def test_no_rotation_needs_no_axis():
    nothing = {"RotationMethod": "ArbitraryAxis", "RotationArbitraryAxis": (0.0, 0.0, 0.0)}
    np.testing.assert_array_equal(transform(**nothing, RotationAngle=0.0), np.eye(4))


LIBRARY = "sm_lib/Body Elements"
OF_2016 = {"brick": "Brick", "cylinder": "Cylinder", "sphere": "Sphere"}  # GeometryShape
SIZES = {
    "brick": {"BrickDimensions": (0.3, 0.02, 0.01)},
    "cylinder": {"CylinderRadius": 0.013, "CylinderLength": 0.7},
    "sphere": {"SphereRadius": 0.003},
}
OF_ROBOTS = {
    "brick": Brick(length=0.3, width=0.02, height=0.01),
    "cylinder": Cylinder(radius=0.013, length=0.7),
    "sphere": Sphere(radius=0.003),
}
KIND_OF = {shape: kind for kind, shape in SHAPES.items()}
SHAPELESS = sorted({*SOLIDS} - {*SHAPES, "Solid", "Inertia"})


def solid(kind, **parameters):
    """Read a block that is untouched but for these parameters."""
    source = f"{LIBRARY}/{kind}"
    defaults = default_values("Reference", source)
    return read_solid(
        Block(
            sid="1",
            name=kind,
            type="Reference",
            source=source,
            system="",
            parameters={**defaults, **parameters},
        )
    )


@pytest.mark.parametrize("shape", SIZES)
def test_shape_size_and_mass_from_density(shape):
    found = solid(KIND_OF[shape], Density=7850.0, **SIZES[shape])
    assert found.shape == shape
    assert found.density == 7850.0
    assert list(found.size) == list(vars(OF_ROBOTS[shape]).values())
    same = Solid(shape=OF_ROBOTS[shape], density=7850.0, centre=(0.0,) * 3, colour=(0.0,) * 3)
    assert found.mass == pytest.approx(mass_properties(same).mass, rel=1e-15)
    assert found.moments == found.offsets == ()


@pytest.mark.parametrize("shape", SIZES)
def test_volume_is_that_of_a_robots_shape(shape):
    size = tuple(vars(OF_ROBOTS[shape]).values())
    assert volume(shape, size) == pytest.approx(volume_of(OF_ROBOTS[shape]), rel=1e-15)


@pytest.mark.parametrize("shape", SIZES)
def test_block_of_2016_says_the_same(shape):
    old = solid("Solid", GeometryShape=OF_2016[shape], **SIZES[shape])
    assert old == solid(KIND_OF[shape], **SIZES[shape])


@pytest.mark.parametrize("shape", ["Ellipsoid", "RegularExtrusion", "FromFile"])
def test_other_shapes_of_2016(shape):
    assert solid("Solid", GeometryShape=shape).shape == OTHER


@pytest.mark.parametrize("kind", SHAPELESS)
def test_shape_that_is_not_known_has_a_density_alone(kind):
    found = solid(kind, Density=2700.0)
    assert (found.shape, found.size, found.density, found.mass) == (OTHER, (), 2700.0, 0.0)


@pytest.mark.parametrize("kind", [*SHAPES, *SHAPELESS])
def test_mass_said_outright_leaves_the_moments_to_the_shape(kind):
    found = solid(kind, BasedOnType="Mass", Mass=0.25)
    assert (found.density, found.mass, found.moments) == (None, 0.25, ())


@pytest.mark.parametrize("kind", [*SHAPES, "Inertia"])
def test_point_mass_has_no_moments(kind):
    found = solid(kind, InertiaType="PointMass", Mass=0.25, CenterOfMass=(0.1, 0.0, 0.0))
    assert (found.density, found.mass) == (None, 0.25)
    assert (found.moments, found.offsets) == ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0))


@pytest.mark.parametrize("kind", [*SHAPES, "Inertia"])
def test_custom_inertia_is_told_whole(kind):
    found = solid(
        kind,
        InertiaType="Custom",
        Mass=0.25,
        CenterOfMass=(0.1, 0.2, 0.3),
        MomentsOfInertia=(1.0, 2.0, 3.0),
        ProductsOfInertia=(4.0, 5.0, 6.0),
    )
    assert (found.density, found.mass, found.moments) == (None, 0.25, (1.0, 2.0, 3.0))
    assert found.offsets == (0.1, 0.2, 0.3, 4.0, 5.0, 6.0)


def test_solids_are_what_has_a_mass():
    heavy = {kind for kind, known in MULTIBODY.items() if "Mass" in {one.name for one in known}}
    assert heavy - {"Gravitational Field"} == {*SOLIDS}  # the field has that of its center


def test_inertia_is_no_shape_and_no_density():
    found = solid("Inertia")
    assert (found.shape, found.density, found.mass, found.colour) == (OTHER, None, 1.0, ())


def test_colour_without_its_opacity():
    found = solid("Brick Solid", GraphicDiffuseColor=(0.1, 0.2, 0.3, 0.5))
    assert found.colour == (0.1, 0.2, 0.3)


def test_numbers_that_no_solid_has_are_read_as_they_are():
    assert solid("Brick Solid", BrickDimensions=(0.1, -0.2)).size == (0.1, -0.2)
    assert solid("Brick Solid", BrickDimensions="size").size == ()
    assert solid("Spherical Solid", SphereRadius=0.0).mass == 0.0
    for huge in ({"CylinderRadius": 1e200}, {"CylinderRadius": -1e200, "CylinderLength": 1e-200}):
        assert solid("Cylindrical Solid", **huge).mass == math.inf
    assert solid("Spherical Solid", SphereRadius=1e200).mass == math.inf


def test_units_of_a_file(tmp_path):
    model = read_model(published_leg().write(tmp_path / "leg.slx"))
    read = {block.name: read_solid(block) for block in model.blocks if block.kind in SOLIDS}
    assert sorted(read) == ["Brick Solid0", "Brick Solid1", "Brick Solid2", "Spherical Solid"]
    assert read["Brick Solid1"].size == pytest.approx((0.1, 0.001, 0.001))
    assert read["Brick Solid1"].mass == pytest.approx(1e-4)
    assert read["Spherical Solid"].size == pytest.approx((0.003,))


TWO = {"lconn": 1, "rconn": 1}


def network(builder, tmp_path):
    return network_of(flatten(read_model(builder.write(tmp_path / "m.slx"))))


def arm():
    """Draw two joints in a row with a transform between them; the first one is sensed."""
    model = ModelBuilder()
    world = model.add_library(WORLD, "World", ports={"rconn": 1})
    first = model.add_library(REVOLUTE, "First", {"SensePosition": "on"}, ports=TWO)
    link = model.add_library(RIGID_TRANSFORM, "Link", ports=TWO)
    second = model.add_library(REVOLUTE, "Second", ports=TWO)
    solid = model.add_library(BRICK, "Solid", ports={"rconn": 1})
    converter = model.add_library(TO_SIMULINK, "Converter", ports={"lconn": 1, "out": 1})
    model.physical(f"{world}#rconn:1", f"{first}#lconn:1")
    model.physical(f"{first}#rconn:1", f"{link}#lconn:1")
    model.physical(f"{link}#rconn:1", f"{second}#lconn:1")
    model.physical(f"{second}#rconn:1", f"{solid}#rconn:1")
    model.physical(f"{first}#rconn:2", f"{converter}#lconn:1")
    return model


def steps(found, rank=lambda block, body: (0,)):
    walk = Walk(found, rank)
    world = next(block for block in found.blocks.values() if block.kind == "World Frame")
    return [walk.take(world), *walk]


def test_signals_and_frames_are_told_apart(tmp_path):
    found = network(arm(), tmp_path)
    assert len(found.signals) == 1
    assert len(set(found.frames.values())) == 4
    names = {sid: block.name for sid, block in found.blocks.items()}
    assert {names[sid] for sid in found.sensed} == {"First"}
    assert "Converter" not in {names[sid] for sid in found.mechanical}


def test_a_walk_numbers_the_bodies_from_the_world(tmp_path):
    found = steps(network(arm(), tmp_path))
    assert [(step.block.name, step.body, step.beyond) for step in found] == [
        ("World", 0, 0),
        ("First", 0, 1),
        ("Link", 1, 1),
        ("Second", 1, 2),
        ("Solid", 2, 2),
    ]
    assert [step.near[0].partition("#")[2] for step in found[1:4]] == ["lconn:1"] * 3


def test_a_joint_that_closes_a_loop_leads_nowhere(tmp_path):
    model = arm()
    closing = model.add_library(SIX_DOF, "Closing", ports=TWO)
    model.physical(f"{model.sid('World')}#rconn:1", f"{closing}#lconn:1")
    model.physical(f"{model.sid('Solid')}#rconn:1", f"{closing}#rconn:1")
    last = steps(network(model, tmp_path), lambda block, body: (block.kind == "6-DOF Joint",))[-1]
    assert last.block.name == "Closing"
    assert [port.partition("#")[2] for port in last.near] == ["lconn:1", "rconn:1"]
    assert last.far == ()
    assert last.body == last.beyond == 0


def test_blocks_without_a_rank_are_not_entered(tmp_path):
    found = steps(
        network(arm(), tmp_path), lambda block, body: None if block.name == "Second" else (0,)
    )
    assert [step.block.name for step in found] == ["World", "First", "Link"]


def test_a_joint_that_hangs_free_has_two_bodies(tmp_path):
    model = ModelBuilder()
    model.add_library(REVOLUTE, "Free", ports=TWO)
    found = network(model, tmp_path)
    walk = Walk(found, lambda block, body: (0,))
    (block,) = found.blocks.values()
    step = walk.take(block)
    assert step.near == ()
    assert (step.body, step.beyond) == (1, 2)
    assert [walk.reached[frame] for frame in found.ends(block)] == [1, 2]
