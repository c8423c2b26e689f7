"""Derives transforms, Jacobians, the determinant and its zeros from a Khalil table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from drake_leg.robot.robot import Row
from drake_leg.symbolic.chain import (
    SymbolicChain,
    base_transforms,
    direct_jacobian,
    indirect_jacobian,
    row_transform,
    symbolic_chain,
)
from drake_leg.symbolic.notation import normal_form, pythagoras, tidy

ANY_INTEGER = sp.Symbol("k", integer=True)


@dataclass(frozen=True, kw_only=True)
class Solution:
    """The values of one joint position at which a factor is zero, for given other positions."""

    angle: sp.Symbol  # or the position of a sliding joint
    values: tuple[sp.Expr, ...]  # angles each with a free integer k [rad]
    real_where: sp.Expr  # the values are real where this is not negative


@dataclass(frozen=True, kw_only=True)
class SingularFamily:
    """One factor of a determinant and its zeros."""

    factor: sp.Expr
    solutions: tuple[Solution, ...]  # one for every joint in it that can be solved for


def singular_families(determinant: sp.Expr, q: tuple[sp.Symbol, ...]) -> tuple[SingularFamily, ...]:
    """Find the zeros of every factor of a determinant that depends on the joints, simplest first.

    A factor is solved for a joint if it is of degree one in the sine and cosine of its angle, or
    in the position of a sliding joint: report A, eq. 17 and appendix; report B, 1.6.
    """
    factors = [
        factor.base if factor.is_Pow and factor.exp.is_Integer else factor
        for factor in sp.Mul.make_args(determinant)
        if factor.free_symbols & set(q)
    ]
    factors.sort(key=sp.count_ops)
    return tuple(
        SingularFamily(
            factor=factor,
            solutions=tuple(
                solution
                for joint in q
                if factor.has(joint) and (solution := _solve(factor, joint)) is not None
            ),
        )
        for factor in factors
    )


def _solve(factor: sp.Expr, joint: sp.Symbol) -> Solution | None:
    """Solve a factor for a turning or a sliding joint; None where its degree is not one."""
    expanded = sp.expand(sp.expand_trig(factor))
    if not any(wave.has(joint) for wave in factor.atoms(sp.sin, sp.cos)):
        slope, rest = expanded.coeff(joint, 1), expanded.coeff(joint, 0)
        if sp.expand(expanded - slope * joint - rest) != 0:
            return None
        values = (tidy(-rest) / tidy(slope),)
        return Solution(angle=joint, values=values, real_where=sp.Integer(1))
    a, b = expanded.coeff(sp.cos(joint)), expanded.coeff(sp.sin(joint))
    c = sp.expand(expanded - a * sp.cos(joint) - b * sp.sin(joint))
    return None if any(part.has(joint) for part in (a, b, c)) else solve_for(factor, joint)


def solve_for(factor: sp.Expr, angle: sp.Symbol) -> Solution:
    """Solve ``a cos(x) + b sin(x) + c = 0`` by the tangent of the half angle.

    With ``t = tan(x/2)`` it is ``(c - a) t^2 + 2 b t + (c + a) = 0``, and ``x = 2 atan(t)``. Where
    ``c = a`` for all values of the other angles, ``x = pi`` is another root. Any number of turns
    is added to the roots; if they are all the multiples of pi, they are one value.
    """
    expanded = sp.expand(sp.expand_trig(factor))
    a, b = expanded.coeff(sp.cos(angle)), expanded.coeff(sp.sin(angle))
    c = expanded - sp.expand(a * sp.cos(angle) + b * sp.sin(angle))
    t = sp.Symbol("t", real=True)
    roots = [2 * sp.atan(root) for root in sp.solve((c - a) * t**2 + 2 * b * t + c + a, t)]
    if sp.expand(c - a) == 0:
        roots.append(sp.pi)
    return Solution(
        angle=angle,
        values=_with_turns(roots),
        real_where=sp.factor(pythagoras(a**2 + b**2 - c**2)),
    )


def _with_turns(roots: list[sp.Expr]) -> tuple[sp.Expr, ...]:
    if set(roots) == {sp.Integer(0), sp.pi}:
        return (sp.pi * ANY_INTEGER,)
    return tuple(root + 2 * sp.pi * ANY_INTEGER for root in roots)


class Derivation:
    """The matrices of a table, simplified, each derived when first used.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which m rows move.
    task : sequence of int, optional
        Rows of the Jacobian (0-2 angular, 3-5 translational) that make it square; by default the
        translational rows that are not zero, or else all rows that are not zero, if they are m.
    """

    def __init__(self, rows: Sequence[Row], task: Sequence[int] | None = None) -> None:
        self.chain: SymbolicChain = symbolic_chain(rows)
        self._chosen = task

    @cached_property
    def neighbours(self) -> tuple[sp.Matrix, ...]:
        """Frame i in frame i - 1, each (4, 4)."""
        return tuple(map(row_transform, self.chain.rows))

    def in_base(self, frame: int) -> sp.Matrix:
        """Frame, from 1, in frame 0, (4, 4)."""
        return base_transforms(self.chain)[frame - 1].applyfunc(tidy)

    @cached_property
    def to_base(self) -> tuple[sp.Matrix, ...]:
        """Frame i in frame 0, each (4, 4)."""
        return tuple(X_BC.applyfunc(tidy) for X_BC in base_transforms(self.chain))

    @cached_property
    def _direct(self) -> sp.Matrix:
        return direct_jacobian(self.chain)

    @cached_property
    def spatial_jacobian(self) -> sp.Matrix:
        """Jacobian by the direct method, (6, m), rotation first."""
        return self._direct.applyfunc(tidy)

    @cached_property
    def difference(self) -> sp.Matrix:
        """Direct minus indirect Jacobian, (6, m)."""
        return (self._direct - indirect_jacobian(self.chain)).applyfunc(normal_form)

    @cached_property
    def task(self) -> tuple[int, ...]:
        """Rows of the square Jacobian; empty if there is no square one."""
        if self._chosen is not None:
            return tuple(self._chosen)
        moved = [row for row in range(6) if not self.spatial_jacobian[row, :].is_zero_matrix]
        for rows in ([row for row in moved if row >= 3], moved):
            if len(rows) == len(self.chain.q):
                return tuple(rows)
        return ()

    @cached_property
    def jacobian(self) -> sp.Matrix:
        """Square Jacobian: the task's rows, the first joints' columns."""
        rows = self._direct.extract(list(self.task), list(range(len(self.task))))
        return rows.applyfunc(tidy)

    @cached_property
    def determinant(self) -> sp.Expr:
        """Determinant of the square Jacobian, factored."""
        return tidy(self.jacobian.det())

    @cached_property
    def expanded_determinant(self) -> sp.Expr:
        """The determinant in single angles, multiplied out."""
        return sp.factor(normal_form(self.determinant))

    @cached_property
    def inverse(self) -> sp.Matrix:
        """Inverse of the square Jacobian."""
        return (self.jacobian.adjugate().applyfunc(tidy) / self.determinant).applyfunc(sp.factor)

    @cached_property
    def families(self) -> tuple[SingularFamily, ...]:
        """Where the determinant is zero."""
        return singular_families(self.determinant, self.chain.q)
