"""Lists the reports' equations as SymPy derives them, and those of any other table, in pieces."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

from drake_leg.symbolic.decimals import in_decimals
from drake_leg.symbolic.derivation import (
    ANY_INTEGER,
    Derivation,
    SingularFamily,
)
from drake_leg.symbolic.geometry import PARTS
from drake_leg.symbolic.table import SymbolicRow, SymbolicTable, row_transform


@dataclass(frozen=True, kw_only=True)
class Equation:
    """One equation of a report, or a consequence of its equations."""

    label: str = ""  # its number in the report, where it has one
    title: str
    left: sp.Basic  # name
    right: sp.Basic  # value
    relation: type[sp.Rel] = sp.Eq

    def latex(self) -> str:
        """Write it for LaTeX's mathematics mode, in the reports' shorthand."""
        return str(sp.latex(self._shown(), full_prec=False))

    def text(self) -> str:
        """Write it for a terminal, in the reports' shorthand; a matrix takes several lines."""
        return str(sp.pretty(self._shown(), use_unicode=True, wrap_line=False, full_prec=False))

    def _shown(self) -> sp.Rel:
        right = in_decimals(shorthand(self.right))
        return self.relation(shorthand(self.left), right, evaluate=False)


def leg_a_equations(leg: Derivation) -> tuple[Equation, ...]:
    """Derive report A's equations 1-17 and 19; 18 is 14 again."""
    J = leg.jacobian
    qdot = sp.Matrix(sp.symbols("qdot_1:4"))
    contributions = [sp.MatrixSymbol(f"V_{number}", 3, 1) for number in (1, 2, 3)]
    return (
        Equation(
            label="1",
            title="transform of a row (d, alpha, r, theta)",
            left=sp.MatrixSymbol("T", 4, 4),
            right=general_transform(),
        ),
        *_neighbours(leg, labels=("2", "3", "4", "5")),
        *(_to_base(leg, frame, label=str(4 + frame)) for frame in (2, 3, 4)),
        Equation(
            label="9",
            title="what joint j contributes, z its axis and p = O_j O_E",
            left=sp.MatrixSymbol("V_j", 3, 1),
            right=sp.MatMul(sp.Symbol("qdot_j"), _general_contribution(), evaluate=False),
        ),
        *(
            Equation(
                label=str(10 + column),
                title=f"what joint {column + 1} contributes",
                left=contributions[column],
                right=sp.MatMul(qdot[column], J[:, column], evaluate=False),
            )
            for column in range(3)
        ),
        Equation(
            label="13",
            title="the contributions' sum",
            left=sp.MatrixSymbol("V", 3, 1),
            right=sp.MatAdd(*contributions),
        ),
        Equation(
            label="14",
            title="velocity of the foot",
            left=sp.MatrixSymbol("V", 3, 1),
            right=sp.MatMul(J, qdot, evaluate=False),
        ),
        _jacobian(leg, label="15"),
        Equation(
            label="16",
            title="velocity of the foot by components",
            left=sp.Matrix(sp.symbols("xdot ydot zdot")),
            right=sp.MatMul(J, qdot, evaluate=False),
        ),
        _determinant(
            leg.expanded_determinant, "determinant, multiplied out as it is printed", label="17"
        ),
        Equation(
            label="19",
            title="inverse Jacobian",
            left=sp.MatrixSymbol("J", 3, 3) ** -1,
            right=leg.inverse,
        ),
    )


def leg_b_equations(leg: Derivation) -> tuple[Equation, ...]:
    """Derive report B's equations of the leg, sections 2.3 to 2.5."""
    return (
        *_neighbours(leg, labels=("2.3",) * 4),
        _to_base(leg, 4, label="2.4"),
        Equation(
            label="2.5.1",
            title="position of the foot",
            left=sp.MatrixSymbol("P", 3, 1),
            right=leg.to_base[-1][:3, 3],
        ),
        _jacobian(leg, label="2.5.2"),
    )


def scara_equations(arm: Derivation) -> tuple[Equation, ...]:
    """Derive report B's sections 1.3 to 1.6, with h = 452.4 mm and q4 = 452.4 - 340 - R."""
    return (
        *_neighbours(arm, labels=("1.3",) * 4),
        _to_base(arm, 3, label="1.4"),
        _jacobian(arm, label="1.5"),
        _determinant(arm.determinant, "determinant", label="1.6"),
    )


def findings(robot: Derivation) -> tuple[Equation, ...]:
    """State that both methods agree, and where the Jacobian is singular."""
    return (
        Equation(
            title="Jacobian by both methods, rotation and translation",
            left=sp.Symbol("direct") - sp.Symbol("indirect"),
            right=_zero_or(robot.difference),
        ),
        _determinant(robot.determinant, "determinant, factored"),
        *(equation for family in robot.families for equation in zeros_of(family)),
    )


def zeros_of(family: SingularFamily) -> list[Equation]:
    """State where a factor of a determinant is zero."""
    unsolved = "" if family.solutions else " (SymPy solves this for no single joint)"
    title = f"singular where{unsolved}"
    stated = [Equation(title=title, left=family.factor, right=sp.Integer(0))]
    for solution in family.solutions:
        turns = ", k any integer" if any(v.has(ANY_INTEGER) for v in solution.values) else ""
        title = f"{solution.angle} there{turns}"
        stated += [Equation(title=title, left=solution.angle, right=v) for v in solution.values]
        if not solution.real_where.is_number:
            stated.append(
                Equation(
                    title=f"{solution.angle} is real where",
                    left=solution.real_where,
                    right=sp.Integer(0),
                    relation=sp.Ge,
                )
            )
    return stated


def matrices(robot: Derivation) -> dict[str, sp.Matrix]:
    """Return the matrices of a report's equations by name: T, T01, V1, P, J, J⁻¹, det J."""
    last, J = len(robot.neighbours), robot.jacobian
    found = {"T": general_transform()}
    found |= {f"T{i}{i + 1}": X for i, X in enumerate(robot.neighbours)}
    found |= {f"T0{i}": robot.to_base[i - 1] for i in range(2, last + 1)}
    found |= {f"V{j + 1}": J[:, j] for j in range(J.cols)}
    # The SCARA's determinant is printed as its rows multiply out, the leg's in single angles.
    multiplied = sp.expand(J.det())
    if len(sp.Add.make_args(multiplied)) > 2:
        multiplied = robot.expanded_determinant
    return found | {
        "P": robot.to_base[-1][:3, 3],
        "J": J,
        "J⁻¹": robot.inverse,
        "det J": sp.Matrix([[robot.determinant]]),
        "det J expanded": sp.Matrix([[multiplied]]),
    }


@dataclass(frozen=True, kw_only=True)
class Piece:
    """A part of a table's derivation; it may take very long."""

    title: str
    derive: Callable[[], list[Equation]]
    otherwise: str = ""  # printed if there is no equation


def own_pieces(robot: Derivation) -> Iterator[Piece]:
    """List what is derived from a table; later pieces use the results of earlier ones."""
    table = robot.table
    for frame, (row, X_PC) in enumerate(zip(table.rows, robot.neighbours, strict=True), start=1):
        before = row.antecedent
        left = sp.MatrixSymbol(f"T_{before}{frame}", 4, 4)
        yield _piece(f"frame {frame} in frame {before}", left, partial(sp.Matrix, X_PC))
    for frame in range(2, len(robot.neighbours) + 1):
        left = sp.MatrixSymbol(f"T_0{frame}", 4, 4)
        yield _piece(f"frame {frame} in the base", left, partial(robot.in_base, frame))
    ends = _ends(table)
    for frame in ends:
        branch = Derivation(table.branch(frame)) if len(ends) > 1 else robot
        yield from _foot_pieces(branch, f" of frame {frame}" if len(ends) > 1 else "")


def _ends(table: SymbolicTable) -> tuple[int, ...]:
    """Choose the frames that have a Jacobian: the tips, without the frames of loops if others are.

    The last frame is the only one where every row leads to it.
    """
    of_loops = {row for loop in table.loops for row in loop}
    return tuple(tip for tip in table.tips if tip not in of_loops) or table.tips


def _foot_pieces(robot: Derivation, of: str) -> Iterator[Piece]:
    """List what is derived of one foot; ``of`` says which, where there are several."""
    J = sp.MatrixSymbol("J", 6, len(robot.table.q))
    rows = ", ".join(PARTS)
    joints = f", per {', '.join(map(str, robot.table.q))}" if of else ""
    yield _piece(f"Jacobian{of}, its rows {rows}{joints}", J, lambda: robot.spatial_jacobian)
    yield _piece(
        f"Jacobian{of} by both methods",
        sp.Symbol("direct") - sp.Symbol("indirect"),
        lambda: _zero_or(robot.difference),
    )

    def determinant() -> list[Equation]:
        title = f"determinant{of} of the rows {', '.join(PARTS[row] for row in robot.task)}"
        size = len(robot.task)
        return [_determinant(robot.determinant, title, size=size)] if size else []

    def families() -> list[Equation]:
        found = robot.families if robot.task else ()
        return [equation for family in found for equation in zeros_of(family)]

    yield Piece(
        title=f"determinant{of}",
        derive=determinant,
        otherwise="none, as no rows of the Jacobian make it square",
    )
    yield Piece(
        title=f"singular postures{of}",
        derive=families,
        otherwise="not found, as there is no determinant",
    )


def _piece(title: str, left: sp.Basic, right: Callable[[], sp.Basic]) -> Piece:
    return Piece(title=title, derive=lambda: [Equation(title=title, left=left, right=right())])


def general_transform() -> sp.Matrix:
    """General transform of a row, report A's equation 1."""
    d, alpha, r, theta = sp.symbols("d alpha r theta", real=True)
    return row_transform(SymbolicRow(joint="fixed", d=d, alpha=alpha, r=r, theta=theta))


def _general_contribution() -> sp.Matrix:
    z = sp.Matrix(sp.symbols("z_x z_y z_z"))
    return z.cross(sp.Matrix(sp.symbols("p_x p_y p_z")))


def _zero_or(difference: sp.Matrix) -> sp.Basic:
    return sp.Integer(0) if difference.is_zero_matrix else difference


def _neighbours(robot: Derivation, labels: Sequence[str]) -> list[Equation]:
    return [
        Equation(
            label=label,
            title=f"frame {frame} in frame {frame - 1}",
            left=sp.MatrixSymbol(f"T_{frame - 1}{frame}", 4, 4),
            right=X_PC,
        )
        for frame, (label, X_PC) in enumerate(zip(labels, robot.neighbours, strict=True), start=1)
    ]


def _to_base(robot: Derivation, frame: int, *, label: str) -> Equation:
    return Equation(
        label=label,
        title=f"frame {frame} in the base",
        left=sp.MatrixSymbol(f"T_0{frame}", 4, 4),
        right=robot.to_base[frame - 1],
    )


def _jacobian(robot: Derivation, *, label: str) -> Equation:
    return Equation(
        label=label, title="Jacobian", left=sp.MatrixSymbol("J", 3, 3), right=robot.jacobian
    )


def _determinant(value: sp.Expr, title: str, *, label: str = "", size: int = 3) -> Equation:
    left = sp.Determinant(sp.MatrixSymbol("J", size, size))
    return Equation(label=label, title=title, left=left, right=value)


# --- notation --------------------------------------------------------------------------------


SHORT = re.compile(r"([cs])(\d+)")  # c23 is cos(q2 + q3)
POSITION = re.compile(r"q\d+")  # of a joint
GREEK = {"alpha": "α", "theta": "θ"}


def shorthand(expression: sp.Basic) -> sp.Basic:
    """Write as the reports do: c1 for cos(q1), s23 for sin(q2 + q3); only to be shown."""

    def short(letter: str, function: type[sp.Function], angle: sp.Expr) -> sp.Expr:
        terms = sorted(sp.Add.make_args(angle), key=str)
        if all(term.is_Symbol and POSITION.fullmatch(term.name) for term in terms):
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
