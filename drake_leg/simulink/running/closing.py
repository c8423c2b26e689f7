"""Loops through a mechanism: what drives it depends on the forces and accelerations that follow.

Accelerations are affine in forces, so that one step of Newton's method solves such a loop where its
blocks are linear, too.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.running.solving import UnsolvedLoopError

ROUNDS = 20
CLOSE = 1e-10  # of the response, relative to what is larger than 1
SINGULAR = 1e-9  # of the loop's gains
ABOUT = "the loop of what drives the mechanism and the forces or accelerations sensed there"


def closed(response: Callable[[Array], Array], count: int) -> Array:
    """Find sensed values that cause themselves.

    Parameters
    ----------
    response : callable
        What is sensed, (n,), where the given values, (n,), are taken for what is sensed.
    count : int
        n. The search begins at 0.

    Raises
    ------
    UnsolvedLoopError
        If there are none, or any, near where Newton's method goes.
    """
    z = np.zeros(count)
    found = response(z)
    for _ in range(ROUNDS):
        gap = found - z
        if not np.isfinite(gap).all():
            break
        if np.all(np.abs(gap) <= CLOSE * np.maximum(np.abs(found), 1.0)):
            return found
        columns = [response(z + step) - found for step in np.eye(count)]
        gains = np.eye(count) - np.array(columns).T
        if not np.linalg.svd(gains, compute_uv=False)[-1] > SINGULAR:
            break
        z = z + np.linalg.solve(gains, gap)
        found = response(z)
    raise UnsolvedLoopError(ABOUT)
