"""Where every frame of a robot is, moment by moment, from recorded joint positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, finite_vectors
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.recording import Recording
from drake_leg.robot import Robot

LARGEST_MISS = 1e-6  # [m], of a recorded tip from the tip of the robot that is said to have moved


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
        """Way of the tip, the origin of the last frame.

        Returns
        -------
        p_BT : (rows, 3) ndarray
            In the base frame [m].
        """
        tip: Array = self.poses()[:, -1, :3, 3]
        return tip


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


def still(robot: Robot, q: ArrayLike) -> Motion:
    """Make the motion of a robot that rests.

    Parameters
    ----------
    robot : Robot
        m joint positions.
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
    robot : Robot
        What moved.
    recording : Recording
        With ``time`` and ``q1`` ... ``qm``, or ``q`` where there is one joint. Where the tip was
        recorded too, in ``x``, ``y``, ``z``, it proves that the robot is the right one.

    Returns
    -------
    Motion

    Raises
    ------
    InvalidValueError
        If a column is missing, or the recorded tip is not where this robot has it.
    """
    names = {header.partition("[")[0] for header in recording.columns}
    count = len(robot.moving)
    joints = ["q"] if count == 1 and "q" in names else [f"q{i + 1}" for i in range(count)]
    motion = Motion(robot=robot, time=recording["time"], q=recording.stack(*joints))
    if names.issuperset("xyz"):
        miss = float(np.abs(motion.path() - recording.stack("x", "y", "z")).max())
        if miss > LARGEST_MISS:
            raise InvalidValueError(
                f"the recording's tip is up to {miss:.3g} m away from where {robot.name!r} has it: "
                "the run was made with other lengths; give the robot that moved"
            )
    return motion
