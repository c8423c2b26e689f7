"""Margins of support: distances from the edge of a polygon, of one point or of many."""

import math

import numpy as np
import pytest

from drake_leg.kinematics.walking.margins import on_ground, support_margin, zero_moment_point


@pytest.mark.parametrize(
    ("feet", "point", "margin"),
    [
        ([(0, 0), (1, 0), (1, 1), (0, 1)], (0.5, 0.4), 0.4),
        ([(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)], (0.5, 0.4), 0.4),
        ([(0, 0), (1, 0), (1, 1), (0, 1)], (1.3, 0.5), -0.3),
        ([(0, 0), (1, 0), (0, 1)], (2.0, 0.0), -1.0),
        ([(0, 0), (1, 0)], (0.5, 0.2), -0.2),
        ([(0, 0), (1, 0), (2, 0)], (1.5, 0.0), 0.0),
        ([(0, 0)], (3.0, 4.0), -5.0),
        ([], (0.0, 0.0), -math.inf),
    ],
)
def test_the_margin_is_the_distance_from_the_edge_of_support(feet, point, margin):
    found = support_margin(np.array(feet, dtype=float).reshape(-1, 2), point)
    assert found == pytest.approx(margin, abs=1e-15)


def test_margins_of_many_points_are_those_of_each_with_the_feet_that_are_down():
    random = np.random.default_rng(2)
    feet = random.uniform(-0.2, 0.2, (300, 6, 2))
    points = random.uniform(-0.15, 0.15, (300, 2))
    down = random.uniform(size=(300, 6)) < 0.6
    found = support_margin(feet, points, down)
    each = [
        float(support_margin(places[stands], at))
        for places, stands, at in zip(feet, down, points, strict=True)
    ]
    assert found.tolist() == each
    assert (found > 0.0).any()
    assert (found < 0.0).any()


def test_the_margin_inside_is_the_greatest_circle_around_the_point_in_the_hull():
    spatial = pytest.importorskip("scipy.spatial")
    random = np.random.default_rng(4)
    for _ in range(50):
        feet = random.uniform(-1.0, 1.0, (5, 2))
        point = feet.mean(axis=0)
        equations = spatial.ConvexHull(feet).equations  # outward normals, offsets
        expected = -(equations[:, :2] @ point + equations[:, 2]).max()
        assert support_margin(feet, point) == pytest.approx(expected, abs=1e-14)


def test_on_a_slope_the_point_is_found_along_gravity():
    gravity = 9.81 * np.array([np.sin(0.2), 0.0, -np.cos(0.2)])  # uphill is against x
    at = on_ground(np.array([0.3, 0.1, 0.15]), gravity, 0.05)
    assert at == pytest.approx([0.3 + 0.1 * np.tan(0.2), 0.1], abs=1e-15)


def test_a_wrench_has_no_horizontal_moment_about_its_zero_moment_point():
    random = np.random.default_rng(6)
    moment, force = random.uniform(-1.0, 1.0, (2, 20, 3))
    force[:, 2] -= 3.0
    at = np.column_stack([zero_moment_point(moment, force, 0.07), np.full(20, 0.07)])
    assert (moment - np.cross(at, force))[:, :2] == pytest.approx(np.zeros((20, 2)), abs=1e-15)
