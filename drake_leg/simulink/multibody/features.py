"""Where the faces, edges and corners of a solid lie, by Simscape's names for them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.multibody.mass import Array

_SIGNED = re.compile(r"([+-])([xyz])")
_NUMBERED = re.compile(r"(top|bottom|side) (surface|curve|point) (\d+)")
_AXES = {"x": 0, "y": 1, "z": 2}
_ENDS = {"top": 1.0, "bottom": -1.0}


@dataclass(frozen=True, kw_only=True)
class Feature:
    """A face, an edge or a corner of a solid with the reference frame R."""

    center: Array  # (3,) p_RF [m]
    normal: Array | None = None  # (3,) of a face, outward, or of a circle; in R


def brick_feature(name: str, edges: Sequence[float]) -> Feature:
    """Find ``+z surface``, ``-z +x curve`` or ``+x +y +z point`` of a brick with edges [m]."""
    signs = {_AXES[axis]: float(f"{sign}1") for sign, axis in _SIGNED.findall(name)}
    center = np.zeros(3)
    for axis, sign in signs.items():
        center[axis] = sign * edges[axis] / 2.0
    if not signs:
        raise _unknown(name)
    return Feature(center=center, normal=np.sign(center) if len(signs) == 1 else None)


def cylinder_feature(name: str, length: float) -> Feature:
    """Find ``top surface``, ``bottom curve`` or ``side surface`` of a cylinder [m]."""
    end, _, kind = name.partition(" ")
    if name == "side surface":
        return Feature(center=np.zeros(3))
    if end in _ENDS and kind in ("surface", "curve"):
        up = np.array([0.0, 0.0, _ENDS[end]])
        return Feature(center=up * length / 2.0, normal=up)
    raise _unknown(name)


def ball_feature(name: str) -> Feature:
    """Find the surface of a sphere or an ellipsoid, which is around its center."""
    if not name.endswith("surface"):
        raise _unknown(name)
    return Feature(center=np.zeros(3))


def extrusion_feature(name: str, section: Array, length: float, centroid: Array) -> Feature:
    """Find a face, edge or corner of an extrusion along z, ``side surface 2`` or ``top point 5``.

    ``section`` (n, 2) [m] has the material on its left. Side surface k goes from its point k to
    the next one, counted from 1. ``centroid`` (2,) is that of the cross-section [m].
    """
    end, _, kind = name.partition(" ")
    if end in _ENDS and kind == "surface":
        up = np.array([0.0, 0.0, _ENDS[end]])
        return Feature(center=np.append(centroid, _ENDS[end] * length / 2.0), normal=up)
    match = _NUMBERED.fullmatch(name)
    if match is None or not 1 <= int(match[3]) <= len(section):
        raise _unknown(name)
    number = int(match[3])
    here, after = section[number - 1], section[number % len(section)]
    height = _ENDS.get(match[1], 0.0) * length / 2.0
    if match[2] == "point" or (match[1], match[2]) == ("side", "curve"):
        return Feature(center=np.append(here, height))
    middle, along = (here + after) / 2.0, after - here
    outward = np.array([along[1], -along[0], 0.0]) / np.linalg.norm(along)
    return Feature(center=np.append(middle, height), normal=outward if match[1] == "side" else None)


def revolution_feature(name: str, section: Array) -> Feature:
    """Find ``side surface 2`` of a full revolution about z: a flat ring, or a cylinder.

    ``section`` (n, 2) [m], x and z, has the material on its left. Side surface k is made by the
    line from its point k to the next one, counted from 1.
    """
    match = _NUMBERED.fullmatch(name)
    if match is None or match[1] != "side" or match[2] != "surface":
        raise _unknown(name)
    number = int(match[3])
    if not 1 <= number <= len(section):
        raise _unknown(name)
    here, after = section[number - 1], section[number % len(section)]
    if here[1] == after[1]:
        up = np.array([0.0, 0.0, np.sign(here[0] - after[0])])
        return Feature(center=np.array([0.0, 0.0, here[1]]), normal=up)
    if here[0] == after[0]:
        return Feature(center=np.array([0.0, 0.0, (here[1] + after[1]) / 2.0]))
    raise _unknown(name)


def _unknown(name: str) -> InvalidValueError:
    return InvalidValueError(
        f"it has no {name!r} that is known: place the frame by another feature"
    )
