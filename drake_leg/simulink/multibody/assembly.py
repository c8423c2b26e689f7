"""Assembles a mechanism: joint positions at which its loops close, near its state targets."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.simulink.mechanism import inverse
from drake_leg.simulink.multibody.bodies import Joint, Mechanism
from drake_leg.simulink.multibody.mass import Array

STEPS = 100
CLOSED = 1e-10  # [m, rad]
DIFFERENCE = 1e-6  # [rad or m], of a derivative
LONGEST = 0.3  # [rad or m], of a step


class Assembly:
    """The positions of all joints of a mechanism: of the tree, then of those that close loops."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._joints = (*mechanism.joints, *mechanism.loops)

    @property
    def targets(self) -> Array:
        """Return the positions at the state targets, or 0."""
        return np.concatenate([np.zeros(0), *(joint.start for joint in self._joints)])

    def firm(self) -> Array:
        """Tell which positions have a target of high priority."""
        return np.array(
            [
                primitive.target is not None and primitive.firm
                for joint in self._joints
                for primitive in joint.primitives
                for _ in range(primitive.positions)
            ],
            dtype=bool,
        )

    def gaps(self, q: Array) -> Array:
        """Compute how far loops are from being closed, (6 per loop,) [rad, m]."""
        if not self._mechanism.loops:
            return np.zeros(0)
        parts = self._split(q)
        X_WB = self._poses(parts)
        found = []
        for joint, part in zip(
            self._mechanism.loops, parts[len(self._mechanism.joints) :], strict=True
        ):
            X_WBase = X_WB[joint.base] @ joint.X_PB @ joint.pose(part)
            apart = inverse(X_WBase) @ X_WB[joint.follower] @ joint.X_CF
            found += [Rotation.from_matrix(apart[:3, :3]).as_rotvec(), apart[:3, 3]]
        return np.concatenate(found)

    def closed(self) -> tuple[Array, float]:
        """Return the tree's positions with loops closed, and the gap that is left [rad or m].

        Positions with a target of high priority move only if there is no other way. Each step is
        the shortest that closes the linearized loops.
        """
        size = sum(joint.positions for joint in self._mechanism.joints)
        q = self.targets
        for may_move in (np.logical_not(self.firm()), np.ones(len(q), dtype=bool)):
            moved = self._solved(self.targets, may_move)
            if self._gap(moved) < self._gap(q):
                q = moved
            if self._gap(q) <= CLOSED:
                break
        return q[:size], self._gap(q)

    def _solved(self, q: Array, may_move: Array) -> Array:
        for _ in range(STEPS):
            gaps = self.gaps(q)
            if np.abs(gaps).max(initial=0.0) <= CLOSED or not may_move.any():
                break
            J = self._jacobian(q, np.flatnonzero(may_move))
            step = np.linalg.lstsq(J, -gaps, rcond=1e-10)[0]
            step *= min(1.0, LONGEST / max(float(np.abs(step).max()), LONGEST))
            q = q.copy()
            q[may_move] += step
        return q

    def _jacobian(self, q: Array, columns: Iterable[int]) -> Array:
        found = []
        for column in columns:
            step = np.zeros(len(q))
            step[column] = DIFFERENCE
            found.append((self.gaps(q + step) - self.gaps(q - step)) / (2.0 * DIFFERENCE))
        return np.column_stack(found)

    def _gap(self, q: Array) -> float:
        return float(np.abs(self.gaps(q)).max(initial=0.0))

    def _split(self, q: Array) -> list[Array]:
        ends = np.cumsum([joint.positions for joint in self._joints])
        return np.split(q, ends[:-1])

    def _poses(self, parts: list[Array]) -> list[Array]:
        """Compute the poses X_WB of all bodies; those that float stay at the origin."""
        X_WB = [np.eye(4) for _ in self._mechanism.bodies]
        for joint, part in zip(self._mechanism.joints, parts, strict=False):
            parent, child, X_PC = _step(joint, part)
            X_WB[child] = X_WB[parent] @ X_PC
        return X_WB


def _step(joint: Joint, q: Array) -> tuple[int, int, Array]:
    """Return a joint's parent and child in the tree, and the pose of the child."""
    X = joint.X_PB @ joint.pose(q) @ inverse(joint.X_CF)
    if joint.reversed:
        return joint.follower, joint.base, inverse(X)
    return joint.base, joint.follower, X
