"""What a printed matrix claims to be, and what is right: in numbers, and in the print's symbols."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import sympy as sp
from sympy.printing.str import StrPrinter

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.feet import random_configurations
from drake_leg.kinematics.khalil import Array, jacobian, moving_rows
from drake_leg.lab.grader.definitions import Cell, Names, Reader
from drake_leg.lab.grader.matrix_text import Kind, read_name
from drake_leg.lab.grader.printed import Printed
from drake_leg.robot.robot import JointType, Robot, Row
from drake_leg.symbolic.derivation import direct_jacobian, tidy
from drake_leg.symbolic.formulas import DEGREE
from drake_leg.symbolic.spelling import plain, spelled_as
from drake_leg.symbolic.table import SymbolicTable, row_transform, table_of_rows

POSITION, PLANAR = (3, 4, 5), (3, 4, 2)  # rows x, y, z; x, y, yaw
FIRST_LENGTH = 3  # of a Jacobian's rows, rotation first
# Rows of a Jacobian by their names, rotation first.
JACOBIAN_ROWS = {
    **{"wx": 0, "wy": 1, "wz": 2, "yaw": 2},
    **{"x": 3, "y": 4, "z": 5, "vx": 3, "vy": 4, "vz": 5},
}
# With and without the constant last row; a position may be a row.
_SHAPES: dict[Kind, tuple[tuple[int, int], ...]] = {
    "transform": ((4, 4), (3, 4)),
    "rotation": ((3, 3),),
    "position": ((3, 1), (4, 1), (1, 3), (1, 4)),
}
_ALL_ROWS = (0, 1, 2, 3, 4, 5)
_SAMPLES = 8  # configurations at which a Jacobian's rank is computed
_NEGLIGIBLE = 1e-9  # of a Jacobian's largest entry


@dataclass(frozen=True, kw_only=True)
class Claim:
    """What a matrix is according to its name and rows."""

    name: str  # as printed
    kind: Kind
    frames: tuple[int, int] = (0, 0)  # of a transform: the second in the first
    rows: tuple[int, ...] = ()  # of a Jacobian: indices, rotation first
    shape: tuple[int, int]

    @property
    def is_pose(self) -> bool:
        """Whether it is a transform, a rotation or a position."""
        return self.kind in _SHAPES

    @property
    def lengths(self) -> list[bool]:
        """Which of a Jacobian's rows are lengths."""
        return [row >= FIRST_LENGTH for row in self.rows]


def claim_of(
    name: str, rows: Sequence[str], typed_shape: tuple[int, int], robot: Robot, rows_key: str
) -> Claim:
    """Read what a matrix is; refuse a name without a meaning for this robot.

    ``rows`` are those of a Jacobian, where the print says them; ``rows_key`` is the place for them.
    """
    read = read_name(name)
    if read.kind in _SHAPES:
        if max(read.frames) > len(robot.rows):
            raise InvalidValueError(
                f"{robot.name} has the frames 0 to {len(robot.rows)}; write two of them"
            )
        first, *others = _SHAPES[read.kind]
        shape = typed_shape if typed_shape in others else first
        return Claim(name=name, kind=read.kind, frames=read.frames, shape=shape)
    asked = f"name every row {rows_key}, each one of {', '.join(JACOBIAN_ROWS)}"
    names = [plain(row).replace(" ", "").replace("omega", "w") for row in rows or read.rows]
    if any(row not in JACOBIAN_ROWS for row in names):
        raise InvalidValueError(f"its rows are named {', '.join(rows)}; {asked}")
    indices = tuple(JACOBIAN_ROWS[row] for row in names)
    if read.kind == "determinant":
        indices = indices or task_rows(robot, 3) or POSITION
        if len(indices) > len(robot.moving):
            raise InvalidValueError(
                f"a determinant of {len(indices)} rows, and {robot.name} has {len(robot.moving)} "
                f"joint positions; name as many rows {rows_key}"
            )
        return Claim(name=name, kind="determinant", rows=indices, shape=(1, 1))
    count, columns = typed_shape
    if not indices and count not in (len(POSITION), len(_ALL_ROWS)):
        raise InvalidValueError(f"it does not say what its rows are; {asked}")
    if not indices:
        six = count == len(_ALL_ROWS)
        indices = _ALL_ROWS if six else task_rows(robot, columns) or POSITION
    if not fewest_columns(robot, indices) <= columns <= len(robot.moving):
        columns = len(robot.moving)
    return Claim(name=name, kind="jacobian", rows=indices, shape=(len(indices), columns))


def task_rows(robot: Robot, columns: int) -> tuple[int, ...] | None:
    """Choose three rows of a Jacobian's first columns: x, y, z, or x, y, yaw if z does not move.

    None if both are singular everywhere.
    """
    Jv_BF = _jacobians(robot)[..., :columns]
    rank = min(len(POSITION), Jv_BF.shape[-1])
    for rows in (POSITION, PLANAR):
        part = Jv_BF[:, list(rows)]
        if np.linalg.matrix_rank(part, tol=_NEGLIGIBLE * np.abs(part).max()).max() == rank:
            return rows
    return None


def fewest_columns(robot: Robot, rows: tuple[int, ...]) -> int:
    """Count the columns of a Jacobian up to the last one that is not zero in some rows."""
    Jv_BF = np.abs(_jacobians(robot)[:, list(rows)])
    moved = np.flatnonzero(Jv_BF.max(axis=(0, 1)) > _NEGLIGIBLE * Jv_BF.max())
    return int(moved.max(initial=-1)) + 1


def _jacobians(robot: Robot) -> Array:
    rng = np.random.default_rng(0)
    return jacobian(robot.rows, random_configurations(robot, _SAMPLES, rng))


# --- in numbers ------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class SampledChain:
    """A Khalil table of n rows, of which m move, at N samples."""

    joints: tuple[JointType, ...]  # of the rows
    d: Array  # (N, n), in any unit of lengths
    alpha: Array  # (N, n) [rad]
    r: Array  # (N, n), without the position of a sliding joint
    theta: Array  # (N, n) [rad], without the position of a turning joint
    q: Array  # (N, m) [rad or the unit of lengths]

    @property
    def moving(self) -> list[int]:
        """The rows that move, counted from 0."""
        return [index for index, joint in enumerate(self.joints) if joint != "fixed"]

    def _positions(self, joint: JointType) -> Array:
        """Spread the positions of turning or of sliding joints over the rows, (N, n)."""
        spread = np.zeros_like(self.theta)
        for column, index in enumerate(self.moving):
            if self.joints[index] == joint:
                spread[:, index] = self.q[:, column]
        return spread

    def about_x(self) -> Array:
        """Every row's turn and shift about x, (N, n, 4, 4)."""
        X = np.broadcast_to(np.eye(4), (*self.alpha.shape, 4, 4)).copy()
        X[..., 1, 1] = X[..., 2, 2] = np.cos(self.alpha)
        X[..., 2, 1] = np.sin(self.alpha)
        X[..., 1, 2] = -X[..., 2, 1]
        X[..., 0, 3] = self.d
        return X

    def about_z(self) -> Array:
        """Every row's turn and shift about z, with the joint's position, (N, n, 4, 4)."""
        theta = self.theta + self._positions("revolute")
        X = np.broadcast_to(np.eye(4), (*theta.shape, 4, 4)).copy()
        X[..., 0, 0] = X[..., 1, 1] = np.cos(theta)
        X[..., 1, 0] = np.sin(theta)
        X[..., 0, 1] = -X[..., 1, 0]
        X[..., 2, 3] = self.r + self._positions("prismatic")
        return X

    def steps(self) -> Array:
        """Transforms from every row's frame to the frame before it, (N, n, 4, 4).

        ``X = Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``.
        """
        return self.about_x() @ self.about_z()

    def frames(self) -> Array:
        """Poses of the frames 0 to n in the base, (N, n + 1, 4, 4)."""
        return running_products(self.steps())

    def jacobian(self) -> Array:
        """Jacobian of the last frame by the direct method, rotation first, (N, 6, m)."""
        X_B = self.frames()
        return twists(self, X_B[:, 1:], X_B[:, -1, :3, 3])


def chain_of(rows: Sequence[Row], q: Array, meters: float) -> SampledChain:
    """Write a robot's table for samples of its joint positions (N, m) [rad or m].

    The chain's unit of lengths has so many ``meters``.
    """

    def column(name: str, unit: float) -> Array:
        return np.tile([getattr(row, name) / unit for row in rows], (len(q), 1))

    sliding = [rows[index].joint == "prismatic" for index in moving_rows(rows)]
    return SampledChain(
        joints=tuple(row.joint for row in rows),
        d=column("d", meters),
        alpha=column("alpha", 1.0),
        r=column("r", meters),
        theta=column("theta", 1.0),
        q=q / np.where(sliding, meters, 1.0),
    )


def running_products(steps: Array) -> Array:
    """Multiply transforms from the left: 1, X1, X1 X2, ..., (N, n + 1, 4, 4)."""
    products = [np.broadcast_to(np.eye(4), (*steps.shape[:1], 4, 4))]
    for index in range(steps.shape[1]):
        products.append(products[-1] @ steps[:, index])
    return np.stack(products, axis=1)


def twists(chain: SampledChain, axes: Array, point: Array) -> Array:
    """Twist at a point P (N, 3) per unit of each joint's rate, (N, 6, m), rotation first.

    ``[z; z x OP]``, or ``[0; z]`` for a sliding joint, which turns nothing; ``axes`` (N, n, 4, 4)
    are the frames about or along whose z axes the rows move.
    """
    columns = []
    for index in chain.moving:
        z, p = axes[:, index, :3, 2], axes[:, index, :3, 3]
        turns = chain.joints[index] == "revolute"
        halves = (z, np.cross(z, point - p)) if turns else (np.zeros_like(z), z)
        columns.append(np.concatenate(halves, axis=-1))
    return np.stack(columns, axis=-1)


def right_values(claim: Claim, chain: SampledChain) -> Array:
    """Evaluate what is claimed at N samples, (N, r, c), in the chain's unit of lengths."""
    if claim.is_pose:
        return claimed_part(claim, between(chain.frames(), *claim.frames))
    return claimed_part(claim, chain.jacobian())


def between(X_B: Array, first: int, last: int) -> Array:
    """Pose of one frame in another, (N, 4, 4), of the poses of all frames in the base."""
    relative: Array = np.linalg.inv(X_B[:, first]) @ X_B[:, last]
    return relative


def claimed_part(claim: Claim, whole: Array) -> Array:
    """Extract what is claimed, (N, r, c), from a pose or a (6, m) Jacobian, rotation first."""
    if claim.kind == "position":
        return whole[:, : max(claim.shape), 3].reshape(-1, *claim.shape)
    if claim.is_pose:
        return whole[:, : claim.shape[0], : claim.shape[1]]
    Jv_BF = whole[:, list(claim.rows)]
    if claim.kind == "jacobian":
        return Jv_BF[..., : claim.shape[1]]
    determinants: Array = np.linalg.det(Jv_BF[..., : len(claim.rows)])
    return determinants[:, np.newaxis, np.newaxis]


def scales(claim: Claim, length: float) -> Array:
    """Scale of the entries of a claim, (r, c): 1 in a rotation, or a power of a length."""
    scale = np.ones(claim.shape)
    if claim.kind == "transform":
        scale[:3, 3] = length
    elif claim.kind == "position":
        scale[:] = length
    elif claim.kind == "jacobian":
        scale[claim.lengths] = length
    else:
        scale[:] = length ** sum(claim.lengths)
    return scale


# --- in symbols ------------------------------------------------------------------------------


class RightForms:
    """Writes right entries for one print."""

    def __init__(self, robot: Robot, printed: Printed, reader: Reader, names: Names) -> None:
        self._chain = table_of_rows(robot.rows)
        self._meters = printed.meters
        self._symbols = printed.symbols
        self._names = {
            symbol: names[Cell(index, column)]
            for index, row in enumerate(self._chain.rows)
            for column in ("d", "alpha", "r", "theta")
            for symbol in getattr(row, column).free_symbols & set(self._chain.values)
            if Cell(index, column) in names
        }
        spelling = " ".join(printed.joints.values())
        self._joints = {
            self._chain.q[index]: _evaluated(formula, spelling)
            for index, formula in reader.joints.items()
        }

    def text(self, claim: Claim, row: int, column: int, spelling: str) -> str:
        """Write the right entry of a row and column, from 0.

        ``spelling`` is all of the matrix's text: angles and lengths are named as there.
        """
        entry = tidy(_right_matrix(claim, self._chain)[row, column])
        names = " ".join(self._symbols) if claim.kind == "determinant" else spelling
        entry = entry.subs(self._lengths(names)).subs(self._joints)
        text = _Decimals().doprint(entry.replace(_is_decimal, lambda number: sp.Float(number)))
        return spelled_as(spelling, text)

    def determinant_factors(
        self, rows: Sequence[int], spelling: str
    ) -> list[tuple[str, Callable[[Mapping[str, Array]], Array]]]:
        """Factor the determinant of some rows, and as many columns, of the Jacobian.

        Every factor that depends on a joint: where it is zero, as text, and its values at named
        variables q1, ... Where a factor is zero, the robot is singular.
        """
        chain = self._chain
        factors = sp.Mul.make_args(tidy(_determinant(chain, rows)))
        found = [f for f in factors if f.free_symbols & set(chain.q)]
        found.sort(key=sp.count_ops)
        lengths = {
            symbol: sp.Symbol(self._names[symbol])
            if symbol in self._names
            else sp.Float(f"{value / self._meters:.9g}")
            for symbol, value in chain.values.items()
        }
        texts = (_zeros_text(factor.subs(lengths)) for factor in found)
        return [
            (spelled_as(spelling, text), _values(factor, chain))
            for text, factor in zip(texts, found, strict=True)
        ]

    def _lengths(self, spelling: str) -> dict[sp.Symbol, sp.Expr]:
        """Write the table's lengths with the print's names, or as numbers."""
        spelled = re.sub(r"[_{}\\]", "", spelling.casefold())
        named = any(plain(name) in spelled for name in self._symbols)
        return {
            symbol: sp.Symbol(self._names[symbol], positive=True)
            if named and symbol in self._names
            else self._number(symbol.name, value)
            for symbol, value in self._chain.values.items()
        }

    def _number(self, name: str, value: float) -> sp.Expr:
        if name.startswith(("alpha", "theta")):
            return sp.Float(value)
        number = Fraction(value / self._meters).limit_denominator(10**6)
        return sp.Rational(number.numerator, number.denominator)


class _Decimals(StrPrinter):  # type: ignore[misc] # SymPy has no types
    """Writes 112.4 and not 112.400000000000."""

    def _print_Float(self, expr: sp.Float) -> str:
        return f"{float(expr):.10g}"


def _is_decimal(expression: sp.Basic) -> bool:
    """Whether an expression is a fraction that is written with a decimal point."""
    return bool(expression.is_Rational and expression.q not in (1, 2))


def _right_matrix(claim: Claim, chain: SymbolicTable) -> sp.Matrix:
    """Derive all entries of a claim, in the chain's symbols."""
    if claim.is_pose:
        pose = _pose(chain, *claim.frames)
        if claim.kind != "position":
            return pose
        return pose[:, 3].T if claim.shape[0] == 1 else pose[:, 3]
    if claim.kind == "determinant":
        return sp.Matrix([[_determinant(chain, claim.rows)]])
    return direct_jacobian(chain).extract(list(claim.rows), list(range(claim.shape[1])))


def _determinant(chain: SymbolicTable, rows: Sequence[int]) -> sp.Expr:
    """Derive the determinant of some rows, and as many columns, of the Jacobian."""
    square = direct_jacobian(chain).extract(list(rows), list(range(len(rows))))
    return square.applyfunc(tidy).det()


def _pose(chain: SymbolicTable, first: int, last: int) -> sp.Matrix:
    """Derive the pose of one frame in another, of a later one in an earlier or the inverse."""
    if first > last:
        there = _pose(chain, last, first)
        R, p = there[:3, :3].T, there[:3, 3]
        return sp.Matrix([[R, -R * p], [sp.zeros(1, 3), sp.ones(1, 1)]])
    product = sp.eye(4)
    for row in chain.rows[first:last]:
        product = product * row_transform(row)
    return product


def _evaluated(part: sp.Expr, spelling: str) -> sp.Expr:
    """Evaluate a formula as it was printed, its symbols written as in the print."""
    if part.is_Float:
        return sp.Rational(repr(float(part)))
    if part == DEGREE:
        return sp.pi / 180
    if part.is_Symbol:
        found = re.search(rf"\b{part.name}\b", spelling, re.IGNORECASE)
        return sp.Symbol(found[0] if found else part.name, real=True)
    if part.is_Atom:
        return part
    return part.func(*(_evaluated(argument, spelling) for argument in part.args))


def _zeros_text(factor: sp.Expr) -> str:
    """Say where a factor is zero."""
    text = f"{factor.args[0]} = kπ" if factor.func is sp.sin else f"{factor} = 0"
    return re.sub(r"\d+\.\d+", lambda found: f"{float(found[0]):.9g}", text)


def _values(factor: sp.Expr, chain: SymbolicTable) -> Callable[[Mapping[str, Array]], Array]:
    variables = [f"q{index + 1}" for index in range(len(chain.q))]
    function = sp.lambdify(chain.q, factor.subs(chain.values), "numpy")

    def values(named: Mapping[str, Array]) -> Array:
        zero = np.zeros_like(next(iter(named.values())))
        return np.asarray(function(*(named.get(name, zero) for name in variables)))

    return values
