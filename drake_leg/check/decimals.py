"""Numbers rounded in print: 1.5708 stands for π/2, and 0.7071 for the square root of a half."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal

import numpy as np

from drake_leg.check.formula_trees import changed, parts
from drake_leg.kinematics.batches import Array

FEWEST = 3  # digits; 0.5 and 1.2 are meant as they stand
_MOST = 20  # rounded numbers in one entry
_NEXT = 1e-3  # of half a unit: so near its next number, nobody cuts a number off
_ALIKE = 1e-3  # of the largest: what numbers change counts as one and the same below that


def agrees_within_digits(
    tree: ast.expr, right: Array, margin: float, values_of: Callable[[ast.expr], Array]
) -> bool:
    """Whether a formula is right, its decimals being rounded or cut off after their last digit.

    Parameters
    ----------
    right : (N,) ndarray
        What is right at N postures.
    margin : float
        How far from it counts as equal whatever the digits.
    values_of : callable
        Evaluates a formula at the postures.

    Returns
    -------
    bool
        False for a formula without decimals.
    """
    halves = {id(number): half for number, half in _decimals(tree)}
    if not 0 < len(halves) <= _MOST:
        return False
    rounded = right - values_of(tree)
    cut = right - values_of(_moved(tree, halves))
    moved = [right - values_of(_moved(tree, {number: half})) for number, half in halves.items()]
    slopes = rounded[:, np.newaxis] - np.stack(moved, axis=-1)
    return _explain(slopes, rounded, margin, margin) or _explain(
        slopes * (1.0 - _NEXT), cut, margin, _NEXT * margin
    )


def _explain(slopes: Array, differences: Array, margin: float, below: float) -> bool:
    """Whether every number, moved by its half unit at most, can bring about the differences.

    Parameters
    ----------
    slopes : (N, n) ndarray
        What half a unit of each of n numbers changes at N postures.
    differences : (N,) ndarray
        What is right, less what is printed.
    margin : float
        How much else they may be, towards smaller numbers.
    below : float
        The same towards greater ones.
    """
    spread = np.abs(slopes).sum(axis=-1)
    if not np.all(np.isfinite(spread)) or not np.all(np.abs(differences) <= spread + margin):
        return False
    if np.linalg.matrix_rank(slopes, tol=_ALIKE * np.linalg.norm(slopes)) < slopes.shape[1]:
        return bool(np.all(np.abs(differences) <= spread + below))
    inverse = np.linalg.pinv(slopes)
    moves, doubt = inverse @ differences, np.abs(inverse).sum(axis=-1)
    return bool(np.all(-1.0 - margin * doubt <= moves) and np.all(moves <= 1.0 + below * doubt))


def _decimals(tree: ast.expr) -> Iterator[tuple[ast.Constant, float]]:
    """List the numbers with digits behind the point, each with half a unit of its last one."""
    for node in parts(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, float):
            _, digits, exponent = Decimal(repr(node.value)).as_tuple()
            if isinstance(exponent, int) and exponent < 0 and len(digits) >= FEWEST:
                yield node, 0.5 * 10.0**exponent


def _moved(tree: ast.expr, changes: Mapping[int, float]) -> ast.expr:
    """Add to some numbers of a formula."""

    def add(node: ast.expr) -> ast.expr | None:
        match node:
            case ast.Constant(value=float() as value) if id(node) in changes:
                return ast.Constant(value=value + changes[id(node)])
        return None

    return changed(tree, add)
