"""The reports' numbered equations, as SymPy derives them, in the reports' order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from drake_leg.symbolic.chain import SymbolicRow, row_transform
from drake_leg.symbolic.derivation import Derivation
from drake_leg.symbolic.singularities import ANY_INTEGER, SingularFamily
from drake_leg.symbolic.trigonometry import normal_form, shorthand, tidy


@dataclass(frozen=True, kw_only=True)
class Equation:
    """One equation of a report, or what follows from them."""

    label: str = ""  # its number in the report, where it has one
    title: str
    left: sp.Basic  # the name of what is derived
    right: sp.Basic  # what it is
    relation: type[sp.Rel] = sp.Eq

    def latex(self) -> str:
        """Write it for LaTeX's mathematics mode, in the reports' shorthand."""
        return str(sp.latex(self._shown()))

    def text(self) -> str:
        """Write it for a terminal, in the reports' shorthand.

        Returns
        -------
        str
            Several lines where there is a matrix.
        """
        return str(sp.pretty(self._shown(), use_unicode=True, wrap_line=False))

    def _shown(self) -> sp.Rel:
        return self.relation(shorthand(self.left), shorthand(self.right), evaluate=False)


def leg_a_equations(leg: Derivation) -> tuple[Equation, ...]:
    """Derive report A's equations 1-17 and 19; 18 is 14 again.

    References
    ----------
    Report A, section 2.
    """
    J, determinant = leg.jacobian, leg.determinant
    qdot = sp.Matrix(sp.symbols("qdot_1:4"))
    contributions = [sp.MatrixSymbol(f"V_{number}", 3, 1) for number in (1, 2, 3)]
    return (
        Equation(
            label="1",
            title="transform of a row (d, alpha, r, theta)",
            left=sp.MatrixSymbol("T", 4, 4),
            right=_general_transform(),
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
        Equation(
            label="17",
            title="determinant, multiplied out as it is printed",
            left=sp.Determinant(sp.MatrixSymbol("J", 3, 3)),
            right=sp.factor(normal_form(determinant)),
        ),
        Equation(
            label="19",
            title="inverse Jacobian",
            left=sp.MatrixSymbol("J", 3, 3) ** -1,
            right=(J.adjugate().applyfunc(tidy) / determinant).applyfunc(sp.factor),
        ),
    )


def leg_b_equations(leg: Derivation) -> tuple[Equation, ...]:
    """Derive report B's equations of the leg.

    References
    ----------
    Report B, sections 2.3 to 2.5.
    """
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
    """Derive report B's equations of the SCARA, with h = 452.4 mm and q4 = 452.4 - 340 - R.

    References
    ----------
    Report B, sections 1.3 to 1.6.
    """
    return (
        *_neighbours(arm, labels=("1.3",) * 4),
        _to_base(arm, 3, label="1.4"),
        _jacobian(arm, label="1.5"),
        Equation(
            label="1.6",
            title="determinant",
            left=sp.Determinant(sp.MatrixSymbol("J", 3, 3)),
            right=arm.determinant,
        ),
    )


def findings(robot: Derivation) -> tuple[Equation, ...]:
    """State what the matrices prove: both methods agree, and where the Jacobian is singular.

    Returns
    -------
    tuple of Equation
        The Jacobians' difference, the factored determinant, its zeros.

    References
    ----------
    Report A, appendix; report B, 1.6.
    """
    agree = robot.difference.is_zero_matrix
    return (
        Equation(
            title="Jacobian by both methods, rotation and translation",
            left=sp.Symbol("direct") - sp.Symbol("indirect"),
            right=sp.Integer(0) if agree else robot.difference,
        ),
        Equation(
            title="determinant, factored",
            left=sp.Determinant(sp.MatrixSymbol("J", 3, 3)),
            right=robot.determinant,
        ),
        *(equation for family in robot.families for equation in zeros_of(family)),
    )


def zeros_of(family: SingularFamily) -> list[Equation]:
    """State where a factor of a determinant is zero."""
    unsolved = "" if family.solutions else ", which SymPy solves for no joint alone"
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


def _general_transform() -> sp.Matrix:
    d, alpha, r, theta = sp.symbols("d alpha r theta", real=True)
    return row_transform(SymbolicRow(joint="fixed", d=d, alpha=alpha, r=r, theta=theta))


def _general_contribution() -> sp.Matrix:
    z = sp.Matrix(sp.symbols("z_x z_y z_z"))
    return z.cross(sp.Matrix(sp.symbols("p_x p_y p_z")))


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
        label=label,
        title="Jacobian",
        left=sp.MatrixSymbol("J", 3, 3),
        right=robot.jacobian,
    )
