"""Quadratic programs: the least value of a convex quadratic function where constraints hold."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.optimize import nnls

from drake_leg.simulink.matlab.data import Allowance, Known, LackError, Struct, settled
from drake_leg.simulink.matlab.inputs import matrix
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script

Array = NDArray[np.float64]
ROUNDING = 1e-9  # of the largest number
NOTHING = 1e-12  # of a row, which no x that meets the equations changes
_MOST_ARGUMENTS = 10  # H, f, A, b, Aeq, beq, lb, ub, x0, options


def least_quadratic(
    H: Array,
    f: Array,
    at_most: tuple[Array, Array] | None = None,
    equal: tuple[Array, Array] | None = None,
) -> Array:
    """Find the x (n,) of the least ``x' H x / 2 + f' x`` where ``A x <= b`` and ``C x = d``.

    Where only the equations hold, H must be positive definite; so the minimum is unique.

    Raises
    ------
    MatlabError
        If nothing meets the constraints, or the minimum is not unique.

    References
    ----------
    Lawson, Hanson, Solving Least Squares Problems, chapter 23: least distance by non-negative
    least squares.
    """
    n = len(f)
    x: Array = np.zeros(n)
    free: Array = np.eye(n)
    if equal is not None and len(equal[1]):
        x = np.asarray(np.linalg.lstsq(equal[0], equal[1], rcond=None)[0], dtype=np.float64)
        if _is_off(equal[0] @ x - equal[1], equal[1]):
            raise MatlabError("'quadprog': nothing meets the equations")
        free = np.asarray(scipy.linalg.null_space(equal[0]), dtype=np.float64)
    if not free.shape[1]:
        _require_kept(at_most, x)
        return x
    try:
        L = np.linalg.cholesky(free.T @ H @ free)
    except np.linalg.LinAlgError:
        raise MatlabError(
            "'quadprog': its matrix is not positive definite, so that there is no one minimum"
        ) from None
    to_x = free @ scipy.linalg.solve_triangular(L, np.eye(len(L)), trans=1, lower=True)
    center: Array = x - to_x @ (to_x.T @ (H @ x + f))  # the minimum without the inequalities
    if at_most is None or not len(at_most[1]):
        return center
    A, b = at_most
    G, h = -A @ to_x, A @ center - b
    sizes = np.linalg.norm(A, axis=1) * np.linalg.norm(to_x)
    is_fixed = np.linalg.norm(G, axis=1) <= NOTHING * sizes
    if np.any((h > ROUNDING * (np.abs(A) @ np.abs(center) + np.abs(b)))[is_fixed]):
        raise MatlabError("'quadprog': nothing meets the constraints")
    found: Array = center + to_x @ _shortest(G[~is_fixed], h[~is_fixed])
    return found


def _shortest(G: Array, h: Array) -> Array:
    """Find the shortest y where ``G y >= h``; no row of G is 0."""
    norms = np.linalg.norm(G, axis=1)
    least = float(np.max(h / norms, initial=0.0))  # y is no shorter: a unit of its size
    if not least:
        return np.zeros(G.shape[1])
    h = h / least
    scale = np.maximum(norms, np.abs(h))
    G, h = G / scale[:, np.newaxis], h / scale
    goal = np.append(np.zeros(G.shape[1]), 1.0)
    stacked = np.vstack([G.T, h])
    try:
        weights, _ = nnls(stacked, goal, maxiter=30 * len(h) + 30)
    except RuntimeError:
        raise MatlabError("'quadprog': its steps do not end: scale the constraints") from None
    rest = stacked @ weights - goal
    if rest @ rest < ROUNDING**2:
        raise MatlabError("'quadprog': nothing meets the constraints")
    y: Array = -rest[:-1] / rest[-1]
    active = weights > 0.0
    exact: Array = np.linalg.lstsq(G[active], h[active], rcond=None)[0]
    is_better = np.max(h - G @ exact) <= max(np.max(h - G @ y), ROUNDING)
    return least * (exact if is_better else y)


def _require_kept(at_most: tuple[Array, Array] | None, x: Array) -> None:
    if at_most is not None and _is_off(np.maximum(at_most[0] @ x - at_most[1], 0.0), at_most[1]):
        raise MatlabError("'quadprog': nothing meets the constraints")


def _is_off(rest: Array, of: Array) -> bool:
    return bool(np.linalg.norm(rest) > ROUNDING * max(1.0, float(np.linalg.norm(of))))


# --- MATLAB's functions --------------------------------------------------------------------------


def _quadprog(budget: Allowance, wanted: int, *given: Any) -> Any:
    """``[x, fval, exitflag] = quadprog(H, f, A, b, Aeq, beq, lb, ub, x0, options)``.

    The minimum is unique and exact, whatever the start and the options are. The fourth and the
    fifth value, on the solver and its multipliers, are empty structures.
    """
    if not 2 <= len(given) <= _MOST_ARGUMENTS:
        raise MatlabError(f"'quadprog' does not take {len(given)} arguments")
    H, f, A, b, C, d, low, high = ([*map(_real, given[:8])] + [None] * 6)[:8]
    if H is None:
        raise LackError("'quadprog' without its matrix is a linear program, which is not solved")
    n = len(H)
    budget.work(10.0 * n**3)
    linear = np.zeros(n) if f is None else f.ravel()
    if H.shape != (n, n) or linear.size != n:
        raise MatlabError(f"'quadprog': {n} rows of its matrix do not fit {linear.size} numbers")
    H = (H + H.T) / 2.0
    bounds = [_rows(A, b, n), _bound(low, n, -1.0), _bound(high, n, 1.0)]
    rows = [each for each in bounds if each is not None]
    at_most = None
    if rows:
        at_most = np.vstack([each[0] for each in rows]), np.concatenate([each[1] for each in rows])
        budget.work(10.0 * len(at_most[1]) * n**2)
    x = least_quadratic(H, linear, at_most, _rows(C, d, n))
    least = float(x @ H @ x / 2.0 + linear @ x)
    return settled(x[:, np.newaxis]), least, 1.0, Struct(), Struct()


def _real(value: Any) -> Array | None:
    """Take an argument for real numbers; None where it is empty."""
    found = matrix(value)
    if np.iscomplexobj(found):
        raise MatlabError("'quadprog' does not take complex numbers")
    return np.asarray(found, dtype=float) if found.size else None


def _rows(A: Array | None, b: Array | None, n: int) -> tuple[Array, Array] | None:
    if A is None or b is None:
        return None
    if A.shape != (b.size, n):
        raise MatlabError(f"'quadprog': {len(A)} rows of {A.shape[1]} do not fit {b.size} and {n}")
    finite = np.isfinite(b.ravel())
    return A[finite], b.ravel()[finite]


def _bound(bound: Array | None, n: int, sign: float) -> tuple[Array, Array] | None:
    if bound is None:
        return None
    if bound.size > n:
        raise MatlabError(f"'quadprog': {bound.size} bounds do not fit {n} numbers")
    values = np.append(sign * bound.ravel(), np.full(n - bound.size, math.inf))
    return _rows(sign * np.eye(n), values, n)


def _options(budget: Allowance, wanted: int, solver: Any, *pairs: Any) -> Any:
    """``optimoptions('quadprog', name, value, ...)``; those of `quadprog` change no minimum."""
    if solver not in ("quadprog", "fsolve") or len(pairs) % 2:
        raise LackError(f"options of {solver if isinstance(solver, str) else 'this'} are not known")
    return Struct(zip(map(str, pairs[::2]), pairs[1::2], strict=True))


QUADRATIC: dict[str, Known] = {"optimoptions": _options, "quadprog": _quadprog}
