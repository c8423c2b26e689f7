"""Meshes of extruded and revolved solids: closed, with the volume of their exact formulas."""

import math
from collections import Counter

import numpy as np
import pytest

from drake_leg.simulink.multibody.meshes import mesh, obj, triangulated
from drake_leg.simulink.multibody.solids import Extrusion, Revolution

ARROW = np.array([[0, 0], [2, -1], [1, 0], [2, 1]], dtype=float)
FRAME = np.array(  # a square with a square hole, reached and left on one line
    [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0], [1, 1], [1, 2], [2, 2], [2, 1], [1, 1]], dtype=float
)
RING = np.array([[1, 0], [2, 0], [2, 1], [1, 1]], dtype=float)


def volume(corners, triangles):
    a, b, c = (corners[list(column)] for column in zip(*triangles, strict=True))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


@pytest.mark.parametrize("section", [ARROW, FRAME, RING], ids=["arrow", "frame", "ring"])
def test_an_extrusion_has_its_volume(section):
    shape = Extrusion(section=section, length=0.5)
    assert volume(*mesh(shape)) == pytest.approx(shape.properties(1.0).mass)


@pytest.mark.parametrize("angle", [math.tau, 1.0])
def test_a_revolution_has_nearly_its_volume(angle):
    shape = Revolution(section=RING, angle=angle)
    assert volume(*mesh(shape)) == pytest.approx(shape.properties(1.0).mass, rel=5e-3)


@pytest.mark.parametrize(
    "shape", [Extrusion(section=ARROW, length=1.0), Revolution(section=RING, angle=1.0)]
)
def test_every_edge_is_used_once_each_way(shape):
    _, triangles = mesh(shape)
    edges = Counter((t[i], t[(i + 1) % 3]) for t in triangles for i in range(3))
    assert all(count == 1 and edges[b, a] == 1 for (a, b), count in edges.items())


def test_triangles_fill_a_polygon():
    angles = np.linspace(0.0, math.tau, 60, endpoint=False)
    star = (
        np.column_stack([np.cos(angles), np.sin(angles)]) * (1 + 0.5 * np.cos(5 * angles))[:, None]
    )
    a, b, c = (star[list(column)] for column in zip(*triangulated(star), strict=True))
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0
    x, y = star.T
    whole = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(whole)


def test_an_obj_file_has_facets_with_normals_and_counts_from_one():
    lines = obj(np.eye(3), [(0, 1, 2), (0, 0, 1)]).splitlines()
    assert lines[-2:] == ["vn 0.577350 0.577350 0.577350", "f 1//1 2//1 3//1"]
