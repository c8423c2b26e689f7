"""Forces and torques on bodies, added up."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from drake_leg.simulink.dynamics.moment import Moment, cross
from drake_leg.simulink.multibody.mass import Array


class Wrenches:
    """Torques about bodies' origins, then forces, in the world, by the number of the body."""

    def __init__(self, start: Mapping[int, Array] | None = None) -> None:
        self.by_body: dict[int, Array] = {
            body: wrench.copy() for body, wrench in (start or {}).items()
        }

    def add(
        self, moment: Moment, body: int, point: Array, force: Array, torque: Array | None = None
    ) -> None:
        """Add a force at a point, and a torque, all in the world; the world itself takes all."""
        if body == 0:
            return
        total = self.by_body.setdefault(body, np.zeros(6))
        total[:3] += cross(point - moment.body_pose(body)[:, 3], force)
        total[3:] += force
        if torque is not None:
            total[:3] += torque
