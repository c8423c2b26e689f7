"""Keeps the loops of a shown robot closed."""

from __future__ import annotations

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot
from drake_leg.scene.showable import Showable
from drake_leg.scene.shown_plant import ShownPlant


class Closing:
    """Moves the passive joints of a plant's postures (q,) so that the robot's loops are closed."""

    def __init__(self, robot: Robot, plant: ShownPlant) -> None:
        self._loops = ClosedLoops(robot)
        self._joints = np.asarray(plant.joints)

    @property
    def driven(self) -> tuple[str, ...]:
        """Names of the active joints."""
        return self._loops.active

    def near(self, posture: Array) -> Array:
        """Close the loops; the active joints stay where they are."""
        closed, q = posture.copy(), posture[self._joints]
        closed[self._joints] = self._loops.position(q[self._loops.active_columns], q)
        return closed

    def moved(self, before: Array, after: Array) -> Array:
        """Move from a closed posture to the active joints' new positions; stay if they block."""
        closed, goal = after.copy(), after[self._joints][self._loops.active_columns]
        try:
            closed[self._joints] = self._loops.moved(before[self._joints], goal)
        except SingularConfigurationError:
            return before
        return closed


def closing(what: Showable, plant: ShownPlant) -> Closing | None:
    """Return what keeps loops closed; None where there are none."""
    return Closing(what, plant) if isinstance(what, Robot) and what.loops else None
