"""Rotations between their descriptions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array, assemble, finite_vectors


def rotation_matrices(quaternions: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions w, x, y, z (..., 4); q and -q have one.

    Raises
    ------
    InvalidValueError
        If the last axis is not 4 long, or a value is not finite.
    """
    w, x, y, z = np.moveaxis(finite_vectors("the quaternion", quaternions, 4), -1, 0)
    return assemble(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    )
