"""Faces, edges and corners of solids, by their names."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.features import (
    ball_feature,
    brick_feature,
    cylinder_feature,
    extrusion_feature,
    revolution_feature,
)

EDGES = (2.0, 4.0, 6.0)
SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])  # counterclockwise
CENTROID = np.array([1.0, 0.5])


@pytest.mark.parametrize(
    ("name", "center", "normal"),
    [
        ("+z surface", (0, 0, 3), (0, 0, 1)),
        ("-y surface", (0, -2, 0), (0, -1, 0)),
        ("-z +x curve", (1, 0, -3), None),
        ("+x -y +z point", (1, -2, 3), None),
    ],
)
def test_brick(name, center, normal):
    found = brick_feature(name, EDGES)
    assert tuple(found.center) == center
    assert (found.normal is None) if normal is None else tuple(found.normal) == normal


@pytest.mark.parametrize(
    ("name", "height", "normal"),
    [("top surface", 0.5, 1), ("bottom curve", -0.5, -1), ("side surface", 0.0, None)],
)
def test_cylinder(name, height, normal):
    found = cylinder_feature(name, 1.0)
    assert tuple(found.center) == (0.0, 0.0, height)
    assert (found.normal is None) if normal is None else tuple(found.normal) == (0, 0, normal)


@pytest.mark.parametrize(
    ("name", "center", "normal"),
    [
        ("top surface", (1, 0.5, 0.25), (0, 0, 1)),
        ("bottom surface", (1, 0.5, -0.25), (0, 0, -1)),
        ("side surface 1", (1, 0, 0), (0, -1, 0)),
        ("side surface 2", (2, 0.5, 0), (1, 0, 0)),
        ("side surface 4", (0, 0.5, 0), (-1, 0, 0)),
        ("side curve 3", (2, 1, 0), None),
        ("top curve 2", (2, 0.5, 0.25), None),
        ("bottom point 3", (2, 1, -0.25), None),
    ],
)
def test_extrusion(name, center, normal):
    found = extrusion_feature(name, SQUARE, 0.5, CENTROID)
    np.testing.assert_allclose(found.center, center, atol=1e-15)
    assert (found.normal is None) == (normal is None)
    if normal is not None:
        np.testing.assert_allclose(found.normal, normal, atol=1e-15)


WHEEL = np.array([[1.0, 0.5], [2.0, 0.5], [2.0, 1.5], [1.5, 2.0], [1.0, 2.0]])


@pytest.mark.parametrize(
    ("number", "height", "normal"),
    [(1, 0.5, -1), (2, 1.0, None), (4, 2.0, 1), (5, 1.25, None)],
)
def test_revolution(number, height, normal):
    found = revolution_feature(f"side surface {number}", WHEEL)
    assert tuple(found.center) == (0.0, 0.0, height)
    assert (found.normal is None) if normal is None else tuple(found.normal) == (0, 0, normal)


def test_balls_have_one_surface():
    assert not ball_feature("surface").center.any()


@pytest.mark.parametrize(
    "find",
    [
        lambda: brick_feature("top surface", EDGES),
        lambda: cylinder_feature("+z surface", 1.0),
        lambda: ball_feature("top point"),
        lambda: extrusion_feature("side surface 5", SQUARE, 0.5, CENTROID),
        lambda: extrusion_feature("side surface 0", SQUARE, 0.5, CENTROID),
        lambda: extrusion_feature("+z surface", SQUARE, 0.5, CENTROID),
        lambda: revolution_feature("side surface 3", WHEEL),  # a cone
        lambda: revolution_feature("side surface 6", WHEEL),
        lambda: revolution_feature("top surface", WHEEL),
    ],
)
def test_what_is_not_there_is_named(find):
    with pytest.raises(InvalidValueError, match="it has no '"):
        find()
