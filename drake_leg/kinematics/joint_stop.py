"""Force and energy of a joint's limits: Simscape's smoothed spring and damper.

The depth of a joint in its stop is positive beyond the bound; the rate is its derivative. Both may
carry derivatives.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics


def engagement(stop: HardStop, depth: ArrayLike) -> Array:
    """Share of spring and damper that acts: ``3 s^2 - 2 s^3`` at ``s = depth / width`` in 0 ... 1.

    0 at the bound and 1 at the end of the transition region, with slope 0 at both: the polynomial
    of least degree that fits Simscape's description, which states no formula.
    """
    s = np.clip(np.asarray(depth) / stop.transition_width, 0.0, 1.0)
    share: Array = s * s * (3.0 - 2.0 * s)
    return share


def stop_force(stop: HardStop, depth: ArrayLike, rate: ArrayLike) -> Array:
    """Force that pushes a joint out of its stop, (...) [N*m or N]; it never pulls.

    ``engagement * max(0, k depth + d rate)``, with the depth in rad or m.
    """
    x, v = np.asarray(depth), np.asarray(rate)
    push = np.maximum(0.0, stop.stiffness * x + stop.damping * v)
    return engagement(stop, x) * push


def limit_force(mechanics: JointMechanics, q: ArrayLike, qdot: ArrayLike) -> Array:
    """Force of a joint's limits on it, along the joint, (...) [N*m or N]; 0 within them.

    Limits without a stop contribute nothing.
    """
    at, rate = np.asarray(q), np.asarray(qdot)
    total: Array = np.zeros(np.broadcast_shapes(at.shape, rate.shape))
    for side, bound, stop in mechanics.stops:
        total = total - side * stop_force(stop, side * (at - bound), side * rate)
    return total


def stored_energy(stop: HardStop, depth: ArrayLike) -> Array:
    """Energy in the stop's spring at a depth (...) [J], the integral of ``engagement k depth``."""
    x, w = np.asarray(depth), stop.transition_width
    s = np.clip(x / w, 0.0, 1.0)
    within = w**2 * s**4 * (0.75 - 0.4 * s)
    beyond = 0.5 * (np.maximum(x, w) ** 2 - w**2)
    energy: Array = stop.stiffness * (within + beyond)
    return energy


def limit_energy(mechanics: JointMechanics, q: ArrayLike) -> Array:
    """Energy in the springs of a joint's limits at positions (...) [J]."""
    at = np.asarray(q, dtype=np.float64)
    total: Array = np.zeros(at.shape)
    for side, bound, stop in mechanics.stops:
        total = total + stored_energy(stop, np.maximum(0.0, side * (at - bound)))
    return total
