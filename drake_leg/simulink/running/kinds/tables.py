"""Lookup tables."""

from __future__ import annotations

import re

import numpy as np

from drake_leg.simulink.running.code import Call, Operand, Writer
from drake_leg.simulink.running.kinds import kind

FROM_PORT = "Input port"
_OF_A_TABLE = re.compile(r"\bu\d")  # inputs that are looked up, in the map of a block's ports


@kind("Lookup_n-D", "Lookup", "PS Lookup Table (1D)")
def lookup(w: Writer) -> None:
    """Look a number up: lines between points, in one dimension or two."""
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
        beyond = "line" if "linear" in s.text("extrap_method", "") else "clip"
        _one(w, s.numbers("x", "[1:5]"), s.numbers("f", "[0:4]"), beyond, "linear")
        return
    method = {"Flat": "flat", "Nearest": "nearest", "None - Flat": "flat"}.get(
        s.text("InterpMethod", "Linear point-slope"), "linear"
    )
    if s.text("InterpMethod", "Linear") in ("Cubic spline", "Akima spline"):
        method = "spline"
    beyond = "clip" if s.text("ExtrapMethod", "Linear") == "Clip" else "line"
    if FROM_PORT in (s.text("TableSource"), s.text("BreakpointsForDimension1Source")):
        _of_ports(w, dimensions, beyond, method)
        return
    points = _points(w, 1)
    table = s.matrix("Table", "[0 1]")
    if dimensions == 1:
        _one(w, points, table.ravel(order="F"), beyond, method)
    elif dimensions == 2 and method != "spline":
        _two(w, points, _points(w, 2), table, beyond, method)
    elif dimensions == 2:
        raise w.fault(
            f"looks up in two dimensions by {s.text('InterpMethod')!r}: make it 'Linear' with "
            "`parameter`"
        )
    else:
        raise w.fault(f"has {dimensions} dimensions; tables of one or two run")


def _of_ports(w: Writer, dimensions: int, beyond: str, method: str) -> None:
    """Look a number up in a table that is a signal, or whose points are; points come first."""
    u = w.numeric()
    if dimensions != 1 or method == "spline" or not u.is_scalar:
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
    if "Interpolation" not in how:
        raise w.fault(
            f"looks up by {how!r}, which does not run: make it one of interpolation with "
            "`parameter`"
        )
    at, of = w.vector(1), w.vector(2)
    if at.size != of.size:
        raise w.fault(f"has {at.size} points and {of.size} values: give as many of both")
    u = w.numeric()
    if not u.is_scalar:
        raise w.fault("looks a vector up, which does not run: give it one number")
    w.out(f"table_1d({u.code}, {at.code}, {of.code}, beyond={beyond!r}, method='linear')")


@kind("PreLookup")
def prelookup(w: Writer) -> None:
    """Tell between which points a number lies: how many are below, and the fraction beyond."""
    points = w.settings.numbers("BreakpointsData", "[10:10:110]")
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


@kind("Lookup2D")
def lookup_2d(w: Writer) -> None:
    """Look a number up in a table of two dimensions."""
    s = w.settings
    rows, columns = s.numbers("RowIndex", "[1 2]"), s.numbers("ColumnIndex", "[1 2]")
    beyond = "clip" if "Use End" in s.text("LookUpMeth", "") else "line"
    _two(w, rows, columns, s.matrix("Table", "[0 1;1 2]"), beyond)


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
    if method == "spline":
        from scipy.interpolate import CubicSpline

        curve = w.constant(CubicSpline(points, values), "curve")
        w.pen.written[curve] = Call(function="CubicSpline", arguments=(points, values))
        w.out(f"float({curve}({u.code}))" if u.is_scalar else f"{curve}({u.code})")
        return
    if u.is_scalar:
        w.out(call.format(u.code))
    else:
        w.out(f"array([{call.format('each')} for each in flat({u.code})]).reshape({u.shape})")


def _two(
    w: Writer,
    rows: np.ndarray,
    columns: np.ndarray,
    table: np.ndarray,
    beyond: str,
    method: str = "linear",
) -> None:
    if table.shape != (len(rows), len(columns)):
        raise w.fault(f"has a table of {table.shape} for {len(rows)} rows, {len(columns)} columns")
    r, c = w.constant(rows, "rows"), w.constant(columns, "columns")
    w.out(
        f"table_2d({w.input(0).code}, {w.input(1).code}, {r}, {c}, {w.constant(table, 'table')}, "
        f"beyond='{beyond}', method='{method}')"
    )
