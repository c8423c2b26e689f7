"""A walk as a robot's blocks look it up: one row for each time step."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.gait import GAITS, Gait
from drake_leg.kinematics.walking.gaits import Attitude, Command, Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.sequence import WalkSequence
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot

ROWS = 1024  # that are planned at once
ON_TIME = 1e-6  # of a time step: how far a time may be from a multiple of it


def walk_of(
    robot: Robot,
    gait: Gait = GAITS["tripod"],
    *,
    period: float = 1.0,
    lift: float = 0.03,
    commands: Sequence[Command] = (),
    attitudes: Sequence[Attitude] = (),
    height: float | None = None,
    foot_height: float = 0.0,
) -> Walk:
    """Plan a walk of a robot whose feet stand, at rest, where its starting posture has them.

    Parameters
    ----------
    robot : Robot
        With legs of three joints on a floating body.
    gait : Gait
        With as many legs.
    period : float
        Of the gait [s].
    lift : float
        Height of a swing [m].
    commands, attitudes : sequence
        Of the body.
    height : float, optional
        Of the body over the ground [m]; by default that of the starting posture.
    foot_height : float
        Of a standing foot's point over the ground [m]: the radius of a ball.

    Raises
    ------
    InvalidValueError
        If the robot has no such legs, or a number makes no sense.
    """
    legs = Legs.of(robot)
    require_phases(gait, robot.name, legs.count)
    feet = legs.feet(np.reshape(starting_posture(robot), (-1, 3)))
    if height is None:
        height = foot_height - float(feet[:, 2].mean())
    standing = Attitude(shift=(0.0, 0.0, height), start=-1.0, lasting=1.0)
    feet[:, 2] = foot_height
    return Walk(
        gait=gait,
        period=period,
        neutral=feet,
        lift=lift,
        commands=commands,
        attitudes=(standing, *attitudes),
    )


def require_phases(gait: Gait, robot: str, legs: int) -> None:
    """Refuse a gait for another number of legs than a robot has."""
    if len(gait.phases) != legs:
        raise InvalidValueError(
            f"the gait {gait.name!r} is for {len(gait.phases)} legs, and {robot!r} has {legs}: it "
            f"needs {legs} `phases`, one for each leg"
        )


class PlanRow(NamedTuple):
    """The plan for one time step; G is the frame of the ground, B that of the body.

    Velocities are means of those at the beginning and at the end of the step, so that blocks that
    hold them for the step integrate them to second order; that of the body's place is its way in
    the step. All else is at the beginning, the torques, too: a discrete plant has its masses,
    weights and contacts there, and the difference of two mean velocities is the acceleration there.
    """

    X_GB: Array  # (4, 4) [-, m]
    twist: Array  # (6,), of B in G, expressed in B [rad/s, m/s]
    feet: Array  # (n, 3), p_BF [m]
    swing: Array  # (n, 3), velocity of the feet in G, expressed in B [m/s]
    down: NDArray[np.bool_]  # (n,)
    torques: Array  # (3 n,), feed-forward of the joints [N*m]
    swung: Array  # (2, n), how much of its swing a foot has done, and has at the end of the step


Torques = Callable[[Array], Array]  # times (rows,) to the joints' torques (rows, 3 n)


class Plan(Protocol):
    """What the blocks of a robot that walks look up, time step by time step."""

    step: float  # [s]

    def at(self, time: float) -> PlanRow:
        """Return the row of a time [s]."""
        ...


class WalkPlan:
    """The rows of a walk, planned in blocks when their time comes.

    Parameters
    ----------
    walk : Walk or WalkSequence
        A function of time.
    step : float
        Between two rows [s].
    torques : callable, optional
        The feed-forward, times (rows,) [s] to (rows, 3 n) [N*m]; by default none.
    """

    def __init__(
        self, walk: Walk | WalkSequence, *, step: float, torques: Torques | None = None
    ) -> None:
        self.walk, self.step = walk, step
        self._torques = torques
        self._first, self._rows = 0, list[PlanRow]()

    def at(self, time: float) -> PlanRow:
        """Return the row of a time [s]."""
        number = round(time / self.step)
        if abs(time - number * self.step) > ON_TIME * self.step:
            return self._planned(np.array([time, time + self.step]))[0]
        if not 0 <= number - self._first < len(self._rows):
            self._first = number
            self._rows = self._planned(
                self.step * np.arange(number, number + ROWS + 1, dtype=np.float64)
            )
        return self._rows[number - self._first]

    def _planned(self, times: Array) -> list[PlanRow]:
        """Rows for the steps between times, one less than there are."""
        X, dX, _ = self.walk.body(times)
        R, p = X[:, :3, :3], X[:, :3, 3]
        turning = np.einsum("tji,tjk->tik", R, dX[:, :3, :3])  # skew of the angular velocity
        w = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=-1)
        way = np.diff(p, axis=0) / np.diff(times)[:, np.newaxis]
        v = np.einsum("tji,tj->ti", R[:-1], way)
        in_ground, velocity, _ = self.walk.feet_in_world(times)
        feet = np.einsum("tji,tnj->tni", R, in_ground - p[:, np.newaxis])
        swing = np.einsum("tji,tnj->tni", R, velocity)
        if self._torques is None:
            torques = np.zeros((len(times), 3 * feet.shape[1]))
        else:
            torques = self._torques(times)
        down = self.walk.down(times)
        parts = (
            X,
            np.hstack([_means(w), v]),
            feet,
            _means(swing),
            down,
            torques[:-1],
            self._swung(times, down),
        )
        return [PlanRow(*row) for row in zip(*parts, strict=False)]

    def _swung(self, times: Array, down: NDArray[np.bool_]) -> Array:
        """How much of its swing each foot has done, (rows, 2, n); 0 where it stands."""
        done = np.where(down, 0.0, self.walk.swung(times))
        end = np.where(down[:-1], 0.0, np.where(down[1:], 1.0, done[1:]))
        return np.stack([done[:-1], end], axis=1)


def _means(rows: Array) -> Array:
    """Means of neighboring rows."""
    return np.asarray((rows[:-1] + rows[1:]) / 2.0)


def difference(X_GB: Array, R_GS: Array, p_GS: Array) -> list[float]:
    """Twist (6,) that takes a sensed pose S to a planned pose B in unit time, in S.

    Rotation first [rad, m]; it is exact for a rotation, and puts translation beside it.
    """
    R = R_GS.T @ X_GB[:3, :3]
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2.0
    sine = math.sqrt(float(axis @ axis))
    angle = math.atan2(sine, (float(R[0, 0] + R[1, 1] + R[2, 2]) - 1.0) / 2.0)
    scale = angle / sine if sine > 1e-12 else 1.0
    return [*(scale * axis).tolist(), *(R_GS.T @ (X_GB[:3, 3] - p_GS)).tolist()]


def levelling_twist(planned: Array, sensed: Array) -> Array:
    """Rotation vector (3,) [rad] that turns a body until up is where it is planned.

    Both are unit vectors upwards, (3,), in the frame of the body. It has the least angle.
    """
    axis = np.cross(planned, sensed)
    sine = math.sqrt(float(axis @ axis))
    angle = math.atan2(sine, float(planned @ sensed))
    return axis * (angle / sine if sine > 1e-12 else 1.0)
