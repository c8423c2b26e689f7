"""Numbers rounded in print: 1.5708 stands for π/2, and 0.7071 for the square root of a half."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal

import numpy as np

from drake_leg.check.formula_trees import parts
from drake_leg.kinematics.batches import Array

FEWEST = 3  # digits; 0.5 and 1.2 are meant as they stand
_MOST = 20  # rounded numbers in one entry


def agrees_within_digits(
    tree: ast.expr, right: Array, margin: float, values_of: Callable[[ast.expr], Array]
) -> bool:
    """Whether a formula is right, its decimals being rounded or cut off after their last digit.

    Parameters
    ----------
    tree : ast.expr
        A formula.
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
    rounded = values_of(tree)
    cut = values_of(_moved(tree, halves))
    spread = np.full(len(right), margin)
    for number, half in halves.items():
        spread += np.abs(values_of(_moved(tree, {number: half})) - rounded)
    return any(bool(np.all(np.abs(values - right) <= spread)) for values in (rounded, cut))


def _decimals(tree: ast.expr) -> Iterator[tuple[ast.Constant, float]]:
    """List the numbers with digits behind the point, each with half a unit of its last one."""
    for node in parts(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, float):
            _, digits, exponent = Decimal(repr(node.value)).as_tuple()
            if isinstance(exponent, int) and exponent < 0 and len(digits) >= FEWEST:
                yield node, 0.5 * 10.0**exponent


def _moved(node: ast.expr, changes: Mapping[int, float]) -> ast.expr:
    """Add to some numbers of a formula."""
    match node:
        case ast.Constant(value=float() as value) if id(node) in changes:
            return ast.Constant(value=value + changes[id(node)])
        case ast.UnaryOp(op=sign, operand=operand):
            return ast.UnaryOp(op=sign, operand=_moved(operand, changes))
        case ast.BinOp(left=left, op=sign, right=right):
            return ast.BinOp(left=_moved(left, changes), op=sign, right=_moved(right, changes))
        case ast.Call(func=function, args=[argument]):
            return ast.Call(func=function, args=[_moved(argument, changes)], keywords=[])
    return node
