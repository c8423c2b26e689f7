"""Linear equations that may be too few or too many, solved for as many unknowns as there are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RESIDUE = 1e-11  # of the terms that cancel one another, below which they do so exactly


@dataclass(frozen=True, eq=False, kw_only=True)
class Eliminated:
    """Equations ``M z + N k = 0`` in which each pivot stands alone in its column."""

    M: Array
    N: Array
    combination: Array  # of the equations that were given, in rows
    pivots: dict[int, int]  # column of M -> row, whose entry there is 1
    left: tuple[int, ...]  # rows without a pivot: they say something of k alone

    @property
    def free(self) -> tuple[int, ...]:
        """Return the columns that no equation determines."""
        return tuple(column for column in range(self.M.shape[1]) if column not in self.pivots)


def eliminated(M: Array, N: Array) -> Eliminated:
    """Solve equations by Gauss and Jordan.

    What is left of terms that cancel is told from small numbers by the sizes of those terms.
    """
    rows, columns = M.shape
    A = np.hstack([M, N, np.eye(rows)])
    sizes = np.abs(A)
    pivots: dict[int, int] = {}
    free = np.ones(rows, dtype=bool)
    for column in range(columns):
        scale = np.abs(A[:, :columns]).max(axis=1, initial=0.0)
        share = np.abs(A[:, column]) / np.where(scale > 0.0, scale, 1.0)
        share[~free] = 0.0
        if not share.any():
            continue
        row = int(share.argmax())
        pivots[column] = row
        free[row] = False
        sizes[row] /= abs(A[row, column])
        A[row] /= A[row, column]
        others = np.flatnonzero(A[:, column])
        for other in others[others != row]:
            taken = A[other, column] * A[row]
            A[other] -= taken
            sizes[other] = np.maximum(sizes[other], np.abs(taken))
            A[other][np.abs(A[other]) <= RESIDUE * sizes[other]] = 0.0
            A[other, column] = 0.0
    known = columns + N.shape[1]
    return Eliminated(
        M=A[:, :columns],
        N=A[:, columns:known],
        combination=A[:, known:],
        pivots=pivots,
        left=tuple(np.flatnonzero(free).tolist()),
    )
