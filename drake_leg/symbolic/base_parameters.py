"""Base inertial parameters: the fewest that give the same torques, and what is grouped in them.

Two kinds of grouping are found. Across every joint there is one by Gautier and Khalil's rule,
which holds for all joints alike. What remains near a fixed base, whose first links cannot move in
all ways, shows as columns of the regressor that depend on those before; their coefficients are
found in numbers, for letters drawn at random, and recognized as formulas.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property, partial
from itertools import combinations_with_replacement

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.symbolic.decimals import latex_text, plain_text
from drake_leg.symbolic.derivation import pythagoras
from drake_leg.symbolic.inertia import at_parent
from drake_leg.symbolic.mechanism import ORIGIN, Turn, row_position, row_turns
from drake_leg.symbolic.programs import Program
from drake_leg.symbolic.regressor import Parameter, parameters, regressor, require_parameters
from drake_leg.symbolic.table import INERTIAL, JOINT, LinkParameters, SymbolicRow, SymbolicTable

Combination = dict[Parameter, sp.Expr]  # a sum of parameters: the coefficient of each
FRICTION = ("FV", "FS")  # each with a column like no other
INDEPENDENT = 1e-8  # part of a column that the ones before do not explain
DRAWS = 40  # sets of letters beyond the size of a formula's basis
RECOGNIZED = 1e-7  # greatest error of a coefficient's formula
MOST_TERMS = 250  # in the formulas that are tried
LARGEST_DENOMINATOR = 24  # of a fraction that is recognized


@dataclass(frozen=True, kw_only=True)
class BaseParameters:
    """The base parameters of a table, each a sum of dynamic parameters.

    Those that nothing is added to keep their names; the others have an R: ZZR1.
    """

    table: SymbolicTable
    groups: Mapping[Parameter, Combination]

    def name(self, kept: Parameter) -> str:
        """Name a base parameter."""
        alone = self.groups[kept] == {kept: sp.Integer(1)}
        return str(kept) if alone else f"{kept.name}R{kept.link}"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all, in the order of the regressor's columns."""
        return tuple(self.name(kept) for kept in self.groups)

    def expression(self, kept: Parameter) -> sp.Expr:
        """Write what is grouped in a base parameter."""
        return sp.Add(*(c * self._value(p) for p, c in self.groups[kept].items()))

    def __str__(self) -> str:
        lines = [
            name if name == str(kept) else f"{name} = {plain_text(self.expression(kept))}"
            for name, kept in zip(self.names, self.groups, strict=True)
        ]
        if self.without_effect:
            lines.append(f"without effect: {', '.join(map(str, self.without_effect))}")
        return "\n".join(lines)

    def latex(self) -> str:
        """Write the groups as lines of LaTeX's mathematics."""
        lines = [
            f"{sp.latex(sp.Symbol(name))} = {latex_text(self.expression(kept))}"
            for name, kept in zip(self.names, self.groups, strict=True)
        ]
        if self.without_effect:
            lines.append(f"% without effect: {', '.join(map(str, self.without_effect))}")
        return "\n".join(lines)

    def _value(self, parameter: Parameter) -> sp.Expr:
        links = (self.table.base, *self.table.links)
        return getattr(links[parameter.link], parameter.name)

    @cached_property
    def without_effect(self) -> tuple[Parameter, ...]:
        """The parameters that are in no group: no motion shows them."""
        grouped = {p for group in self.groups.values() for p in group}
        return tuple(p for p in parameters(self.table) if p not in grouped)

    @cached_property
    def values(self) -> dict[str, float]:
        """The numbers of the base parameters by name, of those whose letters have values."""
        numbers = {symbol: sp.Float(value) for symbol, value in self.table.values.items()}
        found = {kept: self.expression(kept).xreplace(numbers) for kept in self.groups}
        return {self.name(k): float(v) for k, v in found.items() if not v.free_symbols}

    @cached_property
    def reduced_table(self) -> SymbolicTable:
        """The table with the base parameters in place of its own, which has the same torques."""
        symbols = {kept: sp.Symbol(self.name(kept), real=True) for kept in self.groups}
        links = []
        for number, link in enumerate((self.table.base, *self.table.links)):
            own = {kept.name: symbol for kept, symbol in symbols.items() if kept.link == number}
            links.append(LinkParameters(**own, force=link.force, moment=link.moment))
        numbers = {sp.Symbol(name, real=True): value for name, value in self.values.items()}
        table = replace(self.table, base=links[0], links=tuple(links[1:]))
        kept_values = {s: v for s, v in self.table.values.items() if s in table.free_symbols}
        return replace(table, values=kept_values | numbers)

    def regressor(self) -> Program:
        """Make the program of the matrix whose columns are the base parameters'."""
        return regressor(self.table, tuple(self.groups), self.names)


def group_parameters(table: SymbolicTable) -> BaseParameters:
    """Find the base parameters of a table.

    Raises
    ------
    InvalidValueError
        If a coefficient is not recognized as a formula, or all parameters are 0.
    """
    require_parameters(table)
    groups = _across_joints(table)
    candidates = [kept for kept in groups if kept.name not in FRICTION]
    samples = _Samples(table, candidates)
    independent, dependent = samples.split() if candidates else ([], [])
    for kept in dependent:
        group = groups.pop(kept)
        for other, coefficient in samples.coefficients(kept, independent).items():
            _add(groups[other], group, coefficient)
    short = {k: {p: _short(c) for p, c in g.items()} for k, g in groups.items() if g}
    return BaseParameters(table=table, groups=short)


# --- across the joints -----------------------------------------------------------------------


def _same(expression: sp.Expr) -> sp.Expr:
    return expression


def shares(row: SymbolicRow) -> dict[str, dict[str, sp.Expr]]:
    """Find what of a link acts as if it were fixed to its antecedent, and as what of that.

    Of a turning link, a body that is alike from all sides of the axis: YY with an equal XX, MZ and
    M. Of a sliding one, its inertia, as it does not turn. Of a fixed one, everything: Gautier and
    Khalil, 1990.
    """
    one = sp.Integer(1)
    bodies = {name: LinkParameters(**{name: one}) for name in INERTIAL}
    turns: Sequence[Turn] = row_turns(row)
    p = row_position(row, turns)
    if row.joint == "revolute":
        bodies |= {"YY": LinkParameters(XX=one, YY=one)}
        bodies = {name: bodies[name] for name in ("YY", "MZ", "M")}
        turns = turns[:2]
    elif row.joint == "prismatic":
        bodies = {name: bodies[name] for name in INERTIAL[:6]}
        p = ORIGIN
    moved = {name: at_parent(body, turns, p, _same) for name, body in bodies.items()}
    return {
        name: {n: getattr(body, n) for n in INERTIAL if getattr(body, n) != 0}
        for name, body in moved.items()
    }


def _across_joints(table: SymbolicTable) -> dict[Parameter, Combination]:
    """Group towards the base, from the tips, and list what is left in Khalil's order."""
    groups: dict[Parameter, Combination] = {
        parameter: {parameter: sp.Integer(1)} for parameter in parameters(table)
    }
    for number in range(len(table.rows), 0, -1):
        row = table.rows[number - 1]
        for name, to in shares(row).items():
            group = groups.pop(Parameter(link=number, name=name), {})
            if row.antecedent or table.floating:
                for other, share in to.items():
                    place = Parameter(link=row.antecedent, name=other)
                    _add(groups.setdefault(place, {}), group, share)
            if row.joint == "revolute" and name == "YY":
                place = Parameter(link=number, name="XX")
                _add(groups.setdefault(place, {}), group, sp.Integer(-1))
    left = [kept for kept, group in groups.items() if group]
    return {kept: groups[kept] for kept in sorted(left, key=_khalils_order)}


def _khalils_order(parameter: Parameter) -> tuple[int, int]:
    return parameter.link, (*INERTIAL, *JOINT).index(parameter.name)


@cache
def _short(coefficient: sp.Expr) -> sp.Expr:
    """Shorten a coefficient: one of angles may be shorter without squares of sines."""
    if not coefficient.has(sp.sin):
        return coefficient
    return min(coefficient, pythagoras(coefficient), key=sp.count_ops)


def _add(group: Combination, other: Combination, coefficient: sp.Expr) -> None:
    """Add a multiple of one sum to another."""
    for parameter, own in other.items():
        total = sp.expand(group.get(parameter, 0) + coefficient * own)
        group[parameter] = total
        if total == 0:
            del group[parameter]


# --- near the base ---------------------------------------------------------------------------


class _Samples:
    """Columns of a regressor at random motions, for letters drawn at random."""

    def __init__(self, table: SymbolicTable, candidates: Sequence[Parameter]) -> None:
        self._table, self._candidates = table, list(candidates)
        self._rng = np.random.default_rng(0)
        self._program = regressor(table, candidates)
        self._draws: list[tuple[dict[str, float], Array]] = []

    def _draw(self, index: int) -> tuple[dict[str, float], Array]:
        """Return one set of letters and the columns for it, (rows, columns)."""
        while len(self._draws) <= index:
            letters = {s.name: self._rng.uniform(0.3, 1.2) for s in self._program.letters}
            states = 20 + 2 * len(self._candidates)
            motion = [
                self._rng.uniform(-2.0, 2.0, (states, len(one.symbols)))
                for one in self._program.inputs
            ]
            W = self._program(*motion, letters=letters)["W"]
            self._draws.append((letters, W.reshape(-1, len(self._candidates))))
        return self._draws[index]

    def split(self) -> tuple[list[Parameter], list[Parameter]]:
        """Tell the columns that do not depend on those before from those that do."""
        W = self._draw(0)[1]
        basis = np.zeros((W.shape[0], 0))
        independent, dependent = [], []
        for parameter, column in zip(self._candidates, W.T, strict=True):
            length, rest = float(np.linalg.norm(column)), column
            for _ in range(2):  # once more, for what rounding left
                rest = rest - basis @ (basis.T @ rest)
            if np.linalg.norm(rest) <= INDEPENDENT * max(length, INDEPENDENT):
                dependent.append(parameter)
            else:
                independent.append(parameter)
                basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
        return independent, dependent

    def coefficients(self, kept: Parameter, independent: Sequence[Parameter]) -> Combination:
        """Write a dependent column as a sum of independent ones, with formulas."""
        own = self._candidates.index(kept)
        others = [self._candidates.index(one) for one in independent]

        @cache
        def numbers(index: int) -> Array:
            W = self._draw(index)[1]
            if np.linalg.norm(W[:, own]) <= INDEPENDENT:
                return np.zeros(len(others))
            solution = np.linalg.lstsq(W[:, others], W[:, own], rcond=None)[0]
            return np.asarray(solution, dtype=np.float64)

        def number(place: int, index: int) -> float:
            return float(numbers(index)[place])

        return {
            other: self._formula(kept, other, partial(number, place))
            for place, other in enumerate(independent)
            if max(abs(number(place, 0)), abs(number(place, 1))) > RECOGNIZED
        }

    def _formula(
        self, kept: Parameter, other: Parameter, number: Callable[[int], float]
    ) -> sp.Expr:
        """Recognize a coefficient by its numbers for many sets of letters."""
        if abs(number(0) - number(1)) <= RECOGNIZED:
            return self._constant(number(0))
        path = self._table.path(kept.link)
        for rows in (path[path.index(other.link) + 1 :] if other.link in path else (), path):
            lengths, waves = self._letters(rows)
            for turning in (_of_degree_one(waves), _of_degree_two(waves)):
                terms = [sp.expand(a * t) for a in _products(lengths) for t in turning]
                if len(terms) > MOST_TERMS:
                    continue
                quotient = self._quotient(terms, turning, number)
                if quotient is not None:
                    return quotient
        raise InvalidValueError(
            f"{kept} of {self._table.name} depends on {other} by a formula that is not recognized",
            advice="give its lengths and angles as numbers",
        )

    def _quotient(
        self, above: Sequence[sp.Expr], below: Sequence[sp.Expr], number: Callable[[int], float]
    ) -> sp.Expr | None:
        """Find the one quotient of sums of such terms that a coefficient is, if it is one.

        ``p(x) - number(x) q(x) = 0`` for all letters x: the factors of the terms in p and q are in
        the null space of these equations. A smaller one, where q is 1, is tried first.
        """
        for denominator in ([sp.Integer(1)], below):
            draws = range(len(above) + len(denominator) + DRAWS)
            letters = [self._draw(index)[0] for index in draws]
            values = np.array([[number(index)] for index in draws])
            equations = np.hstack(
                [_evaluated(above, letters), -values * _evaluated(denominator, letters)]
            )
            scale = np.linalg.norm(equations, axis=0)
            _, sizes, directions = np.linalg.svd(equations / scale)
            if sizes[-1] > RECOGNIZED * sizes[0] or sizes[-2] <= RECOGNIZED * sizes[0]:
                continue
            factors = directions[-1] / scale
            bottom = factors[len(above) :]
            factors = factors / bottom[np.abs(bottom).argmax()]
            p, q = (
                sp.Add(*(self._constant(f) * t for f, t in pairs if abs(f) > RECOGNIZED))
                for pairs in (
                    list(zip(factors.tolist(), above, strict=False)),
                    list(zip(factors[len(above) :].tolist(), denominator, strict=True)),
                )
            )
            return p / q
        return None

    def _letters(self, rows: Sequence[int]) -> tuple[list[sp.Expr], list[sp.Expr]]:
        """List the lengths of rows, and the cosines and sines of their angles."""
        chosen = [self._table.rows[number - 1] for number in rows]
        joints = set(self._table.q)
        lengths = set().union(*(_letters(row, ("d", "r", "b")) for row in chosen)) - joints
        angles = set().union(*(_letters(row, ("alpha", "gamma", "theta")) for row in chosen))
        waves = [
            wave(angle) for angle in sorted(angles - joints, key=str) for wave in (sp.cos, sp.sin)
        ]
        return sorted(lengths, key=str), waves

    def _constant(self, number: float) -> sp.Expr:
        """Recognize a number: a simple fraction, times the waves of the table's exact angles."""
        exact = {
            wave(angle)
            for row in self._table.rows
            for angle in (row.alpha, row.gamma, row.theta.subs(dict.fromkeys(self._table.q, 0)))
            for wave in (sp.cos, sp.sin)
            if not angle.free_symbols and not angle.has(sp.Float)
        }
        for factor in _products(sorted(exact - {sp.Integer(0)}, key=str)):
            part = Fraction(number / float(factor)).limit_denominator(LARGEST_DENOMINATOR)
            if abs(float(part) * float(factor) - number) <= RECOGNIZED:
                return sp.Rational(part.numerator, part.denominator) * factor
        return sp.Float(number)


def _letters(row: SymbolicRow, columns: Sequence[str]) -> set[sp.Symbol]:
    return set().union(*(getattr(row, column).free_symbols for column in columns))


def _products(factors: Sequence[sp.Expr]) -> list[sp.Expr]:
    """1, the factors, and the products of two."""
    pairs = [a * b for a, b in combinations_with_replacement(factors, 2)]
    return list(dict.fromkeys([sp.Integer(1), *factors, *pairs]))


def _of_degree_one(waves: Sequence[sp.Expr]) -> list[sp.Expr]:
    return [sp.Integer(1), *waves]


def _of_degree_two(waves: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Products of two, without the squares of sines, which are 1 less those of cosines."""
    return [t for t in _products(waves) if not (t.is_Pow and t.base.func is sp.sin)]


def _evaluated(terms: Sequence[sp.Expr], draws: Sequence[Mapping[str, float]]) -> Array:
    """Evaluate formulas for sets of letters, (draws, terms)."""
    symbols = sorted(set().union(*(term.free_symbols for term in terms)), key=str)
    function = sp.lambdify(symbols, list(terms), "numpy")
    return np.array([function(*(draw[s.name] for s in symbols)) for draw in draws], dtype=float)
