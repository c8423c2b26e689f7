"""Where a leg's foot can be, as a section through the plane of the leg."""

from __future__ import annotations

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.leg import LegGeometry

CORNERS = 96  # of a circle


def section_circles(leg: LegGeometry) -> tuple[Array, Array]:
    """Inner and outer border of what the foot reaches without turning the hip.

    Returns
    -------
    inner, outer : (CORNERS, 3) ndarray
        Circles of radius |l2 - l3| and l2 + l3 around the knee, in the plane of the leg at
        q1 = 0: x away from the hip axis, z up [m].
    """
    angles = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    circle = np.column_stack([np.cos(angles), np.zeros(CORNERS), np.sin(angles)])
    knee = np.array([leg.l1, 0.0, 0.0])
    return knee + abs(leg.l2 - leg.l3) * circle, knee + (leg.l2 + leg.l3) * circle


def section_triangles(leg: LegGeometry) -> tuple[Array, Array]:
    """The section as a surface.

    Returns
    -------
    vertices : (2 CORNERS, 3) ndarray
        Those of the inner circle first [m].
    triangles : (2 CORNERS, 3) ndarray
        Indices of vertices.
    """
    here = np.arange(CORNERS)
    after = (here + 1) % CORNERS
    halves = ([here, here + CORNERS, after + CORNERS], [here, after + CORNERS, after])
    triangles = np.concatenate([np.column_stack(half) for half in halves])
    return np.concatenate(section_circles(leg)), triangles
