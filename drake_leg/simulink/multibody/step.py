"""Mass of what a STEP file holds, by integrals over its exact surfaces."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import Array, MassProperties, composed

ENDINGS = (".step", ".stp")
_SHELLS = ("StepShape_ClosedShell", "StepShape_OpenShell", "StepShape_ConnectedFaceSet")
MOST_BYTES = 200_000_000
ACCURACY = 1e-12  # of the volume, to which the integrals are refined
_METERS = {"INCH": 0.0254, "FOOT": 0.3048}
_PREFIXES = {"$": 1.0, "MILLI": 1e-3, "CENTI": 1e-2, "MICRO": 1e-6}
_CONVERTED = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'(\w+)'")
_SI = re.compile(rb"SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.\s*\)")


def shape_of_step(path: Path) -> Any:  # noqa: ANN401 - of Open CASCADE
    """Read the shape that a STEP file holds, in meters.

    Raises
    ------
    InvalidValueError
        If it cannot be read.
    """
    return _shape(path, changed_at(path))


def changed_at(path: Path) -> int:
    """Tell when a file was changed [ns].

    Raises
    ------
    InvalidValueError
        If it cannot be read, or is too large.
    """
    try:
        stat = path.stat()
    except OSError as error:
        raise InvalidValueError(f"which cannot be read ({error.strerror})") from None
    if stat.st_size > MOST_BYTES:
        raise InvalidValueError(f"which has more than {MOST_BYTES:,} bytes")
    return stat.st_mtime_ns


def properties_of_step(path: Path) -> MassProperties:
    """Return the properties of the solids of a STEP file, of a density of 1 kg/m^3.

    Its own unit is heeded.

    Raises
    ------
    InvalidValueError
        If it cannot be read, or holds no closed solid.
    """
    return _read(path, changed_at(path))


def surfaces_of_step(path: Path, kind: str) -> list[tuple[Array, Array]]:
    """List the surfaces of a kind under the faces of shells, in the order of a STEP file.

    Each has an origin [m] and an axis: ``StepGeom_Plane``, its normal.

    Raises
    ------
    InvalidValueError
        If its own unit is not known.
    """
    unit = unit_of_step(path)
    surfaces = (face.FaceGeometry() for face in _faces_in(path))
    return [
        _origin_and_axis(surface.Position(), unit)
        for surface in surfaces
        if surface.DynamicType().Name() == kind
    ]


def circles_of_step(path: Path) -> list[Array]:
    """List the centers of circles around the faces of shells, in the order of a STEP file [m].

    A circle between two faces is there twice, as it bounds both.

    Raises
    ------
    InvalidValueError
        If its own unit is not known.
    """
    unit, found = unit_of_step(path), []
    for curve in (curve for face in _faces_in(path) for curve in _curves_around(face)):
        if curve.DynamicType().Name() == "StepGeom_Circle":
            found.append(_origin_and_axis(curve.Position().Axis2Placement3d(), unit)[0])
    return found


def _faces_in(path: Path) -> Iterator[Any]:
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    model = reader.StepModel()
    for number in range(1, model.NbEntities() + 1):
        shell = model.Value(number)
        if shell.DynamicType().Name() in _SHELLS:
            faces = (shell.CfsFacesValue(at) for at in range(1, shell.NbCfsFaces() + 1))
            yield from (face for face in faces if hasattr(face, "FaceGeometry"))


def _curves_around(face: Any) -> Iterator[Any]:  # noqa: ANN401 - of Open CASCADE
    for number in range(1, face.NbBounds() + 1):
        loop = face.BoundsValue(number).Bound()
        if loop.DynamicType().Name() == "StepShape_EdgeLoop":
            for at in range(1, loop.NbEdgeList() + 1):
                curve = loop.EdgeListValue(at).EdgeElement().EdgeGeometry()
                while hasattr(curve, "Curve3d"):
                    curve = curve.Curve3d()
                yield curve


def _origin_and_axis(placement: Any, unit: float) -> tuple[Array, Array]:  # noqa: ANN401
    point, axis = placement.Location(), np.array([0.0, 0.0, 1.0])
    if placement.HasAxis():
        axis = np.array([placement.Axis().DirectionRatiosValue(k) for k in (1, 2, 3)])
    origin = np.array([point.CoordinatesValue(k) for k in (1, 2, 3)])
    return unit * origin, axis / np.linalg.norm(axis)


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
