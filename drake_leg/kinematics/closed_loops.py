"""Closes the loops of a robot: passive joints from active ones, their rates and accelerations.

A loop is cut at a joint, whose two frames K and E have to coincide but for that joint's motion.
With ``e`` the five errors of every cut, ``e(q) = 0``, and ``J`` their derivative, the columns of
the active joints being ``J_a`` and those of the passive ones ``J_p``,

``qdot_p = W_c qdot_a``, ``W_c = -J_p^+ J_a``, and
``qddot_p = W_c qddot_a - J_p^+ dJ/dt qdot``.

A planar loop has more equations than it needs; the pseudoinverse ``J_p^+`` solves all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.khalil import Array, finite_vectors, one_vector
from drake_leg.kinematics.loop_cuts import CutMotion, Cuts
from drake_leg.kinematics.movable import SINGULAR_BELOW
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot, require_robot

CLOSED = 1e-12  # closure error of a closed loop; lengths relative to the robot's size
ROUNDING = 1e-15  # a closure error that need not get smaller
ITERATIONS = 50  # of Newton's method, from anywhere
FEW = 8  # the same, from nearby
LONGEST_STEP = 0.5  # [rad, or parts of the robot's size], of one iteration
# Smallest singular value of J_p, relative to the greatest: below it, rounding of a closed posture,
# divided by the square of this, leaves no digit of the passive joints' rates.
UNDETERMINED = 1e-7
RANK_TOLERANCE = 1e-6  # of the greatest singular value: smaller ones do not count
TRIALS = 48  # random starts, of which those that close tell the rank
SUBSTEPS = 10  # halvings of a step along a motion
PREDICTED = 0.1  # [rad, or parts of the size]: the prediction of a step may be that wrong


class ClosedLoops:
    """The closed loops of a robot: the passive joints' motion from that of the active ones.

    Joint positions q are those of the cut tree, in the order of ``robot.moving``; the joints at
    which the loops are cut come apart, from ``cut_motion``. The robot moves as its active joints
    do: ``qdot = W(q) qdot_a``, (Khalil's W, with the rows of the active joints).

    Parameters
    ----------
    robot : Robot
        With at least one loop.
    active : sequence of str, optional
        Names of the joints that drive the loops, by default those that are actuated. There must be
        as many as the robot has degrees of freedom.

    Raises
    ------
    InvalidValueError
        If the robot has no loops or none that close, or if the active joints are more, fewer or
        others than those that determine its posture.

    Examples
    --------
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> loops = ClosedLoops(FOUR_BAR)
    >>> loops.active, loops.passive, loops.freedom
    (('crank',), ('coupler', 'rocker'), 1)
    >>> q = loops.position([1.0])
    >>> bool(loops.closure(q) < 1e-12)
    True
    >>> qdot = loops.W(q) @ [2.0]  # rates of all joints when the crank turns at 2 rad/s
    >>> float(qdot[0])
    2.0
    """

    def __init__(self, robot: Robot, active: Sequence[str] | None = None) -> None:
        require_robot(robot)
        if not robot.loops:
            raise InvalidValueError(f"{robot.name!r} has no closed loop")
        self.robot = robot
        self.joints = tuple(str(segment.joint) for segment in robot.moving)
        self.turning = np.array([segment.row.joint == "revolute" for segment in robot.moving])
        self._cuts = Cuts(robot)
        self.size = self._cuts.size
        self.units = np.where(self.turning, 1.0, self.size)  # of q, [rad or m]
        _refuse_mechanics(robot)
        chosen = self._actuated() if active is None else _named(self.joints, active)
        self._a = [i for i, name in enumerate(self.joints) if name in chosen]
        self._p = [i for i in range(len(self.joints)) if i not in self._a]
        self._require_active()

    def __repr__(self) -> str:
        return (
            f"<ClosedLoops of {self.robot.name}: {self.freedom} degrees of freedom, active "
            f"{', '.join(self.active)}; passive {', '.join(self.passive)}; cut "
            f"{', '.join(self.cuts)}>"
        )

    # --- joints and counts -------------------------------------------------------------------

    @property
    def active(self) -> tuple[str, ...]:
        """Names of the joints whose motion is given."""
        return tuple(self.joints[i] for i in self._a)

    @property
    def passive(self) -> tuple[str, ...]:
        """Names of the tree's joints that follow."""
        return tuple(self.joints[i] for i in self._p)

    @property
    def cuts(self) -> tuple[str, ...]:
        """Names of the joints at which the loops are cut."""
        return tuple(loop.joint for loop in self.robot.loops)

    @property
    def active_columns(self) -> list[int]:
        """Where the active joints are among all."""
        return self._a

    @property
    def passive_columns(self) -> list[int]:
        """Where the passive joints are among all."""
        return self._p

    @property
    def frames(self) -> int:
        """Khalil's number of frames NF = 2 NJ - NL: each cut joint has two."""
        links = len(self.joints)
        joints = links + len(self.robot.loops)
        return 2 * joints - links

    @cached_property
    def rank(self) -> int:
        """How many independent equations close the loops, in most closed postures."""
        return _usual_rank(self.scaled_jacobian(self._samples))

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the robot with its loops closed."""
        return len(self.joints) - self.rank

    @cached_property
    def _samples(self) -> Array:
        """Closed postures of all kinds, (k, n)."""
        start = np.array(starting_posture(self.robot))
        random = np.random.default_rng(0).uniform(-1.0, 1.0, (TRIALS, len(self.joints)))
        starts = np.vstack([start, start + random * np.where(self.turning, math.pi, self.size)])
        q, error = self.closest(starts, range(len(self.joints)))
        if not (error <= CLOSED).any():
            raise InvalidValueError(
                f"the loops of {self.robot.name!r} do not close: from {TRIALS + 1} postures, "
                f"Newton's method leaves errors of {error.min():.3g} or more (in rad, or in parts "
                f"of the robot's size, {self.size:.3g} m)",
                advice="check the lengths of its links and the two frames of every cut",
            )
        samples: Array = q[error <= CLOSED]
        return samples

    def _actuated(self) -> tuple[str, ...]:
        return tuple(str(s.joint) for s in self.robot.moving if s.mechanics.actuated)

    def _require_active(self) -> None:
        """Refuse active joints that are more, fewer or others than the degrees of freedom."""
        count, freedom = len(self.active), self.freedom
        listed = f"{count} ({', '.join(self.active)})" if count else "none"
        said = (
            f"{self.robot.name!r} has {freedom} degree{'s' * (freedom != 1)} of freedom with its "
            f"loops closed; of its joints {', '.join(self.joints)}, {listed} "
            f"{'is' if count == 1 else 'are'} active"
        )
        if count != freedom:
            raise InvalidValueError(
                said, advice=f"let {freedom} of them be actuated (mu in a .par file)"
            )
        J = self.scaled_jacobian(self._samples)[..., self._p]
        if _usual_rank(J) < len(self._p):
            raise InvalidValueError(
                f"{said}, and do not determine the posture of the others, "
                f"{', '.join(self.passive)}",
                advice="let others be actuated (mu in a .par file)",
            )

    # --- how far the loops are from closed ---------------------------------------------------

    def closure(self, q: ArrayLike) -> Array:
        """Greatest error of the equations in postures q (..., n) [rad, or parts of the size]."""
        return self._worst(self._cuts.equations(self._positions(q))[0])

    def gap(self, q: ArrayLike) -> Array:
        """Greatest distance between the two sides of a cut, (...) [m]; angles times the size."""
        distance: Array = self.size * self.closure(q)
        return distance

    def _worst(self, errors: Array) -> Array:
        worst: Array = np.abs(errors / self._cuts.units).max(axis=-1)
        return worst

    def jacobian(self, q: ArrayLike) -> Array:
        """J (..., 5 loops, n) of the equations that close the loops, ``J qdot = 0``."""
        return self._cuts.equations(self._positions(q))[1]

    def drift(self, q: ArrayLike, qdot: ArrayLike) -> Array:
        """``dJ/dt qdot`` in one posture, (5 loops,)."""
        return self._cuts.drift(self._posture(q), one_vector("qdot", qdot, len(self.joints)))

    def scaled_jacobian(self, q: Array) -> Array:
        """J (..., 5 loops, n) with the robot's size as the unit of length."""
        return self._scaled(self._cuts.equations(q)[1])

    def _scaled(self, J: Array) -> Array:
        scaled: Array = J * self.units / self._cuts.units[:, np.newaxis]
        return scaled

    def _positions(self, q: ArrayLike) -> Array:
        return finite_vectors("q", q, len(self.joints))

    # --- position ----------------------------------------------------------------------------

    def closest(
        self, q: Array, free: Sequence[int] | None = None, iterations: int = ITERATIONS
    ) -> tuple[Array, Array]:
        """Close the loops from postures (..., n) by Newton's method, damped far from closed ones.

        Only the passive joints move, or the ``free`` ones. Returns postures and their closure
        errors, which are small where the loops are closed.
        """
        free = self._p if free is None else list(free)
        q = np.array(q, dtype=np.float64)
        best, least = q.copy(), np.full(q.shape[:-1], np.inf)
        for _ in range(iterations):
            e, J = self._cuts.equations(q)
            error = self._worst(e)
            is_done = (error <= ROUNDING) | ((least <= CLOSED) & (error >= 0.5 * least))
            best = np.where((error < least)[..., np.newaxis], q, best)
            least = np.minimum(error, least)
            if is_done.all():
                break
            inverse = np.linalg.pinv(self._scaled(J)[..., free], rcond=SINGULAR_BELOW)
            step = -(inverse @ (e / self._cuts.units)[..., np.newaxis])[..., 0]
            longest = np.abs(step).max(axis=-1, keepdims=True, initial=LONGEST_STEP)
            q[..., free] += step * (LONGEST_STEP / longest) * self.units[free]
        return best, least

    def position(self, q_a: ArrayLike, near: ArrayLike | None = None) -> Array:
        """Posture q (n,) with the active joints at q_a and the loops closed.

        Parameters
        ----------
        q_a : (a,) array_like
            Positions of the active joints [rad or m].
        near : (n,) array_like, optional
            A posture in whose vicinity the passive joints are searched, by default the robot's
            starting posture.

        Raises
        ------
        InvalidValueError
            If the loops do not close there.
        """
        guess = np.array(starting_posture(self.robot)) if near is None else self._positions(near)
        guess = guess.copy()
        guess[self._a] = one_vector("q_a", q_a, len(self._a))
        q, error = self.closest(guess)
        if error <= CLOSED:
            return q
        found = self.assemblies_near(guess)
        if found is None:
            raise InvalidValueError(
                f"the loops of {self.robot.name!r} do not close with "
                f"{self.in_words(guess[self._a])}",
                advice="choose other positions of the active joints, or other lengths",
            )
        return found

    def closed_from(self, guess: Array) -> Array:
        """Close the loops from a posture nearby; the active joints stay where they are.

        Raises
        ------
        SingularConfigurationError
            If they do not close nearby.
        """
        q, error = self.closest(guess, iterations=FEW)
        if error > CLOSED:
            raise self.singular(guess)
        return q

    def nearest(self, guess: Array) -> tuple[Array, Array, Array]:
        """Close the loops from a posture nearby, all joints moving as little as possible.

        Returns the posture, the motions N (n, freedom) that keep it closed, orthonormal with q in
        its ``units``, and the pseudoinverse of J, (n, 5 loops).

        Raises
        ------
        SingularConfigurationError
            If the loops do not close nearby, or have more freedom there than elsewhere.
        """
        q, r = np.array(guess), self.rank
        for _ in range(FEW):
            e, J = self._cuts.equations(q)
            U, sigma, Vt = np.linalg.svd(self._scaled(J))
            if not sigma[r - 1] > SINGULAR_BELOW * sigma[0]:
                raise self.singular(q)
            inverse = (Vt[:r].T / sigma[:r]) @ U[:, :r].T
            error = self._worst(e)
            if error <= ROUNDING:
                break
            q = q - self.units * (inverse @ (e / self._cuts.units))
        if not error <= CLOSED:
            raise self.singular(q)
        return q, Vt[r:].T, self.units[:, np.newaxis] * inverse / self._cuts.units

    def assemblies_near(self, q: Array) -> Array | None:
        """The assembly with the active joints of q that is nearest to q; None if there is none."""
        from drake_leg.kinematics.assemblies import assemblies

        found = assemblies(self, q[self._a]).found
        if not found:
            return None
        return min((np.array(one.q) for one in found), key=lambda one: self.distance(one, q))

    def distance(self, one: Array, other: Array) -> float:
        """Greatest difference of two postures, less whole turns [rad, or parts of the size]."""
        apart = (one - other) / self.units
        turned = np.abs(np.mod(apart + math.pi, math.tau) - math.pi)
        return float(np.where(self.turning, turned, np.abs(apart)).max())

    def in_words(self, q_a: ArrayLike) -> str:
        """Name the active joints and their positions."""
        return ", ".join(
            f"{name} at {math.degrees(value):.6g} deg" if turns else f"{name} at {value:.6g} m"
            for name, value, turns in zip(
                self.active, np.asarray(q_a).tolist(), self.turning[self._a].tolist(), strict=True
            )
        )

    def follow(self, q_a: ArrayLike, start: ArrayLike | None = None) -> Array:
        """Postures (rows, n) along a motion of the active joints (rows, a), without a jump.

        Every posture is reached from the one before by small steps, so that the assembly stays the
        same. ``start`` is near the first posture.

        Raises
        ------
        InvalidValueError
            If the loops do not close at the beginning.
        SingularConfigurationError
            If the motion meets a posture that the active joints do not determine.
        """
        motion = finite_vectors("the motion of the active joints", q_a, len(self._a))
        if motion.ndim != 2 or not len(motion):
            raise InvalidValueError(
                f"the motion of the active joints has shape {motion.shape}; it must be one row of "
                f"{len(self._a)} for each time"
            )
        q = self.position(motion[0], start)
        postures = [q]
        for row in motion[1:]:
            q = self.moved(q, row)
            postures.append(q)
        return np.array(postures)

    def moved(self, q: Array, q_a: Array) -> Array:
        """Move the active joints of a closed posture to q_a; the passive ones follow."""
        done, step = 0.0, 1.0
        begin = q[self._a]
        while done < 1.0:
            step = min(step, 1.0 - done)
            goal = begin + (done + step) * (q_a - begin)
            guess = q + self.W(q) @ (goal - q[self._a])
            guess[self._a] = goal
            found, error = self.closest(guess, iterations=FEW)
            missed = np.abs((found - guess) / self.units).max()
            if error <= CLOSED and missed <= PREDICTED:
                q, done, step = found, done + step, 2.0 * step
            elif step < 2.0**-SUBSTEPS:
                raise self.singular(q)
            else:
                step /= 2.0
        return q

    # --- velocity and acceleration -----------------------------------------------------------

    def W(self, q: ArrayLike) -> Array:
        """Rates of all joints by those of the active ones, ``qdot = W qdot_a``, (n, a).

        Raises
        ------
        SingularConfigurationError
            If the active joints do not determine the passive ones there.
        """
        W, _ = self._rates(self._posture(q))
        return W

    def rates_and_bias(self, q: Array, qdot_a: Array) -> tuple[Array, Array]:
        """W, and the accelerations with the active joints at constant speed, together."""
        W, inverse = self._rates(q)
        bias = np.zeros(len(q))
        bias[self._p] = -(inverse @ self._cuts.drift(q, W @ qdot_a))
        return W, bias

    def bias(self, q: ArrayLike, qdot: ArrayLike) -> Array:
        """Accelerations with the active joints at constant speed: ``qddot = W qddot_a + bias``.

        ``qdot`` (n,) are the rates of all joints, ``W qdot_a``.
        """
        rates = one_vector("qdot", qdot, len(self.joints))
        return self.rates_and_bias(self._posture(q), rates[self._a])[1]

    def _posture(self, q: ArrayLike) -> Array:
        return one_vector("q", q, len(self.joints))

    def _rates(self, q: Array) -> tuple[Array, Array]:
        """W, (n, a), and ``J_p^+``, (p, 5 loops)."""
        J = self.jacobian(q)
        U, sigma, Vt = np.linalg.svd(self._scaled(J)[:, self._p], full_matrices=False)
        if not sigma[-1] > UNDETERMINED * sigma[0]:
            raise self.singular(q)
        inverse = self.units[self._p, np.newaxis] * ((Vt.T / sigma) @ U.T) / self._cuts.units
        W = np.zeros((len(q), len(self._a)))
        W[self._a, np.arange(len(self._a))] = 1.0
        W[self._p] = -inverse @ J[:, self._a]
        return W, inverse

    def sigma_min(self, q: ArrayLike) -> float:
        """Smallest singular value of ``J_p``, scaled by the size: 0 in a singular assembly."""
        J = self.scaled_jacobian(self._posture(q))[:, self._p]
        sigma = np.linalg.svd(J, compute_uv=False)
        return float(sigma[-1]) if len(sigma) else math.inf

    def singular(self, q: Array) -> SingularConfigurationError:
        """Make the error that tells of a singular assembly near q."""
        return SingularConfigurationError(
            q=q.tolist(),
            sigma_min=self.sigma_min(q),
            problem=f"the assembly of {self.robot.name!r} is singular near "
            f"{self.in_words(q[self._a])}: its active joints do not determine the passive ones "
            "there",
            advice="choose another posture, or a motion that does not meet this one",
        )

    def cut_motion(
        self, q: ArrayLike, qdot: ArrayLike | None = None, qddot: ArrayLike | None = None
    ) -> CutMotion:
        """Motion of the joints at which the loops are cut, in one posture; at rest by default."""
        still = np.zeros(len(self.joints))
        rates = still if qdot is None else one_vector("qdot", qdot, len(still))
        accelerations = still if qddot is None else one_vector("qddot", qddot, len(still))
        return self._cuts.motion(self._posture(q), rates, accelerations)


def _usual_rank(J: Array) -> int:
    """The most frequent rank of some matrices (k, m, n)."""
    if not J.shape[-1]:
        return 0
    sigma = np.linalg.svd(J, compute_uv=False)
    ranks = (sigma > RANK_TOLERANCE * sigma[:, :1]).sum(axis=1)
    return int(np.bincount(ranks).argmax())


def _refuse_mechanics(robot: Robot) -> None:
    """Refuse damping and springs at a joint at which a loop is cut."""
    for loop in robot.loops:
        mechanics = robot.segments[loop.cut - 1].mechanics
        acting = ("damping", "dry_friction", "rotor_inertia", "spring_stiffness")
        if any(getattr(mechanics, name) for name in acting):
            raise InvalidValueError(
                f"the joint {loop.joint!r}, at which a loop of {robot.name!r} is cut, has damping, "
                "friction, a rotor or a spring",
                advice="cut the loop at another of its joints",
            )


def _named(joints: Sequence[str], names: Sequence[str]) -> tuple[str, ...]:
    for name in names:
        if name not in joints:
            raise InvalidValueError(
                f"{shown(name)} is no joint that could be active; the joints are "
                f"{', '.join(joints)}"
            )
    return tuple(names)
