"""Closed forms of the three-joint leg: foot, Jacobian, determinant, inverse kinematics.

With ci = cos qi, c23 = cos(q2 + q3) and the same for sines:

- ``reach = l1 + l2 c2 + l3 c23`` is the foot's signed distance from the hip axis (rho);
- ``depth = l2 s2 + l3 s23`` is its height over the hip, up to the sign ``s`` of the variant.

The Jacobian has two singular families: ``sin q3 = 0`` (leg stretched or folded) and
``reach = 0`` (foot on the hip axis). The foot can reach a point in up to four ways: the leg may
face it or turn its back to it (the sign of the reach), and the ankle may bend either way (the sign
of sin q3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.differentiable import cosine, sine, value_of
from drake_leg.kinematics.khalil import (
    Array,
    assemble,
    finite_vectors,
    in_blocks,
    nearest_turn,
    one_vector,
    principal,
    split,
    triangle_angle,
    within_turns,
)
from drake_leg.kinematics.movable import Floats, Functions, Movable, Values
from drake_leg.robot.robot import Robot
from drake_leg.units import LEAST, MOST, require_positive

# sin(q3), or the reach over the leg's length, below which the closed form no longer divides.
SINGULAR_BELOW = 1e-12
BRANCHES = ((1, 1), (1, -1), (-1, 1), (-1, -1))  # facing, bend
JOINTS = ("revolute", "revolute", "revolute", "fixed")  # of the reports' table


@dataclass(frozen=True, kw_only=True)
class LegGeometry:
    """Dimensions of a leg for its closed forms."""

    l1: float  # [m], coxa
    l2: float  # [m], femur
    l3: float  # [m], tibia
    sign: int  # -1 where the knee axis is turned by -90 degrees (report A), +1 by +90 (report B)

    def __post_init__(self) -> None:
        for name in ("l1", "l2", "l3"):
            require_positive(f"the length {name}", getattr(self, name), "m")
        if self.sign not in (-1, 1):
            raise InvalidValueError(f"the leg's sign is {self.sign!r}; it must be -1 or +1")

    @classmethod
    def from_robot(cls, robot: Robot) -> Self:
        """Read the lengths and the sign off the Khalil table of a leg such as ``LEG_B``."""
        if not is_hexabot_leg(robot):
            raise InvalidValueError(f"{robot.name!r} does not have the table of the reports' leg")
        rows = robot.rows
        sign = int(math.copysign(1, rows[1].alpha))
        return cls(l1=rows[1].d, l2=rows[2].d, l3=rows[3].d, sign=sign)


def is_hexabot_leg(robot: Robot) -> bool:
    """Whether a robot has the table of the reports' leg, of any lengths."""
    rows = robot.rows
    return (
        robot.is_plain
        and tuple(row.joint for row in rows) == JOINTS
        and not any(row.r or row.theta for row in rows)
        and rows[0].d == 0.0
        and all(LEAST <= row.d <= MOST for row in rows[1:])
        and abs(rows[1].alpha) == math.pi / 2
        and not any(row.alpha for row in (rows[0], *rows[2:]))
    )


class _Links(NamedTuple):
    """Terms that all closed forms of the leg share; floats, or arrays of a batch."""

    c1: Any  # of the plane in which femur and tibia move
    s1: Any
    x2: Any  # of the femur in that plane, outwards and across [m]
    z2: Any
    x3: Any  # of the tibia [m]
    z3: Any
    reach: Any  # of the foot from the hip axis [m]


def _links(leg: LegGeometry, q: ArrayLike) -> _Links:
    (q1, q2, q3), cos, sin = split("q", q, 3)
    x2, z2 = leg.l2 * cos(q2), leg.l2 * sin(q2)
    x3, z3 = leg.l3 * cos(q2 + q3), leg.l3 * sin(q2 + q3)
    return _Links(cos(q1), sin(q1), x2, z2, x3, z3, leg.l1 + (x2 + x3))


def foot_position(leg: LegGeometry, q: ArrayLike) -> Array:
    """Position p_BF of the foot in the base frame, (..., 3) [m].

    Report A, eq. 8; report B, 2.5.1 (printed with q2 - q3 for q2 + q3).
    """
    c1, s1, _, z2, _, z3, reach = _links(leg, q)
    return assemble((c1 * reach, s1 * reach, leg.sign * (z2 + z3)))


def foot_reach(leg: LegGeometry, q: ArrayLike) -> Array:
    """Signed distance of the foot from the hip axis, (...) [m]; negative behind the hip."""
    return np.asarray(_links(leg, q).reach)


def foot_and_jacobian(leg: LegGeometry, q: ArrayLike) -> tuple[Array, Array]:
    """``foot_position`` and ``foot_jacobian`` together, which share most of the work."""
    angles = finite_vectors("q", q, 3)
    if angles.ndim == 1:
        return _foot_and_jacobian(leg, angles)
    p_BF, Jv_BF = in_blocks(partial(_foot_and_jacobian, leg), angles, (3,), (3, 3))
    return p_BF, Jv_BF


def _foot_and_jacobian(leg: LegGeometry, q: Array) -> tuple[Array, Array]:
    c1, s1, x2, z2, x3, z3, reach = _links(leg, q)
    x, y, depth, across = c1 * reach, s1 * reach, z2 + z3, x2 + x3
    rows = (
        (-y, -c1 * depth, -c1 * z3),
        (x, -s1 * depth, -s1 * z3),
        (0.0, leg.sign * across, leg.sign * x3),
    )
    return assemble((x, y, leg.sign * depth)), assemble(rows)


def foot_jacobian(leg: LegGeometry, q: ArrayLike) -> Array:
    """Translational Jacobian of the foot F in the base frame B: ``v_BF = Jv_BF @ qdot``.

    (..., 3, 3) [m/rad], at the hip, knee and ankle angles (..., 3) [rad]; singular where sin(q3) =
    0 or the foot is on the hip axis (report A, eq. 15).
    """
    return foot_and_jacobian(leg, q)[1]


def determinant(leg: LegGeometry, q: ArrayLike) -> Array:
    """Determinant of the foot's translational Jacobian, factored, (...) [m^3/rad^3].

    ``det J = -s l2 l3 sin(q3) (l1 + l2 c2 + l3 c23)``: zero on both singular families (report A,
    eq. 17, printed unfactored, the family on the hip axis left out).
    """
    (_, _, q3), _, sin = split("q", q, 3)
    return np.asarray(-leg.sign * leg.l2 * leg.l3 * sin(q3) * _links(leg, q).reach)


def sigma_min(leg: LegGeometry, q: ArrayLike) -> Array:
    """Smallest singular value of the foot's translational Jacobian, (...) [m/rad].

    One singular value is the foot's distance from the hip axis. The other two are those of femur
    and tibia, the squares of which have the sum ``r^2 + l3^2``, with the foot r away from the knee,
    and the product ``(l2 l3 sin q3)^2``.
    """
    _, _, x2, z2, x3, z3, reach = _links(leg, q)
    total = np.square(x2 + x3) + np.square(z2 + z3) + leg.l3**2
    product = 2.0 * np.abs(x2 * z3 - z2 * x3)
    both = np.sqrt(total + product) + np.sqrt(np.maximum(total - product, 0.0))
    smallest: Array = np.minimum(np.abs(reach), product / both)
    return smallest


def jacobian_rate_bias(leg: LegGeometry, q: ArrayLike, qdot: ArrayLike) -> Array:
    """Acceleration of the foot at zero joint acceleration, (..., 3) [m/s^2].

    ``a_BF = Jv_BF @ qddot + bias`` with ``bias = dJv_BF/dt @ qdot``.
    """
    c1, s1, x2, z2, x3, z3, reach = _links(leg, q)
    (w1, w2, w3), _, _ = split("qdot", qdot, 3)
    w23 = w2 + w3
    radial = -x2 * w2**2 - x3 * w23**2 - reach * w1**2
    tangential = -2.0 * (z2 * w2 + z3 * w23) * w1
    vertical = -leg.sign * (z2 * w2**2 + z3 * w23**2)
    return assemble((c1 * radial - s1 * tangential, s1 * radial + c1 * tangential, vertical))


class MovableLeg(Movable):
    """The leg's foot in x, y and z, its Jacobian inverted in closed form (report A, eq. 19).

    In the leg's own plane the foot moves radially and vertically, across it tangentially:
    ``qdot1 = v_t / reach``, and the knee and the ankle solve the two-link arm,
    ``qdot2 = (c23 v_r + s23 v_z) / (l2 s3)`` and so on, with ``v_z`` signed by the variant.
    """

    geometry: LegGeometry
    has_formula = True
    _functions: tuple[Any, Any] = (math.cos, math.sin)

    def __init__(self, leg: LegGeometry) -> None:
        self.geometry = leg
        self.length = leg.l1 + leg.l2 + leg.l3
        self.determinant_scale = leg.l2 * leg.l3 * self.length
        self._numbers = leg.l1, leg.l2, leg.l3, leg.sign

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""
        return foot_position(self.geometry, q)

    def jacobian(self, q: Floats) -> Array:
        """Translational Jacobian, (3, 3) [m/rad]."""
        return foot_jacobian(self.geometry, q)

    def bias(self, q: Floats, qdot: Floats) -> Array:
        """``dJ/dt qdot``, (3,) [m/s^2]."""
        return jacobian_rate_bias(self.geometry, q, qdot)

    def determinant(self, q: Floats) -> float:
        """Det J, factored [m^3]."""
        l1, l2, l3, sign = self._numbers
        cos, sin = self._functions
        _, q2, q3 = q
        reach = l1 + l2 * cos(q2) + l3 * cos(q2 + q3)
        determinant: float = -sign * l2 * l3 * sin(q3) * reach
        return determinant

    def determinants(self, q: Array) -> Array:
        """Det J of many postures (rows, 3), (rows,) [m^3]."""
        return determinant(self.geometry, q)

    def sigma_mins(self, q: Array) -> Array:
        """Smallest singular value of J in many postures (rows, 3), (rows,) [m]."""
        return sigma_min(self.geometry, q)

    def rates(self, q: Floats, v: Floats) -> Floats:
        """``J^-1 v``."""
        return _rates(self._numbers, self._regular_plane(q), v)

    def accelerations(
        self,
        q: Floats,
        qdot: Floats,
        a: Floats,
        v: Floats | None = None,
        w: Floats | None = None,
    ) -> Floats:
        """``J^-1 (a - dJ/dt qdot)`` with J changing along w."""
        along = qdot if w is None else w
        return _accelerations(self._numbers, self._regular_plane(q), a, qdot, along)

    def formula(
        self, q: Values, a: Values, qdot: Values, w: Values, functions: Functions
    ) -> tuple[Values, ...]:
        """``J^-1 (a - dJ/dt qdot)`` in the arithmetic of ``functions``."""
        return _accelerations(self._numbers, _plane(self._numbers, q, functions), a, qdot, w)

    def rate_formula(self, q: Values, v: Values, functions: Functions) -> tuple[Values, ...]:
        """``J^-1 v`` in the arithmetic of ``functions``."""
        return _rates(self._numbers, _plane(self._numbers, q, functions), v)

    def task_position(self, q: Values, functions: Functions) -> tuple[Values, ...]:
        """Position of the foot in the base frame, (3,) [m]."""
        c1, s1, *_, z2, _, z3, reach = _plane(self._numbers, q, functions)
        return c1 * reach, s1 * reach, self._numbers[3] * (z2 + z3)

    def postures(self, task: Array, like: Floats) -> Array:
        """Joint angles for feet (rows, 3) [m], on the branch of ``like``."""
        return inverse_kinematics(self.geometry, task, like)

    def differentiable(self) -> DifferentiableLeg:
        """The leg for angles that carry derivatives."""
        return DifferentiableLeg(self.geometry)

    def _regular_plane(self, q: Floats) -> tuple[Values, ...]:
        plane = _plane(self._numbers, q, self._functions)
        _, _, s3, *_, reach = plane
        if abs(s3) <= SINGULAR_BELOW or abs(reach) <= SINGULAR_BELOW * self.length:
            raise self.singular(q)
        return plane


def rates_and_accelerations(
    lengths: tuple[Values, Values, Values], q: Values, v: Values, a: Values
) -> tuple[tuple[Values, ...], tuple[Values, ...]]:
    """``J^-1 v`` and ``J^-1 (a - dJ/dt qdot)`` of many legs of sign +1, all of them arrays."""
    leg = (*lengths, 1)
    plane = _plane(leg, q, (np.cos, np.sin))
    qdot = _rates(leg, plane, v)
    return qdot, _accelerations(leg, plane, a, qdot, qdot)


Numbers = tuple[Values, Values, Values, int]  # l1, l2, l3 and the sign


def _plane(leg: Numbers, q: Values, functions: Functions) -> tuple[Values, ...]:
    """Terms of the leg's plane in any arithmetic: c1, s1, s3, c23, s23, x2, z2, x3, z3, reach."""
    l1, l2, l3, _ = leg
    cos, sin = functions
    q1, q2, q3 = q
    q23 = q2 + q3
    c23, s23 = cos(q23), sin(q23)
    x2, z2, x3, z3 = l2 * cos(q2), l2 * sin(q2), l3 * c23, l3 * s23
    return cos(q1), sin(q1), sin(q3), c23, s23, x2, z2, x3, z3, l1 + x2 + x3


def _rates(leg: Numbers, plane: tuple[Values, ...], v: Values) -> tuple[Values, ...]:
    """``J^-1 v``."""
    c1, s1 = plane[:2]
    return _inverted(leg, plane, c1 * v[0] + s1 * v[1], c1 * v[1] - s1 * v[0], leg[3] * v[2])


def _accelerations(
    leg: Numbers, plane: tuple[Values, ...], a: Values, qdot: Values, w: Values
) -> tuple[Values, ...]:
    """``J^-1 (a - dJ/dt qdot)`` with J changing along w."""
    c1, s1, _, _, _, x2, z2, x3, z3, reach = plane
    u1, u2, u3 = qdot
    w1, w2, w3 = w
    u23, w23 = u2 + u3, w2 + w3
    w2_2, w23_2 = u2 * w2, u23 * w23
    radial = c1 * a[0] + s1 * a[1] + x2 * w2_2 + x3 * w23_2 + reach * u1 * w1
    tangential = c1 * a[1] - s1 * a[0] + (z2 * w2 + z3 * w23) * u1 + (z2 * u2 + z3 * u23) * w1
    vertical = leg[3] * a[2] + z2 * w2_2 + z3 * w23_2
    return _inverted(leg, plane, radial, tangential, vertical)


def _inverted(
    leg: Numbers, plane: tuple[Values, ...], radial: Values, tangential: Values, vertical: Values
) -> tuple[Values, ...]:
    """Solve for the joints, from the foot's motion in the leg's plane and across it."""
    _, l2, l3, _ = leg
    _, _, s3, c23, s23, x2, z2, x3, z3, reach = plane
    return (
        tangential / reach,
        (c23 * radial + s23 * vertical) / (l2 * s3),
        -((x2 + x3) * radial + (z2 + z3) * vertical) / (l2 * l3 * s3),
    )


class DifferentiableLeg(MovableLeg):
    """The leg for angles, and lengths l1, l2, l3, that carry derivatives, such as AutoDiffXd."""

    _functions = (cosine, sine)

    def __init__(self, leg: LegGeometry, lengths: Sequence[Any] = ()) -> None:
        super().__init__(leg)
        if lengths:
            self._numbers = (*lengths, leg.sign)

    def foot(self, q: Floats) -> Array:
        """Position of the foot in the base frame, (3,) [m]."""
        return np.array(self.task_position(q, self._functions))

    def jacobian(self, q: Floats) -> Array:
        """Translational Jacobian, (3, 3) [m/rad]."""
        c1, s1, _, _, _, x2, z2, x3, z3, reach = _plane(self._numbers, q, self._functions)
        sign, depth = self.geometry.sign, z2 + z3
        return np.array(
            [
                [-s1 * reach, -c1 * depth, -c1 * z3],
                [c1 * reach, -s1 * depth, -s1 * z3],
                [0.0 * c1, sign * (x2 + x3), sign * x3],
            ]
        )

    def singular(self, q: Floats, time: float | None = None) -> SingularConfigurationError:
        """Make the error of a singular posture, in floats."""
        now = None if time is None else value_of(time)
        return MovableLeg(self.geometry).singular([value_of(each) for each in q], now)


def foot_rotation_angles(leg: LegGeometry, R_BF: ArrayLike) -> Array:
    """Angles a, b, c [rad] of foot rotations (..., 3, 3) in the leg's own Z-X-Z sequence, (..., 3).

    ``R_BF = Rz(a) Rx(b) Rz(c)``: for a foot rotated by the leg, a = q1, b = s pi/2 and
    c = q2 + q3, so the sequence is regular wherever the leg goes. a and c are in (-pi, pi]; the
    leg's sign chooses between the two solutions.
    """
    R = finite_vectors("R_BF", R_BF, 3)
    if R.ndim < 2 or R.shape[-2] != 3:
        raise InvalidValueError(f"R_BF has shape {R.shape}; it must end in 3, 3")
    s = leg.sign
    a = np.arctan2(s * R[..., 0, 2], -s * R[..., 1, 2])
    b = s * np.arccos(np.clip(R[..., 2, 2], -1.0, 1.0))
    c = np.arctan2(s * R[..., 2, 0], s * R[..., 2, 1])
    return np.stack([a, b, c], axis=-1)


@dataclass(frozen=True, kw_only=True)
class Branch:
    """One way of putting the foot at a point."""

    facing: int  # +1: the foot is in front of the hip, -1: behind it
    bend: int  # sign of sin q3
    q: tuple[float, float, float] | None  # [rad]; None where the point is out of reach
    within_limits: bool  # of the joints; True without limits

    @property
    def name(self) -> str:
        """Description of the branch."""
        front = "foot in front of the hip" if self.facing > 0 else "foot behind the hip"
        return f"{front}, q3 {'positive' if self.bend > 0 else 'negative'}"


def branch_angles(leg: LegGeometry, p_BF: ArrayLike) -> Array:
    """Joint angles of all four branches for feet p_BF (..., 3) [m], (..., 4, 3) [rad].

    ``foot_position(leg, branch_angles(leg, p)[..., b, :]) == p`` wherever it is not NaN, that is,
    in reach; angles are in (-pi, pi], in the order of ``BRANCHES``. The ankle follows from the
    triangle of femur, tibia and the distance from knee to foot. On the hip axis the hip angle is
    arbitrary.
    """
    points = finite_vectors("p_BF", p_BF, 3)
    return np.stack([_solve(leg, points, *branch) for branch in BRANCHES], axis=-2)


def _solve(leg: LegGeometry, p_BF: Array, facing: int, bend: int) -> Array:
    x, y, w = p_BF[..., 0], p_BF[..., 1], leg.sign * p_BF[..., 2]
    q1 = np.arctan2(facing * y, facing * x)
    u = facing * np.hypot(x, y) - leg.l1
    q3 = bend * triangle_angle(leg.l2, leg.l3, np.hypot(u, w))
    q2 = np.arctan2(w, u) - np.arctan2(leg.l3 * np.sin(q3), leg.l2 + leg.l3 * np.cos(q3))
    return principal(np.stack([np.where(np.isnan(q3), np.nan, q1), q2, q3], axis=-1))


def branches(
    leg: LegGeometry,
    p_BF: ArrayLike,
    limits: Sequence[tuple[float, float]] | None = None,
) -> tuple[Branch, ...]:
    """All four ways of putting the foot at one point (3,) [m], including those out of reach.

    ``limits`` are the lower and upper limit of each of the three joints [rad].
    """
    if limits is not None and len(limits) != 3:
        raise InvalidValueError(f"there are {len(limits)} pairs of limits; a leg has three joints")
    found = []
    for (facing, bend), q in zip(
        BRANCHES, branch_angles(leg, one_vector("p_BF", p_BF, 3)), strict=True
    ):
        reached = bool(np.isfinite(q).all())
        inside = limits is None or all(
            within_turns(angle, low, high) for angle, (low, high) in zip(q, limits, strict=True)
        )
        found.append(
            Branch(
                facing=facing,
                bend=bend,
                q=(float(q[0]), float(q[1]), float(q[2])) if reached else None,
                within_limits=reached and inside,
            )
        )
    return tuple(found)


def inverse_kinematics(leg: LegGeometry, p_BF: ArrayLike, like: ArrayLike) -> Array:
    """Joint angles (..., 3) that put the foot at a point, on the branch of a given posture.

    ``foot_position(leg, inverse_kinematics(leg, p_BF, like)) == p_BF``. Every angle is the one
    nearest to that of ``like`` (3,) [rad], by whole turns; NaN where the point is out of reach.
    """
    near, points = one_vector("like", like, 3), finite_vectors("p_BF", p_BF, 3)
    facing = 1 if foot_reach(leg, near) >= 0.0 else -1
    bend = 1 if math.sin(near[2]) >= 0.0 else -1
    return nearest_turn(_solve(leg, points, facing, bend), near)
