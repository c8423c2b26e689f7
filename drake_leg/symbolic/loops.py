"""How the joints of a robot with closed loops follow its actuated ones, from the cut tree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.geometry import SPATIAL, Poses, jacobian_entries, written_out
from drake_leg.symbolic.mechanism import ORIGIN, Mechanism, Motion
from drake_leg.symbolic.programs import Steps
from drake_leg.symbolic.table import SymbolicTable

W_Z, V_Z = 2, 5  # rows of a Jacobian that a revolute cut leaves free, and a prismatic one
INDEPENDENT = 1e-6


class Closure:
    """How the passive joints of a robot with closed loops follow the actuated ones.

    The two frames of every cut part at ``D qdot``, which is 0 where the loops are closed, and so is
    its rate. There ``qdot = W qdot_a`` and ``qddot = W qddot_a + b``.

    Raises
    ------
    InvalidValueError
        If the loops do not determine the passive joints.
    """

    def __init__(self, frames: Mechanism) -> None:
        table = frames.table
        self._frames = frames
        actuated = [table.rows[number - 1].actuated for number in table.moving]
        self.passive = [k for k, has_motor in enumerate(actuated) if not has_motor]
        self.active = [k for k, has_motor in enumerate(actuated) if has_motor]
        self._cuts = [_Cut(frames, cut, end) for cut, end in table.loops]
        D = sp.Matrix.vstack(sp.zeros(0, len(actuated)), *(cut.parting for cut in self._cuts))
        self._rows = _independent_rows(frames, D, self.passive)
        if len(self._rows) < len(self.passive):
            raise InvalidValueError(
                f"{table.name} has {len(self.passive)} joints that are not actuated, and its loops "
                f"determine {len(self._rows)} of them",
                advice="make as many joints actuated as the robot has degrees of freedom",
            )
        self._D_a, self._D_p = (D.extract(self._rows, of) for of in (self.active, self.passive))

    def motors(self, torques: sp.Matrix) -> sp.Matrix:
        """What actuated joints supply where the others supply nothing, (actuated, 1): W' tau.

        By virtual power it is ``tau_a - D_a' f`` with ``D_p' f = tau_p``.
        """
        forces = _solution(self._D_p.T, [torques[k] for k in self.passive], self._frames.steps)
        return sp.Matrix(torques.extract(self.active, [0]) - self._D_a.T * sp.Matrix(forces))

    def W(self) -> sp.Matrix:
        """Rates of all joints per rate of the actuated ones, (joints, actuated)."""
        W = sp.zeros(len(self.active) + len(self.passive), len(self.active))
        for column, joint in enumerate(self.active):
            W[joint, column] = 1
            rates = _solution(self._D_p, list(-self._D_a[:, column]), self._frames.steps)
            for passive, rate in zip(self.passive, rates, strict=True):
                W[passive, column] = rate
        return W

    def bias(self, motion: Motion) -> list[sp.Expr]:
        """Accelerations of all joints where the actuated ones have none: b.

        ``motion`` is that without accelerations of joints.
        """
        drift = sp.Matrix.vstack(*(cut.drift(motion) for cut in self._cuts))
        right = [-drift[row] for row in self._rows]
        b = [sp.Integer(0)] * (len(self.active) + len(self.passive))
        for joint, rate in zip(
            self.passive, _solution(self._D_p, right, self._frames.steps), strict=True
        ):
            b[joint] = rate
        return b


def closure_of(frames: Mechanism) -> Closure | None:
    """Return how joints follow others; None where none does.

    Where all joints are actuated, they may move as in the tree: no force passes through the cut.
    """
    table = frames.table
    if not table.loops or all(table.rows[number - 1].actuated for number in table.moving):
        return None
    return Closure(frames)


class _Cut:
    """The two frames of a cut: how fast they part, along the first, and how that changes."""

    def __init__(self, frames: Mechanism, cut: int, end: int) -> None:
        table = frames.table
        self._frames, self._cut, self._end = frames, cut, end
        self._poses = Poses(frames, cut)
        first = jacobian_entries(frames, cut, cut, self._poses)
        second = jacobian_entries(frames, end, cut, self._poses)
        self._slides = cut in table.sliding_cuts
        self._arm = ORIGIN  # from the second frame to the first
        if self._slides:
            self._arm = -self._poses.p[end]
            for k in range(second.cols):
                second[3:, k] += second[:3, k].cross(self._arm)
        apart = (first - second)[:, -len(table.moving) :]  # a floating base moves both alike
        sides = set(table.path(cut)) ^ set(table.path(end))
        for k, number in enumerate(table.moving):
            if number not in sides:  # so does a joint before both
                apart[:, k] = sp.zeros(SPATIAL, 1)
        apart = apart.applyfunc(frames.steps.again)
        # The cut joint moves one row, unless it is among the others.
        self._free = None
        if table.rows[cut - 1].joint == "fixed":
            self._free = V_Z if self._slides else W_Z
        self._along = ORIGIN
        if self._free is not None:
            speed = (apart[self._free, :] * sp.Matrix(frames.qdot))[0]
            self._along = sp.Matrix([0, 0, speed])
        self.parting = self._constrained(apart)

    def _constrained(self, matrix: sp.Matrix) -> sp.Matrix:
        if self._free is None:
            return matrix
        kept = [row for row in range(SPATIAL) if row != self._free]
        return matrix.extract(kept, list(range(matrix.cols)))

    def drift(self, motion: Motion) -> sp.Matrix:
        """``dD/dt qdot`` where the loop is closed and the joints keep their speed."""
        name = self._frames.steps.again
        R = self._poses.R[self._end]
        w = motion.w[self._cut]
        turning = (R * motion.wd[self._end]).applyfunc(name)
        angular = motion.wd[self._cut] - turning
        linear = motion.vd[self._cut] - (R * motion.vd[self._end]).applyfunc(name)
        along = self._along.applyfunc(name)
        if self._slides:
            linear = linear - turning.cross(self._arm) - w.cross(w.cross(self._arm) + 2 * along)
        else:
            angular = angular - w.cross(along)
        return self._constrained(sp.Matrix.vstack(angular, linear)).applyfunc(name)


def _independent_rows(frames: Mechanism, D: sp.Matrix, passive: Sequence[int]) -> list[int]:
    """Choose rows that determine the passive joints, for positions and lengths at random."""
    rows = [i for i in range(D.rows) if any(D[i, k] != 0 for k in passive)]
    if len(rows) <= len(passive):
        return rows
    matrix = written_out(frames, D.extract(rows, list(passive)))
    symbols = sorted(matrix.free_symbols, key=str)
    numbers = np.random.default_rng(0).uniform(0.3, 1.2, len(symbols))
    value = np.array(sp.lambdify(symbols, matrix, "numpy")(*numbers), dtype=np.float64)
    chosen: list[int] = []
    for i in range(len(rows)):
        if np.linalg.matrix_rank(value[[*chosen, i]], tol=INDEPENDENT) > len(chosen):
            chosen.append(i)
    return [rows[i] for i in chosen]


def _solution(A: sp.Matrix, right: Sequence[sp.Expr], steps: Steps) -> list[sp.Expr]:
    """Solve linear equations: those with a coefficient 1 first, the others by Cramer's rule.

    Without pivots that may vanish, nothing is divided by but the determinant.
    """
    size = A.rows
    system = sp.MutableDenseMatrix(A.row_join(sp.Matrix(size, 1, list(right))))
    rows, columns, pivots = list(range(size)), list(range(size)), []
    while pivot := next(((i, j) for i in rows for j in columns if system[i, j] in (1, -1)), None):
        i, j = pivot
        for other in rows:
            if other != i and system[other, j] != 0:
                factor = system[other, j] * system[i, j]
                for k in (*columns, size):
                    system[other, k] = steps.again(system[other, k] - factor * system[i, k])
        rows.remove(i)
        columns.remove(j)
        pivots.append(pivot)
    x: dict[int, sp.Expr] = {}
    if rows:
        core, b = system.extract(rows, columns), system.extract(rows, [size])
        inverse = steps.again(1 / steps.again(core.det(method="laplace")))
        for j, entry in zip(columns, core.adjugate() * b, strict=True):
            x[j] = steps.again(entry * inverse)
    for i, j in reversed(pivots):
        rest = sum((system[i, k] * x[k] for k in x), sp.Integer(0))
        x[j] = steps.again(system[i, j] * (system[i, size] - rest))
    return [x[j] for j in range(size)]


def actuated_joints(table: SymbolicTable) -> list[int]:
    """Numbers of the joints that are actuated, as their positions are counted, from 1."""
    moving = enumerate(table.moving, start=1)
    return [k for k, number in moving if table.rows[number - 1].actuated]
