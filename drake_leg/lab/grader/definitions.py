"""Reads a print's definitions and formulas, and derives the right entries in its notation."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import sympy as sp
from sympy.printing.str import StrPrinter

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.lab.grader.claims import NAMES, Claim
from drake_leg.lab.grader.printed import METRES, Finding, Printed
from drake_leg.lab.grader.tables import Cell
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.derivation import (
    SymbolicChain,
    direct_jacobian,
    row_transform,
    symbolic_chain,
    tidy,
)
from drake_leg.symbolic.formulas import (
    DEGREE,
    FUNCTIONS,
    UNITS,
    changed,
    evaluate,
    inside,
    is_negative,
    names_in,
    product,
    replace_at,
    substitute,
    written,
)
from drake_leg.symbolic.parser import parse_formula
from drake_leg.symbolic.spelling import ANGLE_LETTERS, is_joint_variable, plain, quoted, spelled_as

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
        """Write the table's lengths with the print's names, or as numbers."""
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
    """Whether an expression is a fraction that is written with a decimal point."""
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


# Names that people give to a result: Δ, J11, P4, T, x04. Other symbols may be lengths.
_RESULT = re.compile(r"(?:[jptxyz]|delta|det\w*)_?\(?[\d, ]*\)?")


class Reader:
    """Reads a print's formulas.

    Its symbols and definitions are checked at once: a name that means something already, two
    meanings of one name, a definition that is no formula, and a joint that the robot has not are
    refused with ``InvalidValueError``.
    """

    def __init__(self, printed: Printed, robot: Robot) -> None:
        self._origin = printed.origin
        self.degrees = printed.angles == "deg"
        said: list[tuple[str, float | str]] = [*printed.symbols.items(), *printed.where.items()]
        _require_free(said, printed.origin)
        _require_one_meaning(said, printed.origin)
        self.symbols = {plain(name): value for name, value in printed.symbols.items()}
        self.units = {unit: metres / printed.metres for unit, metres in METRES.items()}
        self._names = {*self.symbols, *map(plain, printed.where)}
        self.definitions(printed.where)  # refused before the joints' formulas are
        self.joints = {
            _joint_index(name, robot, printed.origin): formula
            for name, formula in self._parsed(printed.joints, "joints", weak=False).items()
        }
        of_joints = {name for formula in self.joints.values() for name in names_in(formula)}
        self._names |= of_joints
        self._definitions = self.definitions(printed.where)
        # θ is the angle of a robot with one joint.
        alone = ANGLE_LETTERS if len(robot.moving) == 1 else ()
        self._alone = {a: sp.Symbol("q1") for a in alone if a not in self._names}
        self.variables = frozenset(of_joints | set(self._alone)) - set(self.symbols)

    def definitions(self, where: Mapping[str, str]) -> dict[str, sp.Expr]:
        """Read definitions as printed: name in lower case to formula."""
        names = list(map(plain, where))
        parsed = self._parsed(where, "where", names)
        return dict(zip(names, parsed.values(), strict=True))

    def formula(
        self,
        text: str,
        own: Mapping[str, sp.Expr] | None = None,
        *,
        names: Collection[str] = (),
    ) -> sp.Expr:
        """Read a formula and put all definitions in.

        Parameters
        ----------
        own : mapping, optional
            Definitions that hold for this formula alone.
        names : collection of str
            Symbols in it besides the print's own.

        Returns
        -------
        Expr
            Of joints' variables q1, q2, ..., other symbols and numbers.
        """
        definitions = {**self._definitions, **(own or {})}
        formula = self._parse(text, {*self._names, *definitions, *names})
        formula = substitute(formula, {**self._alone, **definitions})
        return changed(formula, self._without_cosd) if self.degrees else formula

    def joint(self, index: int) -> sp.Expr:
        """Return the formula of a joint's position, counted from 0."""
        return self.joints.get(index, sp.Symbol(f"q{index + 1}"))

    def turns(self, formula: sp.Expr) -> bool:
        """Whether a joint's position is in a formula."""
        return any(is_joint_variable(n) or n in self.variables for n in names_in(formula))

    def _without_cosd(self, part: sp.Expr) -> sp.Expr | None:
        """Read cosd(q2 + 30) as cos(q2 + 30°), in a print whose angles are in degrees."""
        if part.func not in FUNCTIONS:
            return None
        angle, *unit = part.args[0].args if part.args[0].is_Mul else part.args
        if unit != [DEGREE] or not self.turns(angle):
            return None
        return part.func(self._in_radians(angle), evaluate=False)

    def _in_radians(self, angle: sp.Expr) -> sp.Expr:
        """Turn what is added to joints' angles from degrees into radians."""
        if angle.is_Add or is_negative(angle):
            for path, part in inside(angle):
                angle = replace_at(angle, path, self._in_radians(part))
            return angle
        return angle if self.turns(angle) else product(angle, DEGREE)

    def _parse(self, text: str, names: Collection[str], *, weak: bool = True) -> sp.Expr:
        formula = parse_formula(text, names, weak=weak)
        return changed(formula, _with_degrees) if self.degrees else formula

    def _parsed(
        self, texts: Mapping[str, str], key: str, names: Iterable[str] = (), *, weak: bool = True
    ) -> dict[str, sp.Expr]:
        known = {*self._names, *names}
        try:
            return {name: self._parse(text, known, weak=weak) for name, text in texts.items()}
        except InvalidValueError as error:
            raise InvalidValueError(f"{self._origin}: {key}: {error}") from None


def _require_free(said: Iterable[tuple[str, object]], origin: str) -> None:
    """Refuse a symbol that the notation reads as something else."""
    for name, _ in said:
        try:
            read, own = parse_formula(name, weak=False), plain(name)
            meaning = written(read)
        except InvalidValueError:
            read, own, meaning = None, "", "no name"
        if read != sp.Symbol(own) or own in UNITS or is_joint_variable(own):
            raise InvalidValueError(
                f"{origin}: the symbol {quoted(name)} is read as {meaning}; choose another name"
            )


def _require_one_meaning(said: Iterable[tuple[str, float | str]], origin: str) -> None:
    """Refuse two values of one symbol, and two symbols that are read as one."""
    first: dict[str, tuple[str, float | str]] = {}
    for name, value in said:
        other, known = first.setdefault(plain(name), (name, value))
        if _number_or_text(known) == _number_or_text(value):
            continue
        values = f"is given as {_said(known)} and as {_said(value)}"
        if other == name:
            raise InvalidValueError(f"{origin}: {quoted(name)} {values}; define it once")
        raise InvalidValueError(
            f"{origin}: {quoted(other)} and {quoted(name)} are read as one symbol, which {values}; "
            "choose another name for one of them"
        )


def _number_or_text(value: float | str) -> float | str:
    try:
        return float(value)
    except ValueError:
        return value


def _said(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _joint_index(name: str, robot: Robot, origin: str) -> int:
    """Find a joint by its name or by its variable: 0 for the first."""
    names = [str(segment.joint) for segment in robot.moving]
    variables = [f"q{number}" for number in range(1, len(names) + 1)]
    for candidates, key in ((names, name), (variables, plain(name))):
        if key in candidates:
            return candidates.index(key)
    raise InvalidValueError(
        f"{origin}: joints: {robot.name} has no joint {quoted(name)}; it has {', '.join(names)}"
    )


def _with_degrees(part: sp.Expr) -> sp.Expr | None:
    """Read cos(θ2 + 90) as cos(θ2 + 90°): whole numbers of 15 degrees, in a print in degrees."""
    if part.func not in FUNCTIONS:
        return None
    return part.func(_terms_with_degrees(part.args[0]), evaluate=False)


def _terms_with_degrees(part: sp.Expr) -> sp.Expr:
    if part.is_Integer and part != 0 and part % 15 == 0:
        return product(part, DEGREE)
    if not (part.is_Add or is_negative(part)):
        return changed(part, _with_degrees)
    for path, term in inside(part):
        part = replace_at(part, path, _terms_with_degrees(term))
    return part


def with_lengths_as_symbols(printed: Printed, robot: Robot) -> Printed:
    """Move lengths from the definitions to the symbols: L2 = 100, or L2 = 2*L1.

    A definition such as sigma1 = 2*c1 stays one.
    """
    reader = Reader(printed, robot)
    symbols = dict(printed.symbols)
    for name, text in printed.where.items():
        formula = reader.formula(text)
        names = names_in(formula)
        if names <= set(reader.symbols) and (not names or _is_sibling(plain(name), names)):
            symbols[name] = float(evaluate(formula, reader.symbols))
    where = {name: text for name, text in printed.where.items() if name not in symbols}
    return replace(printed, symbols=symbols, where=where)


def _is_sibling(name: str, others: Collection[str]) -> bool:
    """Whether a name differs from another by its number only: L2 and L1."""
    letters = {re.sub(r"\d+$", "", other) for other in others}
    return bool(re.search(r"\d$", name)) and re.sub(r"\d+$", "", name) in letters


def unused_definitions(printed: Printed) -> Iterator[Finding]:
    """Find definitions that nothing graded uses: often a result under another name.

    Not understood are every formula that moves, and every length with the name of a result.
    """
    known = {name: _plain_or_as_it_is(name) for name in (*printed.symbols, *printed.where)}
    names = tuple(known.values())
    for name, spelled in known.items():
        if not _moves(printed.where.get(name, "0"), names) and not _RESULT.fullmatch(spelled):
            continue
        if any(spelled in _plain_or_as_it_is(text) for text in printed.singular):
            continue
        others = [text for other, text in printed.where.items() if other != name]
        if not any(_uses(text, spelled, names) for text in (*_texts(printed), *others)):
            yield Finding(
                place=name,
                fault=f"{quoted(name)} is defined and used nowhere",
                remedy=f"name it as what it is: {NAMES}, singular, or leave it out",
                understood=False,
                kind="unused definition",
            )


def _texts(printed: Printed) -> Iterator[str]:
    """List the formulas of a print besides its definitions."""
    for matrix in printed.matrices:
        for row in matrix.entries:
            yield from row
        yield from matrix.where.values()
    yield from printed.joints.values()
    for table_row in printed.table.rows if printed.table else ():
        yield from table_row.cells.values()


def _moves(text: str, names: tuple[str, ...]) -> bool:
    """Whether a formula changes with the robot's posture; one without angles may be a length."""
    try:
        return any(map(is_joint_variable, names_in(parse_formula(text, names))))
    except InvalidValueError:
        return True


def _uses(text: str, name: str, names: tuple[str, ...]) -> bool:
    """Whether a formula has a name in it; where it cannot be read, whether its letters are."""
    if name not in _plain_or_as_it_is(text):
        return False
    try:
        return name in names_in(parse_formula(text, names))
    except InvalidValueError:
        return True


def _plain_or_as_it_is(text: str) -> str:
    try:
        return plain(text)
    except InvalidValueError:
        return text
