"""Formulas as written: SymPy expressions that are not evaluated, sorted or simplified.

``l2*c2 - 0`` stays a difference of a product and a zero. A difference is a sum with ``-1*x``, a
quotient a product with ``x**-1``, and ``deg`` and ``rad`` are symbols with a fixed value. A *path*
says where a part is: the indices of SymPy's arguments from the outside in.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError

Path = tuple[int, ...]
Parts = tuple[tuple[Path, sp.Expr], ...]
Change = Callable[[sp.Expr], sp.Expr | None]  # of a part; None leaves it as it is

DEGREE = sp.Symbol("deg")
UNITS = {"deg": math.pi / 180.0, "rad": 1.0}
MOST_PARTS = 5000  # of a formula with its definitions
DEEPEST = 200  # parts within parts
FUNCTIONS: dict[Any, Callable[[Any], Any]] = {sp.cos: np.cos, sp.sin: np.sin, sp.tan: np.tan}
_MINUS = sp.S.NegativeOne


def total(one: sp.Expr, other: sp.Expr) -> sp.Expr:
    """Write ``one + other``."""
    return sp.Add(one, other, evaluate=False)


def negative(one: sp.Expr) -> sp.Expr:
    """Write ``-one``."""
    return sp.Mul(_MINUS, one, evaluate=False)


def product(one: sp.Expr, other: sp.Expr) -> sp.Expr:
    """Write ``one * other``."""
    return sp.Mul(one, other, evaluate=False)


def quotient(one: sp.Expr, other: sp.Expr) -> sp.Expr:
    """Write ``one / other``."""
    return sp.Mul(one, sp.Pow(other, _MINUS, evaluate=False), evaluate=False)


def number(value: float) -> sp.Expr:
    """Write a number; a whole number becomes an integer, which is exact."""
    value = float(f"{value:.10g}")
    return sp.Integer(int(value)) if value.is_integer() else sp.Float(value)


def is_negative(part: sp.Expr) -> bool:
    """Whether a part is ``-x``."""
    return bool(part.is_Mul and part.args[0] is _MINUS)


def is_quotient(part: sp.Expr) -> bool:
    """Whether a part is ``x / y``."""
    return bool(part.is_Mul and part.args[1].is_Pow and part.args[1].args[1] is _MINUS)


def number_of(part: sp.Expr) -> float | None:
    """Return the number that a part is, if it is one."""
    return float(part) if part.is_Integer or part.is_Float else None


def names_in(formula: sp.Expr) -> set[str]:
    """Collect the symbols of a formula, without units."""
    return {symbol.name for symbol in formula.free_symbols} - set(UNITS)


@lru_cache(maxsize=10_000)
def inside(part: sp.Expr) -> Parts:
    """List the operands of a part as people read them, without exponents and the -1 of signs."""
    if is_negative(part):
        return (((1,), part.args[1]),)
    if is_quotient(part):
        return ((0,), part.args[0]), ((1, 0), part.args[1].args[0])
    if part.is_Pow:
        return (((0,), part.args[0]),)
    return tuple(((index,), argument) for index, argument in enumerate(part.args))


@lru_cache(maxsize=1000)
def parts(formula: sp.Expr, *, of_functions: bool = True) -> Parts:
    """List a formula and all formulas in it, the outer ones first, with their paths.

    Parameters
    ----------
    of_functions : bool
        Whether the arguments of sines and cosines count.
    """
    found: list[tuple[Path, sp.Expr]] = [((), formula)]
    for path, part in found:
        if of_functions or not part.is_Function:
            found += [((*path, *below), child) for below, child in inside(part)]
    return tuple(found)


def distinct(formulas: Iterable[sp.Expr]) -> Iterator[sp.Expr]:
    """Drop formulas that are written the same as an earlier one."""
    yield from dict.fromkeys(formulas)


def replace_at(formula: sp.Expr, path: Path, new: sp.Expr) -> sp.Expr:
    """Replace the part at a path."""
    if not path:
        return new
    arguments = list(formula.args)
    arguments[path[0]] = replace_at(arguments[path[0]], path[1:], new)
    return formula.func(*arguments, evaluate=False)


def changed(formula: sp.Expr, change: Change) -> sp.Expr:
    """Replace every part for which ``change`` returns another, from the outside in."""
    new = change(formula)
    if new is not None:
        return new
    result = formula
    for path, part in inside(formula):
        other = changed(part, change)
        if other is not part:
            result = replace_at(result, path, other)
    return result


def replace_alike(formula: sp.Expr, old: sp.Expr, new: sp.Expr) -> sp.Expr:
    """Replace every part that is written like the old one."""
    return changed(formula, lambda part: new if part == old else None)


def substitute(formula: sp.Expr, definitions: Mapping[str, sp.Expr]) -> sp.Expr:
    """Replace names by their definitions, also within these definitions.

    Refuses a name that is defined by itself, and a formula that becomes too long.
    """
    count = 0

    def put_in(part: sp.Expr, above: tuple[str, ...], depth: int) -> sp.Expr:
        nonlocal count
        count += 1
        if count > MOST_PARTS or depth > 2 * DEEPEST:
            raise InvalidValueError(
                f"{' in '.join(above) or 'a formula'} becomes too long with its definitions; "
                "write fewer in one another"
            )
        if part.is_Symbol:
            if part.name in above:
                raise InvalidValueError(f"{part.name} is defined by itself; give it a formula")
            if part.name in definitions:
                return put_in(definitions[part.name], (*above, part.name), depth + 1)
            return part
        result = part
        for path, child in inside(part):
            other = put_in(child, above, depth + 1)
            if other is not child:
                result = replace_at(result, path, other)
        return result

    return put_in(formula, (), 0)


class Evaluator:
    """Evaluates formulas with the same numbers, and every part that they share only once.

    Parameters
    ----------
    values : mapping
        Symbol to number or array; angles in rad.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = {**UNITS, **values}
        self._known: dict[sp.Expr, Any] = {}

    def __call__(self, formula: sp.Expr) -> Any:  # noqa: ANN401 - as the values
        """Evaluate a formula, not finite where it has no value; refuse a symbol without one."""
        with np.errstate(all="ignore"):
            return self._value(formula)

    def _value(self, part: sp.Expr) -> Any:  # noqa: ANN401
        if part not in self._known:
            self._known[part] = self._evaluate(part)
        return self._known[part]

    def _evaluate(self, part: sp.Expr) -> Any:  # noqa: ANN401
        if part.is_Symbol:
            if part.name not in self._values:
                raise InvalidValueError(f"{part.name} has no value")
            return self._values[part.name]
        if part.is_Atom:
            return np.float64(float(part))
        if part.is_Pow:
            base, exponent = self._value(part.args[0]), part.args[1]
            return np.sqrt(base) if exponent is sp.S.Half else base ** np.float64(float(exponent))
        values = [self._value(child) for _, child in inside(part)]
        if part.is_Add:
            return values[0] + values[1]
        if is_negative(part):
            return -values[0]
        if part.is_Mul:
            return values[0] / values[1] if is_quotient(part) else values[0] * values[1]
        return FUNCTIONS[part.func](values[0])


def evaluate(formula: sp.Expr, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - as the values
    """Evaluate one formula, as ``Evaluator`` does."""
    return Evaluator(values)(formula)


def written(formula: sp.Expr) -> str:
    """Write a formula as text: ``-l2 * sin(q2 + q3)``."""
    return _written(formula)[0]


def _written(part: sp.Expr) -> tuple[str, int]:
    """Write a part, and return its precedence: 1 a sum, 2 a product, 3 a sign, ..."""
    if part.is_Integer or part.is_Symbol or part is sp.pi:
        return str(part), 5
    if part.is_Float:
        return repr(float(part)), 5
    children = [child for _, child in inside(part)]
    if part.is_Add:
        left, right = children
        if is_negative(right):
            return f"{_bound(left, 1)} - {_bound(right.args[1], 2)}", 1
        return f"{_bound(left, 1)} + {_bound(right, 2)}", 1
    if is_negative(part):
        return f"-{_bound(children[0], 3)}", 3
    if part.is_Mul:
        sign = "/" if is_quotient(part) else "*"
        return f"{_bound(children[0], 2)} {sign} {_bound(children[1], 3)}", 2
    if part.is_Pow and part.args[1] is not sp.S.Half:
        return f"{_bound(children[0], 5)}^{_exponent(part.args[1])}", 4
    name = "sqrt" if part.is_Pow else part.func.__name__
    return f"{name}({written(children[0])})", 5


def _bound(part: sp.Expr, least: int) -> str:
    """Write a part, in brackets if its precedence is lower than that of what is around it."""
    text, strength = _written(part)
    return text if strength >= least else f"({text})"


def _exponent(exponent: sp.Expr) -> str:
    text = str(exponent) if exponent.is_Integer else f"{float(exponent):g}"
    return text if exponent.is_nonnegative else f"({text})"
