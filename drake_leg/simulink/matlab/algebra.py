"""Linear algebra where a singular matrix is no error: it gives infinities, as in MATLAB."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.matlab.arrays import Array, Value, measure, number, whole
from drake_leg.simulink.matlab.limits import EXPONENT, MatlabError


def require_square(matrix: Array, what: str) -> None:
    """Check that a matrix is square.

    Parameters
    ----------
    matrix : (m, n) ndarray
        To check.
    what : str
        What needs it, for the message.

    Raises
    ------
    MatlabError
        If it is not.
    """
    if matrix.shape[0] != matrix.shape[1]:
        raise MatlabError(f"{what} needs a square matrix, not one of {measure(matrix)}")


def inverse(matrix: Array) -> Array:
    """Inverse of a matrix; infinite where it is singular.

    Parameters
    ----------
    matrix : (n, n) ndarray
        Any.

    Returns
    -------
    (n, n) ndarray

    Raises
    ------
    MatlabError
        If it is not square.
    """
    require_square(matrix, "inv")
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.full(matrix.shape, np.inf)


def singular(matrix: Array, what: str) -> tuple[Array, Array, Array]:
    """Decompose a matrix into its singular values and vectors.

    Parameters
    ----------
    matrix : (m, n) ndarray
        Not empty.
    what : str
        What needs it, for the message.

    Returns
    -------
    U : (m, k) ndarray
    sigma : (k,) ndarray
        Falling.
    V_transposed : (k, n) ndarray

    Raises
    ------
    MatlabError
        If the matrix is not finite.
    """
    try:
        if np.isfinite(matrix).all():
            return np.linalg.svd(matrix, full_matrices=False)
    except np.linalg.LinAlgError:
        pass
    raise MatlabError(f"{what} of a matrix needs finite numbers of like sizes")


def pseudoinverse(matrix: Array) -> Array:
    """Moore-Penrose inverse; singular values below MATLAB's tolerance count as zero.

    Parameters
    ----------
    matrix : (m, n) ndarray
        Finite.

    Returns
    -------
    (n, m) ndarray

    Raises
    ------
    MatlabError
        If it is not finite.
    """
    if not matrix.size:
        return np.zeros(matrix.shape[::-1])
    left, sigma, right = singular(matrix, "pinv")
    kept = sigma > max(matrix.shape) * np.spacing(sigma[0])
    inverted: Array = right[kept].T @ (left[:, kept] / sigma[kept]).T
    return inverted


def solve(matrix: Array, wanted: Array) -> Array:
    r"""Solve ``matrix @ x = wanted``, in the least squares where there are more rows.

    Parameters
    ----------
    matrix : (m, n) ndarray
        With m >= n.
    wanted : (m, k) ndarray
        Right sides.

    Returns
    -------
    x : (n, k) ndarray
        Not finite where a square matrix is singular.

    Raises
    ------
    MatlabError
        If the sizes do not fit, or the answer is not unique.
    """
    rows, columns = matrix.shape
    if rows != wanted.shape[0]:
        raise MatlabError(f"a division of {measure(wanted)} by {measure(matrix)} does not fit")
    if rows == columns:
        try:
            return np.linalg.solve(matrix, wanted)
        except np.linalg.LinAlgError:
            return _eliminate(matrix, wanted)
    left, sigma, right = singular(matrix, "a division by")
    if rows < columns or sigma[-1] <= rows * np.spacing(sigma[0]):
        raise MatlabError(f"a division by a {measure(matrix)} matrix has many answers: use pinv")
    least: Array = right.T @ ((left.T @ wanted) / sigma[:, np.newaxis])
    return least


def _eliminate(matrix: Array, wanted: Array) -> Array:
    """Eliminate with row pivots, dividing by zero as IEEE does."""
    n = len(matrix)
    work = np.hstack([matrix, wanted])
    for k in range(n):
        pivot = k + int(np.argmax(np.abs(work[k:, k])))
        work[[k, pivot]] = work[[pivot, k]]
        if work[k, k]:
            work[k + 1 :] -= np.outer(work[k + 1 :, k] / work[k, k], work[k])
    solution = work[:, n:]
    for k in reversed(range(n)):
        solution[k] = (solution[k] - work[k, k + 1 : n] @ solution[k + 1 :]) / work[k, k]
    return solution


def power(left: Value, right: Value) -> Array:
    """Whole power of a square matrix.

    Parameters
    ----------
    right : Value
        The exponent, between -1000 and 1000.

    Returns
    -------
    (n, n) ndarray

    Raises
    ------
    MatlabError
        If it has none.
    """
    base = np.atleast_2d(number(left))
    exponent = whole(right, "the exponent of a matrix")
    require_square(base, "a power (^; for each element, .^)")
    if abs(exponent) > EXPONENT:
        raise MatlabError(f"the exponent {exponent} of a matrix is beyond {EXPONENT}")
    return np.linalg.matrix_power(inverse(base) if exponent < 0 else base, abs(exponent))
