"""Mass of what a STEP file holds, by integrals over its exact surfaces."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import Array, MassProperties, composed

ENDINGS = (".step", ".stp")
MOST_BYTES = 200_000_000
ACCURACY = 1e-12  # of the volume, to which the integrals are refined
SAME = 1e-9  # [m], of points that are one
_NUMBER = re.compile(r" \d+$")
_METERS = {"INCH": 0.0254, "FOOT": 0.3048}
_PREFIXES = {"$": 1.0, "MILLI": 1e-3, "CENTI": 1e-2, "MICRO": 1e-6}
_CONVERTED = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'(\w+)'")
_SI = re.compile(rb"SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.\s*\)")


def properties_of_step(path: Path) -> MassProperties:
    """Return the properties of the solids of a STEP file, of a density of 1 kg/m^3.

    Its own unit is heeded.

    Raises
    ------
    InvalidValueError
        If it cannot be read, or holds no closed solid.
    """
    try:
        stat = path.stat()
    except OSError as error:
        raise InvalidValueError(f"{path.name!r} cannot be read ({error.strerror})") from None
    if stat.st_size > MOST_BYTES:
        raise InvalidValueError(f"{path.name!r} has more than {MOST_BYTES:,} bytes")
    return _read(path, stat.st_mtime_ns)


@lru_cache(maxsize=128)
def _read(path: Path, changed: int) -> MassProperties:
    return _properties(_shape(path, changed))


@lru_cache(maxsize=16)
def _shape(path: Path, _: int) -> Any:  # noqa: ANN401 - of Open CASCADE
    """Read the shape of a file, in meters."""
    try:
        from OCP.IFSelect import IFSelect_ReturnStatus
        from OCP.Interface import Interface_Static
        from OCP.Message import Message
        from OCP.STEPControl import STEPControl_Reader
    except ImportError:
        raise InvalidValueError(
            "which takes Open CASCADE to read", advice="pip install 'drake-leg[cad]'"
        ) from None
    Message.DefaultMessenger_s().ChangePrinters().Clear()
    reader = STEPControl_Reader()
    Interface_Static.SetCVal_s("xstep.cascade.unit", "M")
    done = IFSelect_ReturnStatus.IFSelect_RetDone
    if reader.ReadFile(str(path)) != done or not reader.TransferRoots():
        raise InvalidValueError("which is damaged")
    return reader.OneShape()


def _properties(shape: Any) -> MassProperties:  # noqa: ANN401 - of Open CASCADE
    """Add up the solids of a shape; its other surfaces enclose nothing."""
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopExp import TopExp_Explorer

    explorer, parts = TopExp_Explorer(shape, Kind.TopAbs_SOLID), []
    while explorer.More():
        parts.append((_of_solid(explorer.Current()), np.eye(4)))
        explorer.Next()
    if not parts:
        raise InvalidValueError("whose surface is not closed")
    return composed(parts)


def _of_solid(solid: Any) -> MassProperties:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, found, ACCURACY)
    center, inertia = found.CentreOfMass(), found.MatrixOfInertia()
    volume = float(found.Mass())
    if not volume:
        raise InvalidValueError("whose surface encloses nothing")
    sign = 1.0 if volume > 0.0 else -1.0  # of one whose faces look inwards
    rows = [[inertia.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)]
    return MassProperties(
        mass=sign * volume,
        center=np.array([center.X(), center.Y(), center.Z()]),
        inertia=sign * np.array(rows),
    )


def only_place(path: Path, feature: str) -> Array | None:
    """Return the point of a feature [m], where all of its kind in a STEP file have the same one.

    Such a feature is found whatever its number: the center of a sphere or a circle, or the middle
    of a cylinder's axis. None where there are several, or Open CASCADE is not installed.
    """
    kind = _NUMBER.sub("", feature)
    if kind not in _PLACES or path.suffix.lower() not in ENDINGS:
        return None
    try:
        points = _points(path, path.stat().st_mtime_ns, kind)
    except (InvalidValueError, OSError):
        return None
    if not len(points) or np.ptp(points, axis=0).max() > SAME:
        return None
    middle: Array = points.mean(axis=0)
    return middle


@lru_cache(maxsize=256)
def _points(path: Path, changed: int, kind: str) -> Array:
    """Return the points (n, 3) of all features of a kind [m]."""
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopExp import TopExp_Explorer

    what = Kind.TopAbs_EDGE if kind == "circular curve" else Kind.TopAbs_FACE
    explorer = TopExp_Explorer(_shape(path, changed), what)
    found = []
    while explorer.More():
        point = _PLACES[kind](explorer.Current())
        if point is not None:
            found.append([point.X(), point.Y(), point.Z()])
        explorer.Next()
    return np.array(found).reshape(-1, 3)


def _center_of_circle(edge: Any) -> Any:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_CurveType
    from OCP.TopoDS import TopoDS

    curve = BRepAdaptor_Curve(TopoDS.Edge(edge))
    is_circle = curve.GetType() == GeomAbs_CurveType.GeomAbs_Circle
    return curve.Circle().Location() if is_circle else None


def _center_of_sphere(face: Any) -> Any:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_SurfaceType

    surface = _surface(face)
    is_sphere = surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Sphere
    return surface.Sphere().Location() if is_sphere else None


def _middle_of_cylinder(face: Any) -> Any:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.gp import gp_Vec

    surface = _surface(face)
    if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Cylinder:
        return None
    axis = surface.Cylinder().Axis()
    along = (surface.FirstVParameter() + surface.LastVParameter()) / 2.0
    return axis.Location().Translated(gp_Vec(axis.Direction()) * along)


def _surface(face: Any) -> Any:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.TopoDS import TopoDS

    return BRepAdaptor_Surface(TopoDS.Face(face))


_PLACES = {
    "circular curve": _center_of_circle,
    "spherical surface": _center_of_sphere,
    "cylindrical surface": _middle_of_cylinder,
}


def unit_of_step(path: Path) -> float:
    """Read the unit of the lengths in a STEP file [m].

    Raises
    ------
    InvalidValueError
        If it has none, several, or another one.
    """
    text = path.read_bytes()
    names = {found.decode().upper() for found in _CONVERTED.findall(text)}
    lengths = {_METERS[name] for name in names if name in _METERS}
    lengths = lengths or {
        _PREFIXES.get(found.decode().strip(".").upper(), 0.0) for found in _SI.findall(text)
    }
    if len(lengths) != 1 or 0.0 in lengths:
        raise InvalidValueError("whose own unit is not known")
    return lengths.pop()
