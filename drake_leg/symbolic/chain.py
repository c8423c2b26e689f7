"""The kinematics of a serial chain in symbols: transforms, foot, and the Jacobian by two methods.

The same as ``kinematics.khalil``, with expressions in place of numbers. Nothing is simplified, so
that a chain of six axes takes a second; ``notation.tidy`` makes a result readable.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import accumulate

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from drake_leg.kinematics.khalil import Array, one_vector
from drake_leg.robot.robot import JointType, Row

Function = Callable[[ArrayLike], Array]  # of the joint positions


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
    X_BC = sp.eye(4)
    transforms = []
    for row in chain.rows:
        X_BC = X_BC * row_transform(row)
        transforms.append(X_BC)
    return tuple(transforms)


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
