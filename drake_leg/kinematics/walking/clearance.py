"""How far the links of different legs stay apart, each of them a capsule around its solid."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Link, Robot
from drake_leg.robot.solids import Brick, Cylinder


class Capsules(NamedTuple):
    """Segments with a radius, each on a link."""

    rows: tuple[int, ...]  # of the links, from 1
    names: tuple[str, ...]  # of the links
    legs: tuple[int, ...]  # from 0, the leg that each belongs to
    ends: Array  # (k, 2, 3) [m], in the frames of the links
    radii: Array  # (k,) [m]

    def placed(self, X: Array) -> Array:
        """Ends of all segments, (..., k, 2, 3) [m]; the rows' frames are X (..., m, 4, 4)."""
        frames = X[..., [row - 1 for row in self.rows], :, :]
        turned = np.einsum("...kij,kej->...kei", frames[..., :3, :3], self.ends)
        return np.asarray(turned + frames[..., np.newaxis, :3, 3])


def capsules_of(robot: Robot) -> Capsules:
    """Capsules around the solids of all legs; a link without a solid is a line to its end.

    The capsule of a brick is along its longest edge, and around all its other edges.
    """
    found = [
        (row, link.name, leg, *_capsule(link))
        for leg, tip in enumerate(robot.tips.values())
        for row in robot.path(tip)
        if (link := robot.segments[row - 1].link) is not None
    ]
    rows, names, legs, ends, radii = zip(*found, strict=True)
    return Capsules(rows, names, legs, np.array(ends), np.array(radii))


def _capsule(link: Link) -> tuple[Array, float]:
    """Ends of a link's segment, (2, 3), and its radius [m], in the link's frame."""
    solid = link.solid
    if solid is None:
        return np.array([(0.0, 0.0, 0.0), link.end]), 0.0
    half, shape = np.zeros(3), solid.shape
    if isinstance(shape, Brick):
        sizes = (shape.length, shape.width, shape.height)
        longest = int(np.argmax(sizes))
        half[longest] = sizes[longest] / 2.0
        radius = math.hypot(*np.delete(sizes, longest).tolist()) / 2.0
    elif isinstance(shape, Cylinder):
        half[2], radius = shape.length / 2.0, shape.radius
    else:
        radius = shape.radius
    centre = np.array(solid.centre)
    return np.array([centre - half, centre + half]), radius


class Gaps(NamedTuple):
    """Distances between the capsules of different legs."""

    pairs: Array  # (p, 2) of int, capsules
    distances: Array  # (..., p) [m]; negative where they overlap


def gaps_between_legs(capsules: Capsules, X: Array) -> Gaps:
    """Distances between all links of different legs, the rows' frames being X (..., m, 4, 4)."""
    count = len(capsules.rows)
    pairs = np.array(
        [
            (one, other)
            for one in range(count)
            for other in range(one + 1, count)
            if capsules.legs[one] != capsules.legs[other]
        ]
    ).reshape(-1, 2)
    ends = capsules.placed(X)
    apart = segment_distance(ends[..., pairs[:, 0], :, :], ends[..., pairs[:, 1], :, :])
    return Gaps(pairs, apart - capsules.radii[pairs].sum(axis=1))


def segment_distance(first: Array, second: Array) -> Array:
    """Distance between segments given by their ends (..., 2, 3) [m], (...) [m]."""
    p, r = first[..., 0, :], second[..., 0, :]
    u, v, w = first[..., 1, :] - p, second[..., 1, :] - r, p - r
    uu, vv, uv, uw, vw = (_dot(a, b) for a, b in ((u, u), (v, v), (u, v), (u, w), (v, w)))
    across = uu * vv - uv**2
    s = np.clip(_quotient(uv * vw - uw * vv, across), 0.0, 1.0)
    t = np.clip(_quotient(uv * s + vw, vv), 0.0, 1.0)
    s = np.clip(_quotient(uv * t - uw, uu), 0.0, 1.0)
    return np.asarray(np.linalg.norm(w + s[..., np.newaxis] * u - t[..., np.newaxis] * v, axis=-1))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=-1))


def _quotient(a: Array, b: Array) -> Array:
    """``a / b``, 0 where b is 0: then any point of a segment is as near as any other."""
    return np.asarray(np.divide(a, b, out=np.zeros_like(a), where=b > 0.0))
