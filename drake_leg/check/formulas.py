"""The right form of a printed entry, derived with SymPy and written in the print's own notation."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from fractions import Fraction

import sympy as sp
from sympy.printing.str import StrPrinter

from drake_leg.check.bindings import Cell
from drake_leg.check.claims import Claim
from drake_leg.check.expressions import OPERATORS, SIGNS
from drake_leg.check.notation import plain, spelled_as
from drake_leg.check.printed_file import METRES, Printed
from drake_leg.check.reader import Reader
from drake_leg.errors import InvalidValueError
from drake_leg.robot import Robot
from drake_leg.symbolic.chain import (
    SymbolicChain,
    direct_jacobian,
    row_transform,
    symbolic_chain,
)
from drake_leg.symbolic.trigonometry import tidy


class RightForms:
    """Writes right entries for one print.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    printed : Printed
        Whose names of lengths and angles are used.
    names : mapping
        Cells of the table to the names that the print has for them.
    """

    def __init__(
        self, robot: Robot, printed: Printed, reader: Reader, names: Mapping[Cell, str]
    ) -> None:
        self._chain = symbolic_chain(robot.rows)
        self._metres = METRES[printed.lengths or "m"]
        self._symbols = printed.symbols
        self._names = named_symbols(self._chain, names)
        spelling = " ".join(printed.joints.values())
        self._joints = {
            self._chain.q[index]: _as_sympy(tree, spelling) for index, tree in reader.joints.items()
        }

    def text(self, claim: Claim, row: int, column: int, spelling: str) -> str:
        """Write the right entry.

        Parameters
        ----------
        claim : Claim
            What the matrix is.
        row, column : int
            Of the entry, from 0.
        spelling : str
            All of the matrix's text: angles and lengths are named as there.
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


def named_symbols(chain: SymbolicChain, names: Mapping[Cell, str]) -> dict[sp.Symbol, str]:
    """Find a print's names of a chain's symbols.

    Parameters
    ----------
    names : mapping
        Cells of the table to the names that the print has for them.

    Returns
    -------
    dict
        Without symbols that have no name there.
    """
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
    if claim.kind in ("transform", "rotation", "position"):
        pose = _pose(chain, *claim.frames)
        if claim.kind != "position":
            return pose
        return pose[:, 3].T if claim.shape[0] == 1 else pose[:, 3]
    Jv_BF = direct_jacobian(chain).extract(list(claim.rows), list(range(claim.shape[1])))
    if claim.kind == "jacobian":
        return Jv_BF
    square = direct_jacobian(chain).extract(list(claim.rows), list(range(len(claim.rows))))
    return sp.Matrix([[square.applyfunc(tidy).det()]])


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


def _as_sympy(node: ast.expr, spelling: str) -> sp.Expr:
    """Turn a formula into an expression whose symbols are written as in the print."""
    match node:
        case ast.Constant(value=value):
            return sp.Rational(str(value))
        case ast.Name(id="pi"):
            return sp.pi
        case ast.Name(id="deg"):
            return sp.pi / 180
        case ast.Name(id=name):
            written = re.search(rf"\b{name}\b", spelling, re.IGNORECASE)
            return sp.Symbol(written[0] if written else name, real=True)
        case ast.UnaryOp(op=sign, operand=operand):
            return SIGNS[type(sign)](_as_sympy(operand, spelling))
        case ast.BinOp(left=left, op=sign, right=right):
            return OPERATORS[type(sign)](_as_sympy(left, spelling), _as_sympy(right, spelling))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            return getattr(sp, name)(_as_sympy(argument, spelling))
    raise InvalidValueError(f"{ast.dump(node)} is no formula")
