"""Constraints between two frames: a distance, an angle of their z axes, a point on a curve.

Each row is a motion of the follower with respect to the base that is not possible, and the force or
torque along it is its multiplier.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from drake_leg.simulink.dynamics.curves import Curve
from drake_leg.simulink.dynamics.moment import Moment, Place, cross
from drake_leg.simulink.dynamics.solver import PULL, Constraint
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.model import Block, invalid_parameter, number
from drake_leg.simulink.multibody.mass import Array

NO_LENGTH = 1e-9  # [m], and the sine of an angle, below which there is no direction


@dataclass(frozen=True, eq=False, kw_only=True)
class Twists:
    """The motion of a place in the world: rows of rotation, then of its origin's translation."""

    J: Array  # (6, nv)
    bias: Array  # (6,), its acceleration where velocities are constant


def _twists(moment: Moment, place: Place) -> Twists:
    if not place.body:
        return Twists(J=np.zeros((6, len(moment.v))), bias=np.zeros(6))
    world, frame = moment.plant.world_frame(), moment.bodies[place.body].body_frame()
    of = (moment.context, JacobianWrtVariable.kV, frame, place.p, world, world)
    return Twists(
        J=moment.plant.CalcJacobianSpatialVelocity(*of),
        bias=moment.plant.CalcBiasSpatialAcceleration(*of).get_coeffs(),
    )


class Between(Constraint):
    """Rows between a base and a follower: ``D @ (V_follower - V_base) = 0``, and their gaps."""

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        self.block, self.base, self.follower = block, base, follower

    def gap(self, moment: Moment) -> Array:
        """Return how far each row is from being met [rad or m]."""
        raise NotImplementedError

    def directions(self, moment: Moment) -> tuple[Array, Array]:
        """Return D (r, 6) of rotation and translation, in the world, and ``dD/dt @ V`` (r,)."""
        raise NotImplementedError

    def jacobian(self, moment: Moment) -> Array:
        """Return the rows' rates per velocity of the plant, (r, nv)."""
        D, _ = self.directions(moment)
        J: Array = D @ (_twists(moment, self.follower).J - _twists(moment, self.base).J)
        return J

    def rows(self, moment: Moment) -> tuple[Array, Array]:
        """Return J (r, nv) and c (r,)."""
        D, turning = self.directions(moment)
        base, follower = _twists(moment, self.base), _twists(moment, self.follower)
        J = D @ (follower.J - base.J)
        bias = D @ (follower.bias - base.bias) + turning
        return J, -bias - 2.0 * PULL * (J @ moment.v) - PULL**2 * self.gap(moment)

    def act(self, moment: Moment, multipliers: Array, wrenches: Wrenches) -> None:
        """Add the wrench on the follower, and its opposite on the base."""
        wrench = multipliers @ self.directions(moment)[0]
        for place, sign in ((self.follower, 1.0), (self.base, -1.0)):
            point = moment.pose(place)[1]
            wrenches.add(moment, place.body, point, sign * wrench[3:], sign * wrench[:3])

    def motion(self, moment: Moment) -> Array:
        """Return the twist of the follower less that of the base, of their origins, (6,)."""
        follower, base = (
            np.concatenate(moment.twist(place)) for place in (self.follower, self.base)
        )
        apart: Array = follower - base
        return apart


class Distance(Between):
    """One row: the origins stay at a distance."""

    def __init__(self, block: Block, base: Place, follower: Place) -> None:
        super().__init__(block, base, follower)
        self._distance = number(block.parameters.get("Distance"))
        if not (self._distance > 0.0 and math.isfinite(self._distance)):
            raise invalid_parameter(
                block, "Distance", "it must be a positive number; a joint keeps two points together"
            )

    def __len__(self) -> int:
        """Return 1."""
        return 1

    def _line(self, moment: Moment) -> tuple[float, Array]:
        apart = moment.pose(self.follower)[1] - moment.pose(self.base)[1]
        length = math.sqrt(float(apart @ apart))
        return length, apart / length if length > NO_LENGTH else np.array([0.0, 0.0, 1.0])

    def gap(self, moment: Moment) -> Array:
        """Return how far too far apart the origins are [m]."""
        return np.array([self._line(moment)[0] - self._distance])

    def directions(self, moment: Moment) -> tuple[Array, Array]:
        """Return the line from the base to the follower, and how it turns."""
        length, along = self._line(moment)
        v = self.motion(moment)[3:]
        across = float(v @ v) - float(v @ along) ** 2
        return np.concatenate([np.zeros(3), along])[np.newaxis], np.array(
            [across / max(length, NO_LENGTH)]
        )


class Angle(Between):
    """One row: the z axes have an angle between 0 and 180 degrees."""

    def __init__(self, block: Block, base: Place, follower: Place, angle: float) -> None:
        super().__init__(block, base, follower)
        self._angle = angle

    def __len__(self) -> int:
        """Return 1."""
        return 1

    def _axes(self, moment: Moment) -> tuple[Array, Array, Array, float]:
        """Return both z axes, the axis that turns one toward the other, and the angle's sine."""
        z_B, z_F = (moment.pose(place)[0][:, 2] for place in (self.base, self.follower))
        across = cross(z_B, z_F)
        sine = math.sqrt(float(across @ across))
        axis = across / sine if sine > NO_LENGTH else moment.pose(self.base)[0][:, 0]
        return z_B, z_F, axis, sine

    def gap(self, moment: Moment) -> Array:
        """Return how much too great the angle is [rad]."""
        z_B, z_F, _, sine = self._axes(moment)
        return np.array([math.atan2(sine, float(z_B @ z_F)) - self._angle])

    def directions(self, moment: Moment) -> tuple[Array, Array]:
        """Return the axis about which the angle grows, and how it turns."""
        z_B, z_F, axis, sine = self._axes(moment)
        w_B, w_F = (moment.twist(place)[0] for place in (self.base, self.follower))
        change = cross(cross(w_B, z_B), z_F) + cross(z_B, cross(w_F, z_F))
        change = (change - (change @ axis) * axis) / max(sine, NO_LENGTH)
        D = np.concatenate([axis, np.zeros(3)])[np.newaxis]
        return D, np.array([float(change @ (w_F - w_B))])


class Parallel(Between):
    """Two rows: the z axes are parallel, in one direction or in opposite ones."""

    def __init__(self, block: Block, base: Place, follower: Place, sign: float) -> None:
        super().__init__(block, base, follower)
        self._sign = sign

    def __len__(self) -> int:
        """Return 2."""
        return 2

    def gap(self, moment: Moment) -> Array:
        """Return how far the follower is turned about the x and the y of the base [rad]."""
        R_WB, z_F = moment.pose(self.base)[0], self._sign * moment.pose(self.follower)[0][:, 2]
        x, y, z = (R_WB.T @ z_F).tolist()
        sine = math.hypot(x, y)
        if sine < NO_LENGTH:
            return np.array([0.0 if z > 0.0 else math.pi, 0.0])
        angle = math.atan2(sine, z)
        return angle / sine * np.array([-y, x])

    def directions(self, moment: Moment) -> tuple[Array, Array]:
        """Return the x and the y of the base, and how they turn."""
        R_WB = moment.pose(self.base)[0]
        w_B = moment.twist(self.base)[0]
        D = np.column_stack([R_WB[:, :2].T, np.zeros((2, 3))])
        w = self.motion(moment)[:3]
        return D, np.array([float(cross(w_B, R_WB[:, place]) @ w) for place in (0, 1)])


class OnCurve(Constraint):
    """Two rows: the follower's origin is on a curve of the base."""

    def __init__(self, block: Block, base: Place, follower: Place, curve: Curve) -> None:
        self.block, self._base, self._follower, self._curve = block, base, follower, curve

    def __len__(self) -> int:
        """Return 2."""
        return 2

    def _on(self, moment: Moment) -> tuple[Array, Array, Array, Array]:
        """Return the way from the curve, two normals as columns (3, 2), and both derivatives.

        All are those of the nearest point of the curve, in the base.
        """
        (R_WB, p_WB), (_, p_WF) = moment.pose(self._base), moment.pose(self._follower)
        point = R_WB.T @ (p_WF - p_WB)
        on, first, second = self._curve.at(self._curve.nearest(point))
        along = first / math.sqrt(float(first @ first))
        x = cross(np.eye(3)[np.abs(along).argmin()], along)
        x /= math.sqrt(float(x @ x))
        return point - on, np.column_stack([x, cross(along, x)]), first, second

    def _seen(self, moment: Moment) -> tuple[Array, Array]:
        """Return the velocity of the follower in the base per velocity (3, nv), and its bias."""
        plant, world = moment.plant, moment.plant.world_frame()
        frames = [
            moment.bodies[place.body].body_frame() if place.body else world
            for place in (self._base, self._follower)
        ]
        of = (
            moment.context, JacobianWrtVariable.kV, frames[1], self._follower.p, frames[0],
            frames[0],
        )  # fmt: skip
        J = plant.CalcJacobianTranslationalVelocity(*of)
        bias = plant.CalcBiasTranslationalAcceleration(*of)
        return self._base.R.T @ J, self._base.R.T @ bias.ravel()

    def gap(self, moment: Moment) -> Array:
        """Return how far from the curve the point is [m]."""
        apart, N, _, _ = self._on(moment)
        gap: Array = N.T @ apart
        return gap

    def jacobian(self, moment: Moment) -> Array:
        """Return the rates across the curve per velocity of the plant, (2, nv)."""
        J: Array = self._on(moment)[1].T @ self._seen(moment)[0]
        return J

    def rows(self, moment: Moment) -> tuple[Array, Array]:
        """Return J (2, nv) and c (2,); the curve bends the way of what runs along it."""
        apart, N, first, second = self._on(moment)
        J, bias = self._seen(moment)
        v = J @ moment.v
        rate = float(v @ first) / float(first @ first)
        c = N.T @ (second * rate**2 - bias - 2.0 * PULL * v - PULL**2 * apart)
        return N.T @ J, c

    def act(self, moment: Moment, multipliers: Array, wrenches: Wrenches) -> None:
        """Add the force on the follower, and its opposite on the base, at the point."""
        force = moment.pose(self._base)[0] @ (self._on(moment)[1] @ multipliers)
        point = moment.pose(self._follower)[1]
        wrenches.add(moment, self._follower.body, point, force)
        wrenches.add(moment, self._base.body, point, -force)


def angle_of(block: Block, base: Place, follower: Place) -> Between:
    """Return the constraint of an Angle Constraint.

    Raises
    ------
    InvalidValueError
        If its type is not known, or its angle is not between 0 and 180 degrees.
    """
    kind = str(block.parameters.get("Type")).replace("-", "").replace(" ", "").lower()
    if kind in ("parallel", "antiparallel"):
        return Parallel(block, base, follower, 1.0 if kind == "parallel" else -1.0)
    if kind == "perpendicular":
        return Angle(block, base, follower, math.pi / 2.0)
    if kind != "general":
        raise invalid_parameter(
            block, "Type", "it must be General, Parallel, Anti-Parallel or Perpendicular"
        )
    angle = number(block.parameters.get("Angle"))
    if not 0.0 < angle < math.pi:
        raise invalid_parameter(block, "Angle", "it must be between 0 and 180 degrees")
    return Angle(block, base, follower, angle)
