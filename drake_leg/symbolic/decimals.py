"""Numbers of formulas as people write them: decimals where a fraction is one."""

from __future__ import annotations

import sympy as sp

DIGITS = 15  # of a decimal
LARGEST_DENOMINATOR = 24  # of a fraction that is shown as one


def in_decimals(expression: sp.Expr) -> sp.Expr:
    """Write tenths, hundredths and so on, and fractions with large denominators, as decimals."""
    found = {r: _decimal(r) for r in expression.atoms(sp.Rational) if not _is_short(r)}
    return expression.xreplace(found) if found else expression


def plain_text(expression: sp.Expr) -> str:
    """Write a formula in a line, its numbers as decimals without zeros behind."""
    return str(sp.sstr(in_decimals(expression), full_prec=False))


def latex_text(expression: sp.Expr) -> str:
    """Write a formula in LaTeX, its numbers as decimals without zeros behind."""
    return str(sp.latex(in_decimals(expression), full_prec=False))


def _is_short(number: sp.Rational) -> bool:
    return bool(number.q == 1 or (number.q % 5 != 0 and number.q <= LARGEST_DENOMINATOR))


def _decimal(number: sp.Rational) -> sp.Float:
    return sp.Float(number, DIGITS)
