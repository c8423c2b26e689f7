"""What follows from a Khalil table: transforms, Jacobians, determinant, singular postures."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import sympy as sp

from drake_leg.robot import Row
from drake_leg.symbolic.chain import (
    SymbolicChain,
    base_transforms,
    direct_jacobian,
    indirect_jacobian,
    row_transform,
    symbolic_chain,
)
from drake_leg.symbolic.singularities import SingularFamily, singular_families
from drake_leg.symbolic.trigonometry import normal_form, tidy


class Derivation:
    """A table's matrices, each as short as it gets, and derived when it is first asked for.

    Parameters
    ----------
    rows : sequence of Row
        The table, of which m rows move.
    task : sequence of int, optional
        Rows of the Jacobian (0-2 angular, 3-5 translational) that make it square; by default those
        that translate, or all that move at all, if they are m.
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
        """By the direct method, (6, m)."""
        return self._direct.applyfunc(tidy)

    @cached_property
    def difference(self) -> sp.Matrix:
        """Direct minus indirect Jacobian, (6, m)."""
        return (self._direct - indirect_jacobian(self.chain)).applyfunc(normal_form)

    @cached_property
    def task(self) -> tuple[int, ...]:
        """Rows of the square Jacobian; none if no rows are as many as the joints."""
        if self._chosen is not None:
            return tuple(self._chosen)
        moved = [row for row in range(6) if not self.spatial_jacobian[row, :].is_zero_matrix]
        for rows in ([row for row in moved if row >= 3], moved):
            if len(rows) == len(self.chain.q):
                return tuple(rows)
        return ()

    @cached_property
    def jacobian(self) -> sp.Matrix:
        """Of the task's velocities over the first joints, square."""
        rows = self._direct.extract(list(self.task), list(range(len(self.task))))
        return rows.applyfunc(tidy)

    @cached_property
    def determinant(self) -> sp.Expr:
        """Of the square Jacobian, factored."""
        return tidy(self.jacobian.det())

    @cached_property
    def expanded_determinant(self) -> sp.Expr:
        """The same in single angles, multiplied out."""
        return sp.factor(normal_form(self.determinant))

    @cached_property
    def inverse(self) -> sp.Matrix:
        """Of the square Jacobian."""
        return (self.jacobian.adjugate().applyfunc(tidy) / self.determinant).applyfunc(sp.factor)

    @cached_property
    def families(self) -> tuple[SingularFamily, ...]:
        """Where the determinant is zero."""
        return singular_families(self.determinant, self.chain.q)
