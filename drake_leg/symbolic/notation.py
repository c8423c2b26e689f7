"""Rewrites formulas in sines and cosines exactly; writes them in shorthand, as text, as HTML."""

from __future__ import annotations

import re
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter
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


SHORT = re.compile(r"([cs])(\d+)")  # c23 is cos(q2 + q3)
GREEK = {"alpha": "α", "theta": "θ"}


def shorthand(expression: sp.Basic) -> sp.Basic:
    """Write as the reports do: c1 for cos(q1), s23 for sin(q2 + q3); only to be shown."""

    def short(letter: str, function: type[sp.Function], angle: sp.Expr) -> sp.Expr:
        terms = sorted(sp.Add.make_args(angle), key=str)
        if all(term.is_Symbol and term.name.startswith("q") for term in terms):
            return sp.Symbol(letter + "".join(term.name[1:] for term in terms))
        return function(angle)

    return expression.replace(sp.cos, lambda angle: short("c", sp.cos, angle)).replace(
        sp.sin, lambda angle: short("s", sp.sin, angle)
    )


def text(expression: sp.Basic) -> str:
    """Write a formula in one line of text: ``−50·cos(θ1)·σ2``."""
    return str(_Line().doprint(expression))


def html(expression: sp.Basic) -> str:
    """Write a formula as HTML in the reports' shorthand, its indices as subscripts."""
    return str(_Html().doprint(shorthand(expression)))


class _Line(StrPrinter):  # type: ignore[misc] # SymPy has no types
    """Numbers first, then lengths, sines and cosines, then sums; in sums, numbers last.

    A sum that was written without being evaluated keeps its order.
    """

    times, minus = "·", "−"

    def _print_Add(self, expression: sp.Add, order: Any = None) -> str:  # noqa: ANN401
        terms = expression.args
        if expression == expression.func(*terms):
            terms = sorted(terms, key=_place_of_term)
        first, *others = map(self._print, terms)
        for term in others:
            positive = term.removeprefix(self.minus)
            first += f" + {term}" if positive == term else f" {self.minus} {positive}"
        return str(first)

    def _print_Mul(self, expression: sp.Expr) -> str:
        above, below = sp.fraction(expression)
        number, rest = above.as_coeff_Mul()
        factors = [f for f in sp.Mul.make_args(rest) if f != 1]
        shown = [self._factor(factor) for factor in sorted(factors, key=_place)]
        if abs(number) != 1 or not shown:
            shown.insert(0, self._print(abs(number)))
        sign = self.minus if number < 0 else ""
        over = "" if below == 1 else f"/{self._factor(below, ('is_Add', 'is_Mul'))}"
        return f"{sign}{self.times.join(shown)}{over}"

    def _factor(self, factor: sp.Expr, bracketed: tuple[str, ...] = ("is_Add",)) -> str:
        shown = self._print(factor)
        return f"({shown})" if any(getattr(factor, kind) for kind in bracketed) else str(shown)

    def _print_Pow(self, expression: sp.Pow, rational: bool = False) -> str:
        if expression.exp.is_negative:
            return self._print_Mul(expression)
        return f"{self._factor(expression.base)}{self._power(str(expression.exp))}"

    def _power(self, exponent: str) -> str:
        return exponent.translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))

    def _number(self, expression: sp.Number) -> str:
        return f"{float(expression):g}".replace("-", self.minus)

    _print_Float = _print_Integer = _print_Rational = _number  # noqa: N815 - SymPy's names


class _Html(_Line):
    """Products without a sign; letters in italics."""

    times, minus = "&#8201;", "&minus;"

    def _print_Symbol(self, expression: sp.Symbol) -> str:
        name = GREEK.get(expression.name, expression.name)
        letters, digits = re.fullmatch(r"(\D+)(\d*)", name).groups()  # type: ignore[union-attr]
        return f"<i>{letters}</i><sub>{digits}</sub>" if digits else f"<i>{letters}</i>"

    def _print_Function(self, expression: sp.Function) -> str:
        return f"{expression.func.__name__}{self.times}{self._print(expression.args[0])}"

    def _power(self, exponent: str) -> str:
        return f"<sup>{exponent}</sup>"


def _place(factor: sp.Expr) -> tuple[Any, ...]:
    """Rank a factor: lengths, sines and cosines (of sums first), abbreviations, sums."""
    base = factor.base if factor.is_Pow else factor
    if base.is_Function:
        angle = base.args[0]
        return (2 if angle.is_Add else 3, text(angle).replace("alpha", "ω"))  # behind theta
    if base.is_Symbol:
        short = SHORT.fullmatch(base.name)
        if short:
            return (2, short[2], short[1])
        return (4 if base.name.startswith("σ") else 1, base.name)
    return (5, text(base))


def _place_of_term(term: sp.Expr) -> tuple[Any, ...]:
    factors = [factor for factor in sp.Mul.make_args(term) if not factor.is_number]
    return tuple(sorted(map(_place, factors))) or ((9,),)
