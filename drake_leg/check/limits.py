"""Limits of a formula's size: what is beyond them no person prints, and no machine should try."""

from __future__ import annotations

import ast

from drake_leg.check.formula_trees import inside
from drake_leg.check.notation import quoted
from drake_leg.errors import InvalidValueError

DEEPEST = 200  # levels of a formula's tree
MOST_NODES = 5000  # of a formula with its definitions
GREATEST_DEGREE = 100  # of powers of powers


def require_small(tree: ast.expr, text: str) -> None:
    """Refuse a formula that is too deep or too long to walk through.

    Raises
    ------
    InvalidValueError
        With the text.
    """
    nodes, level = 0, [tree]
    for _ in range(DEEPEST):
        nodes += len(level)
        level = [child for node in level for child in inside(node)]
        if not level and nodes <= MOST_NODES:
            break
    else:
        raise InvalidValueError(
            f"{quoted(text)} has too many terms to be read; write parts of it under [where]"
        )
    if _degree(tree) > GREATEST_DEGREE:
        raise InvalidValueError(
            f"{quoted(text)} has powers of together more than {GREATEST_DEGREE}; write lower ones"
        )


def _degree(tree: ast.expr) -> float:
    """How often a formula multiplies what stands in it at most."""
    match tree:
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _degree(base) * max(1.0, abs(fraction_of(exponent) or 1.0))
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div(), right=right):
            return _degree(left) + _degree(right)
        case ast.BinOp(left=left, right=right):
            return max(_degree(left), _degree(right))
        case ast.UnaryOp(operand=inner) | ast.Call(args=[inner]):
            return _degree(inner)
    return 1.0


def fraction_of(tree: ast.expr) -> float | None:
    """Evaluate a number, a sign, or a fraction of numbers."""
    match tree:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            inner = fraction_of(operand)
            return None if inner is None else -inner
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            above, below = fraction_of(left), fraction_of(right)
            return above / below if above is not None and below else None
    return None
