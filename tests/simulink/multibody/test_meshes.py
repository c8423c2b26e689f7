"""Meshes of extruded and revolved solids: closed, with the volume of their exact formulas."""

import math
from collections import Counter

import numpy as np
import pytest
from mechanism_models import pendulum

from drake_leg.simulink.multibody.meshes import mesh, obj, triangulated, write_meshes
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


@pytest.mark.slow
def test_a_file_of_a_cad_program_is_seen_in_meters(tmp_path):
    trimesh = pytest.importorskip("trimesh", reason="the extra meshes is not installed")
    (tmp_path / "cad").mkdir()
    trimesh.creation.box((10.0, 20.0, 30.0)).export(tmp_path / "cad" / "Rod.STL")
    (tmp_path / "cad" / "torn.stl").write_text("solid", encoding="utf-8")
    texts = {"ExtGeomFileUnits": "mm", "InertiaType": "PointMass"}
    built = pendulum()
    for name, file in (("A", "C:\\lab\\rod.stl"), ("B", "torn.stl"), ("C", "lost.step")):
        built.body("File Solid", name, ExtGeomFileName=file, **texts)
    built.meet("Down", "A", "B", "C")
    built.lines.pop(-2)
    found = write_meshes(built.mechanism(tmp_path), tmp_path, [tmp_path / "cad"])
    assert list(found.names.values()) == ["A.obj"]
    assert (list(found.unread), found.missing) == (["torn.stl"], ["lost.step"])
    lines = (tmp_path / "A.obj").read_text(encoding="utf-8").splitlines()
    corners = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
    np.testing.assert_allclose(np.ptp(corners, axis=0), [0.01, 0.02, 0.03])
