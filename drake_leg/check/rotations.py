"""Why a printed rotation is none."""

from __future__ import annotations

import numpy as np

from drake_leg.kinematics.batches import Array


def rotation_fault(R: Array, tolerance: float) -> str | None:
    """Say why matrices are no rotations.

    Parameters
    ----------
    R : (N, 3, 3) ndarray
        One matrix at N postures [-].
    tolerance : float
        How far a product of two columns may be from 0 or 1.

    Returns
    -------
    str or None
        The columns that are not of length 1 or not at right angles, or the handedness; None for
        rotations.
    """
    off = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max(axis=0) > tolerance
    lengths = [i for i in range(3) if off[i, i]]
    pairs = [(i, j) for i in range(3) for j in range(i + 1, 3) if off[i, j]]
    faults = []
    if lengths:
        faults.append(f"{_columns(lengths)} not of length 1")
    faults += [f"{_columns(pair)} not at right angles" for pair in pairs]
    if not faults and np.any(np.linalg.det(R) < 0.0):
        faults.append("its determinant is -1, a mirror's")
    return ", ".join(faults) or None


def _columns(indices: list[int] | tuple[int, int]) -> str:
    numbers = " and ".join(str(index + 1) for index in indices)
    return f"column {numbers} is" if len(indices) == 1 else f"columns {numbers} are"
