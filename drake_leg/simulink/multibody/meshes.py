"""Meshes of solids that SDF has no element for, as OBJ files.

Extruded and revolved solids are cut into triangles here; files of CAD programs are read by trimesh.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path, PureWindowsPath

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.linking import files_in
from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.multibody.file_shape import FileShape
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.naming import Once, word
from drake_leg.simulink.multibody.solids import Extrusion, Revolution, Solid
from drake_leg.simulink.multibody.step import ENDINGS as STEP_ENDINGS

ARC = math.tau / 48  # [rad], of a facet of a revolution
ENDINGS = (".stl", ".obj", ".ply", *STEP_ENDINGS)

Triangle = tuple[int, int, int]


@dataclass
class Meshes:
    """The meshes of a mechanism, and the files that are not shown."""

    names: dict[Solid, str] = field(default_factory=dict)  # of the files written
    missing: list[str] = field(default_factory=list)  # files that lie nowhere
    unread: dict[str, str] = field(default_factory=dict)  # files that were not read, and why


def write_meshes(mechanism: Mechanism, folder: Path, where: Sequence[Path] = ()) -> Meshes:
    """Write a mesh of each solid that is drawn and needs one, into a folder.

    Files of CAD programs are looked for by their names in other folders, with all folders inside.
    """
    found, once = Meshes(), Once()
    files = FileMeshes(where)
    for _, solid in mechanism.connections.solids:
        if not solid.is_drawn:
            continue
        text = None
        if isinstance(solid.shape, Extrusion | Revolution):
            text = obj(*mesh(solid.shape))
        elif isinstance(solid.shape, FileShape):
            text = files.text(solid.shape, found)
        if text is not None:
            name = f"{once.name(word(solid.block.name))}.obj"
            (folder / name).write_text(text, encoding="utf-8")
            found.names[solid] = name
    return found


class FileMeshes:
    """Reads files of geometry, each once, in meters; they are looked for by their names."""

    def __init__(self, where: Sequence[Path]) -> None:
        self._where = where
        self._places: dict[str, Path] | None = None
        self._meshes: dict[tuple[Path, float], tuple[Array, list[Triangle]] | None] = {}

    def text(self, shape: FileShape, found: Meshes) -> str | None:
        """Read a shape as OBJ, or note why it is not shown."""
        known = self.mesh(shape, found)
        return obj(*known) if known else None

    def mesh(self, shape: FileShape, found: Meshes) -> tuple[Array, list[Triangle]] | None:
        """Read corners (n, 3) [m] and triangles of a shape, or note why it is not read."""
        name = PureWindowsPath(shape.file).name
        if self._places is None:
            self._places = {}
            for path in files_in(self._where, ENDINGS):
                self._places.setdefault(path.name.lower(), path)
        place = self._places.get(name.lower())
        if place is None:
            found.missing += [name] if name not in found.missing else []
            return None
        try:
            key = place, shape.scale(place)
        except InvalidValueError as error:
            found.unread[name] = error.problem
            return None
        if key not in self._meshes:
            self._meshes[key] = _read(*key, found)
        return self._meshes[key]


def _read(path: Path, scale: float, found: Meshes) -> tuple[Array, list[Triangle]] | None:
    try:
        import trimesh
    except ImportError:
        found.unread[path.name] = "pip install 'drake-leg[meshes]'"
        return None
    try:
        loaded = trimesh.load_mesh(path)
        if not len(loaded.faces):
            found.unread[path.name] = "it holds no triangle"
            return None
        return scale * np.asarray(loaded.vertices, dtype=float), loaded.faces.tolist()
    except Exception as error:  # a damaged file may raise anything
        found.unread[path.name] = " ".join(str(error).split())[:100]
        return None


def mesh(shape: Extrusion | Revolution) -> tuple[Array, list[Triangle]]:
    """Return corners (n, 3) [m], in R, and triangles that are counterclockwise from outside."""
    return _extruded(shape) if isinstance(shape, Extrusion) else _revolved(shape)


def obj(corners: Array, triangles: Sequence[Triangle]) -> str:
    """Write a mesh of flat facets as Wavefront OBJ; those without area are left out."""
    faces = np.asarray(triangles, dtype=int).reshape(-1, 3)
    a, b, c = (corners[column] for column in faces.T)
    across = np.cross(b - a, c - a)
    areas = np.linalg.norm(across, axis=1)
    faces, normals = faces[areas > 0.0], across[areas > 0.0] / areas[areas > 0.0, None]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners.tolist()]
    lines += [f"vn {x:.6f} {y:.6f} {z:.6f}" for x, y, z in normals.tolist()]
    lines += [
        f"f {a}//{number} {b}//{number} {c}//{number}"
        for number, (a, b, c) in enumerate((faces + 1).tolist(), start=1)
    ]
    return "\n".join(lines) + "\n"


def _extruded(shape: Extrusion) -> tuple[Array, list[Triangle]]:
    section, count = shape.section, len(shape.section)
    half = np.full((count, 1), shape.length / 2.0)
    corners = np.vstack([np.hstack([section, -half]), np.hstack([section, half])])
    triangles: list[Triangle] = []
    for here in range(count):
        after = (here + 1) % count
        triangles += [(here, after, after + count), (here, after + count, here + count)]
    for a, b, c in triangulated(section):
        triangles += [(c, b, a), (a + count, b + count, c + count)]
    return corners, triangles


def _revolved(shape: Revolution) -> tuple[Array, list[Triangle]]:
    section, count = shape.section, len(shape.section)
    steps = math.ceil(shape.angle / ARC)
    angles = np.linspace(-shape.angle / 2.0, shape.angle / 2.0, steps + 1)
    x, z = section.T
    corners = np.vstack(
        [np.column_stack([x * math.cos(a), x * math.sin(a), z]) for a in angles.tolist()]
    )
    triangles: list[Triangle] = []
    for slice_ in range(steps):
        near, far = slice_ * count, (slice_ + 1) * count
        for here in range(count):
            after = (here + 1) % count
            triangles += [
                (near + here, far + after, near + after),
                (near + here, far + here, far + after),
            ]
    if shape.angle < math.tau:
        last = steps * count
        for a, b, c in triangulated(section):
            triangles += [(a, b, c), (c + last, b + last, a + last)]
    return corners, triangles


def triangulated(polygon: Array) -> list[Triangle]:
    """Cut a simple polygon (n, 2), counterclockwise, into triangles by clipping its ears.

    Holes that are reached and left on one line are cut out, too.
    """
    left = list(range(len(polygon)))
    found: list[Triangle] = []
    while len(left) > 3:
        place = _ear(polygon, left)
        a, b, c = left[place - 1], left[place], left[(place + 1) % len(left)]
        found.append((a, b, c))
        del left[place]
    return [*found, (left[0], left[1], left[2])]


def _ear(polygon: Array, left: Sequence[int]) -> int:
    """Find a corner that can be clipped; of a polygon that has none the most convex one."""
    points = polygon[list(left)]
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    turns = _cross(points - before, after - points)
    for place in np.flatnonzero(turns >= 0.0).tolist():
        a, b, c = before[place], points[place], after[place]
        others = np.delete(points, [place - 1, place, (place + 1) % len(left)], axis=0)
        inside = (
            (_cross(b - a, others - a) > 0.0)
            & (_cross(c - b, others - b) > 0.0)
            & (_cross(a - c, others - c) > 0.0)
        )
        if not inside.any():
            return int(place)
    return int(np.argmax(turns))


def _cross(a: Array, b: Array) -> Array:
    crossed: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return crossed
