"""Where every frame of a robot is, moment by moment, from recorded joint positions."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, finite_vectors
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.quantities import ANGLE_UNITS, LENGTH_UNITS, TIME_UNITS
from drake_leg.recording import Recording
from drake_leg.robot import Robot

LARGEST_MISS = 1e-6  # [m], of a recorded tip from the tip of the robot that is said to have moved


class OtherRobotError(InvalidValueError):
    """A recording that another robot has left than the one that is said to have moved."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A robot's joint positions over time; what lies between two rows is interpolated linearly."""

    robot: Robot
    time: Array  # (rows,) [s], rising
    q: Array  # (rows, m) [rad or m]

    def __post_init__(self) -> None:
        joints = len(self.robot.moving)
        if self.q.shape != (len(self.time), joints) or not len(self.time):
            raise InvalidValueError(
                f"a motion of {self.robot.name!r} has {len(self.time)} times and joint positions "
                f"of shape {self.q.shape}; there must be one row of {joints} at each time"
            )
        if not (np.isfinite(self.time).all() and np.isfinite(self.q).all()):
            raise InvalidValueError(f"a motion of {self.robot.name!r} has a value not finite")
        if (np.diff(self.time) < 0.0).any():
            raise InvalidValueError(f"the times of a motion of {self.robot.name!r} fall somewhere")

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    def sampled(self, rate: float) -> Self:
        """Return the motion at equal distances of time, beginning with its first row.

        Parameters
        ----------
        rate : float
            Rows a second [1/s].

        Returns
        -------
        Motion
            Of ``floor(duration * rate) + 1`` rows.
        """
        count = int(np.floor(self.duration * rate + 1e-9)) + 1
        time = self.time[0] + np.arange(count) / rate
        q = np.column_stack([np.interp(time, self.time, column) for column in self.q.T])
        return type(self)(robot=self.robot, time=time, q=q)

    def poses(self) -> Array:
        """Poses of all frames of the table in the base frame, the base's own first.

        Returns
        -------
        X_BF : (rows, n + 1, 4, 4) ndarray
            Homogeneous transforms [-, m].
        """
        return frame_poses(self.robot, self.q)

    def path(self) -> Array:
        """Way of the tip, as ``tip`` finds it.

        Returns
        -------
        p_BT : (rows, 3) ndarray
            In the base frame [m].
        """
        return tip(self.robot, self.poses())


def frame_poses(robot: Robot, q: ArrayLike) -> Array:
    """Poses of all frames of a robot's table in the base frame, the base's own first.

    Parameters
    ----------
    robot : Robot
        n rows, m joint positions.
    q : (..., m) array_like
        Joint positions [rad or m].

    Returns
    -------
    X_BF : (..., n + 1, 4, 4) ndarray
        Homogeneous transforms [-, m].

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in m, or is not finite.
    """
    X_B = base_transforms(robot.rows, finite_vectors("q", q, len(robot.moving)))
    base = np.broadcast_to(np.eye(4), (*X_B.shape[:-3], 1, 4, 4))
    return np.concatenate([base, X_B], axis=-3)


def tip(robot: Robot, X_BF: Array) -> Array:
    """Where the tip is: the end of the last link, or the last frame where that is farther out.

    The last frame may lie inside the last link, as the pendulum's centre of gravity does, or beyond
    it, as a tool does.

    Parameters
    ----------
    X_BF : (..., n + 1, 4, 4) ndarray
        Poses of its frames, as ``frame_poses``.

    Returns
    -------
    p_BT : (..., 3) ndarray
        [m].
    """
    index, link = [(i, s.link) for i, s in enumerate(robot.segments, 1) if s.link is not None][-1]
    link_end = X_BF[..., index, :3, :] @ [*link.end, 1.0]
    last_origin = X_BF[..., -1, :3, 3]
    reach = np.linalg.norm(last_origin - X_BF[..., index, :3, 3], axis=-1, keepdims=True)
    return np.where(reach > math.hypot(*link.end), last_origin, link_end)


def still(robot: Robot, q: ArrayLike) -> Motion:
    """Make the motion of a robot that rests.

    Parameters
    ----------
    q : (m,) array_like
        Joint positions [rad or m].

    Returns
    -------
    Motion
        Of one row, at time 0.

    Raises
    ------
    InvalidValueError
        If ``q`` has not m finite numbers.
    """
    posture = finite_vectors("q", q, len(robot.moving))
    return Motion(robot=robot, time=np.zeros(1), q=posture.reshape(1, -1))


def recorded_motion(robot: Robot, recording: Recording) -> Motion:
    """Read a motion out of a run's recording.

    Parameters
    ----------
    recording : Recording
        With ``time`` and ``q1`` ... ``qm``, or ``q`` where there is one joint, in the units of
        their headers, or in SI where these name none. Where the tip was recorded too, in ``x``,
        ``y``, ``z``, it proves that the robot is the right one.

    Raises
    ------
    InvalidValueError
        If there is no column ``time``, or a value or a unit makes no sense.
    OtherRobotError
        If the count of joint positions is another, or the recorded tip is not where this robot has
        it.
    """
    names = [header.partition("[")[0] for header in recording.columns]
    joints = sorted((name for name in names if re.fullmatch(r"q\d*", name)), key=_number)
    if len(joints) != len(robot.moving):
        raise OtherRobotError(
            f"the recording has joint positions of {len(joints)} joints and {robot.name!r} has "
            f"{len(robot.moving)}: give the one that moved, --robot"
        )
    kinds = [
        ANGLE_UNITS if segment.row.joint == "revolute" else LENGTH_UNITS for segment in robot.moving
    ]
    q = [_in_si(recording, *column) for column in zip(joints, kinds, strict=True)]
    motion = Motion(robot=robot, time=_in_si(recording, "time", TIME_UNITS), q=np.stack(q, axis=-1))
    if set("xyz") <= set(names):
        p_BT = np.stack([_in_si(recording, name, LENGTH_UNITS) for name in "xyz"], axis=-1)
        miss = float(np.abs(motion.poses()[:, -1, :3, 3] - p_BT).max())
        if miss > LARGEST_MISS:
            raise OtherRobotError(
                f"the recording's tip is up to {miss:.3g} m away from where {robot.name!r} has it: "
                "another robot moved, or one with other lengths; give the one that moved, --robot"
            )
    return motion


def _in_si(recording: Recording, name: str, units: Mapping[str, float]) -> Array:
    values, unit = recording[name], recording.unit(name)
    if unit and unit not in units:
        raise InvalidValueError(
            f"the recording's column {name} is in {unit!r}; it must be in {' or '.join(units)}"
        )
    return values * units[unit] if unit else values


def _number(name: str) -> int:
    return int(name[1:] or 1)
