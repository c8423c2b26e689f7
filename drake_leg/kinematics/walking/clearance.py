"""How far links stay apart: those of different legs as capsules, and all of them off the ground."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.khalil import Array, base_transforms, row_transform
from drake_leg.robot.robot import Link, Robot
from drake_leg.robot.solids import Brick, Cylinder, Solid


class Capsules(NamedTuple):
    """Segments with a radius, each on a link; and which of them are on neighboring legs."""

    rows: tuple[int, ...]  # of the links, from 1
    names: tuple[str, ...]  # of the links
    legs: tuple[int, ...]  # from 0, the leg that each belongs to
    ends: Array  # (k, 2, 3) [m], in the frames of the links
    radii: Array  # (k,) [m]
    pairs: Array  # (p, 2) of int

    def placed(self, X: Array) -> Array:
        """Ends of all segments, (..., k, 2, 3) [m]; the rows' frames are X (..., m, 4, 4)."""
        frames = X[..., [row - 1 for row in self.rows], :, :]
        turned = np.einsum("...kij,kej->...kei", frames[..., :3, :3], self.ends)
        return np.asarray(turned + frames[..., np.newaxis, :3, 3])


@lru_cache(maxsize=8)
def capsules_of(robot: Robot) -> Capsules:
    """Capsules around the solids of all legs; a link without a solid is a line to its end.

    The capsule of a brick is along its longest edge, and around all its other edges. One that is
    inside of another one of the same body, as the ball of a foot in the tibia's, is left out.
    """
    found = [
        (row, link.name, leg, *_capsule(link))
        for leg, tip in enumerate(robot.tips.values())
        for row in robot.path(tip)
        if (link := robot.segments[row - 1].link) is not None and not _is_inside(robot, row, link)
    ]
    rows, names, legs, ends, radii = zip(*found, strict=True)
    beside = _neighbours(robot)
    pairs = [
        (one, other)
        for one, other in combinations(range(len(rows)), 2)
        if (legs[one], legs[other]) in beside
    ]
    return Capsules(
        rows, names, legs, np.array(ends), np.array(radii), np.array(pairs).reshape(-1, 2)
    )


def _neighbours(robot: Robot) -> set[tuple[int, int]]:
    """Legs that follow each other around the body, by their first joints, the lower one first."""
    X_B = base_transforms(robot.rows, np.zeros(len(robot.moving)))
    hips = np.array([X_B[robot.path(tip)[0] - 1, :2, 3] for tip in robot.tips.values()])
    x, y = (hips - hips.mean(axis=0)).T
    around = np.argsort(np.arctan2(y, x)).tolist()
    following = zip(around, [*around[1:], around[0]], strict=True)
    return {(min(pair), max(pair)) for pair in following}


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


def _is_inside(robot: Robot, row: int, link: Link) -> bool:
    """Whether the capsule of a fixed row's link is inside of that of the row before."""
    own, before = robot.rows[row - 1], robot.antecedents[row - 1]
    carrier = robot.segments[before - 1].link if before else None
    if own.joint != "fixed" or carrier is None:
        return False
    (ends, radius), (around, wide) = _capsule(link), _capsule(carrier)
    X = row_transform(own)
    points = (ends @ X[:3, :3].T + X[:3, 3])[:, np.newaxis].repeat(2, axis=1)
    return bool((segment_distance(points, around) + radius <= wide).all())


def lowest(solid: Solid, X: Array) -> Array:
    """Height of a solid's lowest point, (...) [m], its link's frames being X (..., 4, 4)."""
    up = X[..., 2, :3]
    shape = solid.shape
    if isinstance(shape, Brick):
        below = np.abs(up) @ np.array([shape.length, shape.width, shape.height]) / 2.0
    elif isinstance(shape, Cylinder):
        across = np.hypot(up[..., 0], up[..., 1])
        below = np.abs(up[..., 2]) * shape.length / 2.0 + across * shape.radius
    else:
        below = np.full(up.shape[:-1], shape.radius)
    return np.asarray(X[..., 2, 3] + up @ np.array(solid.centre) - below)


def gaps_between_legs(capsules: Capsules, X: Array) -> Array:
    """Distances of all pairs of capsules, (..., p) [m]; negative where they overlap.

    The rows' frames are X (..., m, 4, 4).
    """
    ends = capsules.placed(X)
    first, second = capsules.pairs.T
    apart = segment_distance(ends[..., first, :, :], ends[..., second, :, :])
    return np.asarray(apart - capsules.radii[capsules.pairs].sum(axis=1))


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
