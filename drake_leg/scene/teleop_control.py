"""One step of a robot whose foot is driven by hand, and the guard that keeps it out of trouble."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array, one_vector
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.of_robot import movable
from drake_leg.quantities import beyond
from drake_leg.robot import Robot
from drake_leg.singularity.directions import motion_in_words
from drake_leg.singularity.families import singular_words

State = Literal["free", "near", "slowed", "stopped"]

STOP, SLOW = 0.01, 0.04  # of the robot's length: smallest singular values of the guard
GREATEST_RATE = 4.0  # [rad/s or m/s] of a joint
LARGEST_TURN = 0.02  # [rad or m] of a joint in one substep
AT_LIMIT = {"revolute": 0.02, "prismatic": 0.004}  # [rad], [m]: nearer a joint is at its limit
FREE = 0.995  # share of the commanded way above which nothing is said


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A robot to be driven, and how near it may come to a singularity."""

    robot: Robot
    moved: Movable
    rate: float = GREATEST_RATE

    @property
    def length(self) -> float:
        """Sum of all lengths in the table [m]."""
        return self.moved.length

    @property
    def stop(self) -> float:
        """Smallest singular value below which nothing goes nearer to the singularity [m]."""
        return STOP * self.length

    @property
    def slow(self) -> float:
        """Smallest singular value below which what goes nearer is slowed [m]."""
        return SLOW * self.length

    def sigma_min(self, q: ArrayLike) -> float:
        """Smallest singular value of the foot's Jacobian.

        Parameters
        ----------
        q : (n,) array_like
            Joint positions [rad or m].

        Returns
        -------
        float
            [m].
        """
        posture = np.asarray(q).tolist()
        return self.moved.at(posture).sigma_min(posture)

    def room(self, sigma_min: float) -> float:
        """Share of a way towards the singularity that the guard lets go.

        Parameters
        ----------
        sigma_min : float
            Smallest singular value [m].

        Returns
        -------
        float
            1 and more where it slows nothing, 0 and less where it stops.
        """
        return (sigma_min - self.stop) / (self.slow - self.stop)

    def foot(self, q: ArrayLike) -> Array:
        """Position of the foot.

        Parameters
        ----------
        q : (n,) array_like
            Joint positions [rad or m].

        Returns
        -------
        p_BF : (3,) ndarray
            In the base frame [m].
        """
        return self.moved.foot(np.asarray(q).tolist())


@dataclass(frozen=True, kw_only=True)
class Step:
    """What one step came to."""

    q: Array  # (n,) [rad or m]
    foot: Array  # (3,) p_BF [m]
    sigma_min: float  # [m]
    share: float | None  # of the commanded way that was gone: 0 ... 1; None at rest
    state: State  # near: at rest where the guard would slow the foot
    sentence: str  # for a person; empty where nothing is in the way


def drive_of(robot: Robot, keep: str | None = None) -> Drive:
    """Make a robot ready to be driven.

    Parameters
    ----------
    robot : Robot
        Any whose foot its joints move.
    keep : {"position", "pose"}, optional
        Whether the foot may turn, as ``movable`` takes it.

    Returns
    -------
    Drive
        Guarded below ``SLOW`` and ``STOP`` of the robot's length.

    Raises
    ------
    InvalidValueError
        If the robot cannot do that.
    """
    return Drive(robot=robot, moved=movable(robot, keep=keep))


def at_rest(drive: Drive, q: ArrayLike) -> Step:
    """Describe a posture that nobody moves.

    Parameters
    ----------
    q : (n,) array_like
        Joint positions [rad or m].

    Raises
    ------
    InvalidValueError
        If ``q`` has not n finite numbers.
    SingularConfigurationError
        If the posture is singular: no velocity has joint rates there.
    """
    posture = one_vector("q", q, len(drive.robot.moving))
    sigma_min = drive.sigma_min(posture)
    if sigma_min < 1e-3 * drive.stop:
        raise SingularConfigurationError(q=posture.tolist(), sigma_min=sigma_min)
    return _rest(drive, posture)


def control_step(drive: Drive, q: ArrayLike, v: ArrayLike, dt: float) -> Step:
    """Move the foot for a moment with a commanded velocity, as far as the guard lets it.

    The joints follow ``qdot = J^-1 (share v)`` in substeps of at most ``LARGEST_TURN``. Whatever
    lowers the smallest singular value is slowed in proportion to what is left of it above
    ``drive.stop``; whatever raises it is not. No joint goes faster than ``drive.rate`` or
    further out of its limits. Of v acts what the foot can do.

    Parameters
    ----------
    q : (n,) array_like
        Joint positions at the beginning [rad or m].
    v : (3,) array_like
        Commanded velocity of the foot, base frame [m/s].
    dt : float
        Duration [s].

    Raises
    ------
    InvalidValueError
        If ``q`` or ``v`` has another count of numbers, or one is not finite.
    """
    posture, velocity = one_vector("q", q, len(drive.robot.moving)), one_vector("v", v, 3)
    if not velocity.any() or dt <= 0.0:
        return _rest(drive, posture)
    here = drive.moved.at(posture.tolist())
    if float(np.linalg.norm(here.command(velocity))) < 1e-9:
        sentence = f"the foot {motion_in_words(here)}; drive it another way"
        return _described(drive, posture, 0.0, "stopped", sentence)
    left, gone, obstacle = dt, 0.0, ""
    while left > 1e-12 * dt:
        try:
            robot = drive.moved.at(posture.tolist())
            command = robot.command(velocity)
            peak = float(np.abs(robot.rates(posture.tolist(), command.tolist())).max())
            span = min(left, LARGEST_TURN / min(peak, drive.rate) if peak > 0.0 else left)
            moved, share, reason = _substep(drive, robot, posture, command, span, peak)
        except SingularConfigurationError:
            obstacle = singular_words(drive.moved.geometry, posture)
            break
        posture, gone, left = moved, gone + share * span, left - span
        obstacle = reason or obstacle
        if share == 0.0:
            break
    return _step(drive, posture, gone / dt, obstacle)


def _substep(
    drive: Drive, robot: Movable, q: Array, v: Array, span: float, peak: float
) -> tuple[Array, float, str]:
    """Return the posture after a short time, the share of v that acted, and what was in the way."""
    share, obstacle = 1.0, ""
    if peak > drive.rate:
        share, obstacle = drive.rate / peak, "a joint is at its greatest speed"
    before = drive.sigma_min(q)
    moved = _advance(robot, q, share * v, span)
    if drive.sigma_min(moved) < before or _crossed(robot, q, moved):
        room = drive.room(before)
        if room < 1.0:
            share, obstacle = share * max(room, 0.0), singular_words(drive.moved.geometry, q)
            moved = _advance(robot, q, share * v, span)
        if drive.sigma_min(moved) < min(drive.stop, before) or _crossed(robot, q, moved):
            return q, 0.0, singular_words(drive.moved.geometry, q)
    stopped = _joint_beyond(drive.robot, q, moved)
    if stopped:
        return q, 0.0, f"the joint {stopped} is at its limit"
    return moved, share, obstacle


def _advance(robot: Movable, q: Array, v: Array, span: float) -> Array:
    """Integrate the joint rates by Runge and Kutta's fourth-order step."""
    command = v.tolist()

    def slope(posture: Array) -> Array:
        return np.asarray(robot.rates(posture.tolist(), command), dtype=np.float64)

    a = slope(q)
    b = slope(q + span / 2.0 * a)
    c = slope(q + span / 2.0 * b)
    d = slope(q + span * c)
    return np.asarray(q + span / 6.0 * (a + 2.0 * b + 2.0 * c + d))


def _crossed(robot: Movable, q: Array, moved: Array) -> bool:
    """Tell whether a singularity lies between two postures."""
    determinant = robot.determinant
    return determinant(q.tolist()) * determinant(moved.tolist()) <= 0.0


def _joint_beyond(robot: Robot, q: Array, moved: Array) -> str | None:
    """Name a joint that goes further out of its limits."""
    for segment, now, then in zip(robot.moving, q, moved, strict=True):
        outside = beyond(then, *segment.mechanics.bounds)
        if outside * (then - now) > 0.0:
            return segment.joint
    return None


def _step(drive: Drive, q: Array, share: float, obstacle: str) -> Step:
    state: State = "free" if share > FREE else "slowed" if share > 1.0 - FREE else "stopped"
    sentence = ""
    if state == "slowed":
        sentence = f"{obstacle}: the foot is slowed"
    elif state == "stopped":
        sentence = f"{obstacle}: the foot is stopped; drive it another way"
    return _described(drive, q, share, state, sentence)


def _rest(drive: Drive, q: Array) -> Step:
    """Describe a posture at rest by what the guard would do on the way to what is near."""
    room = drive.room(drive.sigma_min(q))
    near = singular_words(drive.moved.geometry, q)
    if room <= 1.0 - FREE:
        stop = f"{near}: the foot can only be driven away from it"
        return _described(drive, q, None, "stopped", stop)
    if room < 1.0:
        return _described(drive, q, None, "near", f"{near}: nearer to it the foot will be slowed")
    joint = _joint_at_limit(drive.robot, q)
    if joint:
        return _described(drive, q, None, "near", f"the joint {joint} is at its limit")
    return _described(drive, q, None, "free", "")


def _joint_at_limit(robot: Robot, q: Array) -> str | None:
    """Name a joint that is as near to a limit as one that was stopped there."""
    for segment, now in zip(robot.moving, q, strict=True):
        mechanics = segment.mechanics
        near = AT_LIMIT[segment.row.joint]
        below = mechanics.lower is not None and now < mechanics.lower + near
        if below or (mechanics.upper is not None and now > mechanics.upper - near):
            return segment.joint
    return None


def _described(drive: Drive, q: Array, share: float | None, state: State, sentence: str) -> Step:
    return Step(
        q=q,
        foot=drive.foot(q),
        sigma_min=drive.sigma_min(q),
        share=share,
        state=state,
        sentence=sentence,
    )
