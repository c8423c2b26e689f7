"""Where the faces, edges and corners lie of what a STEP file holds."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.step import (
    ENDINGS,
    changed_at,
    circles_of_step,
    shape_of_step,
    surfaces_of_step,
)
from drake_leg.units import plain_number

SAME = 1e-9  # [m], of points that are one, and the same of directions
SAME_SURFACE, SAME_AXIS = 1e-7, 1e-6  # [m], and of directions: as exact as files are
_NUMBER = re.compile(r" \d+$")


@dataclass(frozen=True, eq=False, kw_only=True)
class Place:
    """Where features of one kind lie in a file, one or several."""

    point: Array  # (3,) [m]
    direction: Array | None  # (3,): the outward normal of a face; along an axis, either way
    size: tuple[str, float]  # of the largest: its name, and its number [m] or [m^2]
    count: int = 1  # of the features there

    def numbers(self, scale: float = 1.0, *, directed: bool = False) -> str:
        """Write its point [m] times a scale, and its direction if it is wanted: ``0.1,0,0.02``."""
        numbers = [*(scale * self.point)]
        if directed and self.direction is not None:
            numbers += [*self.direction]
        return ",".join(f"{round(float(number), 12) + 0.0:.9g}" for number in numbers)

    def described(self, scale: float = 1.0) -> str:
        """Describe the size of the largest feature there: ``radius 4 mm``."""
        name, size = self.size
        if name == "area":
            return f"area {plain_number(1e6 * scale**2 * size, 4)} mm²"
        return f"{name} {plain_number(1e3 * scale * size, 4)} mm" if name else ""


def kind_of(feature: str) -> str:
    """Name the kind of a feature: ``circular curve`` of ``circular curve 9``."""
    return _NUMBER.sub("", feature)


def places_of(path: Path, kind: str) -> tuple[Place, ...]:
    """List the places of all features of a kind in a STEP file, as it is read, in meters.

    Nothing tells which number an edge or a corner has. If each is as likely, those places are the
    likeliest where most of them lie: they come first, then the largest.

    Raises
    ------
    InvalidValueError
        If it cannot be read.
    """
    return _places(path, changed_at(path), kind) if kind in KINDS else ()


def only_place(path: Path, feature: str) -> Array | None:
    """Return the point of a feature [m], where all of its kind in a STEP file have the same one.

    Such a feature is found whatever its number: the center of a sphere or a circle, or the middle
    of a cylinder's axis. None where there are several, or Open CASCADE is not installed.
    """
    kind = kind_of(feature)
    if kind not in _ROUND or path.suffix.lower() not in ENDINGS:
        return None
    try:
        points = np.array([place.point for place in places_of(path, kind)])
    except InvalidValueError:
        return None
    if not len(points) or np.ptp(points, axis=0).max() > SAME:
        return None
    middle: Array = points.mean(axis=0)
    return middle


def counted_place(path: Path, feature: str) -> Place | None:
    """Return the place of a face or a circle by its number in a STEP file of one solid.

    Faces of a kind are counted from 1 in the order of the file, and circles once for each face
    around which they are, as models tell whose parts meet. None for other edges and corners, where
    the file holds other than one solid, or without Open CASCADE.
    """
    kind, numbered = kind_of(feature), _NUMBER.search(feature)
    counted = _circles if kind == CIRCLE else _faces if kind in _SURFACES else None
    if numbered is None or counted is None or path.suffix.lower() not in ENDINGS:
        return None
    number = int(numbered[0])
    try:
        places = counted(path, changed_at(path), kind)
    except InvalidValueError:
        return None
    return places[number - 1] if 0 < number <= len(places) else None


@lru_cache(maxsize=256)
def _circles(path: Path, changed: int, kind: str) -> tuple[Place | None, ...]:
    """List the circles around faces, in the order of the file; None where the shape has no such."""
    shape = shape_of_step(path)
    if len([*_parts(shape, "TopAbs_SOLID")]) != 1:
        return ()
    circles = [*_features(shape, kind)]
    found = (
        [each for each in circles if np.linalg.norm(each.point - center) < SAME_SURFACE]
        for center in circles_of_step(path)
    )
    return tuple(each[0] if each else None for each in found)


@lru_cache(maxsize=256)
def _faces(path: Path, changed: int, kind: str) -> tuple[Place | None, ...]:
    """List the faces of a kind in the order of the file, which Open CASCADE may have changed.

    None stands for those that are not told from others at other places on the same surface.
    """
    shape = shape_of_step(path)
    if len([*_parts(shape, "TopAbs_SOLID")]) != 1:
        return ()
    faces = [*_features(shape, kind)]
    surfaces = surfaces_of_step(path, _SURFACES[kind])
    pairs = zip(faces, surfaces, strict=False)
    if len(faces) == len(surfaces) and all(_is_on(*pair, kind) for pair in pairs):
        return tuple(faces)
    found = ([face for face in faces if _is_on(face, each, kind)] for each in surfaces)
    return tuple(each[0] if len({*map(_key, each)}) == 1 else None for each in found)


def _is_on(face: Place, surface: tuple[Array, Array], kind: str) -> bool:
    """Tell whether the middle of a face is on a surface with an origin and an axis, or around."""
    origin, axis = surface
    apart, along = face.point - origin, face.direction
    if along is not None and np.linalg.norm(np.cross(along, axis)) > SAME_AXIS:
        return False
    if kind == "planar surface":
        apart = (apart @ axis) * axis
    elif kind == "cylindrical surface":
        apart = apart - (apart @ axis) * axis
    return bool(np.linalg.norm(apart) < SAME_SURFACE)


@lru_cache(maxsize=256)
def _places(path: Path, changed: int, kind: str) -> tuple[Place, ...]:
    found: dict[tuple[int, ...], Place] = {}
    for place in _features(shape_of_step(path), kind):
        other = found.get(_key(place))
        larger = place if other is None or place.size > other.size else other
        found[_key(place)] = Place(
            point=larger.point,
            direction=larger.direction,
            size=larger.size,
            count=1 if other is None else other.count + 1,
        )
    return tuple(sorted(found.values(), key=lambda place: (-place.count, -place.size[1])))


def _key(place: Place) -> tuple[int, ...]:
    numbers = [*place.point, *(() if place.direction is None else place.direction)]
    return tuple(round(float(number) / SAME) for number in numbers)


def _features(shape: Any, kind: str) -> Iterator[Place]:  # noqa: ANN401 - of Open CASCADE
    what, place_of = KINDS[kind]
    places = map(place_of, _parts(shape, what))
    return (place for place in places if place is not None)


def _parts(shape: Any, what: str) -> Iterator[Any]:  # noqa: ANN401 - of Open CASCADE
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, what))
    seen: dict[int, list[Any]] = {}  # as an edge is met once for each of its faces
    while explorer.More():
        part = explorer.Current()
        alike = seen.setdefault(hash(part.Oriented(TopAbs_Orientation.TopAbs_FORWARD)), [])
        if not any(map(part.IsSame, alike)):
            alike.append(part)
            yield part
        explorer.Next()


# --- features --------------------------------------------------------------------------------


def _circle(edge: Any) -> Place | None:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_CurveType

    curve = _curve(edge)
    if curve is None or curve.GetType() != GeomAbs_CurveType.GeomAbs_Circle:
        return None
    circle = curve.Circle()
    return Place(
        point=_array(circle.Location()),
        direction=_one_way(_array(circle.Axis().Direction())),
        size=("radius", circle.Radius()),
    )


def _segment(edge: Any) -> Place | None:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_CurveType

    curve = _curve(edge)
    if curve is None or curve.GetType() != GeomAbs_CurveType.GeomAbs_Line:
        return None
    ends = [
        _array(curve.Value(at)) for at in (curve.FirstParameter(), curve.LastParameter())
    ]  # fmt: skip
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length < SAME:
        return None
    direction = _one_way((ends[1] - ends[0]) / length)
    return Place(point=(ends[0] + ends[1]) / 2.0, direction=direction, size=("length", length))


def _corner(vertex: Any) -> Place:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRep import BRep_Tool
    from OCP.TopoDS import TopoDS

    point = _array(BRep_Tool.Pnt_s(TopoDS.Vertex(vertex)))
    return Place(point=point, direction=None, size=("", 0.0))


def _plane(face: Any) -> Place | None:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRepGProp import BRepGProp
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_Orientation

    surface = _surface(face)
    if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Plane:
        return None
    found, position = GProp_GProps(), surface.Plane().Position()
    BRepGProp.SurfaceProperties_s(face, found)
    is_reversed = face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
    sign = -1.0 if is_reversed == position.Direct() else 1.0
    return Place(
        point=_array(found.CentreOfMass()),
        direction=sign * _array(position.Direction()),
        size=("area", float(found.Mass())),
    )


def _sphere(face: Any) -> Place | None:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_SurfaceType

    surface = _surface(face)
    if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Sphere:
        return None
    sphere = surface.Sphere()
    point = _array(sphere.Location())
    return Place(point=point, direction=None, size=("radius", sphere.Radius()))


def _cylinder(face: Any) -> Place | None:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_SurfaceType

    surface = _surface(face)
    if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Cylinder:
        return None
    cylinder = surface.Cylinder()
    along = _array(cylinder.Axis().Direction())
    middle = (surface.FirstVParameter() + surface.LastVParameter()) / 2.0
    return Place(
        point=_array(cylinder.Location()) + middle * along,
        direction=_one_way(along),
        size=("radius", cylinder.Radius()),
    )


def _torus(face: Any) -> Place | None:  # noqa: ANN401 - of Open CASCADE
    from OCP.GeomAbs import GeomAbs_SurfaceType

    surface = _surface(face)
    if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Torus:
        return None
    torus = surface.Torus()
    return Place(
        point=_array(torus.Location()),
        direction=_one_way(_array(torus.Axis().Direction())),
        size=("radius", torus.MajorRadius()),
    )


def _curve(edge: Any) -> Any:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.TopoDS import TopoDS

    edge = TopoDS.Edge(edge)
    return None if BRep_Tool.Degenerated_s(edge) else BRepAdaptor_Curve(edge)


def _surface(face: Any) -> Any:  # noqa: ANN401 - of Open CASCADE
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.TopoDS import TopoDS

    return BRepAdaptor_Surface(TopoDS.Face(face))


def _array(point: Any) -> Array:  # noqa: ANN401 - of Open CASCADE
    return np.array([point.X(), point.Y(), point.Z()])


def _one_way(direction: Array) -> Array:
    """Return a direction or its opposite, whichever has its largest element positive."""
    largest = direction[np.abs(direction).round(6).argmax()]
    return direction if largest > 0.0 else -direction


_FACE, CIRCLE = "TopAbs_FACE", "circular curve"
_SURFACES = {
    "planar surface": "StepGeom_Plane",
    "cylindrical surface": "StepGeom_CylindricalSurface",
    "spherical surface": "StepGeom_SphericalSurface",
    "toroidal surface": "StepGeom_ToroidalSurface",
}
KINDS = {
    "planar surface": (_FACE, _plane),
    "cylindrical surface": (_FACE, _cylinder),
    "spherical surface": (_FACE, _sphere),
    "toroidal surface": (_FACE, _torus),
    CIRCLE: ("TopAbs_EDGE", _circle),
    "segment": ("TopAbs_EDGE", _segment),
    "point": ("TopAbs_VERTEX", _corner),
}
_ROUND = (CIRCLE, "spherical surface", "cylindrical surface")
