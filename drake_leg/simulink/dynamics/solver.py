"""Finds the forces that make driven axes follow their motions, and keep loops closed.

``M vdot + h = S^T driving + J^T multipliers`` with ``S vdot`` and ``J vdot`` given: driven axes are
taken out of the equations, and of constraints that are redundant, as in every loop that moves in a
plane, as many are kept as are independent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg.blas import dtrsm, dtrsv
from scipy.linalg.lapack import dgeqp3, dpotrf, dpotrs

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.joints import Joints
from drake_leg.simulink.dynamics.moment import Moment
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.multibody.mass import Array

# Pull driven axes to their motions, and loops together, against the integrator's errors [1/s]. What
# is pulled harder takes more steps.
FOLLOW = 2.0
PULL = 10.0
REDUNDANT = 1e-8  # of the greatest pivot of the constraints, below which one is redundant
LEFT = 1e-6  # of what constraints ask for, that may be left over where they are redundant
POOR = 1e-5  # of the greatest pivot, below which independent constraints are chosen again


@dataclass(frozen=True, eq=False, kw_only=True)
class Solution:
    """What keeps motions and constraints."""

    force: Array  # generalized (nv,), of all that acts on the plant from outside
    driving: Array  # of each motion-driven axis [N*m or N]
    multipliers: Array  # of each row of the constraints


class Constraint:
    """Rows ``J vdot = c`` between bodies."""

    def __len__(self) -> int:
        """Return the number of rows."""
        raise NotImplementedError

    def jacobian(self, moment: Moment) -> Array:
        """Return J, (r, nv)."""
        raise NotImplementedError

    def rows(self, moment: Moment) -> tuple[Array, Array]:
        """Return J (r, nv), and c (r,), which pulls errors to zero."""
        raise NotImplementedError

    def act(self, moment: Moment, multipliers: Array, wrenches: Wrenches) -> None:
        """Add the wrenches of multipliers (r,) on bodies."""
        raise NotImplementedError


class Solver:
    """Solves for the forces of motions and constraints."""

    def __init__(
        self, joints: Joints, constraints: Sequence[Constraint], rotors: Array, nv: int
    ) -> None:
        self._constraints, self._rotors = constraints, rotors
        self._entries = np.array(
            [range(motion.entries.start, motion.entries.stop) for motion in joints.motions],
            dtype=int,
        ).reshape(-1, 3)
        axes = [motion.axis for motion in joints.motions]
        self._A, self._b, self._S = joints.A[axes], joints.b[axes], joints.S[axes]
        single = [place for place, row in enumerate(self._S) if np.count_nonzero(row) == 1]
        self._single = np.array(single, dtype=int)
        self._mixed = np.setdiff1d(np.arange(len(axes)), self._single)
        self._driven = np.array([np.flatnonzero(self._S[place])[0] for place in single], dtype=int)
        self._signs = self._S[self._single, self._driven]
        self._free = np.setdiff1d(np.arange(nv), self._driven)
        self._independent: Array | None = None  # of the rows: those that were chosen last

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to solve."""
        return not (len(self._entries) or self._constraints)

    def solve(self, moment: Moment, force: Array, u: Array) -> Solution:
        """Add the forces of motions and constraints to generalized forces (nv,).

        Raises
        ------
        InvalidValueError
            If free joints move nothing that has mass.
        """
        if self.is_idle:
            return Solution(force=force, driving=np.zeros(0), multipliers=np.zeros(0))
        wanted = self._wanted(moment, u)
        J, c = self._rows(moment, wanted)
        vdot = np.zeros(len(force))
        vdot[self._driven] = wanted[self._single] * self._signs
        h = moment.unforced(vdot) - force
        multipliers = np.zeros(len(c))
        if len(self._free):
            M = moment.mass_matrix
            step, multipliers = self._free_accelerations(M, h, J, c - J @ vdot)
            h = h + M[:, self._free] @ step
        h = h - multipliers @ J
        driving = -self._rotors * wanted
        driving[self._single] += h[self._driven] * self._signs
        driving[self._mixed] = multipliers[: len(self._mixed)]
        total = force + multipliers @ J
        total[self._driven] += h[self._driven]
        return Solution(force=total, driving=driving, multipliers=multipliers[len(self._mixed) :])

    def _wanted(self, moment: Moment, u: Array) -> Array:
        """Return the accelerations of driven axes that keep them on their motions."""
        x, rate, acceleration = u[self._entries].T
        late = rate - self._S @ moment.v
        off = x - self._A @ moment.q - self._b
        wanted: Array = acceleration + 2.0 * FOLLOW * late + FOLLOW**2 * off
        return wanted

    def _rows(self, moment: Moment, wanted: Array) -> tuple[Array, Array]:
        """Return the rows of what is not taken out: axes of floating bases, and constraints."""
        rows = [constraint.rows(moment) for constraint in self._constraints]
        J = np.vstack([self._S[self._mixed], *(J for J, _ in rows)])
        return J, np.concatenate([wanted[self._mixed], *(c for _, c in rows)])

    def _free_accelerations(self, M: Array, h: Array, J: Array, c: Array) -> tuple[Array, Array]:
        """Return the accelerations of free velocities, and the multipliers."""
        free = self._free
        L, failed = dpotrf(M[np.ix_(free, free)], lower=1)
        if failed:
            raise InvalidValueError(
                "joints that no motion drives move nothing that has mass: give it a mass, or drive "
                "them, too"
            )
        y = dtrsv(L, -h[free], lower=1)
        multipliers = np.zeros(len(c))
        if len(c):
            Z = dtrsm(1.0, L, J[:, free].T, lower=1)
            multipliers = self._multipliers(Z, c - Z.T @ y)
            y = y + Z @ multipliers
        step: Array = dtrsv(L, y, lower=1, trans=1)
        return step, multipliers

    def _multipliers(self, Z: Array, gap: Array) -> Array:
        """Solve ``Z^T Z x = gap`` for as many multipliers as are independent; the others are 0.

        The forces of the constraints do not depend on which of them are chosen. Where a mechanism
        leaves a posture in which fewer are, as a flat parallelogram, more are chosen.
        """
        if self._independent is None or self._independent[-1] >= len(gap):
            self._independent = independent_columns(Z)
        found = _chosen_multipliers(Z, gap, self._independent)
        if found is None:
            self._independent = independent_columns(Z)
            found = _chosen_multipliers(Z, gap, self._independent)
        elif np.abs(Z.T @ (Z @ found) - gap).max() > LEFT * np.abs(gap).max():
            chosen = independent_columns(Z, POOR)
            if len(chosen) > len(self._independent):
                self._independent = chosen
                found = _chosen_multipliers(Z, gap, chosen)
        if found is None:
            found = np.linalg.pinv(Z, rcond=REDUNDANT) @ (
                np.linalg.pinv(Z.T, rcond=REDUNDANT) @ gap
            )
        return found


def _chosen_multipliers(Z: Array, gap: Array, chosen: Array) -> Array | None:
    """Solve for the chosen multipliers; None where they are not independent."""
    own = Z[:, chosen]
    C, failed = dpotrf(own.T @ own, lower=1)
    diagonal = C.diagonal()
    if failed or not diagonal.min() > POOR * diagonal.max():
        return None
    found = np.zeros(len(gap))
    found[chosen] = dpotrs(C, gap[chosen], lower=1)[0]
    return found


def independent_columns(Z: Array, least: float = REDUNDANT) -> Array:
    """Return the numbers of as many columns as are independent, ascending.

    A pivot counts that is more than ``least`` of the greatest one.
    """
    R, pivots, *_ = dgeqp3(Z)
    diagonal = np.abs(np.diagonal(R))
    rank = int((diagonal > least * max(diagonal[0], np.finfo(float).tiny)).sum())
    found: Array = np.sort(pivots[:rank] - 1)
    return found
