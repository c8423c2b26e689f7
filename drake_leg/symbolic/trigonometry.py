"""Exact rewriting of sums of products of sines and cosines."""

from __future__ import annotations

import sympy as sp
from sympy.simplify.fu import TR10i


def pythagoras(expression: sp.Expr) -> sp.Expr:
    """Expand a polynomial in sines and cosines with ``sin^2 = 1 - cos^2``: no sine has a power."""

    def is_power_of_sine(part: sp.Expr) -> bool:
        return bool(part.is_Pow and part.base.func is sp.sin and part.exp.is_Integer)

    def without_powers(power: sp.Expr) -> sp.Expr:
        pairs, rest = divmod(int(power.exp), 2)
        return (1 - sp.cos(power.base.args[0]) ** 2) ** pairs * power.base**rest

    return sp.expand(sp.expand(expression).replace(is_power_of_sine, without_powers))


def normal_form(expression: sp.Expr) -> sp.Expr:
    """Write an expression in the sines and cosines of single angles, in one way only.

    Two polynomials in sines and cosines of sums of the same angles are equal exactly where their
    normal forms are the same; an identity has the normal form 0.
    """
    return pythagoras(sp.expand_trig(expression))


def tidy(expression: sp.Expr) -> sp.Expr:
    """Make an expression readable: factors, and sums of angles where they are shorter."""
    expanded = pythagoras(expression)
    return min(sp.factor(TR10i(expanded)), sp.factor(expanded), key=sp.count_ops)
