"""A vehicle that follows a path of straight lines by pure pursuit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
OPPOSITE = 1e-12  # [rad]: as near to pi a vehicle looks away from its goal


def pursued(pose: Array, path: Array, ahead: float, speed: float, most: float, at: float) -> Array:
    """Return what lets a vehicle follow a path: the circle through a goal ahead on the path.

    Parameters
    ----------
    pose : (3,)
        x and y [m], and the direction counterclockwise from x [rad].
    path : (n, 2) or (2,)
        Its corners [m]; rows that are not finite are none.
    ahead : float
        How far the goal is along the path from the path's point nearest to the vehicle [m].
    speed, most : float
        Of the vehicle [m/s]; the largest of its turning [rad/s].
    at : float
        The line of the path on which the vehicle was, from 0 on; below 0 at the start.

    Returns
    -------
    (4,)
        Speed, rate of turning [rad/s], direction to the goal in the vehicle's frame [rad], the line
        on which it is now. The rate is ``2 speed sin(direction) / ahead``.

    References
    ----------
    R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01.
    """
    corners = np.reshape(path, (-1, 2))
    corners = corners[np.isfinite(corners).all(axis=1)]
    if not len(corners):
        return np.array([0.0, 0.0, 0.0, at])
    place, point = _nearest(pose[:2], corners, round(at), ahead)
    goal = _goal(point, corners, place, ahead)
    to_goal = math.atan2(goal[1] - pose[1], goal[0] - pose[0]) - pose[2]
    direction = math.atan2(math.sin(to_goal), math.cos(to_goal))
    rate = 2.0 * speed * math.sin(direction) / ahead
    if math.pi - abs(direction) < OPPOSITE:
        rate = math.copysign(1.0, direction)
    return np.array([speed, min(max(rate, -most), most), direction, float(place)])


def _nearest(position: Array, corners: Array, at: int, ahead: float) -> tuple[int, Array]:
    """Find the nearest point of a path, and its line: from the line before on, not farther ahead.

    A vehicle that passes where the path crosses itself stays on its way.
    """
    first, last = max(at, 0), max(len(corners) - 2, 0)
    best, place, point = math.inf, min(first, last), corners[min(first, last)]
    gone = 0.0
    for k in range(min(first, last), last + 1):
        start, end = corners[k], corners[min(k + 1, len(corners) - 1)]
        along = end - start
        square = float(along @ along)
        share = min(max(float((position - start) @ along) / square, 0.0), 1.0) if square else 0.0
        distance = float(np.hypot(*(start + share * along - position)))
        if distance < best:
            best, place, point, gone = distance, k, start + share * along, 0.0
        gone += math.sqrt(square) * (1.0 - share if place == k else 1.0)
        if at >= 0 and gone > ahead:
            break
    return place, point


def _goal(point: Array, corners: Array, place: int, ahead: float) -> Array:
    """Go along a path from a point on one of its lines; its end is the last goal."""
    here = point
    for corner in corners[place + 1 :]:
        length = float(np.hypot(*(corner - here)))
        if length >= ahead:
            goal: Array = here + (corner - here) * (ahead / length)
            return goal
        ahead, here = ahead - length, corner
    return here
