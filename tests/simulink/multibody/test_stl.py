"""Mass of what STL files hold: that of the same solid by its own formula."""

import numpy as np
import pytest
from mechanism_models import MechanismBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody import mass
from drake_leg.simulink.multibody.meshes import mesh
from drake_leg.simulink.multibody.solids import Extrusion
from drake_leg.simulink.multibody.stl import is_closed, of_mesh, read_stl

SECTION = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]])


def corners():
    points, triangles = mesh(Extrusion(section=SECTION, length=0.5))
    return points[np.array(triangles)]


def binary(path, found):
    head = b"\0" * 80 + len(found).to_bytes(4, "little")
    records = [
        b"\0" * 12 + triangle.astype("<f4").tobytes() + b"\0\0" for triangle in np.asarray(found)
    ]
    path.write_bytes(head + b"".join(records))
    return path


def text(path, found):
    lines = [f"vertex {x:.9g} {y:e} {z}" for triangle in found for x, y, z in triangle.tolist()]
    path.write_text("solid it\n" + "\n".join(lines) + "\nendsolid it\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("write", [binary, text])
@pytest.mark.parametrize("turned", [1, -1])
def test_a_mesh_has_the_mass_of_its_solid(tmp_path, write, turned):
    found = read_stl(write(tmp_path / "a.stl", corners()[:, ::turned] + [10.0, 0.0, 0.0]))
    assert is_closed(found)
    by_mesh = of_mesh(found - [10.0, 0.0, 0.0], 7.0)
    exact = mass.extrusion(SECTION, 0.5, 7.0)
    assert by_mesh.mass == pytest.approx(exact.mass, rel=1e-12)
    np.testing.assert_allclose(by_mesh.center, exact.center, atol=1e-12)
    np.testing.assert_allclose(by_mesh.inertia, exact.inertia, rtol=1e-12, atol=1e-12)


def test_a_surface_with_a_gap_is_not_closed():
    assert not is_closed(corners()[1:])
    with pytest.raises(InvalidValueError, match="encloses nothing"):
        of_mesh(np.zeros((1, 3, 3)), 1.0)


@pytest.mark.parametrize("content", [b"", b"solid\nendsolid", b"\0" * 84, b"\xff" * 200])
def test_a_file_without_triangles_is_named(tmp_path, content):
    (tmp_path / "a.stl").write_bytes(content)
    with pytest.raises(InvalidValueError, match=r"'a[.]stl' holds no triangles"):
        read_stl(tmp_path / "a.stl")


@pytest.mark.parametrize("broken", ["vertex 1.2.3 0 0", "vertex 1 nan 0", "vertex 1 0", ""])
def test_a_text_whose_triangle_is_cut_is_named(tmp_path, broken):
    path = text(tmp_path / "a.stl", corners())
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([lines[0], broken, *lines[2:]]), encoding="utf-8")
    with pytest.raises(InvalidValueError, match=r"'a[.]stl' has a triangle that is cut"):
        read_stl(path)


def test_a_file_solid_has_its_mass_from_the_file(tmp_path):
    built = MechanismBuilder()
    texts = {"ExtGeomFileName": r"C:\\parts\\part.stl", "ExtGeomFileUnits": "cm", "Density": "500"}
    built.body("File Solid", "Part", **texts)
    built.joint("Revolute", "Hip")
    built.meet("World", "Hip lconn:1")
    built.meet("Hip", "Part")
    with pytest.raises(
        InvalidValueError, match="which lies nowhere in the given folders: make its"
    ):
        built.mechanism(tmp_path)
    binary(tmp_path / "part.stl", corners())
    part = built.mechanism(tmp_path).bodies[1].properties
    assert part.mass == pytest.approx(500.0 * 2.0 * 1e-6, rel=1e-6)
    center = mass.extrusion(SECTION, 0.5, 1.0).center
    np.testing.assert_allclose(part.center, center / 100.0, atol=1e-15)
    binary(tmp_path / "part.stl", corners()[1:])
    with pytest.raises(InvalidValueError, match="whose surface is not closed"):
        built.mechanism(tmp_path)
