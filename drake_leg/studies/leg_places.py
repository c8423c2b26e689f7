"""Straight steps of many legs as data, and where along them the legs are, in closed form.

A leg's foot goes along a line, so that its posture follows from the distance it has gone: with
the foot's distance h from the hip axis and its height w, ``u = h - l1`` and ``r^2 = u^2 + w^2`` is
seen from the knee,

- ``l2 l3 sin q3 = sqrt(((l2 + l3)^2 - r^2) (r^2 - (l2 - l3)^2)) / 2``,
- the singular values of the Jacobian are h and those of the two-link arm, whose squares have the
  sum ``r^2 + l3^2`` and whose product is ``l2 l3 |sin q3|``.

No angle is computed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drake_leg.kinematics.khalil import Array

Booleans = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class LegSteps:
    """Steps of n legs; each entry is (n,)."""

    l1: Array  # [m]
    l2: Array
    l3: Array
    side: Array  # the leg's sign: of the knee axis
    facing: Array  # +1 with the foot in front of the hip axis, -1 behind it
    bend: Array  # sign of sin q3
    x: Array  # of the foot at the start [m]
    y: Array
    z: Array
    along_x: Array  # heading of the foot's first motion, a unit vector
    along_y: Array
    along_z: Array
    speed: Array  # greatest, of the sine [m/s]
    frequency: Array  # [rad/s]
    end: Array  # part of the line that is gone: sin^2(w t / 2), 1 where the foot turns back
    weight_2: Array  # that the knee carries at the ankle, and half a femur's [N]
    weight_3: Array  # that the ankle carries at the foot, and half a tibia's [N]

    @classmethod
    def of(cls, q0: Array, side: Array, direction: Array, **numbers: Array) -> Self:
        """Start n legs at postures (n, 3) [rad], along directions (n, 3) of any length.

        ``numbers`` are l1, l2, l3, amplitude, frequency, duration, weight_2, weight_3, (n,) each.
        """
        l1, l2, l3 = numbers["l1"], numbers["l2"], numbers["l3"]
        q1, q2, q3 = q0.T
        reach = l1 + l2 * np.cos(q2) + l3 * np.cos(q2 + q3)
        height = l2 * np.sin(q2) + l3 * np.sin(q2 + q3)
        amplitude, frequency = numbers["amplitude"], numbers["frequency"]
        length = np.copysign(np.linalg.norm(direction, axis=1), amplitude)
        along_x, along_y, along_z = direction.T / length
        return cls(
            l1=l1,
            l2=l2,
            l3=l3,
            side=side,
            facing=np.where(reach >= 0.0, 1.0, -1.0),
            bend=np.where(np.sin(q3) >= 0.0, 1.0, -1.0),
            x=np.cos(q1) * reach,
            y=np.sin(q1) * reach,
            z=side * height,
            along_x=along_x,
            along_y=along_y,
            along_z=along_z,
            speed=np.abs(amplitude),
            frequency=frequency,
            end=np.sin(0.5 * np.minimum(frequency * numbers["duration"], np.pi)) ** 2,
            weight_2=numbers["weight_2"],
            weight_3=numbers["weight_3"],
        )

    def __len__(self) -> int:
        return len(self.l1)

    def of_rows(self, rows: NDArray[np.intp] | Booleans | slice) -> Self:
        """Take some of the legs."""
        return type(self)(**{each.name: getattr(self, each.name)[rows] for each in fields(self)})

    @cached_property
    def size(self) -> Array:
        """Length of the stretched leg [m]."""
        return self.l1 + self.l2 + self.l3

    @cached_property
    def length(self) -> Array:
        """Length of the line that the sine has [m]."""
        return 2.0 * self.speed / self.frequency

    def time(self, part: Array) -> Array:
        """Time at which the foot first reaches a part of the line (n,) [s]."""
        found: Array = 2.0 / self.frequency * np.arcsin(np.sqrt(part))
        return found

    @cached_property
    def level(self) -> Array:
        """Length of the line, seen from above [m]."""
        return self.length * np.hypot(self.along_x, self.along_y)

    @cached_property
    def past_hip(self) -> Array:
        """Part of the line where it is nearest to the hip axis; negative before its start."""
        across = (self.along_x**2 + self.along_y**2) * self.length
        to = -(self.x * self.along_x + self.y * self.along_y)
        return np.divide(to, across, out=np.full_like(to, -1.0), where=across > 0.0)

    @cached_property
    def least_hip_distance(self) -> Array:
        """How near a whole step comes to the hip axis, (n,) [m]."""
        nearest = np.clip(self.past_hip, 0.0, self.end)
        least: Array = Place(self, nearest).hip_distance
        return least

    @cached_property
    def turning(self) -> Array:
        """Size of the line's moment about the hip axis, for a unit of velocity [m]."""
        return np.abs(self.x * self.along_y - self.y * self.along_x)

    @cached_property
    def from_hip(self) -> Array:
        """How near the whole line comes to the hip axis [m]."""
        across = np.hypot(self.along_x, self.along_y)
        outside = np.hypot(self.x, self.y)
        return np.divide(self.turning, across, out=outside, where=across > 0.0)


class Place:
    """Where n legs have their feet at parts of their lines, (m, n), and what follows from it."""

    def __init__(self, steps: LegSteps, part: Array) -> None:
        self._of = steps
        self._part = part

    @cached_property
    def _past_hip(self) -> Array:
        """How far the foot has passed the hip axis, along the line seen from above [m]."""
        return self._of.level * (self._part - self._of.past_hip)

    @cached_property
    def _hip_square(self) -> Array:
        return self._past_hip * self._past_hip + self._of.from_hip**2

    @cached_property
    def hip_distance(self) -> Array:
        """h, from the hip axis [m]."""
        return np.sqrt(self._hip_square)

    @cached_property
    def _speed(self) -> Array:
        """``A sin(w t)`` with ``sin^2(w t / 2)`` the part of the line [m/s]."""
        return 2.0 * self._of.speed * np.sqrt(self._part * (1.0 - self._part))

    @cached_property
    def outwards(self) -> Array:
        """u, of the foot from the knee, in the plane of the leg [m]."""
        return self._of.facing * self.hip_distance - self._of.l1

    @cached_property
    def across(self) -> Array:
        """w, of the foot from the knee [m]."""
        of = self._of
        return of.side * of.z + of.side * of.length * of.along_z * self._part

    @cached_property
    def square(self) -> Array:
        """r^2, of the distance from knee to foot [m^2]."""
        return self.outwards * self.outwards + self.across * self.across

    @cached_property
    def room(self) -> tuple[Array, Array]:
        """Up to the stretched and the folded leg, negative beyond: of r^2 [m^2]."""
        return (
            (self._of.l2 + self._of.l3) ** 2 - self.square,
            self.square - (self._of.l2 - self._of.l3) ** 2,
        )

    @cached_property
    def _twice_bent(self) -> Array:
        """``2 l2 l3 |sin q3|`` [m^2]."""
        stretched, folded = self.room
        return np.sqrt(np.maximum(stretched * folded, 0.0))

    @cached_property
    def bent(self) -> Array:
        """``l2 l3 sin q3`` [m^2]."""
        return 0.5 * self._of.bend * self._twice_bent

    @cached_property
    def slope(self) -> Array:
        """Derivative of r^2 by the part of the line [m^2]."""
        of = self._of
        outwards = of.facing * of.level * self._past_hip / self.hip_distance
        across = of.side * of.length * of.along_z
        return 2.0 * (self.outwards * outwards + self.across * across)

    @cached_property
    def tibia(self) -> tuple[Array, Array]:
        """The tibia outwards and across, ``l3 cos(q2 + q3)`` and ``l3 sin(q2 + q3)`` [m]."""
        inverse = 1.0 / self.square
        part = 0.5 + 0.5 * (self._of.l3**2 - self._of.l2**2) * inverse
        turned = self.bent * inverse
        return (
            part * self.outwards - turned * self.across,
            part * self.across + turned * self.outwards,
        )

    @cached_property
    def arm_sigma(self) -> Array:
        """Smallest singular value of the two-link arm [m]."""
        total, product = self.square + self._of.l3**2, self._twice_bent
        both = np.sqrt(total + product) + np.sqrt(np.maximum(total - product, 0.0))
        sigma: Array = product / both
        return sigma

    @cached_property
    def determinant(self) -> Array:
        """Of the Jacobian [m^3]."""
        return -self._of.side * self._of.facing * self.bent * self.hip_distance

    @cached_property
    def _motion(self) -> tuple[Array, Array]:
        """Foot's velocity outwards and across [m/s]."""
        of, speed = self._of, self._speed
        level = of.facing * np.hypot(of.along_x, of.along_y)
        return level * self._past_hip * speed / self.hip_distance, of.side * of.along_z * speed

    def rate(self, joint: int) -> Array:
        """Size of a joint's rate [rad/s]."""
        if joint == 0:
            return self._of.turning * self._speed / self._hip_square
        outwards, across = self._motion
        u, w = self.tibia if joint == 1 else (self.outwards, self.across)
        return np.abs((u * outwards + w * across) / self.bent)

    def torque(self, joint: int) -> Array:
        """Size of the torque that holds a joint at rest [N*m]; the hip axis is vertical."""
        u, _ = self.tibia
        carried = self._of.weight_3 * u
        if joint == 1:
            carried = carried + self._of.weight_2 * (self.outwards - u)
        return np.abs(carried)


Quantity = Callable[[Place], Array]

QUANTITIES: dict[str, Quantity] = {
    "arm_sigma": lambda place: -place.arm_sigma,
    "det_min": lambda place: -place.determinant,
    "det_max": lambda place: place.determinant,
    "rate_1": lambda place: place.rate(0),
    "rate_2": lambda place: place.rate(1),
    "rate_3": lambda place: place.rate(2),
    "torque_2": lambda place: place.torque(1),
    "torque_3": lambda place: place.torque(2),
}
