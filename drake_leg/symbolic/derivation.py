"""All that a report derives of a robot, derived from its Khalil rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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


@dataclass(frozen=True, kw_only=True)
class Derivation:
    """Transforms, Jacobian, determinant and singularities, each as short as it gets."""

    chain: SymbolicChain
    neighbours: tuple[sp.Matrix, ...]  # frame i in frame i - 1, (4, 4)
    to_base: tuple[sp.Matrix, ...]  # frame i in frame 0, (4, 4)
    jacobian: sp.Matrix  # of the task's velocities, square
    difference: sp.Matrix  # direct minus indirect Jacobian, (6, m)
    determinant: sp.Expr  # of the task's Jacobian, factored
    families: tuple[SingularFamily, ...]


def derive(rows: Sequence[Row], task: Sequence[int]) -> Derivation:
    """Derive a robot's matrices.

    Parameters
    ----------
    task : (n,) sequence of int
        Rows of the Jacobian (0-2 angular, 3-5 translational) that the task is made of; its
        columns are the first n joints.

    References
    ----------
    Report A, section 2 and appendix; report B, sections 1 and 2.
    """
    chain = symbolic_chain(rows)
    direct, indirect = direct_jacobian(chain), indirect_jacobian(chain)
    jacobian = direct.extract(list(task), list(range(len(task)))).applyfunc(tidy)
    determinant = tidy(jacobian.det())
    return Derivation(
        chain=chain,
        neighbours=tuple(row_transform(row) for row in chain.rows),
        to_base=tuple(X_BC.applyfunc(tidy) for X_BC in base_transforms(chain)),
        jacobian=jacobian,
        difference=(direct - indirect).applyfunc(normal_form),
        determinant=determinant,
        families=singular_families(determinant, chain.q),
    )
