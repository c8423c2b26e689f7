"""Linear algebra, polynomials and interpolation."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.linalg

from drake_leg.simulink.matlab import numeric
from drake_leg.simulink.matlab.data import (
    Allowance,
    Known,
    LackError,
    numbers_of,
    of_values,
    settled,
)
from drake_leg.simulink.matlab.inputs import axis_of, matrix, of_matrix, scalar, whole
from drake_leg.simulink.matlab.numeric import MatlabError, measure
from drake_leg.simulink.matlab.operators import combined

# ruff: noqa: ANN401 - any value of a script


def _norm(budget: Allowance, wanted: int, value: Any, order: Any = 2.0) -> Any:
    array = matrix(value)
    if not array.size:
        return 0.0
    if order == "fro":
        return float(np.linalg.norm(array))
    kind = math.inf if order in ("inf", "Inf") else scalar(order)
    if 1 in array.shape:
        return float(np.linalg.norm(array.ravel(), kind))
    if kind not in (1.0, 2.0, math.inf):
        raise MatlabError(f"norm of order {kind:g} is not supported: 1, 2, inf or 'fro'")
    if kind == 2.0:
        budget.work(10.0 * array.size * min(array.shape))
        return float(numeric.singular(array, "norm")[1][0])
    return float(np.linalg.norm(array, kind))


def _eig(budget: Allowance, wanted: int, value: Any, other: Any = None) -> Any:
    a = matrix(value)
    numeric.require_square(a, "eig")
    budget.work(25.0 * a.size * len(a))
    if other is None and np.array_equal(a, a.conj().T):
        found, vectors = np.linalg.eigh(a)
    else:
        found, vectors = scipy.linalg.eig(a, None if other is None else matrix(other))
    if wanted < 2:
        return settled(found[:, np.newaxis])
    return settled(vectors), settled(np.diag(found))


def _svd(budget: Allowance, wanted: int, value: Any, *rest: Any) -> Any:
    a = matrix(value)
    budget.work(25.0 * a.size * max(a.shape))
    u, s, v = np.linalg.svd(a, full_matrices=not rest)
    if wanted < 2:
        return settled(s[:, np.newaxis])
    wide = np.zeros((u.shape[1], v.shape[0]))
    np.fill_diagonal(wide, s)
    return settled(u), settled(wide), settled(v.conj().T)


def _qr(budget: Allowance, wanted: int, value: Any, *rest: Any) -> Any:
    a = matrix(value)
    budget.work(5.0 * a.size * max(a.shape))
    q, r = np.linalg.qr(a, mode="reduced" if rest else "complete")
    return (settled(q), settled(r)) if wanted > 1 else settled(r)


def _lu(budget: Allowance, wanted: int, value: Any) -> Any:
    a = matrix(value)
    budget.work(float(a.size) * max(a.shape))
    p, low, up = scipy.linalg.lu(a)
    if wanted < 3:
        return settled(p @ low), settled(up)
    return settled(low), settled(up), settled(p.T)


def _det(array: Any) -> Any:
    numeric.require_square(array, "det")
    return np.linalg.det(array)


def _rank(array: Any) -> float:
    return float(np.linalg.matrix_rank(array))


def _chol(array: Any) -> Any:
    try:
        return np.linalg.cholesky(array).conj().T
    except np.linalg.LinAlgError:
        raise MatlabError("chol needs a positive definite matrix") from None


def _kron(budget: Allowance, wanted: int, left: Any, right: Any) -> Any:
    a, b = matrix(left), matrix(right)
    budget.room(float(a.size) * b.size)
    return settled(np.kron(a, b))


def _blocks(budget: Allowance, wanted: int, *given: Any) -> Any:
    arrays = [matrix(value) for value in given]
    budget.room(
        float(sum(array.shape[0] for array in arrays)) * sum(array.shape[1] for array in arrays)
    )
    return settled(scipy.linalg.block_diag(*arrays))


def _cross(left: Any, right: Any, *axis: Any) -> Any:
    a, b = numbers_of(left), numbers_of(right)
    if a.size == b.size == 3:
        product = np.cross(a.ravel(), b.ravel())
        return product.reshape(a.shape if a.shape == b.shape else (3, 1))
    if a.shape != b.shape or 3 not in a.shape:
        raise MatlabError(f"cross needs vectors of 3, not {measure(a)} and {measure(b)}")
    along = whole(axis[0]) - 1 if axis else a.shape.index(3)
    return settled(np.cross(a, b, axis=along))


def _dot(left: Any, right: Any, *axis: Any) -> Any:
    a, b = numbers_of(left), numbers_of(right)
    if 1 in a.shape and 1 in b.shape and a.size == b.size and not axis:
        return settled(np.asarray(np.vdot(a.ravel(), b.ravel())))
    if a.shape != b.shape:
        raise MatlabError(f"dot of {measure(a)} and {measure(b)} does not match in size")
    along = axis_of(a, axis[0] if axis else None)
    return settled(np.sum(np.conj(a) * b, axis=along, keepdims=True))


def _product(symbol: str) -> Known:
    return lambda budget, wanted, left, right: combined(symbol, left, right, budget)


def _trapz(x: Any, y: Any = None) -> Any:
    b = numbers_of(x if y is None else y)
    places = None if y is None else numbers_of(x).ravel()
    return settled(np.trapezoid(b, places, axis=axis_of(b)))


def _polyfit(budget: Allowance, wanted: int, x: Any, y: Any, degree: Any) -> Any:
    a, b, n = numbers_of(x).ravel(), numbers_of(y).ravel(), whole(degree)
    budget.room(float(a.size) * (n + 1))
    budget.work(5.0 * a.size * (n + 1) ** 2)
    q, r = np.linalg.qr(np.vander(a, n + 1))
    return settled(np.linalg.solve(r, q.T @ b)[np.newaxis, :])


def _polyval(budget: Allowance, wanted: int, p: Any, x: Any) -> Any:
    coefficients, at = numbers_of(p).ravel(), numbers_of(x)
    budget.work(float(coefficients.size) * at.size)
    return settled(np.asarray(np.polyval(coefficients, at)))


def _conv(budget: Allowance, wanted: int, left: Any, right: Any, *shape: Any) -> Any:
    if shape:
        raise LackError(f"conv by {shape[0]!r} is not known here")
    a, b = numbers_of(left), numbers_of(right)
    budget.work(float(a.size) * b.size)
    tall = max((a, b), key=np.size).shape[1] == 1
    return settled(np.convolve(a.ravel(), b.ravel()).reshape((-1, 1) if tall else (1, -1)))


def _roots(budget: Allowance, wanted: int, value: Any) -> Any:
    coefficients = numbers_of(value).ravel()
    budget.work(25.0 * coefficients.size**3)
    return settled(np.roots(coefficients)[:, np.newaxis])


def _row(function: Callable[..., Any]) -> Known:
    def applied(budget: Allowance, wanted: int, value: Any) -> Any:
        array = numbers_of(value)
        budget.work(float(array.size) ** 2)
        return settled(np.atleast_2d(function(array.ravel())))

    return applied


def _running_trapz(x: Any, y: Any = None) -> Any:
    from scipy.integrate import cumulative_trapezoid

    b = numbers_of(x if y is None else y)
    places = None if y is None else numbers_of(x).ravel()
    return settled(cumulative_trapezoid(b, places, axis=axis_of(b), initial=0.0))


def _lyap(budget: Allowance, wanted: int, a: Any, q: Any) -> Any:
    """Solve ``a x + x a' + q = 0``."""
    left, right = matrix(a), matrix(q)
    numeric.require_square(left, "lyap")
    budget.work(50.0 * left.size * len(left))
    return settled(scipy.linalg.solve_continuous_lyapunov(left, -right))


def _schur(budget: Allowance, wanted: int, value: Any, kind: Any = "real") -> Any:
    """``[U, T] = schur(A)``: ``A = U T U'``, T in blocks of one or two rows, or triangular."""
    a = matrix(value)
    numeric.require_square(a, "schur")
    if kind not in ("real", "complex"):
        raise LackError(f"'schur' by {kind!r} is not known here")
    budget.work(25.0 * a.size * len(a))
    t, u = scipy.linalg.schur(a, output=str(kind))
    return settled(t) if wanted < 2 else (settled(u), settled(t))


_HALVES = {"lhp": "lhp", "rhp": "rhp", "udi": "iuc", "udo": "ouc"}  # SciPy's names of them


def _ordered_schur(budget: Allowance, wanted: int, u: Any, t: Any, first: Any) -> Any:
    """``[U, T] = ordschur(U, T, 'lhp')``: eigenvalues of a half plane, or a disk, first."""
    if first not in _HALVES:
        raise LackError("'ordschur' chooses by 'lhp', 'rhp', 'udi' or 'udo' only here")
    left, middle = matrix(u), matrix(t)
    budget.work(30.0 * middle.size * len(middle))
    kind = "complex" if np.iscomplexobj(left @ middle) else "real"
    a = left @ middle @ left.conj().T
    found, vectors, _ = scipy.linalg.schur(a, output=kind, sort=_HALVES[str(first)])
    return settled(vectors), settled(found)


def _hull(budget: Allowance, wanted: int, *given: Any) -> Any:
    """``k = convhull(x, y)``: places of the hull's corners, counterclockwise, and the first."""
    columns = [np.real(numbers_of(each)) for each in given if not isinstance(each, str)]
    if len(columns) == 2:
        columns = [np.column_stack([each.ravel() for each in columns])]
    if len(columns) != 1 or columns[0].ndim != 2 or columns[0].shape[1] != 2:
        raise LackError("'convhull' of points in the plane only is known here")
    (points,) = columns
    budget.step(20 * len(points))
    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    corners = [*_turning_left(points, order)[:-1], *_turning_left(points, order[::-1])[:-1]]
    if len(corners) < 3:
        raise MatlabError("'convhull' needs three points that are not on a line")
    x, y = points[corners].T
    area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0
    return settled(np.array([*corners, corners[0]])[:, np.newaxis] + 1.0), area


def _turning_left(points: Any, order: list[int]) -> list[int]:
    """Keep the points of a way at which it turns left: one half of a hull."""
    found: list[int] = []
    for place in order:
        while len(found) > 1:
            (ax, ay), (bx, by), (cx, cy) = points[[found[-2], found[-1], place]]
            if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0.0:
                break
            found.pop()
        found.append(place)
    return found


def _magic(budget: Allowance, wanted: int, count: Any) -> Any:
    """Square of the numbers from 1 on whose rows, columns and diagonals have one sum."""
    n = max(whole(count), 0)
    budget.room(float(n) ** 2)
    if n % 2:
        rows, columns = np.mgrid[1 : n + 1, 1 : n + 1]
        ahead = np.mod(rows + columns - (n + 3) // 2, n)
        return settled(n * ahead + np.mod(rows + 2 * columns - 2, n) + 1.0)
    if n % 4 == 0:
        found = np.arange(1.0, n * n + 1.0).reshape(n, n)
        half = np.mod(np.arange(1, n + 1), 4) // 2
        return settled(np.where(half[:, np.newaxis] == half, n * n + 1.0 - found, found))
    if n == 2:
        return np.array([[1.0, 3.0], [4.0, 2.0]])
    m = n // 2
    odd = numbers_of(_magic(budget, 1, float(m)))
    found = np.block([[odd, odd + 2 * m * m], [odd + 3 * m * m, odd + m * m]])
    k = (n - 2) // 4
    swapped = [*range(k), *range(n - k + 1, n)]
    upper, lower = found[:m].copy(), found[m:].copy()
    found[:m, swapped], found[m:, swapped] = lower[:, swapped], upper[:, swapped]
    middle = [0, k]
    found[k, middle], found[k + m, middle] = found[k + m, middle], found[k, middle]
    return settled(found)


ALGEBRA: dict[str, Known] = {
    "norm": _norm,
    "inv": of_matrix(numeric.inverse),
    "pinv": of_matrix(numeric.pseudoinverse, 25.0),
    "det": of_matrix(_det),
    "trace": of_matrix(np.trace, 0.0),
    "rank": of_matrix(_rank, 10.0),
    "null": of_matrix(scipy.linalg.null_space, 25.0),
    "orth": of_matrix(scipy.linalg.orth, 25.0),
    "cond": of_matrix(np.linalg.cond, 10.0),
    "chol": of_matrix(_chol),
    "expm": of_matrix(scipy.linalg.expm, 20.0),
    "logm": of_matrix(scipy.linalg.logm, 100.0),
    "sqrtm": of_matrix(scipy.linalg.sqrtm, 50.0),
    "triu": of_matrix(np.triu, 0.0),
    "tril": of_matrix(np.tril, 0.0),
    "transpose": of_matrix(np.transpose, 0.0),
    "ctranspose": of_matrix(lambda array: np.conj(array.T), 0.0),
    "eig": _eig,
    "svd": _svd,
    "qr": _qr,
    "lu": _lu,
    "kron": _kron,
    "blkdiag": _blocks,
    "cross": of_values(_cross),
    "dot": of_values(_dot),
    "mtimes": _product("*"),
    "mrdivide": _product("/"),
    "mldivide": _product("\\"),
    "linsolve": _product("\\"),
    "mpower": _product("^"),
    "trapz": of_values(_trapz),
    "cumtrapz": of_values(_running_trapz),
    "lyap": _lyap,
    "schur": _schur,
    "ordschur": _ordered_schur,
    "convhull": _hull,
    "magic": _magic,
    "polyfit": _polyfit,
    "polyval": _polyval,
    "polyder": _row(np.polyder),
    "polyint": _row(np.polyint),
    "poly": _row(np.poly),
    "conv": _conv,
    "roots": _roots,
}
