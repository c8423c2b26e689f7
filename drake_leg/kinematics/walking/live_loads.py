"""The loads of a walk that is driven while it goes: a feed-forward for its servos."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.walking.gaits import Motion, in_body
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.live import LiveTorques, LiveWalk, Moment
from drake_leg.kinematics.walking.loads import outwards_on, planned_loads
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.robot.ground import FLAT
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import Servo
from drake_leg.units import STANDARD_GRAVITY


def live_torques(robot: Robot, servo: Servo, *, gravity: float = STANDARD_GRAVITY) -> LiveTorques:
    """Return the feed-forward of a robot's servos for a ``LiveWalk`` on level ground.

    It is that of a planned walk with the same motion: weight and inertia of all links, spread over
    the standing feet. Joints of a foot that is out of reach get none.
    """
    legs, downwards = Legs.of(robot), (0.0, 0.0, -gravity)

    def torques(walk: LiveWalk, now: Moment, then: Moment) -> Array:
        instant = _Instant(walk, now, then)
        plan = PlannedWalk(
            robot=robot,
            legs=legs,
            walk=instant,
            times=np.zeros(1),
            gravity=downwards,
            outwards=outwards_on(FLAT),
        )
        return np.asarray(np.nan_to_num(planned_loads(plan, servo).torques[0]))

    return torques


@dataclass(frozen=True)
class _Instant:
    """The end of a time step of a driven walk, as a walk at a single time."""

    walk: LiveWalk
    now: Moment
    then: Moment

    @property
    def period(self) -> float:
        """Of the gait [s]."""
        return self.walk.period

    @property
    def begins(self) -> float:
        """No time is before its only one."""
        return 0.0

    def body(self, time: Array) -> Motion:
        """Pose X_GB, (1, 4, 4), with derivatives."""
        at, (forward, sideways, turning) = self.then, self.then.velocity
        ahead, aside, bend = at.acceleration
        K = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        X = at.X_GB
        R, dX, ddX = X[:3, :3], np.zeros((4, 4)), np.zeros((4, 4))
        dX[:3, :3] = turning * R @ K
        ddX[:3, :3] = R @ (bend * K + turning**2 * K @ K)
        dX[:3, 3] = R @ np.array([forward, sideways, at.climb])
        ddX[:3, 3] = R @ np.array(
            [ahead - turning * sideways, aside + turning * forward, at.climbing]
        )
        return Motion(X[np.newaxis], dX[np.newaxis], ddX[np.newaxis])

    def feet_in_world(self, time: Array) -> Motion:
        """Feet p_GF, (1, n, 3) [m], with velocities and accelerations."""
        bend = (self.then.speeds - self.now.speeds) / self.walk.step
        parts = (self.then.feet, self.then.speeds, bend)
        return Motion(*(part[np.newaxis] for part in parts))

    def feet(self, time: Array) -> Motion:
        """Feet p_BF, (1, n, 3) [m], with derivatives."""
        return in_body(self.body(time), self.feet_in_world(time))

    def down(self, time: Array) -> NDArray[np.bool_]:
        """Whether each foot stands, (1, n)."""
        return self.then.down[np.newaxis]

    def firmness(self, time: Array, fading: float) -> Array:
        """How firmly each foot stands, (1, n)."""
        return self.walk.firmness(self.then, fading)[np.newaxis]
