"""Solids of Simscape Multibody: what they are, however their blocks say it."""

import math

import pytest
from slx_models import published_leg

from drake_leg.robot.robot import Brick, Cylinder, Solid, Sphere, mass_properties
from drake_leg.robot.robot import volume as volume_of
from drake_leg.simulink.catalogue import MULTIBODY
from drake_leg.simulink.mechanism import OTHER, SHAPES, SOLIDS, read_solid, volume
from drake_leg.simulink.model import Block
from drake_leg.simulink.parameters import default_values
from drake_leg.simulink.reader import read_model

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
    assert heavy == {*SOLIDS}


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
