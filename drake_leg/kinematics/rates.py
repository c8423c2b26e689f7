"""Joint rates and accelerations from what the foot is commanded to do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg.lapack import dgesv

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array

# Smallest pivot of the Jacobian's LU factors, relative to the largest, that is still divided
# by: below it the joint rates have lost half of their digits.
SINGULAR_BELOW = 1e-8


def exact_rates(J: Array, v: Array, q: Sequence[float]) -> Array:
    """Solve ``J @ qdot = v``: the reports' ``inv(J) * v``.

    LAPACK's ``dgesv`` is called by itself: ``numpy.linalg.solve`` wraps it at four times the
    cost for a matrix this small, and hides the pivots.

    Parameters
    ----------
    J : (n, n) ndarray
        Jacobian at ``q``.
    v : (n,) ndarray
        Commanded task velocity, in the units of J's rows per second.
    q : (n,) sequence of float
        Joint positions [rad or m], for the error's text.

    Returns
    -------
    qdot : (n,) ndarray
        Joint rates [rad/s or m/s].

    Raises
    ------
    SingularConfigurationError
        If the smallest pivot is at most ``SINGULAR_BELOW`` times the largest.

    References
    ----------
    Report A, eq. 19.
    """
    lu, _, qdot, _ = dgesv(J, v)
    pivots = [abs(pivot) for pivot in lu.diagonal().tolist()]
    if not min(pivots) > SINGULAR_BELOW * max(pivots):
        raise SingularConfigurationError(q=q, sigma_min=float(smallest_singular_value(J)))
    solution: Array = qdot
    return solution


def smallest_singular_value(J: Array) -> Array:
    """Smallest singular value: how far the Jacobian is from losing rank.

    Parameters
    ----------
    J : (..., m, n) ndarray
        One Jacobian or many.

    Returns
    -------
    (...) ndarray
        In the unit of J.
    """
    return np.linalg.svd(J, compute_uv=False)[..., -1].astype(np.float64, copy=False)
