"""The legs of a walking robot, all at once: joints for feet and back, in closed form.

Every leg has a hip whose axis is vertical in the body's frame B, and a knee and an ankle whose axes
are horizontal and parallel, so that femur and tibia move in a plane through the hip's axis. Its
closed forms are those of the reports' leg; the joint angles differ from that leg's angles by a sign
and an offset, which follow from where the table puts the frames.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import (
    Array,
    base_transforms,
    finite_vectors,
    nearest_turn,
)
from drake_leg.kinematics.leg import (
    LegGeometry,
    inverse_kinematics,
    rates_and_accelerations,
    sigma_min,
)
from drake_leg.kinematics.walking.gaits import Motion
from drake_leg.kinematics.walking.leg_on_body import LegOnBody
from drake_leg.kinematics.walking.legs_together import LegsTogether
from drake_leg.robot.robot import Robot, require_robot

JOINTS = ("hip", "knee", "ankle")
STRAIGHT = 1e-9  # how far an axis may be from its direction [rad], or a foot from its plane [-]
_KNEE_UP = (0.0, 0.0, -math.pi / 2)  # [rad], a posture of that branch, the foot before the hip


@dataclass(frozen=True, kw_only=True, eq=False)
class Legs:
    """Legs of three joints on a floating body, in the order of the table.

    A leg's own angles are ``offsets + signs * q``: the direction of its plane, from x towards y;
    how far the femur points upwards; and how far the tibia points upwards from the femur.
    """

    robot: str
    names: tuple[str, ...]  # the tips', without "_foot"
    joint_names: tuple[tuple[str, str, str], ...]
    hips: Array  # (n, 3) [m], p_BH, on the hip's axis at the height of the knee
    lengths: Array  # (n, 3) [m], of coxa, femur and tibia
    limits: Array  # (n, 3, 2) [rad], lower and upper; infinite where there is none
    signs: Array  # (n, 3), -1 or 1
    offsets: Array  # (n, 3) [rad]

    @classmethod
    def of(cls, robot: Robot) -> Self:
        """Read the legs off the table of a floating robot.

        Raises
        ------
        InvalidValueError
            If the robot does not float, or one of its tips is not moved as a leg's foot is; it
            says by which joint.
        """
        require_robot(robot)
        if not robot.floating:
            raise InvalidValueError(
                f"the base of {robot.name!r} is fixed; a robot that walks has a base with "
                "`floating=True`"
            )
        if robot.loops:
            raise InvalidValueError(
                f"{robot.name!r} has closed loops; the legs of a robot that walks are open chains"
            )
        rows = _leg_rows(robot)
        X_B = base_transforms(robot.rows, np.zeros(len(robot.moving)))
        read = [_read(robot, tip, rows[tip], X_B) for tip in rows]
        hips, lengths, signs, offsets = (np.array(part) for part in zip(*read, strict=True))
        segments = [[robot.segments[row - 1] for row in rows[tip]] for tip in rows]
        return cls(
            robot=robot.name,
            names=tuple(tip.removesuffix("_foot") for tip in rows),
            joint_names=tuple(
                (str(hip.joint), str(knee.joint), str(ankle.joint)) for hip, knee, ankle in segments
            ),
            hips=hips,
            lengths=lengths,
            limits=np.array(
                [
                    [
                        (
                            -math.inf if one.mechanics.lower is None else one.mechanics.lower,
                            math.inf if one.mechanics.upper is None else one.mechanics.upper,
                        )
                        for one in leg
                    ]
                    for leg in segments
                ]
            ),
            signs=signs,
            offsets=offsets,
        )

    @property
    def count(self) -> int:
        """How many legs there are."""
        return len(self.names)

    @cached_property
    def geometries(self) -> tuple[LegGeometry, ...]:
        """Every leg for the closed forms of its own angles."""
        return tuple(
            LegGeometry(l1=float(coxa), l2=float(femur), l3=float(tibia), sign=1)
            for coxa, femur, tibia in self.lengths
        )

    @cached_property
    def movable(self) -> LegsTogether:
        """All legs for an inverse Jacobian block, in the table's angles and the body's frame."""
        parts = (self.hips.tolist(), self.signs.tolist(), self.offsets.tolist())
        return LegsTogether(
            [
                LegOnBody(leg, *on_body)
                for leg, on_body in zip(self.geometries, zip(*parts, strict=True), strict=True)
            ]
        )

    def joints(self, feet: ArrayLike) -> Array:
        """Joint angles (..., n, 3) [rad] for feet p_BF (..., n, 3) [m], the knees bent upwards.

        ``legs.feet(legs.joints(feet)) == feet`` where it is not NaN, that is, in reach. Of all
        whole turns, an angle is the nearest to the middle of its joint's range.
        """
        places = self._of_all_legs("the feet", feet) - self.hips
        own = np.stack(
            [
                inverse_kinematics(leg, places[..., number, :], _KNEE_UP)
                for number, leg in enumerate(self.geometries)
            ],
            axis=-2,
        )
        return nearest_turn(self.signs * (own - self.offsets), self._middles)

    def feet(self, q: ArrayLike) -> Array:
        """Feet p_BF (..., n, 3) [m], at joint angles (..., n, 3) [rad]."""
        own = self._own(q)
        l1, l2, l3 = self._lengths
        femur, tibia = own[..., 1], own[..., 1] + own[..., 2]  # over the horizontal
        out = l1 + l2 * np.cos(femur) + l3 * np.cos(tibia)
        found = np.empty_like(own)
        found[..., 0] = np.cos(own[..., 0]) * out
        found[..., 1] = np.sin(own[..., 0]) * out
        found[..., 2] = l2 * np.sin(femur) + l3 * np.sin(tibia)
        found += self.hips
        return found

    def joints_and_feet(self, q: ArrayLike) -> Array:
        """Hip, knee, ankle and foot of every leg, (..., n, 4, 3) [m], in B: the leg as a line."""
        hip, femur, tibia = np.moveaxis(self._own(q), -1, 0)
        tibia = femur + tibia  # over the horizontal
        l1, l2, l3 = self.lengths.T
        still, c, s = np.zeros_like(hip), np.cos, np.sin
        steps_out = [still, l1 + still, l2 * c(femur), l3 * c(tibia)]
        steps_up = [still, still, l2 * s(femur), l3 * s(tibia)]
        out, up = (np.cumsum(np.stack(steps, axis=-1), axis=-1) for steps in (steps_out, steps_up))
        towards = hip[..., np.newaxis]
        line = np.stack([c(towards) * out, s(towards) * out, up], axis=-1)
        return np.asarray(self.hips[:, np.newaxis] + line)

    def jacobians(self, q: ArrayLike) -> Array:
        """``v_BF = J qdot`` of every foot by its own joints, (..., n, 3, 3) [m/rad], in B."""
        own = self._own(q)
        l1, l2, l3 = self._lengths
        c, s = np.cos(own[..., 0]), np.sin(own[..., 0])
        femur, tibia = own[..., 1], own[..., 1] + own[..., 2]  # over the horizontal
        # Out and up from the ankle, and from the knee, to the foot.
        out3, up3 = l3 * np.cos(tibia), l3 * np.sin(tibia)
        out2, up2 = out3 + l2 * np.cos(femur), up3 + l2 * np.sin(femur)
        out1 = l1 + out2
        J = np.zeros((*own.shape, 3))
        J[..., 0, 0], J[..., 1, 0] = -s * out1, c * out1
        for column, out, up in ((1, out2, up2), (2, out3, up3)):
            J[..., 0, column], J[..., 1, column], J[..., 2, column] = -c * up, -s * up, out
        J *= self.signs[:, np.newaxis]
        return J

    def forces(self, q: ArrayLike, torques: ArrayLike) -> Array:
        """Forces on the feet (..., n, 3) [N] in B, by the torques J^T f that they cause.

        Angles and torques are (..., n, 3) [rad, N*m].
        """
        J_transposed = np.swapaxes(self.jacobians(q), -1, -2)
        return np.asarray(
            np.linalg.solve(J_transposed, np.asarray(torques)[..., np.newaxis])[..., 0]
        )

    def sigma_mins(self, q: ArrayLike) -> Array:
        """Smallest singular value of every leg's Jacobian, (..., n) [m/rad]."""
        own = self._own(q)
        return np.stack(
            [sigma_min(leg, own[..., i, :]) for i, leg in enumerate(self.geometries)], axis=-1
        )

    def motion(self, feet: Motion) -> Motion:
        """Joint angles, rates and accelerations (..., n, 3) of moving feet, all in B.

        ``J qdot = v`` and ``J qddot = a - dJ/dt qdot``. NaN where a foot is out of reach; rates are
        not finite where a leg is singular.
        """
        q = self.joints(feet.value)
        own, v, a = (
            tuple(np.moveaxis(part, -1, 0)) for part in (self._own(q), feet.rate, feet.acceleration)
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            found = rates_and_accelerations(self._lengths, own, v, a)
        rates, accelerations = (np.stack(part, axis=-1) for part in found)
        return Motion(q, self.signs * rates, self.signs * accelerations)

    @cached_property
    def _lengths(self) -> tuple[Array, Array, Array]:
        """Lengths of coxae, femora and tibiae, each (n,) [m]."""
        coxa, femur, tibia = self.lengths.T.copy()
        return coxa, femur, tibia

    @cached_property
    def _middles(self) -> Array:
        """Middle of every joint's range, (n, 3) [rad]; 0 where it has none."""
        bounded = np.isfinite(self.limits).all(axis=-1)
        return np.where(bounded, np.where(np.isfinite(self.limits), self.limits, 0.0).mean(-1), 0.0)

    def _own(self, q: ArrayLike) -> Array:
        """Angles of the legs' own closed forms, (..., n, 3) [rad]; NaN stays."""
        angles = np.asarray(q, dtype=np.float64)
        return self.offsets + self.signs * angles

    def _of_all_legs(self, what: str, values: ArrayLike) -> Array:
        places = finite_vectors(what, values, 3)
        if places.ndim < 2 or places.shape[-2] != self.count:
            raise InvalidValueError(
                f"{what} have shape {places.shape}; {self.robot!r} has {self.count} legs, so it "
                f"must end in {self.count}, 3"
            )
        return places


def _leg_rows(robot: Robot) -> dict[str, tuple[int, ...]]:
    """Rows, from 1, of the three joints that move each tip, the legs one after the other."""
    found: dict[str, tuple[int, ...]] = {}
    for tip, row in robot.tips.items():
        moving = tuple(one for one in robot.path(row) if robot.rows[one - 1].joint != "fixed")
        kinds = [robot.rows[one - 1].joint for one in moving]
        if kinds != ["revolute"] * 3:
            has = ", ".join(kinds) or "none"
            raise InvalidValueError(
                f"the tip {tip!r} of {robot.name!r} is moved by {len(moving)} joints ({has}); a "
                "leg has three that are revolute: hip, knee and ankle"
            )
        found[tip] = moving
    in_table = [row for row, one in enumerate(robot.rows, start=1) if one.joint != "fixed"]
    if [row for rows in found.values() for row in rows] != in_table:
        raise InvalidValueError(
            f"the joints of {robot.name!r} do not come leg by leg in its table; every leg has its "
            "own hip, knee and ankle, in consecutive rows"
        )
    return found


def _read(
    robot: Robot, tip: str, rows: tuple[int, ...], X_B: Array
) -> tuple[Array, Array, Array, Array]:
    """Hip, lengths, signs and offsets of one leg, from its frames where all joints are at 0."""
    frames = [X_B[row - 1] for row in rows]
    (h, k, a), (hip, knee, ankle) = zip(*((X[:3, 2], X[:3, 3]) for X in frames), strict=True)
    foot = X_B[robot.tips[tip] - 1][:3, 3]
    names = [robot.segments[row - 1].joint for row in rows]

    def require(holds: bool, what: str) -> None:
        if not holds:
            raise InvalidValueError(f"the leg {tip!r} of {robot.name!r} is unlike others: {what}")

    require(
        math.hypot(h[0], h[1]) < STRAIGHT,
        f"the axis of its hip, {names[0]!r}, must be parallel to the body's z axis",
    )
    require(abs(k[2]) < STRAIGHT, f"the axis of its knee, {names[1]!r}, must be horizontal")
    require(
        float(np.linalg.norm(np.cross(k, a))) < STRAIGHT,
        f"the axis of its ankle, {names[2]!r}, must be parallel to that of its knee",
    )
    z = np.array([0.0, 0.0, 1.0])
    out = np.cross(k, z)
    out = out if (knee - hip) @ out >= 0.0 else -out
    femur, tibia = ([float(way @ out), float(way[2])] for way in (ankle - knee, foot - ankle))
    lengths = [float((knee - hip) @ out), math.hypot(*femur), math.hypot(*tibia)]
    scale = sum(lengths)
    for length, between in zip(
        lengths, ("hip and knee", "knee and ankle", "ankle and foot"), strict=True
    ):
        require(length > STRAIGHT * scale, f"there must be a distance between {between}")
    beside = float((foot - hip) @ k)
    require(
        abs(beside) < STRAIGHT * scale,
        f"its foot is {1000.0 * abs(beside):.6g} mm beside the plane in which its femur and tibia "
        "would move through the axis of its hip",
    )
    at_knee = math.atan2(femur[1], femur[0])
    return (
        np.array([hip[0], hip[1], knee[2]]),
        np.array(lengths),
        np.array([math.copysign(1.0, h[2])] + [_lifting(axis, out) for axis in (k, a)]),
        np.array([math.atan2(out[1], out[0]), at_knee, math.atan2(tibia[1], tibia[0]) - at_knee]),
    )


def _lifting(axis: Array, out: Array) -> float:
    """1 if a positive turn about a horizontal axis lifts what points outwards, else -1."""
    return math.copysign(1.0, float(np.cross(axis, out)[2]))
