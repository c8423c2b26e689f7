"""Mass properties of solids, against closed forms and against sums over many small parts."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import (
    brick,
    cylinder,
    ellipsoid,
    extrusion,
    of_mass,
    revolution,
)


def assert_same(first, second, rtol=1e-12):
    assert first.mass == pytest.approx(second.mass, rel=rtol)
    size = math.sqrt(np.trace(second.inertia) / second.mass)
    np.testing.assert_allclose(first.center, second.center, atol=rtol * size)
    np.testing.assert_allclose(first.inertia, second.inertia, atol=rtol * second.mass * size**2)


def rectangle(x0, x1, y0, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def moments(density, *parts):
    """Mass, first and second moments about R of solids that are added."""
    mass = sum(sign * one.mass for sign, one in parts)
    first = sum(sign * one.mass * one.center for sign, one in parts)
    about = sum(sign * (one.inertia + one.mass * shift(one.center)) for sign, one in parts)
    return mass, first / mass, about - mass * shift(first / mass)


def shift(p):
    return p @ p * np.eye(3) - np.outer(p, p)


def test_closed_forms():
    ball = ellipsoid([0.1, 0.1, 0.1], 500.0)
    assert ball.mass == pytest.approx(4 / 3 * math.pi * 1e-3 * 500)
    np.testing.assert_allclose(ball.inertia, 0.4 * ball.mass * 0.01 * np.eye(3))
    box = brick([1.0, 2.0, 3.0], 2.0)
    assert box.mass == 12.0
    np.testing.assert_allclose(np.diag(box.inertia), [13.0, 10.0, 5.0])
    rod = cylinder(0.1, 2.0, 1000.0)
    moment = rod.mass * (3 * 0.01 + 4.0) / 12
    np.testing.assert_allclose(np.diag(rod.inertia), [moment, moment, rod.mass * 0.005])


def test_an_extruded_rectangle_is_a_brick():
    assert_same(extrusion(rectangle(-1, 1, -0.5, 0.5), 3.0, 7.0), brick([2, 1, 3], 7.0))


def test_an_extrusion_with_a_hole_is_a_difference():
    outer, hole = rectangle(-1, 1, -1, 1), rectangle(0.1, 0.4, 0.2, 0.9)
    whole = extrusion(outer, 0.5, 10.0)
    way = [*outer, outer[0], hole[0], *reversed(hole), outer[0]]
    found = extrusion(way, 0.5, 10.0)
    mass, center, inertia = moments(10.0, (1, whole), (-1, extrusion(hole, 0.5, 10.0)))
    assert found.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(found.center, center, atol=1e-12)
    np.testing.assert_allclose(found.inertia, inertia, atol=1e-12)


def test_a_revolved_rectangle_is_a_cylinder():
    assert_same(revolution(rectangle(0, 0.2, -0.5, 0.5), 9.0), cylinder(0.2, 1.0, 9.0))


@pytest.mark.parametrize("angle", [0.3, math.pi / 2, math.pi, 5.0, math.tau])
def test_a_revolution_is_the_integral_over_its_section_and_angle(angle):
    triangle = np.array([(0.1, -0.2), (0.5, 0.1), (0.2, 0.4)])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    nodes, weights = (nodes + 1) / 2, weights / 2
    u, v, w = np.meshgrid(nodes, nodes, nodes, indexing="ij")
    scale = np.einsum("i,j,k->ijk", weights, weights, weights)
    a, b, c = triangle
    jacobian = abs(np.linalg.det(np.array([b - a, c - a]))) * (1 - u)
    r, z = np.moveaxis(a + u[..., None] * (b - a) + ((1 - u) * v)[..., None] * (c - a), -1, 0)
    turn = angle * (w - 0.5)
    dm = 3.0 * scale * jacobian * r * angle
    place = np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=-1)
    mass = dm.sum()
    center = np.einsum("ijk,ijkx->x", dm, place) / mass
    second = np.einsum("ijk,ijkx,ijky->xy", dm, place - center, place - center)
    found = revolution(triangle, 3.0, angle)
    assert found.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(found.center, center, atol=1e-12)
    np.testing.assert_allclose(found.inertia, np.trace(second) * np.eye(3) - second, atol=1e-12)


def test_a_given_mass_scales_the_inertia():
    assert_same(of_mass(brick([1, 2, 3], 1.0), 12.0), brick([1, 2, 3], 2.0))


@pytest.mark.parametrize(
    ("section", "angle", "words"),
    [
        ([(0, 0), (1, 0)], math.tau, "3 points"),
        ([(0, 0), (0, 1), (1, 0)], math.tau, "counterclockwise"),
        ([(-0.1, 0), (1, 0), (0, 1)], math.tau, "across the axis"),
        ([(0, 0), (math.inf, 0), (0, 1)], math.tau, "not finite"),
        ([(0, 0), (1, 0), (0, 1)], 0.0, "more than 0"),
    ],
)
def test_what_is_no_cross_section_is_refused(section, angle, words):
    with pytest.raises(InvalidValueError, match=words):
        revolution(section, 1.0, angle)
