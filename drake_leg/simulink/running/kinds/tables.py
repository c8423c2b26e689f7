"""Lookup tables."""

from __future__ import annotations

import re

import numpy as np

from drake_leg.simulink.running.code import Call, Operand, Writer
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.quantities import in_si

FROM_PORT = "Input port"
CURVES = ("cubic", "akima")  # methods of curves between points
_METHODS = {
    "Linear": "linear",
    "Linear point-slope": "linear",
    "Linear Lagrange": "linear",
    "Flat": "flat",
    "None - Flat": "flat",
    "Nearest": "nearest",
    "Cubic spline": "cubic",
    "Akima spline": "akima",
}
_OF_A_TABLE = re.compile(r"\bu\d")  # inputs that are looked up, in the map of a block's ports


@kind("Lookup_n-D", "Lookup", "PS Lookup Table (1D)")
def lookup(w: Writer) -> None:
    """Look numbers up: by lines or steps in any dimensions, by curves in one."""
    s = w.settings
    inputs = len(_OF_A_TABLE.findall(s.text("InputPortMap")))  # which tells what the file omits
    dimensions = int(s.number("NumberOfTableDimensions", f"{max(inputs, 1)}"))
    if w.node.block.type == "Lookup":
        points, values = s.numbers("InputValues", "[-5:5]"), s.numbers("Table", "tanh([-5:5])")
        method, beyond = s.text("LookUpMeth", "Interpolation-Extrapolation"), ""
        beyond = "clip" if "Use End" in method else "line"
        _one(w, points, values, beyond, "linear")
        return
    if w.node.block.kind.startswith("PS"):
        x, f = (np.ravel(in_si(w, *each)) for each in (("x", "[1:5]"), ("f", "[0:4]")))
        _one(w, x, f, _beyond_physical(w), "linear")
        return
    method = _METHODS.get(s.text("InterpMethod", "Linear point-slope"), "")
    if not method:
        raise w.fault(f"interpolates by {s.text('InterpMethod')!r}, which does not run")
    beyond = {"Clip": "clip", "Linear": "line"}.get(s.text("ExtrapMethod", "Linear"), "curve")
    if FROM_PORT in (s.text("TableSource"), s.text("BreakpointsForDimension1Source")):
        _of_ports(w, dimensions, beyond, method)
        return
    points = _points(w, 1)
    table = s.matrix("Table", "[0 1]")
    if dimensions == 1:
        _one(w, points, table.ravel(order="F"), beyond, method)
    elif method in CURVES:
        raise w.fault(
            f"looks up in {dimensions} dimensions by {s.text('InterpMethod')!r}: make it 'Linear' "
            "with `parameter`"
        )
    else:
        others = [_points(w, place) for place in range(2, dimensions + 1)]
        _several(w, [points, *others], table, beyond, method)


def _of_ports(w: Writer, dimensions: int, beyond: str, method: str) -> None:
    """Look a number up in a table that is a signal, or whose points are; points come first."""
    u = w.numeric()
    if dimensions != 1 or method in CURVES or not u.is_scalar:
        raise w.fault("takes its table from a port: lines through one dimension run, of a scalar")
    place, codes = 1, []
    for name, source in (
        ("BreakpointsForDimension1", "BreakpointsForDimension1Source"),
        ("Table", "TableSource"),
    ):
        if w.settings.text(source) == FROM_PORT:
            codes.append(w.vector(place))
            place += 1
        else:
            values = _points(w, 1) if name != "Table" else w.settings.numbers(name, "[0 1]")
            codes.append(Operand(code=w.constant(values, name), value=values))
    at, of = codes
    if at.size != of.size:
        raise w.fault(f"has {at.size} points and {of.size} values: give as many of both")
    w.out(f"table_1d({u.code}, {at.code}, {of.code}, beyond={beyond!r}, method={method!r})")


@kind("Lookup Table Dynamic")
def dynamic_lookup(w: Writer) -> None:
    """Look a number up in points and values that come in."""
    how = w.settings.text("LookUpMeth", "Interpolation-Extrapolation")
    beyond = "line" if how == "Interpolation-Extrapolation" else "clip"
    method = {"Use Input Nearest": "nearest", "Use Input Below": "flat", "Use Input Above": "above"}
    if "Interpolation" not in how and how not in method:
        raise w.fault(f"looks up by {how!r}, which does not run")
    at, of = w.vector(1), w.vector(2)
    if at.size != of.size:
        raise w.fault(f"has {at.size} points and {of.size} values: give as many of both")
    u = w.numeric()
    if not u.is_scalar:
        raise w.fault("looks a vector up, which does not run: give it one number")
    w.out(
        f"table_1d({u.code}, {at.code}, {of.code}, beyond={beyond!r}, "
        f"method={method.get(how, 'linear')!r})"
    )


@kind("PreLookup")
def prelookup(w: Writer) -> None:
    """Tell between which points a number lies: how many are below, and the fraction beyond."""
    s = w.settings
    if s.text("BreakpointsSpecification", "Explicit values") == "Even spacing":
        count = np.arange(s.number("BreakpointsNumPoints", "11"))
        spacing = s.number("BreakpointsSpacing", "10")
        points = s.number("BreakpointsFirstPoint", "10") + spacing * count
    else:
        points = s.numbers("BreakpointsData", "[10:10:110]")
    u = w.numeric()
    if not u.is_scalar:
        raise w.fault("looks a vector up, which does not run: give it one number")
    beyond = "clip" if w.settings.text("ExtrapMethod", "Clip") == "Clip" else "line"
    p = w.constant(points, "points")
    found = w.let(f"place_in({u.code}, {p}, beyond={beyond!r})", "place")
    w.out(f"{found.code}[0]", 0)
    w.out(f"{found.code}[1]", 1)


@kind("Interpolation_n-D")
def interpolation(w: Writer) -> None:
    """Interpolate in a table between the places that Prelookups found."""
    s = w.settings
    dimensions = int(s.number("NumberOfTableDimensions", "1"))
    if dimensions > 2 or not s.text("InterpMethod", "Linear").startswith("Linear"):
        raise w.fault("interpolates by lines in one dimension or two alone")
    table = s.matrix("Table", "[0 1]")
    if dimensions == 1:
        k, f = w.input(0).code, w.input(1).code
        values = w.constant(table.ravel(order="F"), "values")
        w.out(f"between({values}, {k}, {f})")
        return
    k1, f1, k2, f2 = (w.input(place).code for place in range(4))
    rows = w.constant(table, "table")
    w.out(f"between(array([between(row, {k2}, {f2}) for row in {rows}]), {k1}, {f1})")


@kind("LookupNDDirect")
def direct_lookup(w: Writer) -> None:
    """Take an element, a column or a matrix out of a table, by places counted from 0."""
    s = w.settings
    table = s.matrix("Table", "[4 5 6;16 19 20;10 18 23]")
    dimensions = int(s.number("NumberOfTableDimensions", "2"))
    taken = s.text("InputsSelectThisObjectFromTable", "Element")
    if (
        s.text("TableIsInput", "off") == "on"
        or dimensions > 2
        or taken not in ("Element", "Column")
    ):
        raise w.fault("takes an element or a column out of a table of two dimensions alone")
    if dimensions == 1:
        table = table.reshape(-1, 1)
    fails = s.text("DiagnosticForOutOfRangeInput", "Warning") == "Error"
    places = []
    for place in range(w.count):
        count = table.shape[place + 1 if taken == "Column" else place]
        i = w.number(place).code
        kept = f"int(limited(fix({i}), 0.0, {count - 1}.0))"
        places.append(f"selected(0, fix({i}), {count})" if fails else kept)
    if taken == "Column":
        places.insert(0, ":")
    elif dimensions == 1:
        places.append("0")
    w.out(f"settled({w.constant(table, 'table')}[{', '.join(places)}])")


@kind("Lookup2D", "PS Lookup Table (2D)")
def lookup_2d(w: Writer) -> None:
    """Look numbers up in a table of two dimensions."""
    s = w.settings
    if w.node.block.kind.startswith("PS"):
        points = [np.ravel(in_si(w, name, "[1:5]")) for name in ("x1", "x2")]
        values = np.reshape(in_si(w, "f", ""), s.matrix("f").shape)
        _several(w, points, values, _beyond_physical(w), "linear")
        return
    rows, columns = s.numbers("RowIndex", "[1 2]"), s.numbers("ColumnIndex", "[1 2]")
    beyond = "clip" if "Use End" in s.text("LookUpMeth", "") else "line"
    _several(w, [rows, columns], s.matrix("Table", "[0 1;1 2]"), beyond, "linear")


def _beyond_physical(w: Writer) -> str:
    """Return how a physical table goes on beyond its points; it has lines between them."""
    if w.settings.text("interp_method", "linear").rpartition(".")[2] not in ("linear", "1", ""):
        raise w.fault("interpolates smoothly, which does not run: make it linear")
    return "line" if "linear" in w.settings.text("extrap_method", "") else "clip"


def _points(w: Writer, dimension: int) -> np.ndarray:
    if w.settings.text("BreakpointsSpecification", "Explicit values") == "Even spacing":
        first = w.settings.number(f"BreakpointsForDimension{dimension}FirstPoint", "1")
        spacing = w.settings.number(f"BreakpointsForDimension{dimension}Spacing", "1")
        count = w.settings.matrix("Table", "[0 1]")
        length = count.size if 1 in count.shape else count.shape[dimension - 1]
        return np.asarray(first + spacing * np.arange(length))
    return w.settings.numbers(f"BreakpointsForDimension{dimension}", "[1 2]")


def _one(w: Writer, points: np.ndarray, values: np.ndarray, beyond: str, method: str) -> None:
    if len(points) != len(values) or not len(points) or np.any(np.diff(points) <= 0.0):
        raise w.fault(
            f"has {len(points)} points and {len(values)} values: give as many of both, the points "
            "rising"
        )
    p, v = w.constant(points, "points"), w.constant(values, "values")
    u = w.numeric()
    call = f"table_1d({{0}}, {p}, {v}, beyond='{beyond}', method='{method}')"
    if method in CURVES:
        from scipy.interpolate import CubicHermiteSpline

        given = (points, values, curve_slopes(points, values, method))
        curve = w.constant(CubicHermiteSpline(*given), "curve")
        w.pen.written[curve] = Call(function="CubicHermiteSpline", arguments=given)
        call = f"on_curve({{0}}, {curve}, {p}, {v}, beyond='{beyond}')"
    _each(w, [u], call)


def curve_slopes(points: np.ndarray, values: np.ndarray, method: str) -> np.ndarray:
    """Return the slopes at points of a cubic spline, or of a modified Akima spline.

    The first has no knots at the second point and the last but one. The second one's slope is a
    mean of those of the lines beside, each with the weight of how little the lines beyond the other
    one bend.
    """
    if len(points) < 3:
        return np.gradient(values, points) if len(points) == 2 else np.zeros(len(points))
    if method == "cubic":
        from scipy.interpolate import CubicSpline

        found: np.ndarray = CubicSpline(points, values)(points, 1)
        return found
    d = np.diff(values) / np.diff(points)
    before, after = 2.0 * d[0] - d[1], 2.0 * d[-1] - d[-2]
    d = np.array([2.0 * before - d[0], before, *d, after, 2.0 * after - d[-1]])
    bend = np.abs(np.diff(d)) + np.abs(d[1:] + d[:-1]) / 2.0
    right, left = bend[2:], bend[:-2]
    total = right + left
    mean = (right * d[1:-2] + left * d[2:-1]) / np.where(total > 0.0, total, 1.0)
    return np.where(total > 0.0, mean, 0.0)


def _each(w: Writer, inputs: list[Operand], call: str) -> None:
    """Write a call for a number, or for each element of vectors and matrices."""
    alike = w.alike(inputs)
    (shape,) = {one.shape for one in alike if not one.is_scalar} or {()}
    if shape == ():
        w.out(call.format(*(one.code for one in alike)))
        return
    names = [f"each_{place}" for place in range(len(alike))]
    sources = [
        f"repeat({one.code}, {int(np.prod(shape))})" if one.is_scalar else f"flat({one.code})"
        for one in alike
    ]
    made = f"[{call.format(*names)} for {', '.join(names)}, in zip({', '.join(sources)})]"
    w.out(f"array({made}).reshape({shape}, order='F')")


def _several(
    w: Writer, points: list[np.ndarray], table: np.ndarray, beyond: str, method: str
) -> None:
    """Look up in a table of several dimensions."""
    sizes = tuple(len(each) for each in points)
    if table.shape != sizes:
        raise w.fault(
            f"has a table of {'×'.join(map(str, table.shape))} for {' and '.join(map(str, sizes))} "
            "points: give as many of both"
        )
    for each in points:
        if np.any(np.diff(each) <= 0.0):
            raise w.fault("has points that do not rise: sort them")
    inputs = [w.numeric(place) for place in range(w.count)]
    if w.settings.text("UseOneInputPortForAllInputData", "off") == "on":
        u = w.vector()
        inputs = [Operand(code=f"{u.code}[{k}]", value=float(u.value[k])) for k in range(u.size)]
    if len(inputs) != len(points):
        raise w.fault(f"has {len(inputs)} inputs for {len(points)} dimensions: connect all")
    at = ", ".join(f"{{{place}}}" for place in range(len(points)))
    of = ", ".join(w.constant(each, "points") for each in points)
    call = (
        f"table_nd(({at}), ({of}), {w.constant(table, 'table')}, "
        f"beyond='{beyond}', method='{method}')"
    )
    _each(w, inputs, call)
