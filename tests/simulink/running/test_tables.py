"""Lookup tables with their options, against SciPy's interpolation and lines by hand."""

import numpy as np
import pytest
from rigs import Rig
from scipy.interpolate import Akima1DInterpolator, CubicSpline, RegularGridInterpolator

from drake_leg.errors import InvalidValueError

POINTS, VALUES = np.array([0.0, 1.0, 3.0, 4.0, 6.0]), np.array([1.0, 4.0, 2.0, 2.0, -1.0])
LINE = {
    "NumberOfTableDimensions": "1",
    "BreakpointsForDimension1": "[0 1 3 4 6]",
    "Table": "[1 4 2 2 -1]",
}
BLOCK = {
    "NumberOfTableDimensions": "3",
    "BreakpointsForDimension1": "[0 1]",
    "BreakpointsForDimension2": "[0 1 3]",
    "BreakpointsForDimension3": "[0 2]",
    "Table": "cat(3, [1 2 4;0 5 3], [7 -2 1;3 3 8])",
}
GRID = ([0.0, 1.0], [0.0, 1.0, 3.0], [0.0, 2.0])
SOLID = np.stack([[[1, 2, 4], [0, 5, 3]], [[7, -2, 1], [3, 3, 8]]], axis=2).astype(float)
INSIDE = np.array([0.0, 0.3, 1.0, 2.2, 3.5, 5.9, 6.0])


def looked_up(folder, inputs, **parameters):
    rig = Rig()
    sources = [rig.constant(value) for value in inputs]
    rig.show(rig.block("Lookup_n-D", "table", *sources, **parameters), "y")
    return rig.values(folder)["y"]


@pytest.mark.parametrize(
    ("method", "curve"),
    [
        ("Cubic spline", CubicSpline(POINTS, VALUES)),
        ("Akima spline", Akima1DInterpolator(POINTS, VALUES, method="makima", extrapolate=True)),
    ],
)
def test_curves_go_through_points_and_beyond(method, curve, tmp_path):
    at = np.array([-0.5, *INSIDE, 7.0])
    found = looked_up(
        tmp_path, [f"{at.tolist()}"], InterpMethod=method, ExtrapMethod=method, **LINE
    )
    np.testing.assert_allclose(found, curve(at), atol=1e-12)


@pytest.mark.parametrize(
    ("beyond", "ends"), [("Clip", [1.0, -1.0]), ("Linear", [1.0 - 0.5 * 3.0, -1.0 - 1.5])]
)
def test_a_curve_ends_as_its_extrapolation_says(beyond, ends, tmp_path):
    found = looked_up(tmp_path, ["[-0.5 7]"], InterpMethod="Akima spline", ExtrapMethod=beyond,
                      **LINE)  # fmt: skip
    np.testing.assert_allclose(found, ends, atol=1e-12)


@pytest.mark.parametrize(
    ("points", "values", "expected"), [("[0 1]", "[0 1]", 0.5), ("[0 1 3]", "[0 1 9]", 0.25)]
)
def test_a_curve_of_few_points_is_a_line_or_a_parabola(points, values, expected, tmp_path):
    how = {"InterpMethod": "Cubic spline", "ExtrapMethod": "Cubic spline"}
    found = looked_up(tmp_path, ["0.5"], NumberOfTableDimensions="1",
                      BreakpointsForDimension1=points, Table=values, **how)  # fmt: skip
    assert found == pytest.approx(expected)


@pytest.mark.parametrize("one_port", ["on", "off"])
def test_a_table_of_three_dimensions(one_port, tmp_path):
    at = (0.3, 2.0, 1.5)
    inputs = [f"{list(at)}"] if one_port == "on" else [str(each) for each in at]
    found = looked_up(tmp_path, inputs, UseOneInputPortForAllInputData=one_port, **BLOCK)
    assert found == pytest.approx(RegularGridInterpolator(GRID, SOLID)(at).item())


@pytest.mark.parametrize("method", ["Flat", "Nearest"])
def test_a_table_of_three_dimensions_without_lines(method, tmp_path):
    found = looked_up(tmp_path, ["0.6", "2.5", "0.4"], InterpMethod=method, **BLOCK)
    assert found == (2.0 if method == "Flat" else 3.0)


def test_each_element_is_looked_up(tmp_path):
    """A matrix and a number: the number goes with every element."""
    at = np.array([[0.1, 0.9], [0.4, 1.0]])
    found = looked_up(tmp_path, ["[0.1 0.9;0.4 1]", "2", "1.5"], **BLOCK)
    grid = RegularGridInterpolator(GRID, SOLID)
    expected = [[grid((u, 2.0, 1.5)).item() for u in row] for row in at]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    found = looked_up(tmp_path, ["[0 1;3 6]"], **LINE)
    np.testing.assert_allclose(found, [[1.0, 4.0], [2.0, -1.0]])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"Table": "[1 2;3 4]"}, "has a table of 2×2 for 2 and 3 and 2 points"),
        ({"BreakpointsForDimension2": "[0 3 1]"}, "has points that do not rise"),
        ({"InterpMethod": "Akima spline"}, "looks up in 3 dimensions by 'Akima spline'"),
        ({"InterpMethod": "Odd"}, "interpolates by 'Odd', which does not run"),
        ({"UseOneInputPortForAllInputData": "on"}, "has 1 inputs for 3 dimensions"),
    ],
)
def test_a_table_that_does_not_run_is_refused(change, message, tmp_path):
    with pytest.raises(InvalidValueError, match=message):
        looked_up(tmp_path, ["0", "0", "0"], **(BLOCK | change))


@pytest.mark.parametrize(("beyond", "expected"), [("linear", 12.0), ("nearest", 8.0)])
def test_a_physical_table_of_two_dimensions(beyond, expected, tmp_path):
    """The function x y at its corners, which is 2 (0.75 * 8) inside."""
    rig = Rig()
    inputs = []
    for value in ("3", "4"):
        inputs.append(rig.add_library("nesl_utility/Simulink-PS Converter", value, ports={"in": 1}))
        rig.connect(rig.constant(value), inputs[-1])
    table = rig.add_library(
        "fl_lib/Physical Signals/Lookup Tables/PS Lookup Table (2D)", "table",
        {"x1": "[0 2]", "x2": "[0 4]", "f": "[0 0;0 8]", "interp_method": "1",
         "extrap_method": f"simscape.enum.extrapolation.{beyond}"},
    )  # fmt: skip
    out = rig.add_library("nesl_utility/PS-Simulink Converter", "out", ports={"out": 1})
    for place, source in enumerate(inputs, 1):
        rig.physical(f"{source}#rconn:1", f"{table}#lconn:{place}")
    rig.physical(f"{table}#rconn:1", f"{out}#lconn:1")
    rig.show(out, "y")
    assert rig.values(tmp_path)["y"] == expected


@pytest.mark.parametrize(
    ("how", "expected"),
    [("Use Input Nearest", 20.0), ("Use Input Below", 10.0), ("Use Input Above", 20.0)],
)
def test_a_dynamic_table_without_lines(how, expected, tmp_path):
    rig = Rig()
    inputs = [rig.constant(value) for value in ("2.2", "[0 1 3]", "[0 10 20]")]
    rig.show(rig.block("simulink/Lookup Tables/Lookup Table Dynamic", "table", *inputs,
                       LookUpMeth=how), "y")  # fmt: skip
    assert rig.values(tmp_path)["y"] == expected


def test_a_prelookup_of_even_points(tmp_path):
    rig = Rig()
    even = {"BreakpointsSpecification": "Even spacing", "BreakpointsFirstPoint": "2",
            "BreakpointsSpacing": "0.5", "BreakpointsNumPoints": "4"}  # fmt: skip
    place = rig.add_block("PreLookup", "place", even, ports={"in": 1, "out": 2})
    rig.connect(rig.constant("2.6"), place)
    rig.show(f"{place}#out:1", "k")
    rig.show(f"{place}#out:2", "f")
    found = rig.values(tmp_path)
    assert found["k"] == 1.0
    assert found["f"] == pytest.approx(0.2)
