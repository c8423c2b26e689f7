"""The singular postures of the leg and the feet that belong to them, as curves and surfaces.

Two families: sin q3 = 0, the leg stretched or folded, and rho = 0, the foot on the hip axis,
rho = l1 + l2 c2 + l3 c23. The hip angle is free in both.
"""

from __future__ import annotations

import math

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.leg import LegGeometry, foot_position


def hip_axis_arcs(leg: LegGeometry, samples: int = 181) -> tuple[Array, ...]:
    """Knee and ankle angles with which the foot is on the hip axis, as arcs (samples, 2) [rad].

    ``l1 + l2 cos q2 + l3 cos(q2 + q3) == 0`` for each of them. They are continuous along an arc and
    not wrapped: both signs of q2, both of q2 + q3. There are none where the leg is too short to
    reach its hip axis. MATLAB lists them as solutions after the first (report A, appendix).

    Raises
    ------
    InvalidValueError
        If there are fewer than 2 samples.
    """
    if samples < 2:
        raise InvalidValueError(f"there are {samples} samples of an arc; it takes at least 2")
    least, greatest = (-leg.l3 - leg.l1) / leg.l2, (leg.l3 - leg.l1) / leg.l2
    if greatest < -1.0:
        return ()
    from_, to = math.acos(min(greatest, 1.0)), math.acos(max(least, -1.0))
    knee = np.linspace(from_, to, samples)
    across = np.arccos(np.clip(-(leg.l1 + leg.l2 * np.cos(knee)) / leg.l3, -1.0, 1.0))
    signs = [(a, b) for a in (1.0, -1.0) for b in (1.0, -1.0)]
    return tuple(np.column_stack([a * knee, b * across - a * knee]) for a, b in signs)


def stretched_feet(leg: LegGeometry, turns: Array, lean: Array) -> Array:
    """Feet of the stretched leg: a torus about the hip axis, of radii l1 and l2 + l3.

    Hip angles (m,) and knee angles (n,) [rad] make positions p_BF (n, m, 3) [m].
    """
    return _feet(leg, turns, lean, 0.0)


def folded_feet(leg: LegGeometry, turns: Array, lean: Array) -> Array:
    """Feet of the folded leg: as ``stretched_feet``, with radii l1 and ``|l2 - l3|``."""
    return _feet(leg, turns, lean, math.pi)


def _feet(leg: LegGeometry, turns: Array, lean: Array, ankle: float) -> Array:
    hip, knee = np.meshgrid(turns, lean)
    return foot_position(leg, np.stack([hip, knee, np.full_like(hip, ankle)], axis=-1))


def leaning_over(leg: LegGeometry) -> float:
    """Greatest knee angle [rad] at which the stretched leg has its foot in front of the hip.

    There both families meet, and the rank is 1. pi where the foot never is behind.
    """
    return math.acos(max(-leg.l1 / (leg.l2 + leg.l3), -1.0))


def axis_reach(leg: LegGeometry) -> tuple[float, float]:
    """From where to where the foot reaches the hip axis [m], above the hip and below alike.

    Least and greatest distance from the hip; the least is 0 except for legs whose foot cannot come
    near the knee, and both are 0 where the leg is too short to reach its hip axis.
    """
    reaches = (abs(leg.l2 - leg.l3), leg.l2 + leg.l3)
    near, far = (math.sqrt(max(reach**2 - leg.l1**2, 0.0)) for reach in reaches)
    return near, far
