"""A SYMORO ``.par`` file as a table in symbols: its letters stay letters, its numbers are exact."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import JointType
from drake_leg.robot.symoro.arithmetic import (
    PI,
    Call,
    Expression,
    Name,
    Number,
    Power,
    Product,
    Sum,
    Value,
)
from drake_leg.robot.symoro.as_robot import letters_of
from drake_leg.robot.symoro.positions import Position, positions
from drake_leg.robot.symoro.reader import ParFile
from drake_leg.robot.symoro.text import AT_JOINT, FORCE, INERTIAL, MOMENT, POSE
from drake_leg.symbolic.table import NO_LINK, LinkParameters, SymbolicRow, SymbolicTable, Three

JOINTS: tuple[JointType, ...] = ("revolute", "prismatic", "fixed")  # by sigma
_FUNCTIONS: dict[str, Callable[..., sp.Expr]] = {
    "sqrt": sp.sqrt,
    "sin": sp.sin,
    "cos": sp.cos,
    "tan": sp.tan,
    "asin": sp.asin,
    "acos": sp.acos,
    "atan": sp.atan,
    "atan2": sp.atan2,
    "abs": sp.Abs,
}


_INFINITE = (sp.zoo, sp.nan, sp.oo, -sp.oo)


def table_of_par(par: ParFile, values: Mapping[str, Expression] | None = None) -> SymbolicTable:
    """Write a file's table and its links' parameters as expressions of its letters.

    The position of joint 3 is ``q3``, however the file calls it, unless that is another letter of
    the file. Inertial parameters that the file does not have
    are ``XX1`` ... ``M1``, its forces, frictions and rotors 0, its gravity ``G3`` along z of frame
    0. ``values`` has numbers for letters that are not to stay.

    Raises
    ------
    InvalidValueError
        With file, line, row and key, where the file makes no table.
    """
    return _Writer(par, values or {}).table()


class _Writer:
    """Writes one file."""

    def __init__(self, par: ParFile, values: Mapping[str, Expression]) -> None:
        self._par, self._values = par, values

    def table(self) -> SymbolicTable:
        par = self._par
        found = positions(par, self._values)
        moving = {position.row: (position, self._symbol(position)) for position in found}
        links = [self._link(row) if row <= par.links else NO_LINK for row in par.rows]
        return SymbolicTable(
            name=par.name,
            rows=tuple(self._row(row, moving.get(row)) for row in par.rows),
            q=tuple(own for _, own in moving.values()),
            links=tuple(links),
            gravity=self._gravity(),
            floating=par.floating,
            base=self._link(0) if par.floating else NO_LINK,
            pose=self._pose(),
            loops=par.loops,
        )

    def _symbol(self, position: Position) -> sp.Symbol:
        name = f"q{position.row}"
        taken = name in letters_of(self._par) and name != position.name
        return symbol(position.name if taken else name)

    def _row(self, row: int, moving: tuple[Position, sp.Symbol] | None) -> SymbolicRow:
        par = self._par
        return SymbolicRow(
            joint=JOINTS[par.sigmas[row - 1]],
            antecedent=par.antecedents[row - 1],
            actuated=par.actuated[row - 1],
            gamma=self._of_row("gamma", row, moving),
            b=self._of_row("b", row, moving),
            alpha=self._of_row("alpha", row, moving),
            d=self._of_row("d", row, moving),
            theta=self._of_row("theta", row, moving),
            r=self._of_row("r", row, moving),
        )

    def _of_row(self, key: str, row: int, moving: tuple[Position, sp.Symbol] | None) -> sp.Expr:
        if moving is not None and moving[0].key == key:
            position, own = moving
            return self._read(key, row, position.offset) + own
        return self._read(key, row, self._par.expression(key, row))

    def _link(self, link: int) -> LinkParameters:
        own = {key: self._entry(key, link, default=key) for key in INERTIAL}
        return LinkParameters(
            **own,
            **{key: self._entry(key, link) for key in AT_JOINT},
            force=self._three(FORCE, link),
            moment=self._three(MOMENT, link),
        )

    def _three(self, keys: tuple[str, ...], link: int) -> Three:
        x, y, z = (self._entry(key, link) for key in keys)
        return x, y, z

    def _entry(self, key: str, index: int, default: str = "") -> sp.Expr:
        if self._par.value(key, index) is None and default:
            return self._read(key, index, Name(f"{default}{index}"))
        return self._read(key, index, self._par.expression(key, index))

    def _gravity(self) -> Three:
        if "G" not in self._par.values:
            return sp.S.Zero, sp.S.Zero, self._read("G", 2, Name("G3"))
        x, y, z = (self._entry("G", component) for component in range(3))
        return x, y, z

    def _pose(self) -> sp.Matrix | None:
        if POSE not in self._par.values:
            return None
        pose = sp.Matrix(4, 4, [self._entry(POSE, index) for index in range(16)])
        return None if pose == sp.eye(4) else pose

    def _read(self, key: str, index: int, expression: Expression) -> sp.Expr:
        try:
            found = sympy_of(expression, self._values)
        except InvalidValueError as error:
            raise self._par.error(key, index, error) from None
        if found.has(sp.I) or (found.is_number and found.is_real is False):
            raise self._par.error(key, index, "it is not a real number")
        return found


def symbol(name: str) -> sp.Symbol:
    """Letter of a file; all of them are real."""
    return sp.Symbol(name, real=True)


def sympy_of(expression: Expression, values: Mapping[str, Expression]) -> sp.Expr:
    """Write arithmetic with SymPy, its numbers as exact fractions.

    Raises
    ------
    InvalidValueError
        If it divides by zero, or takes a function where it is infinite.
    """
    found = _written(expression, values)
    if found in _INFINITE:
        raise InvalidValueError("it divides by zero")
    return found


def _written(expression: Expression, values: Mapping[str, Expression]) -> sp.Expr:
    match expression:
        case Number(value):
            return _exact(value)
        case Name(name):
            if name == PI:
                return sp.pi
            return sympy_of(values[name], {}) if name in values else symbol(name)
        case Sum(terms):
            return sp.Add(*(sign * sympy_of(term, values) for sign, term in terms))
        case Product(factors):
            return sp.Mul(*(_power(sympy_of(factor, values), n) for n, factor in factors))
        case Power(base, exponent):
            return _power(sympy_of(base, values), _exact(exponent))
        case Call(function, arguments):
            return _FUNCTIONS[function](*(sympy_of(each, values) for each in arguments))


def _power(base: sp.Expr, exponent: sp.Expr | int) -> sp.Expr:
    if base.is_zero and exponent < 0:
        raise InvalidValueError("it divides by zero")
    return base**exponent


def _exact(value: Value) -> sp.Expr:
    fraction = value if isinstance(value, Fraction) else None
    return sp.Float(value) if fraction is None else sp.Rational(*fraction.as_integer_ratio())
