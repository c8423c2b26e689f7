"""Where a determinant is zero: its factors, each solved for the joint angles in it."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from drake_leg.symbolic.trigonometry import pythagoras, tidy

ANY_INTEGER = sp.Symbol("k", integer=True)


@dataclass(frozen=True, kw_only=True)
class Solution:
    """The values of one joint position at which a factor is zero, the others as they are."""

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
