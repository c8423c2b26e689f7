"""How safely a robot is supported: distances of a point on the ground from the feet's polygon."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.kinematics.khalil import Array

LOADED = 0.02  # of the robot's weight: a foot with less supports nothing
BOUNCE = 0.020  # [s]: a foot that was loaded within this time supports; contacts open for moments
EXACT = 1e-9  # [s], of rows at the ends of that time


def supporting(time: Array, pressing: Array, weight: float) -> NDArray[np.bool_]:
    """Whether each foot supports a robot, (rows, n): it is loaded within ``BOUNCE`` of the row.

    The feet press on the ground with forces (rows, n) [N]; the contact of a foot that has just
    touched down may open again for a few steps.
    """
    loaded = pressing > LOADED * weight
    before = np.vstack([np.zeros((1, loaded.shape[1]), dtype=int), np.cumsum(loaded, axis=0)])
    first = np.searchsorted(time, time - BOUNCE - EXACT)
    last = np.searchsorted(time, time + BOUNCE + EXACT)
    return np.asarray(before[last] > before[first])


def support_margin(
    feet: ArrayLike, point: ArrayLike, down: NDArray[np.bool_] | None = None
) -> Array:
    """Distance of a point inside the feet's convex hull from its edge, (...) [m]; outside negative.

    The feet are (..., k, 2) [m], the point is (..., 2) [m]; of the feet, those that are ``down``
    (..., k) of bool count, by default all. Fewer than three feet, or feet on a line, support
    nothing: then it is minus the distance from what they span, -inf without a foot.
    """
    places, at = np.asarray(feet, dtype=np.float64), np.asarray(point, dtype=np.float64)
    counts = np.ones(places.shape[:-1], dtype=bool) if down is None else np.asarray(down)
    start, end = places[..., :, np.newaxis, :], places[..., np.newaxis, :, :]
    way = end - start  # (..., k, k, 2), from each foot to each other one
    size = np.square(way).sum(axis=-1)
    pairs = counts[..., :, np.newaxis] & counts[..., np.newaxis, :]
    offsets = places[..., np.newaxis, :, :] - places[..., :, np.newaxis, :]
    sides = _across(way[..., :, :, np.newaxis, :], offsets[..., :, np.newaxis, :, :])
    ignored = ~counts[..., np.newaxis, np.newaxis, :]
    edges = (
        pairs & ((sides >= 0.0) | ignored).all(axis=-1) & ((sides > 0.0) & ~ignored).any(axis=-1)
    )
    towards = at[..., np.newaxis, np.newaxis, :] - start
    length = np.sqrt(np.where(size > 0.0, size, 1.0))
    inside = np.where(edges, _across(way, towards) / length, np.inf).min(
        axis=(-2, -1), initial=np.inf
    )
    along = np.clip((towards * way).sum(axis=-1) / np.where(size > 0.0, size, 1.0), 0.0, 1.0)
    apart = np.linalg.norm(towards - along[..., np.newaxis] * way, axis=-1)
    outside = np.where(pairs, apart, np.inf).min(axis=(-2, -1), initial=np.inf)
    is_inside = edges.any(axis=(-2, -1)) & (inside >= 0.0)
    return np.asarray(np.where(is_inside, inside, -outside))


def _across(way: Array, offset: Array) -> Array:
    """How far an offset is to the left of a way, times the way's length, (...)."""
    return np.asarray(way[..., 0] * offset[..., 1] - way[..., 1] * offset[..., 0])


def on_ground(point: Array, force: Array, height: ArrayLike = 0.0) -> Array:
    """Where a line along a force through a point (..., 3) meets the ground, (..., 2) [m].

    The ground is the plane ``z = height``.
    """
    share = (np.asarray(height) - point[..., 2]) / force[..., 2]
    return np.asarray(point[..., :2] + share[..., np.newaxis] * force[..., :2])


def zero_moment_point(moment: Array, force: Array, height: ArrayLike = 0.0) -> Array:
    """Point of the ground about which a wrench has no horizontal moment, (..., 2) [m].

    The moment (..., 3) [N*m] is about the origin, the force (..., 3) [N] is not horizontal; the
    ground is the plane ``z = height``.
    """
    z = np.asarray(height)
    x = (z * force[..., 0] - moment[..., 1]) / force[..., 2]
    y = (z * force[..., 1] + moment[..., 0]) / force[..., 2]
    return np.stack([x, y], axis=-1)
