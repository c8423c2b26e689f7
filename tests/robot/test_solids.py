"""Mass and inertia of solids, against Drake's."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.multibody.tree import SpatialInertia

from drake_leg.errors import InvalidValueError
from drake_leg.robot.solids import Brick, Cylinder, Solid, Sphere, mass_properties, volume

size = st.floats(1e-3, 2.0)
density = st.floats(1.0, 2e4)


def check(shape, density, drakes):
    solid = Solid(shape=shape, density=density, centre=(1.0, 2.0, 3.0), colour=(0.0, 0.0, 0.0))
    own = mass_properties(solid)
    inertia = drakes.CalcRotationalInertia()
    assert own.mass == pytest.approx(drakes.get_mass(), rel=1e-13)
    np.testing.assert_allclose(
        own.moments, inertia.get_moments(), rtol=1e-12, atol=1e-15 * max(own.moments)
    )
    np.testing.assert_array_equal(inertia.get_products(), 0.0)


@given(size, size, size, density)
def test_a_brick_is_drakes_box(length, width, height, density):
    drakes = SpatialInertia.SolidBoxWithDensity(density, length, width, height)
    check(Brick(length=length, width=width, height=height), density, drakes)


@given(size, size, density)
def test_a_cylinder_is_drakes_cylinder_about_z(radius, length, density):
    drakes = SpatialInertia.SolidCylinderWithDensity(density, radius, length, [0.0, 0.0, 1.0])
    check(Cylinder(radius=radius, length=length), density, drakes)


@given(size, density)
def test_a_ball_is_drakes_sphere(radius, density):
    drakes = SpatialInertia.SolidSphereWithDensity(density, radius)
    check(Sphere(radius=radius), density, drakes)


@pytest.mark.parametrize("radius", [1e-120, 1e120])
def test_a_ball_beyond_all_measure_is_refused(radius):
    with pytest.raises(InvalidValueError, match="radius is 1e"):
        Sphere(radius=radius)


def test_volumes_are_the_textbooks():
    assert volume(Brick(length=2.0, width=3.0, height=5.0)) == 30.0
    assert volume(Cylinder(radius=2.0, length=3.0)) == pytest.approx(12 * math.pi)
    assert volume(Sphere(radius=3.0)) == pytest.approx(36 * math.pi)
