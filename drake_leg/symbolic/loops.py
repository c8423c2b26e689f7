"""Torques of the motors of a robot with closed loops, from those of its cut tree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.geometry import SPATIAL, Poses, jacobian_entries, written_out
from drake_leg.symbolic.mechanism import Mechanism
from drake_leg.symbolic.programs import Steps
from drake_leg.symbolic.table import SymbolicTable

W_Z, V_Z = 2, 5  # rows of a Jacobian that a revolute cut leaves free, and a prismatic one
INDEPENDENT = 1e-6


def motor_torques(frames: Mechanism, torques: sp.Matrix) -> sp.Matrix:
    """Derive what actuated joints supply where the others supply nothing, (actuated, 1).

    ``D_a qdot_a + D_p qdot_p = 0`` keeps the loops closed. By virtual power the motors supply
    ``tau_a - D_a' f`` with ``D_p' f = tau_p``: that is ``tau_a + W' tau_p``, with the Jacobian
    ``W`` of the passive joints by the actuated ones.

    Raises
    ------
    InvalidValueError
        If the loops do not determine the passive joints.
    """
    table = frames.table
    if all(table.rows[number - 1].actuated for number in table.moving):
        return torques  # as in the tree: then no force passes through the cut
    passive = [k for k, n in enumerate(table.moving) if not table.rows[n - 1].actuated]
    active = [k for k in range(len(table.moving)) if k not in passive]
    if not passive:
        return torques
    D = _closure(frames)
    rows = _independent_rows(frames, D, passive)
    if len(rows) < len(passive):
        raise InvalidValueError(
            f"{table.name} has {len(passive)} joints that are not actuated, and its loops "
            f"determine {len(rows)} of them",
            advice="make as many joints actuated as the robot has degrees of freedom",
        )
    forces = _solution(D.extract(rows, passive).T, [torques[k] for k in passive], frames.steps)
    D_a = D.extract(rows, active)
    return sp.Matrix(torques.extract(active, [0]) - D_a.T * sp.Matrix(forces))


def _closure(frames: Mechanism) -> sp.Matrix:
    """Velocity at which the two frames of every cut part, along the first, per joint."""
    table, found = frames.table, []
    for cut, end in table.loops:
        poses = Poses(frames, cut)
        sides = set(table.path(cut)) ^ set(table.path(end))
        apart = jacobian_entries(frames, cut, cut, poses) - jacobian_entries(
            frames, end, cut, poses
        )
        apart = apart[:, -len(table.moving) :]  # a floating base moves both alike
        common = [k for k, number in enumerate(table.moving) if number not in sides]
        for k in common:  # so does a joint before both
            apart[:, k] = sp.zeros(SPATIAL, 1)
        free = V_Z if cut in table.sliding_cuts else W_Z
        if table.rows[cut - 1].joint == "fixed":  # the cut joint is not among the others
            apart.row_del(free)
        found.append(apart.applyfunc(frames.steps.again))
    return sp.Matrix.vstack(sp.zeros(0, len(table.moving)), *found)


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
