"""Mass of what an STL file holds, by exact integrals over the triangles of its closed surface."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import Array, MassProperties, of_second_moments

MOST_BYTES = 200_000_000
_HEAD = 84  # bytes before the triangles of a binary file
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
_NUMBER = rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_CORNER = re.compile(rb"vertex\s+(%b)\s+(%b)\s+(%b)(?!\S)" % (_NUMBER, _NUMBER, _NUMBER))
_WORD = re.compile(rb"\bvertex\b")


def read_stl(path: Path) -> Array:
    """Read the corners of all triangles, (n, 3, 3), in the file's unit.

    Raises
    ------
    InvalidValueError
        If it cannot be read, or holds no triangles, or one of them is not whole.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InvalidValueError(f"{path.name!r} has more than {MOST_BYTES:,} bytes")
        content = path.read_bytes()
    except OSError as error:
        raise InvalidValueError(f"{path.name!r} cannot be read ({error.strerror})") from None
    count = int.from_bytes(content[80:_HEAD], "little")
    if count and len(content) == _HEAD + count * _RECORD.itemsize:
        corners = np.frombuffer(content, _RECORD, count, _HEAD)["corners"].astype(float)
    else:
        found = _CORNER.findall(content)
        if len(found) % 3 or len(found) != len(_WORD.findall(content)):
            raise InvalidValueError(f"{path.name!r} has a triangle that is cut: export it again")
        corners = np.array(found, dtype=float).reshape(-1, 3, 3)
    if not len(corners) or not np.isfinite(corners).all():
        raise InvalidValueError(f"{path.name!r} holds no triangles: export it again")
    return corners


def is_closed(corners: Array) -> bool:
    """Whether each edge of the triangles is met as often from one side as from the other."""
    _, places = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = places.reshape(-1, 3)
    first, second = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(places.max()) + 1
    return bool(np.array_equal(np.sort(first * count + second), np.sort(second * count + first)))


def of_mesh(corners: Array, density: float) -> MassProperties:
    """Return the properties of what triangles (n, 3, 3) [m] enclose, whichever way they turn."""
    middle = corners.reshape(-1, 3).mean(axis=0)
    a, b, c = np.moveaxis(corners - middle, 1, 0)
    volumes = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
    volume = float(volumes.sum())
    if volume == 0.0:
        raise InvalidValueError("its surface encloses nothing")
    sums = a + b + c
    first = volumes @ sums / 4.0
    second = sum(np.einsum("n,ni,nj->ij", volumes, x, x) for x in (a, b, c, sums)) / 20.0
    center = first / volume
    spread = second / volume - np.outer(center, center)
    return of_second_moments(abs(volume) * density, center + middle, spread)
