"""Masses of STEP files against closed forms; the files are written by Open CASCADE itself."""

import math
import sys

import numpy as np
import pytest
from cad_files import open_cascade, write
from mechanism_models import pendulum

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody import step
from drake_leg.simulink.multibody.step import properties_of_step, unit_of_step

EXACT = 1e-9  # of the largest value, as the documentation states
STEEL = 7800.0


cad = pytest.fixture(open_cascade)


def shapes():
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeCone,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeTorus,
    )

    R, r = 5.0, 1.3
    torus = math.tau * math.pi * R * r**2
    across, along = R**2 / 2.0 + 5.0 * r**2 / 8.0, R**2 + 3.0 * r**2 / 4.0
    yield BRepPrimAPI_MakeTorus(R, r).Shape(), torus, 0.0, (across, across, along)
    r, h = 2.0, 5.0
    side = (3.0 * r**2 + h**2) / 12.0
    squares = (side, side, r**2 / 2.0)
    yield BRepPrimAPI_MakeCylinder(r, h).Shape(), math.pi * r**2 * h, h / 2.0, squares
    cone = math.pi * r**2 * h / 3.0
    side = 3.0 * r**2 / 20.0 + 3.0 * h**2 / 80.0
    squares = (side, side, 3.0 * r**2 / 10.0)
    yield BRepPrimAPI_MakeCone(r, 0.0, h).Shape(), cone, h / 4.0, squares


@pytest.mark.slow
@pytest.mark.parametrize(("unit", "meters"), [("MM", 1e-3), ("INCH", 0.0254), ("M", 1.0)])
def test_a_torus_a_cylinder_and_a_cone_are_exact_in_any_unit(cad, tmp_path, unit, meters):
    for number, (shape, volume, height, squares) in enumerate(shapes()):
        path = write(tmp_path / f"{number}.step", shape, unit)
        found = properties_of_step(path)
        assert found.mass == pytest.approx(volume * meters**3, rel=EXACT)
        scale = 5.0 * meters
        np.testing.assert_allclose(
            found.center, [0.0, 0.0, height * meters], rtol=0, atol=EXACT * scale
        )
        expected = np.diag(squares) * meters**2 * found.mass
        np.testing.assert_allclose(found.inertia, expected, rtol=0, atol=EXACT * expected.max())
        assert unit_of_step(path) == meters


@pytest.mark.slow
def test_surfaces_beside_solids_weigh_nothing(cad, tmp_path):
    """A second solid, its faces turned inwards, counts; a face of construction does not."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
    from OCP.TopoDS import TopoDS_Compound

    whole, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(whole)
    face = gp_Pln(gp_Pnt(0.0, 0.0, 5.0), gp_Dir(0.0, 0.0, 1.0))
    builder.Add(whole, BRepBuilderAPI_MakeFace(face, 0.0, 1.0, 0.0, 1.0).Face())
    builder.Add(whole, BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape())
    far = BRepPrimAPI_MakeBox(gp_Pnt(9.0, 0.0, 0.0), gp_Pnt(10.0, 2.0, 3.0)).Shape()
    builder.Add(whole, far.Reversed())
    found = properties_of_step(write(tmp_path / "two.step", whole, "M"))
    assert found.mass == pytest.approx(12.0, rel=EXACT)
    np.testing.assert_allclose(found.center, [5.0, 1.0, 1.5], atol=EXACT)
    assert found.inertia[2, 2] == pytest.approx(12.0 * (5.0 / 12.0 + 4.5**2), rel=EXACT)


@pytest.mark.slow
def test_a_solid_has_the_mass_of_its_file_and_its_own_unit_goes_first(cad, tmp_path):
    cylinder = next(each for each in shapes() if each[2] == 2.5)
    write(tmp_path / "Rod.STEP", cylinder[0])
    volume = cylinder[1] * 1e-9

    def solid(**texts):
        built = pendulum()
        given = {"ExtGeomFileName": "C:\\cad\\rod.step", "Density": str(STEEL)} | texts
        built.body("File Solid", "Part", **given)
        built.meet("Down", "Part")
        built.lines.pop(-2)
        return built.mechanism(tmp_path).bodies[1].properties

    assert solid().mass == pytest.approx(STEEL * volume, rel=EXACT)
    inches = {"UnitType": "Custom", "ExtGeomFileUnits": "in"}
    assert solid(**inches).mass == pytest.approx(STEEL * volume * 25.4**3, rel=EXACT)
    given = solid(BasedOnType="Mass", Mass="2")
    assert given.mass == 2.0
    assert given.inertia[2, 2] == pytest.approx(2.0 * 0.002**2 / 2.0, rel=EXACT)
    with pytest.raises(InvalidValueError, match="it has its density from its file"):
        solid(BasedOnType="DensityFromFile")
    with pytest.raises(InvalidValueError, match=r"'lost\.stp', which lies nowhere in the given"):
        solid(ExtGeomFileName="lost.stp")


def test_a_file_without_a_solid_is_refused(cad, tmp_path):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    solid = BRepPrimAPI_MakeCylinder(1.0, 1.0).Shape()
    face = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_FACE).Current()
    with pytest.raises(InvalidValueError, match="surface is not closed"):
        properties_of_step(write(tmp_path / "face.step", face))
    torn = tmp_path / "torn.step"
    torn.write_text("ISO-10303-21;\nHEADER;\n", encoding="utf-8")
    with pytest.raises(InvalidValueError, match="which is damaged"):
        properties_of_step(torn)
    with pytest.raises(InvalidValueError, match="cannot be read"):
        properties_of_step(tmp_path / "absent.step")


def test_without_open_cascade_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OCP.IFSelect", None)
    path = tmp_path / "rod.step"
    path.write_text("", encoding="utf-8")
    with pytest.raises(InvalidValueError, match=r"Open CASCADE.*pip install 'drake-leg\[cad\]'"):
        properties_of_step(path)
    monkeypatch.setattr(step, "MOST_BYTES", -1)
    with pytest.raises(InvalidValueError, match="more than -1 bytes"):
        properties_of_step(path)


@pytest.mark.parametrize(
    ("text", "meters"),
    [
        ("#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));", 1e-3),
        ("#1=( LENGTH_UNIT ( ) NAMED_UNIT ( * ) SI_UNIT ( $, .METRE. ) );", 1.0),
        ("SI_UNIT(.MILLI.,.METRE.) CONVERSION_BASED_UNIT('INCH',#2)", 0.0254),
        ("SI_UNIT(.CENTI.,.METRE.) CONVERSION_BASED_UNIT('degree',#2)", 0.01),
        ("SI_UNIT(.CENTI.,.METRE.) SI_UNIT(.MILLI.,.METRE.)", None),
        ("SI_UNIT($,.RADIAN.)", None),
    ],
)
def test_the_unit_of_a_file_is_read_in_its_text(tmp_path, text, meters):
    path = tmp_path / "a.step"
    path.write_text(text, encoding="utf-8")
    if meters is None:
        with pytest.raises(InvalidValueError, match="whose own unit is not known"):
            unit_of_step(path)
    else:
        assert unit_of_step(path) == meters
