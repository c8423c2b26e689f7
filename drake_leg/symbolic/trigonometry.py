"""Exact rewriting of sums of products of sines and cosines, and the reports' shorthand."""

from __future__ import annotations

import sympy as sp
from sympy.simplify.fu import TR10i


def pythagoras(expression: sp.Expr) -> sp.Expr:
    """Expand, with ``sin^2 = 1 - cos^2``.

    Parameters
    ----------
    expression : Expr
        A polynomial in sines and cosines.

    Returns
    -------
    Expr
        A sum in which no sine has a power.
    """

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

    Parameters
    ----------
    expression : Expr
        A polynomial in sines and cosines.

    Returns
    -------
    Expr
        A sum in which no sine has a power.
    """
    return pythagoras(sp.expand_trig(expression))


def tidy(expression: sp.Expr) -> sp.Expr:
    """Make an expression readable: factors, and products as sums of angles where that is shorter.

    Parameters
    ----------
    expression : Expr
        A polynomial in sines and cosines.
    """
    expanded = pythagoras(expression)
    return min(sp.factor(TR10i(expanded)), sp.factor(expanded), key=sp.count_ops)


def shorthand(expression: sp.Basic) -> sp.Basic:
    """Write as the reports do: c1 for cos(q1), s23 for sin(q2 + q3).

    Parameters
    ----------
    expression : Basic
        An expression or a matrix.

    Returns
    -------
    Basic
        To be shown; it is no function of the angles any more.
    """

    def short(letter: str, function: type[sp.Function], angle: sp.Expr) -> sp.Expr:
        terms = sorted(sp.Add.make_args(angle), key=str)
        if all(term.is_Symbol and term.name.startswith("q") for term in terms):
            return sp.Symbol(letter + "".join(term.name[1:] for term in terms))
        return function(angle)

    return expression.replace(sp.cos, lambda angle: short("c", sp.cos, angle)).replace(
        sp.sin, lambda angle: short("s", sp.sin, angle)
    )
