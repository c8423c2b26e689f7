"""What is right, derived with SymPy and written in the print's own notation."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

import numpy as np
import sympy as sp
from sympy.printing.str import StrPrinter

from drake_leg.kinematics.batches import Array
from drake_leg.lab.grader.claims import Claim
from drake_leg.lab.grader.definitions import Reader
from drake_leg.lab.grader.lengths import Cell
from drake_leg.lab.grader.printed import Printed
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.chain import SymbolicChain, direct_jacobian, row_transform, symbolic_chain
from drake_leg.symbolic.formulas import DEGREE
from drake_leg.symbolic.spelling import plain, spelled_as
from drake_leg.symbolic.notation import tidy

Names = Mapping[Cell, str]  # cells of the table to the names that the print has for them


class RightForms:
    """Writes right entries for one print."""

    def __init__(self, robot: Robot, printed: Printed, reader: Reader, names: Names) -> None:
        self._chain = symbolic_chain(robot.rows)
        self._metres = printed.metres
        self._symbols = printed.symbols
        self._names = _named_symbols(self._chain, names)
        spelling = " ".join(printed.joints.values())
        self._joints = {
            self._chain.q[index]: _evaluated(formula, spelling)
            for index, formula in reader.joints.items()
        }

    def text(self, claim: Claim, row: int, column: int, spelling: str) -> str:
        """Write the right entry of a row and column, from 0.

        ``spelling`` is all of the matrix's text: angles and lengths are named as there.
        """
        entry = tidy(_matrix(claim, self._chain)[row, column])
        names = " ".join(self._symbols) if claim.kind == "determinant" else spelling
        entry = entry.subs(self._lengths(names)).subs(self._joints)
        text = _Decimals().doprint(entry.replace(_is_decimal, lambda number: sp.Float(number)))
        return spelled_as(spelling, text)

    def _lengths(self, spelling: str) -> dict[sp.Symbol, sp.Expr]:
        """Name the table's lengths as the print does, or write their numbers."""
        spelled = re.sub(r"[_{}\\]", "", spelling.casefold())
        named = any(plain(name) in spelled for name in self._symbols)
        return {
            symbol: sp.Symbol(self._names[symbol], positive=True)
            if named and symbol in self._names
            else self._number(symbol.name, value)
            for symbol, value in self._chain.values.items()
        }

    def _number(self, name: str, value: float) -> sp.Expr:
        if name.startswith(("alpha", "theta")):
            return sp.Float(value)
        number = Fraction(value / self._metres).limit_denominator(10**6)
        return sp.Rational(number.numerator, number.denominator)


def _named_symbols(chain: SymbolicChain, names: Names) -> dict[sp.Symbol, str]:
    """Find a print's names of a chain's symbols, as far as it has any."""
    return {
        symbol: names[Cell(index, column)]
        for index, row in enumerate(chain.rows)
        for column in ("d", "alpha", "r", "theta")
        for symbol in getattr(row, column).free_symbols & set(chain.values)
        if Cell(index, column) in names
    }


class _Decimals(StrPrinter):  # type: ignore[misc] # SymPy has no types
    """Writes 112.4 and not 112.400000000000."""

    def _print_Float(self, expr: sp.Float) -> str:
        return f"{float(expr):.10g}"


def _is_decimal(expression: sp.Basic) -> bool:
    """Whether an expression is a fraction that people write with a point."""
    return bool(expression.is_Rational and expression.q not in (1, 2))


def _matrix(claim: Claim, chain: SymbolicChain) -> sp.Matrix:
    """Derive all entries of a claim, in the chain's symbols."""
    if claim.is_pose:
        pose = _pose(chain, *claim.frames)
        if claim.kind != "position":
            return pose
        return pose[:, 3].T if claim.shape[0] == 1 else pose[:, 3]
    if claim.kind == "jacobian":
        return _jacobian_part(chain, claim.rows, claim.shape[1])
    square = _jacobian_part(chain, claim.rows, len(claim.rows))
    return sp.Matrix([[square.applyfunc(tidy).det()]])


def _jacobian_part(chain: SymbolicChain, rows: Sequence[int], columns: int) -> sp.Matrix:
    return direct_jacobian(chain).extract(list(rows), list(range(columns)))


def _pose(chain: SymbolicChain, first: int, last: int) -> sp.Matrix:
    """Derive the pose of one frame in another, of a later one in an earlier or the inverse."""
    if first > last:
        there = _pose(chain, last, first)
        R, p = there[:3, :3].T, there[:3, 3]
        return sp.Matrix([[R, -R * p], [sp.zeros(1, 3), sp.ones(1, 1)]])
    product = sp.eye(4)
    for row in chain.rows[first:last]:
        product = product * row_transform(row)
    return product


def _evaluated(part: sp.Expr, spelling: str) -> sp.Expr:
    """Evaluate a formula as it was printed, its symbols written as in the print."""
    if part.is_Float:
        return sp.Rational(repr(float(part)))
    if part == DEGREE:
        return sp.pi / 180
    if part.is_Symbol:
        found = re.search(rf"\b{part.name}\b", spelling, re.IGNORECASE)
        return sp.Symbol(found[0] if found else part.name, real=True)
    if part.is_Atom:
        return part
    return part.func(*(_evaluated(argument, spelling) for argument in part.args))


def determinant_factors(
    robot: Robot, rows: Sequence[int], printed: Printed, names: Names, spelling: str
) -> list[tuple[str, Callable[[Mapping[str, Array]], Array]]]:
    """Factor the determinant of some rows, and as many columns, of the Jacobian.

    Every factor that depends on a joint: where it is zero, as text, and its values at named
    variables q1, ... Where a factor is zero, the robot is singular.
    """
    chain = symbolic_chain(robot.rows)
    square = _jacobian_part(chain, rows, len(rows))
    determinant = tidy(square.applyfunc(tidy).det())
    found = [f for f in sp.Mul.make_args(determinant) if f.free_symbols & set(chain.q)]
    found.sort(key=sp.count_ops)
    named = _named_symbols(chain, names)
    lengths = {
        symbol: sp.Symbol(named[symbol])
        if symbol in named
        else sp.Float(f"{value / printed.metres:.9g}")
        for symbol, value in chain.values.items()
    }
    return [(spelled_as(spelling, _zeros_text(f.subs(lengths))), _values(f, chain)) for f in found]


def _zeros_text(factor: sp.Expr) -> str:
    """Say where a factor is zero."""
    text = f"{factor.args[0]} = kπ" if factor.func is sp.sin else f"{factor} = 0"
    return re.sub(r"\d+\.\d+", lambda found: f"{float(found[0]):.9g}", text)


def _values(factor: sp.Expr, chain: SymbolicChain) -> Callable[[Mapping[str, Array]], Array]:
    variables = [f"q{index + 1}" for index in range(len(chain.q))]
    function = sp.lambdify(chain.q, factor.subs(chain.values), "numpy")

    def values(named: Mapping[str, Array]) -> Array:
        zero = np.zeros_like(next(iter(named.values())))
        return np.asarray(function(*(named.get(name, zero) for name in variables)))

    return values
