"""Where the features of a STEP file lie, against closed forms."""

import re

import numpy as np
import pytest
from cad_files import PART, frame, open_cascade, write
from mechanism_models import pendulum

from drake_leg.cli.terminal import as_options
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody import step_places
from drake_leg.simulink.multibody.step_places import counted_place, only_place, places_of

pytestmark = pytest.mark.slow


@pytest.fixture
def plate(tmp_path):
    """A plate of 100, 40 and 20 mm with a hole along z at x = 30, y = 20 mm; its radius is 5 mm."""
    open_cascade()
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    axis = gp_Ax2(gp_Pnt(30.0, 20.0, 0.0), gp_Dir(0, 0, 1))
    hole = BRepPrimAPI_MakeCylinder(axis, 5.0, 20.0).Shape()
    shape = BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(100.0, 40.0, 20.0).Shape(), hole).Shape()
    return write(tmp_path / "leg.step", shape)


def rows(places):
    """Return points and directions, (n, 6), in order of their numbers."""
    found = np.array([[*place.point, *place.direction] for place in places])
    return found[np.lexsort(found.T)]


def test_planes_have_their_middles_and_outward_normals(plate):
    """The center of area of the drilled faces follows from that of the hole."""
    area, hole = 0.1 * 0.04, np.pi * 0.005**2
    x = (area * 0.05 - hole * 0.03) / (area - hole)
    expected = np.array([
        [x, 0.02, 0.0, 0, 0, -1], [x, 0.02, 0.02, 0, 0, 1],
        [0.0, 0.02, 0.01, -1, 0, 0], [0.1, 0.02, 0.01, 1, 0, 0],
        [0.05, 0.0, 0.01, 0, -1, 0], [0.05, 0.04, 0.01, 0, 1, 0],
    ])  # fmt: skip
    places = places_of(plate, "planar surface")
    np.testing.assert_allclose(rows(places), expected[np.lexsort(expected.T)], atol=1e-9)
    assert [place.count for place in places] == [1] * 6
    assert places[0].size[1] == pytest.approx(area - hole)
    assert places[0].described() == "area 3921 mm²"


def parts(entry):
    """Numbers of the entries that an entry of a STEP file names."""
    return re.findall(r"#(\d+)", entry)


def shell_in(path):
    """Entries of a STEP file by their numbers, and those of the faces of its only shell."""
    text = re.sub(r"\s+", "", path.read_text())
    entries = dict(re.findall(r"#(\d+)=([A-Z_0-9]+\(.*?\));", text))
    (shell,) = (entry for entry in entries.values() if entry.startswith("CLOSED_SHELL"))
    return entries, parts(shell)


def numbers_in(entry):
    return [float(number) for number in re.findall(r"-?\d+\.\d*(?:E[+-]?\d+)?", entry)]


def planes_in(path):
    """Points and normals (n, 6) of the flat faces of a shell, in the order of the text [m]."""
    entries, faces = shell_in(path)
    found = []
    for face in faces:
        surface = entries[parts(entries[face])[-1]]
        if surface.startswith("PLANE"):
            point, normal = (
                numbers_in(entries[at]) for at in parts(entries[parts(surface)[0]])[:2]
            )
            found.append([*np.array(point) / 1000.0, *normal])
    return np.array(found)


def circles_in(path):
    """Centers (n, 3) of the circles around each face of a shell, in the order of the text [m]."""
    entries, faces = shell_in(path)
    found = []
    for face in faces:
        for bound in parts(entries[face])[:-1]:
            for edge in parts(entries[parts(entries[bound])[0]]):
                curve = entries[parts(entries[parts(entries[edge])[-1]])[2]]
                while not curve.startswith(("CIRCLE", "LINE")):
                    curve = entries[parts(curve)[0]]
                if curve.startswith("CIRCLE"):
                    found.append(numbers_in(entries[parts(entries[parts(curve)[0]])[0]]))
    return np.array(found) / 1000.0


def test_the_number_of_a_circle_counts_those_around_each_face(plate):
    circles = circles_in(plate)
    assert sorted(circles[:, 2]) == [0.0, 0.0, 0.02, 0.02]
    found = [counted_place(plate, f"circular curve {number}").point for number in range(1, 5)]
    np.testing.assert_allclose(found, circles, atol=1e-12)
    assert counted_place(plate, "circular curve 5") is None


def test_the_number_of_a_face_counts_those_of_its_kind_in_the_file(plate, tmp_path):
    planes = planes_in(plate)
    assert len(planes) == 6
    for number, plane in enumerate(planes, 1):
        face = counted_place(plate, f"planar surface {number}")
        assert abs((face.point - plane[:3]) @ plane[3:]) < 1e-12
        assert abs(face.direction @ plane[3:]) == pytest.approx(1.0)
    assert counted_place(plate, "planar surface 7") is None
    assert counted_place(plate, "segment 1") is None
    assert counted_place(plate, "top surface") is None
    mechanism = on_a_pendulum("planar surface 2").mechanism(tmp_path)
    ((name, point),) = mechanism.connections.only.items()
    assert name == "Leg.STEP:planar surface 2"
    np.testing.assert_allclose(point, counted_place(plate, "planar surface 2").point)
    along = on_a_pendulum("planar surface 2", "planar surface 3").mechanism(tmp_path)
    solids = along.bodies[1].solids
    X_BR = next(X for solid, X in solids if solid.block.name == "A")
    outward = X_BR[:3, :3] @ counted_place(plate, "planar surface 3").direction
    np.testing.assert_allclose(outward, [0.0, 0.0, 1.0], atol=1e-12)


def test_the_order_is_that_of_the_file_and_not_of_what_is_read(plate, monkeypatch):
    """As where a shell is mended."""
    read = step_places._features
    monkeypatch.setattr(step_places, "_features", lambda *given: reversed([*read(*given)]))
    step_places._faces.cache_clear()
    for number, plane in enumerate(planes_in(plate), 1):
        face = counted_place(plate, f"planar surface {number}")
        assert abs((face.point - plane[:3]) @ plane[3:]) < 1e-12
        assert abs(face.direction @ plane[3:]) == pytest.approx(1.0)
    step_places._faces.cache_clear()


def test_faces_on_one_plane_are_not_told_apart_without_their_order(tmp_path, monkeypatch):
    open_cascade()
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    groove = BRepPrimAPI_MakeBox(gp_Pnt(40.0, 0.0, 10.0), gp_Pnt(60.0, 40.0, 20.0)).Shape()
    shape = BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(100.0, 40.0, 20.0).Shape(), groove).Shape()
    path = write(tmp_path / "groove.step", shape)
    names = [f"planar surface {number}" for number in range(1, 11)]
    assert all(counted_place(path, name) for name in names)
    read = step_places._features
    monkeypatch.setattr(step_places, "_features", lambda *given: reversed([*read(*given)]))
    step_places._faces.cache_clear()
    assert sum(counted_place(path, name) is None for name in names) == 2
    step_places._faces.cache_clear()


def on_a_pendulum(origin, primary=None):
    built = pendulum()
    built.body("File Solid", "A", SerializedFrames=frame(origin, primary), **PART)
    built.meet("Down", "A lconn:1")
    return built


def test_faces_of_several_solids_are_not_counted(tmp_path):
    open_cascade()
    from OCP.BRep import BRep_Builder
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.TopoDS import TopoDS_Compound

    both, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(both)
    for length in (10.0, 20.0):
        builder.Add(both, BRepPrimAPI_MakeBox(length, length, length).Shape())
    assert counted_place(write(tmp_path / "two.step", both), "planar surface 1") is None


@pytest.mark.parametrize(
    ("kind", "count", "first"),
    [
        ("cylindrical surface", 1, [0.03, 0.02, 0.01, 0, 0, 1]),
        ("circular curve", 2, None),
        ("point", None, None),
        ("spherical surface", 0, None),
        ("spline", 0, None),
    ],
)
def test_the_hole_has_an_axis_and_two_rims(plate, kind, count, first):
    places = places_of(plate, kind)
    if count is None:
        assert any(np.allclose(place.point, [0.1, 0.04, 0.02]) for place in places)
        assert len(places) == sum(place.count for place in places) == 8 + 2  # and the rims' starts
        return
    assert sum(place.count for place in places) == count
    if first:
        np.testing.assert_allclose(rows(places)[0], first, atol=1e-12)
        assert places[0].described() == "radius 5 mm"
        assert only_place(plate, f"{kind} 7") is not None


def test_edges_are_met_once_and_most_features_come_first(tmp_path):
    open_cascade()
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder

    box = BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape()
    path = write(tmp_path / "box.step", box)
    edges = places_of(path, "segment")
    assert sum(edge.count for edge in edges) == 12
    assert edges[0].size == ("length", pytest.approx(0.03))
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    def disk(z, radius, height):
        axis = gp_Ax2(gp_Pnt(0.0, 0.0, z), gp_Dir(0, 0, 1))
        return BRepPrimAPI_MakeCylinder(axis, radius, height).Shape()

    wide, narrow = disk(0.0, 9.0, 4.0), disk(1.0, 5.0, 7.0)
    path = write(tmp_path / "steps.step", BRepAlgoAPI_Fuse(wide, narrow).Shape())
    first, *others = places_of(path, "circular curve")
    assert (first.count, [each.count for each in others]) == (2, [1, 1])
    np.testing.assert_allclose(first.point, [0, 0, 0.004], atol=1e-12)  # of the step's two rims


def model(tmp_path, origin, file="C:\\cad\\Leg.STEP", **more):
    built = pendulum()
    texts = {**PART, "ExtGeomFileName": file, **more}
    built.body("File Solid", "A", SerializedFrames=frame(origin, origin), **texts)
    built.meet("Down", "A lconn:1")
    return built


def refusal(built, tmp_path):
    with pytest.raises(InvalidValueError) as caught:
        built.mechanism(tmp_path)
    return str(caught.value).split("\n      ")


def test_an_error_lists_the_places_as_the_option_takes_them(plate, tmp_path):
    built = model(tmp_path, "planar surface 9")
    _, *lines = refusal(built, tmp_path)
    assert len(lines) == 6
    assert "place 'Leg.STEP:planar surface 9' at 0,0.02,0.01,-1,0,0 (1 of 6, area 800 mm²)" in lines
    option = next(as_options(line) for line in lines if ",0,1 (" in line)
    name, numbers = option.removeprefix("--feature ").split("'")[1].split("=")
    assert option.endswith("'  # 1 of 6, area 3921 mm²")
    given = {name: [float(number) for number in numbers.split(",")]}
    assert built.mechanism(tmp_path, features=given)


def test_the_unit_of_the_solid_counts(plate, tmp_path):
    built = model(tmp_path, "planar surface 9", UnitType="Custom", ExtGeomFileUnits="in")
    assert any("at 0,0.508,0.254,-1,0,0" in line for line in refusal(built, tmp_path))
    built = model(tmp_path, "planar surface 2", UnitType="Custom", ExtGeomFileUnits="in")
    (point,) = built.mechanism(tmp_path).connections.only.values()
    np.testing.assert_allclose(point, 25.4 * counted_place(plate, "planar surface 2").point)


def test_places_of_a_file_of_a_cad_program_come_from_a_step_file_of_its_name(plate, tmp_path):
    _, *lines = refusal(model(tmp_path, "circular curve 3", "Leg.SLDPRT"), tmp_path)
    assert len(lines) == 2
    assert lines[0].startswith("place 'Leg.SLDPRT:circular curve 3' at 0.03,0.02,0")


@pytest.mark.parametrize("file", ["Arm.step", "Arm.SLDPRT"])
def test_without_a_file_it_is_told_which_is_looked_for(tmp_path, file):
    _, line = refusal(model(tmp_path, "point 3", file), tmp_path)
    it = "it" if file == "Arm.step" else "'Arm.step'"
    assert line == f"its places are listed where {it} lies beside the model or in a given folder"


def test_a_damaged_file_lists_nothing(tmp_path):
    open_cascade()
    (tmp_path / "leg.step").write_text("no STEP")
    _, line = refusal(model(tmp_path, "point 3"), tmp_path)
    assert line == "its places are not listed from 'leg.step', which is damaged"


def test_what_does_not_fit_a_screen_is_counted(plate, tmp_path, monkeypatch):
    monkeypatch.setattr("drake_leg.simulink.multibody.unplaced.LINES", 4)
    *_, last = refusal(model(tmp_path, "planar surface 9"), tmp_path)
    assert last == f"and 2 more places: `drake-leg inspect {plate}` lists all"
