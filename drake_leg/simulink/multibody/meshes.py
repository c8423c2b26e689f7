"""Meshes of extruded and revolved solids, which SDF has no element for, as OBJ files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.solids import Extrusion, Revolution, Solid

ARC = math.tau / 48  # [rad], of a facet of a revolution

Triangle = tuple[int, int, int]


def write_meshes(mechanism: Mechanism, folder: Path) -> dict[Solid, str]:
    """Write a mesh of each solid that needs one, and return their paths."""
    found = {}
    for number, (_, solid) in enumerate(mechanism.connections.solids):
        if isinstance(solid.shape, Extrusion | Revolution) and solid.is_drawn:
            path = folder / f"{number}.obj"
            path.write_text(obj(*mesh(solid.shape)), encoding="utf-8")
            found[solid] = path.as_uri()
    return found


def mesh(shape: Extrusion | Revolution) -> tuple[Array, list[Triangle]]:
    """Return corners (n, 3) [m], in R, and triangles that are counterclockwise from outside."""
    return _extruded(shape) if isinstance(shape, Extrusion) else _revolved(shape)


def obj(corners: Array, triangles: Sequence[Triangle]) -> str:
    """Write a mesh as Wavefront OBJ."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
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
