"""Derives a Khalil table's transforms, Jacobians, determinant and its zeros, in symbols.

``tidy`` makes a result readable.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import accumulate

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from sympy.simplify.fu import TR10i

from drake_leg.kinematics.khalil import Array, one_vector
from drake_leg.robot.robot import Row
from drake_leg.symbolic.table import (
    SymbolicTable,
    base_transforms,
    row_transform,
    table_of_rows,
)

Function = Callable[[ArrayLike], Array]  # of the joint positions
ANY_INTEGER = sp.Symbol("k", integer=True)


# --- exact rewriting -------------------------------------------------------------------------


def pythagoras(expression: sp.Expr) -> sp.Expr:
    """Expand a polynomial in sines and cosines with ``sin^2 = 1 - cos^2``: no sine has a power."""

    def is_power_of_sine(part: sp.Expr) -> bool:
        return bool(part.is_Pow and part.base.func is sp.sin and part.exp.is_Integer)

    def without_powers(power: sp.Expr) -> sp.Expr:
        pairs, rest = divmod(int(power.exp), 2)
        return (1 - sp.cos(power.base.args[0]) ** 2) ** pairs * power.base**rest

    return sp.expand(sp.expand(expression).replace(is_power_of_sine, without_powers))


def normal_form(expression: sp.Expr) -> sp.Expr:
    """Write an expression in the sines and cosines of single angles, in one way only.

    Two polynomials in sines and cosines of sums of the same angles are equal exactly where their
    normal forms are the same; an identity has the normal form 0.
    """
    return pythagoras(sp.expand_trig(expression))


def tidy(expression: sp.Expr) -> sp.Expr:
    """Make an expression readable: factors, and sums of angles where they are shorter."""
    expanded = pythagoras(expression)
    return min(sp.factor(TR10i(expanded)), sp.factor(expanded), key=sp.count_ops)


# --- the table's functions ----------------------------------------------------------------------


def direct_jacobian(table: SymbolicTable) -> sp.Matrix:
    """Jacobian of the last frame by the direct method, a column per joint, (6, m), rotation first.

    ``[w_BF; v_BF] = Jv_BF @ qdot``; a revolute joint on the way to the frame adds ``[z; z x OF]``,
    a prismatic one ``[0; z]``, another one nothing: report A, eq. 9-15.
    """
    transforms = base_transforms(table)
    path, p_BF = table.path(len(table.rows)), transforms[-1][:3, 3]
    columns = []
    for number in table.moving:
        row, X_BC = table.rows[number - 1], transforms[number - 1]
        z_B, p_BC = X_BC[:3, 2], X_BC[:3, 3]
        if number not in path:
            columns.append(sp.zeros(6, 1))
        elif row.joint == "revolute":
            columns.append(sp.Matrix([*z_B, *z_B.cross(p_BF - p_BC)]))
        else:
            columns.append(sp.Matrix([0, 0, 0, *z_B]))
    return sp.Matrix.hstack(sp.zeros(6, 0), *columns)


def indirect_jacobian(table: SymbolicTable) -> sp.Matrix:
    """Jacobian by the indirect method, differentiating the foot's pose, (6, m), rotation first.

    Its columns are ``[w; dp_BF/dqi]``, with ``w`` the axis of the skew matrix
    ``dR_BF/dqi R_BF'``: report A, appendix.
    """
    X_BF = base_transforms(table)[-1]
    R_BF, p_BF = X_BF[:3, :3], X_BF[:3, 3]
    columns = []
    for position in table.q:
        spin = R_BF.diff(position) * R_BF.T
        columns.append(sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0], *p_BF.diff(position)]))
    return sp.Matrix.hstack(sp.zeros(6, 0), *columns)


def evaluator(table: SymbolicTable, expression: sp.Matrix | Sequence[sp.Matrix]) -> Function:
    """Compile a matrix, or several alike, to a NumPy function of q (m,), with the table's numbers.

    The function raises ``InvalidValueError`` if q is not m finite numbers.
    """
    symbols, numbers = list(table.values), list(table.values.values())
    compiled = sp.lambdify([list(table.q), symbols], expression, "numpy", cse=True)

    def evaluate(q: ArrayLike) -> Array:
        positions = one_vector("q", q, len(table.q)).tolist()
        return np.array(compiled(positions, numbers), dtype=np.float64)

    return evaluate


def evaluate(matrix: sp.Matrix, values: Mapping[str, float]) -> Array:
    """Evaluate a matrix at one set of numbers; ``values`` has its symbols by name."""
    numbers = {symbol: sp.Float(values[symbol.name]) for symbol in matrix.free_symbols}
    return np.array(matrix.xreplace(numbers), dtype=np.float64)


def foot_function(rows: Sequence[Row]) -> Function:
    """Derive a chain's foot: a function of q (m,) [rad or m] returning X_BF (4, 4) [-, m].

    Its rows are multiplied as numbers: as formulas their product grows exponentially.
    """
    table = table_of_rows(rows)
    transforms = evaluator(table, list(map(row_transform, table.rows)))
    return lambda q: reduce(np.matmul, transforms(q))


def jacobian_function(rows: Sequence[Row]) -> Function:
    """Derive a chain's Jacobian by the indirect method, as a function of q (m,) [rad or m].

    It returns Jv_BF (6, m), rotation first, and shares no formula with ``kinematics.khalil``. A
    joint's position is in one row only, so that ``dX_BF/dqi`` is the product of the rows with that
    row's derivative in its place.
    """
    table = table_of_rows(rows)
    X = list(map(row_transform, table.rows))
    moving = [index for index, row in enumerate(table.rows) if row.joint != "fixed"]
    dX = [X[index].diff(position) for index, position in zip(moving, table.q, strict=True)]
    matrices = evaluator(table, X + dX)

    def jacobian(q: ArrayLike) -> Array:
        values, derivatives = np.split(matrices(q), [len(X)])
        before = [np.eye(4), *accumulate(values, np.matmul)]
        after = [np.eye(4), *accumulate(values[::-1], lambda product, row: row @ product)][::-1]
        R_FB = before[-1][:3, :3].T
        columns = np.zeros((6, len(moving)))
        for column, (index, derivative) in enumerate(zip(moving, derivatives, strict=True)):
            dX_BF = before[index] @ derivative @ after[index + 1]
            spin = dX_BF[:3, :3] @ R_FB
            columns[:, column] = spin[2, 1], spin[0, 2], spin[1, 0], *dX_BF[:3, 3]
        return columns

    return jacobian


# --- the derivation --------------------------------------------------------------------------


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
                if factor.has(joint) and (solution := solve_for(factor, joint)) is not None
            ),
        )
        for factor in factors
    )


def solve_for(factor: sp.Expr, joint: sp.Symbol) -> Solution | None:
    """Solve a factor for the position of a sliding joint, or for an angle by ``tan`` of its half.

    With ``t = tan(x/2)``, ``a cos(x) + b sin(x) + c = 0`` is ``(c - a) t^2 + 2 b t + (c + a) = 0``,
    and ``x = 2 atan(t)``. Where ``c = a`` for all values of the other angles, ``x = pi`` is another
    root. Any number of turns is added to the roots; if they are all the multiples of pi, they are
    one value. None where the factor's degree is not one.
    """
    expanded = sp.expand(sp.expand_trig(factor))
    if not any(wave.has(joint) for wave in expanded.atoms(sp.sin, sp.cos)):
        slope, rest = expanded.coeff(joint, 1), expanded.coeff(joint, 0)
        if sp.expand(expanded - slope * joint - rest) != 0:
            return None
        return Solution(angle=joint, values=(tidy(-rest) / tidy(slope),), real_where=sp.Integer(1))
    a, b = expanded.coeff(sp.cos(joint)), expanded.coeff(sp.sin(joint))
    c = sp.expand(expanded - a * sp.cos(joint) - b * sp.sin(joint))
    if any(part.has(joint) for part in (a, b, c)):
        return None
    t = sp.Symbol("t", real=True)
    roots = [2 * sp.atan(root) for root in sp.solve((c - a) * t**2 + 2 * b * t + c + a, t)]
    if sp.expand(c - a) == 0:
        roots.append(sp.pi)
    turns = 2 * sp.pi * ANY_INTEGER
    multiples_of_pi = set(roots) == {sp.Integer(0), sp.pi}
    return Solution(
        angle=joint,
        values=(turns / 2,) if multiples_of_pi else tuple(root + turns for root in roots),
        real_where=sp.factor(pythagoras(a**2 + b**2 - c**2)),
    )


class Derivation:
    """The matrices of a table, simplified, each derived when first used.

    Parameters
    ----------
    table : SymbolicTable or sequence of Row
        The table, of which m rows move.
    task : sequence of int, optional
        Rows of the Jacobian (0-2 angular, 3-5 translational) that make it square; by default the
        translational rows that are not zero, or else all rows that are not zero, if they are m.
    """

    def __init__(
        self, table: SymbolicTable | Sequence[Row], task: Sequence[int] | None = None
    ) -> None:
        self.table = table if isinstance(table, SymbolicTable) else table_of_rows(table)
        self._chosen = task

    @cached_property
    def neighbours(self) -> tuple[sp.Matrix, ...]:
        """Frame i in frame i - 1, each (4, 4)."""
        return tuple(map(row_transform, self.table.rows))

    def in_base(self, frame: int) -> sp.Matrix:
        """Frame, from 1, in frame 0, (4, 4)."""
        return base_transforms(self.table)[frame - 1].applyfunc(tidy)

    @cached_property
    def to_base(self) -> tuple[sp.Matrix, ...]:
        """Frame i in frame 0, each (4, 4)."""
        return tuple(X_BC.applyfunc(tidy) for X_BC in base_transforms(self.table))

    @cached_property
    def _direct(self) -> sp.Matrix:
        return direct_jacobian(self.table)

    @cached_property
    def spatial_jacobian(self) -> sp.Matrix:
        """Jacobian by the direct method, (6, m), rotation first."""
        return self._direct.applyfunc(tidy)

    @cached_property
    def difference(self) -> sp.Matrix:
        """Direct minus indirect Jacobian, (6, m)."""
        return (self._direct - indirect_jacobian(self.table)).applyfunc(normal_form)

    @cached_property
    def task(self) -> tuple[int, ...]:
        """Rows of the square Jacobian; empty if there is no square one."""
        if self._chosen is not None:
            return tuple(self._chosen)
        moved = [row for row in range(6) if not self.spatial_jacobian[row, :].is_zero_matrix]
        for rows in ([row for row in moved if row >= 3], moved):
            if len(rows) == len(self.table.q):
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
        return singular_families(self.determinant, self.table.q)
