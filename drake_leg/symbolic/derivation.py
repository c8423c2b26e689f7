"""Derives a Khalil table's transforms, Jacobians, determinant and its zeros, in symbols.

The chain is that of ``kinematics.khalil``, with expressions in place of numbers. ``tidy`` makes a
result readable.
"""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from itertools import accumulate

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from sympy.simplify.fu import TR10i

from drake_leg.kinematics.khalil import Array, one_vector
from drake_leg.robot.robot import JointType, Row

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


# --- the chain in symbols --------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class SymbolicRow:
    """A row of a Khalil table, its joint's position already in ``theta`` or ``r``."""

    joint: JointType
    d: sp.Expr
    alpha: sp.Expr
    r: sp.Expr
    theta: sp.Expr


@dataclass(frozen=True, kw_only=True)
class SymbolicChain:
    """A Khalil table in symbols."""

    rows: tuple[SymbolicRow, ...]
    q: tuple[sp.Symbol, ...]  # joint positions, q1 ... qm
    values: Mapping[sp.Symbol, float]  # of the other symbols [m or rad]

    @property
    def legend(self) -> str:
        """The numbers of the letters, as in ``l1 = 0.25 m``."""
        return ", ".join(
            f"{symbol} = {value:.9g} {'m' if symbol.is_positive else 'rad'}"
            for symbol, value in self.values.items()
        )


def symbolic_chain(rows: Sequence[Row]) -> SymbolicChain:
    """Write a table in symbols, whose numbers ``values`` keeps.

    Lengths along x that are not zero become l1, l2, ...; those along z become h, or h1, h2, ...
    where there are several; a negative length becomes -l. Angles that are simple fractions of pi
    become exact, others symbols with the row's number, alpha3 or theta5.
    """
    values: dict[sp.Symbol, float] = {}
    q: list[sp.Symbol] = []
    along_x = _names("l", [row.d for row in rows])
    along_z = _names("h", [row.r for row in rows])
    if len(along_z) == 1:
        along_z = dict.fromkeys(along_z, "h")
    symbolic = []
    for index, row in enumerate(rows):
        r = _length(along_z.get(index, ""), row.r, values)
        theta = _angle(f"theta{index + 1}", row.theta, values)
        if row.joint != "fixed":
            q.append(sp.Symbol(f"q{len(q) + 1}", real=True))
            r, theta = (r, theta + q[-1]) if row.joint == "revolute" else (r + q[-1], theta)
        symbolic.append(
            SymbolicRow(
                joint=row.joint,
                d=_length(along_x.get(index, ""), row.d, values),
                alpha=_angle(f"alpha{index + 1}", row.alpha, values),
                r=r,
                theta=theta,
            )
        )
    return SymbolicChain(rows=tuple(symbolic), q=tuple(q), values=values)


def _names(letter: str, lengths: Sequence[float]) -> dict[int, str]:
    """Number the lengths that are not zero: index -> name."""
    present = [index for index, length in enumerate(lengths) if length != 0.0]
    return {index: f"{letter}{number}" for number, index in enumerate(present, start=1)}


def _length(name: str, value: float, values: dict[sp.Symbol, float]) -> sp.Expr:
    if value == 0.0:
        return sp.Integer(0)
    symbol = sp.Symbol(name, positive=True)
    values[symbol] = abs(value)
    return symbol if value > 0.0 else -symbol


def _angle(name: str, value: float, values: dict[sp.Symbol, float]) -> sp.Expr:
    turns = Fraction(value / math.pi).limit_denominator(360)
    if abs(float(turns) * math.pi - value) <= 2.0 * sys.float_info.epsilon * abs(value):
        return sp.Rational(turns.numerator, turns.denominator) * sp.pi
    symbol = sp.Symbol(name, real=True)
    values[symbol] = value
    return symbol


def row_transform(row: SymbolicRow) -> sp.Matrix:
    """Transform from a row's frame to the frame before it, ``X_PC``, (4, 4).

    ``X = Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``: report A, eq. 1.
    """
    c, s = sp.cos(row.theta), sp.sin(row.theta)
    ca, sa = sp.cos(row.alpha), sp.sin(row.alpha)
    return sp.Matrix(
        [
            [c, -s, 0, row.d],
            [s * ca, c * ca, -sa, -row.r * sa],
            [s * sa, c * sa, ca, row.r * ca],
            [0, 0, 0, 1],
        ]
    )


def base_transforms(chain: SymbolicChain) -> tuple[sp.Matrix, ...]:
    """Transforms from every row's frame to the base, each (4, 4); the last is the foot's."""
    return tuple(accumulate(map(row_transform, chain.rows), operator.mul))


def direct_jacobian(chain: SymbolicChain) -> sp.Matrix:
    """Jacobian by the direct method, one joint's contribution per column, (6, m), rotation first.

    ``[w_BF; v_BF] = Jv_BF @ qdot``; a revolute joint adds ``[z; z x OF]``, a prismatic one
    ``[0; z]``: report A, eq. 9-15.
    """
    transforms = base_transforms(chain)
    p_BF = transforms[-1][:3, 3]
    columns = []
    for row, X_BC in zip(chain.rows, transforms, strict=True):
        z_B, p_BC = X_BC[:3, 2], X_BC[:3, 3]
        if row.joint == "revolute":
            columns.append(sp.Matrix([*z_B, *z_B.cross(p_BF - p_BC)]))
        elif row.joint == "prismatic":
            columns.append(sp.Matrix([0, 0, 0, *z_B]))
    return sp.Matrix.hstack(sp.zeros(6, 0), *columns)


def indirect_jacobian(chain: SymbolicChain) -> sp.Matrix:
    """Jacobian by the indirect method, differentiating the foot's pose, (6, m), rotation first.

    Its columns are ``[w; dp_BF/dqi]``, with ``w`` the axis of the skew matrix
    ``dR_BF/dqi R_BF'``: report A, appendix.
    """
    X_BF = base_transforms(chain)[-1]
    R_BF, p_BF = X_BF[:3, :3], X_BF[:3, 3]
    columns = []
    for position in chain.q:
        spin = R_BF.diff(position) * R_BF.T
        columns.append(sp.Matrix([spin[2, 1], spin[0, 2], spin[1, 0], *p_BF.diff(position)]))
    return sp.Matrix.hstack(sp.zeros(6, 0), *columns)


def evaluator(chain: SymbolicChain, expression: sp.Matrix | Sequence[sp.Matrix]) -> Function:
    """Compile a matrix, or several alike, to a NumPy function of q (m,), with the table's numbers.

    The function raises ``InvalidValueError`` if q is not m finite numbers.
    """
    symbols, numbers = list(chain.values), list(chain.values.values())
    compiled = sp.lambdify([list(chain.q), symbols], expression, "numpy", cse=True)

    def evaluate(q: ArrayLike) -> Array:
        positions = one_vector("q", q, len(chain.q)).tolist()
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
    chain = symbolic_chain(rows)
    transforms = evaluator(chain, list(map(row_transform, chain.rows)))
    return lambda q: reduce(np.matmul, transforms(q))


def jacobian_function(rows: Sequence[Row]) -> Function:
    """Derive a chain's Jacobian by the indirect method, as a function of q (m,) [rad or m].

    It returns Jv_BF (6, m), rotation first, and shares no formula with ``kinematics.khalil``. A
    joint's position is in one row only, so that ``dX_BF/dqi`` is the product of the rows with that
    row's derivative in its place.
    """
    chain = symbolic_chain(rows)
    X = list(map(row_transform, chain.rows))
    moving = [index for index, row in enumerate(chain.rows) if row.joint != "fixed"]
    dX = [X[index].diff(position) for index, position in zip(moving, chain.q, strict=True)]
    matrices = evaluator(chain, X + dX)

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
