"""How near a Jacobian is to losing rank, and which direction it loses, for any chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_leg.kinematics.batches import Array

RANK_TOLERANCE = 1e-9  # of the greatest singular value


@dataclass(frozen=True, kw_only=True)
class RankReport:
    """What a singular value decomposition says of a Jacobian."""

    rank: int
    full_rank: int  # the rank that it has elsewhere: its smaller dimension
    sigma_min: float  # smallest singular value, in the Jacobian's unit
    manipulability: float  # product of the singular values (Yoshikawa)
    lost_directions: Array  # (full_rank - rank, rows), orthonormal; empty at full rank


def examine(J: Array) -> RankReport:
    """Take a Jacobian apart.

    Parameters
    ----------
    J : (m, n) ndarray
        Its rows in one unit.

    Returns
    -------
    RankReport
        A lost direction is one in which no joint rate moves the foot; its first component that
        is not zero is positive.
    """
    U, sigma, _ = np.linalg.svd(J)
    smaller = len(sigma)
    rank = int((sigma > RANK_TOLERANCE * sigma[0]).sum()) if sigma[0] > 0.0 else 0
    lost = U[:, rank:smaller].T
    cleaned = np.where(np.abs(lost) < 1e-12, 0.0, lost)
    signs = [np.sign(row[np.flatnonzero(row)[0]]) for row in cleaned]
    return RankReport(
        rank=rank,
        full_rank=smaller,
        sigma_min=float(sigma[-1]),
        manipulability=float(np.prod(sigma)),
        lost_directions=cleaned * np.array(signs).reshape(-1, 1) + 0.0,
    )
