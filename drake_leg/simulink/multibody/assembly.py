"""Assembles a mechanism: joint positions at which its loops close, near its state targets."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.simulink.mechanism import inverse
from drake_leg.simulink.multibody.bodies import Joint, Mechanism
from drake_leg.simulink.multibody.joints import Primitive
from drake_leg.simulink.multibody.mass import Array

STEPS = 60
CLOSED = 1e-10  # [m, rad]
LONGEST = 0.3  # [rad or m], of a step
PATIENCE = 8  # steps without a smaller gap
TRIES, DISTURBED = 20, 0.1  # other beginnings, and how far the first is [rad or m]
SMALL = 1e-4  # [rad], below which a series is as exact


class Assembly:
    """The positions of all joints of a mechanism: of the tree, then of those that close loops."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._joints = (*mechanism.joints, *mechanism.loops)
        self._ends = np.cumsum([0, *(joint.positions for joint in self._joints)])

    @property
    def targets(self) -> Array:
        """Return the positions at the state targets, or 0."""
        return np.concatenate([np.zeros(0), *(joint.start for joint in self._joints)])

    @property
    def firm(self) -> Array:
        """Tell which positions have a target of high priority."""
        return self._which(lambda primitive: primitive.target is not None and primitive.firm)

    @property
    def aimed(self) -> Array:
        """Tell which positions have a target."""
        return self._which(lambda primitive: primitive.target is not None)

    def _which(self, holds: Callable[[Primitive], bool]) -> Array:
        return np.array(
            [
                holds(primitive)
                for joint in self._joints
                for primitive in joint.primitives
                for _ in range(primitive.positions)
            ],
            dtype=bool,
        )

    def gaps(self, q: Array) -> Array:
        """Compute how far loops are from being closed, (6 per loop,) [rad, m]."""
        return self._linearized(q)[0]

    def closed(self) -> tuple[Array, float]:
        """Return the tree's positions with loops closed, and the gap that is left [rad or m].

        Positions with a target of high priority move only if there is no other way. Each step is
        the shortest that closes the linearized loops.
        """
        size = sum(joint.positions for joint in self._mechanism.joints)
        q, gap = self.assembled()
        return q[:size], gap

    def assembled(self, given: Mapping[int, float] | None = None) -> tuple[Array, float]:
        """Return all positions with loops closed, and the gap; given ones stay, by number."""
        start, fixed = self.targets, np.zeros(len(self.targets), dtype=bool)
        for number, position in (given or {}).items():
            start[number], fixed[number] = position, True
        q, gap = start, _greatest(self.gaps(start))
        for may_move in (~(self.firm | fixed), ~fixed):
            if gap <= CLOSED:
                break
            in_loops = np.any(self._linearized(start)[1] != 0.0, axis=0)
            for begin in _beginnings(start, may_move & in_loops):
                moved, left = self._solved(begin, may_move)
                if left < gap:
                    q, gap = moved, left
                if gap <= CLOSED:
                    break
        return q, gap

    def _solved(self, q: Array, may_move: Array) -> tuple[Array, float]:
        """Return the best positions of a search, and their gap."""
        best, least, waited = q, math.inf, 0
        for _ in range(STEPS):
            gaps, J = self._linearized(q)
            if _greatest(gaps) < least:
                best, least, waited = q, _greatest(gaps), 0
            waited += 1
            if least <= CLOSED or waited > PATIENCE or not may_move.any():
                break
            step = np.linalg.lstsq(J[:, may_move], -gaps, rcond=1e-10)[0]
            step *= min(1.0, LONGEST / max(float(np.abs(step).max()), LONGEST))
            q = q.copy()
            q[may_move] += step
        return best, least

    def _linearized(self, q: Array) -> tuple[Array, Array]:
        """Return the gaps, and their derivatives by all positions (6 per loop, n)."""
        X_WB, V_WB = self._moved(q)
        gaps: list[Array] = [np.zeros(0)]
        rows: list[Array] = [np.zeros((0, len(q)))]
        first = len(self._mechanism.joints)
        for number, joint in enumerate(self._mechanism.loops, start=first):
            columns = slice(self._ends[number], self._ends[number + 1])
            X_WE, own = _along(joint, X_WB[joint.base] @ joint.X_PB, q[columns])
            apart = inverse(X_WE) @ X_WB[joint.follower] @ joint.X_CF
            turn: Array = Rotation.from_matrix(apart[:3, :3]).as_rotvec()
            V = V_WB[joint.follower] - V_WB[joint.base]
            V[:, columns] -= own
            # What the follower does with respect to E, seen from E.
            R_EW, o = X_WE[:3, :3].T, X_WE[:3, 3]
            w, v = R_EW @ V[:3], R_EW @ (V[3:] + np.cross(V[:3], o, axis=0))
            gaps += [turn, apart[:3, 3]]
            turning = np.asarray(np.linalg.solve(_left_jacobian(turn), w), dtype=float)
            rows += [turning, v + np.cross(w, apart[:3, 3], axis=0)]
        return np.concatenate(gaps), np.vstack(rows)

    def _moved(self, q: Array) -> tuple[list[Array], list[Array]]:
        """Compute the poses X_WB of all bodies, and their twists (6, n) per rate, at W.

        A twist has an angular velocity, then the velocity of the point that is at the world's
        origin. Bodies that float stay where they are.
        """
        X_WB = [np.eye(4) for _ in self._mechanism.bodies]
        V_WB = [np.zeros((6, len(q))) for _ in self._mechanism.bodies]
        for number, joint in enumerate(self._mechanism.joints):
            columns = slice(self._ends[number], self._ends[number + 1])
            part = q[columns]
            if joint.reversed:
                parent, child = joint.follower, joint.base
                X_WF = X_WB[parent] @ joint.X_CF
                X_WBase = X_WF @ inverse(joint.pose(part))
                _, own = _along(joint, X_WBase, part)
                X_WB[child], own = X_WBase @ inverse(joint.X_PB), -own
            else:
                parent, child = joint.base, joint.follower
                X_WF, own = _along(joint, X_WB[parent] @ joint.X_PB, part)
                X_WB[child] = X_WF @ inverse(joint.X_CF)
            V_WB[child] = V_WB[parent].copy()
            V_WB[child][:, columns] += own
        return X_WB, V_WB


def _beginnings(start: Array, may_move: Array) -> Iterator[Array]:
    """Yield where to begin: at the start, then farther and farther from it.

    From where a loop is stretched or folded, no small step closes it.
    """
    yield start
    rng = np.random.default_rng(0)
    for distance in np.linspace(DISTURBED, math.pi, TRIES):
        yield start + may_move * rng.uniform(-distance, distance, len(start))


def _along(joint: Joint, X_WB: Array, q: Array) -> tuple[Array, Array]:
    """Return the pose of a joint's follower, and its twists (6, n) from the base's, at W."""
    twists, first = [np.zeros((6, 0))], 0
    for primitive in joint.primitives:
        last = first + primitive.positions
        part, R = q[first:last], X_WB[:3, :3]
        axes = R @ _left_jacobian(part) if primitive.kind == "ball" else R[:, [primitive.axis]]
        if primitive.kind == "slide":
            twists.append(np.vstack([np.zeros_like(axes), axes]))
        else:
            v = primitive.lead * axes - np.cross(axes, X_WB[:3, 3], axis=0)
            twists.append(np.vstack([axes, v]))
        X_WB, first = X_WB @ primitive.pose(part), last
    return X_WB, np.hstack(twists)


def _left_jacobian(turn: Array) -> Array:
    """Return the angular velocity per rate of a rotation vector, (3, 3)."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < SMALL:
        half, sixth = 0.5, 1.0 / 6.0
    else:
        half = (1.0 - math.cos(angle)) / angle**2
        sixth = (angle - math.sin(angle)) / angle**3
    J: Array = np.eye(3) + half * K + sixth * K @ K
    return J


def _greatest(gaps: Array) -> float:
    return float(np.abs(gaps).max(initial=0.0))
