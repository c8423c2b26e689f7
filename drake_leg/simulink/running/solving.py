"""The unknowns of algebraic loops, found while a model runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError

Array = NDArray[np.float64]
Residual = Callable[[Array], Array]
Root = tuple[Array, Array | None]

STEPS = 60  # at most, of Newton's method
HALVINGS = 30  # of one of them
CLOSE = 1e-13  # of the largest unknown: the last step
SMALL = 1e-3  # size below which unknowns are taken as so large
ROUNDED = 1e-9  # of the unknowns: a step that is no longer, but does not help, is rounding
FAST = 0.01  # quotient of residuals up to which the Jacobian is kept
DIFFERENCE = math.sqrt(np.finfo(float).eps)


class UnsolvedLoopError(InvalidValueError):
    """An algebraic loop has no solution near the last one."""

    def __init__(self, about: str) -> None:
        super().__init__(f"Newton's method finds no solution of {about}")


def solved(residual: Residual, last: Root, about: str) -> Root:
    """Find a zero of a residual by Newton's method from the last one.

    Parameters
    ----------
    residual : callable
        Of the unknowns; as many numbers.
    last : tuple
        The last zero, and the inverse of the Jacobian there, None where it is not known.
    about : str
        The loop, for the error.

    Returns
    -------
    tuple
        The zero, and the inverse of a Jacobian near it, as in ``last``.

    Raises
    ------
    UnsolvedLoopError
        If the method does not converge.
    """
    z, inverse = last
    f = _attempted(residual, z)
    for _ in range(STEPS):
        if not f.any():
            break
        is_fresh = inverse is None
        if inverse is None:
            inverse = _inverse(residual, z, f)
        step: Array = inverse @ f
        if not math.isfinite(step.sum()):
            raise UnsolvedLoopError(about)
        length, size = np.abs(step).max(), np.abs(z).max()
        if length <= CLOSE * max(size, SMALL):
            z = z - step
            break
        share, after = _shortened(residual, z, step, f, HALVINGS if is_fresh else 0)
        if share:
            z, shrunk = z - share * step, np.abs(after).max() / np.abs(f).max()
            f = after
            if shrunk > FAST or share < 1.0:
                inverse = None
        elif not is_fresh:
            inverse = None
        elif length <= ROUNDED * max(size, 1.0):
            break
        else:
            raise UnsolvedLoopError(about)
    else:
        raise UnsolvedLoopError(about)
    return z, inverse


def _shortened(
    residual: Residual, z: Array, step: Array, f: Array, halvings: int
) -> tuple[float, Array]:
    """Return the share of a step that makes the residual smaller, 0 if none does."""
    share, size = 1.0, np.abs(f).max()
    for _ in range(halvings + 1):
        after = _attempted(residual, z - share * step)
        if np.abs(after).max() < size:
            return share, after
        share *= 0.5
    return 0.0, f


def _attempted(residual: Residual, z: Array) -> Array:
    """Compute a residual; it is no number where a block cannot compute."""
    found = np.full(z.size, math.nan)
    with suppress(ArithmeticError, ValueError):
        found = residual(z)
    return found


def _inverse(residual: Residual, z: Array, f: Array) -> Array:
    """Invert the Jacobian; what has none is no number."""
    jacobian = np.empty((z.size, z.size))
    for k in range(z.size):
        moved = z.copy()
        moved[k] += DIFFERENCE * max(1.0, abs(z[k]))
        jacobian[:, k] = (_attempted(residual, moved) - f) / (moved[k] - z[k])
    found: Array = np.full_like(jacobian, math.nan)
    with suppress(np.linalg.LinAlgError):
        found[:] = np.linalg.inv(jacobian)
    return found
