"""Closed forms of the three-joint leg: foot, Jacobian, determinant, inverse kinematics.

With ci = cos qi, c23 = cos(q2 + q3) and the same for sines:

- ``reach = l1 + l2 c2 + l3 c23`` is the foot's signed distance from the hip axis (rho);
- ``depth = l2 s2 + l3 s23`` is its height over the hip, up to the sign ``s`` of the variant.

The Jacobian has two singular families: ``sin q3 = 0`` (leg stretched or folded) and
``reach = 0`` (foot on the hip axis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array, assemble, finite_vectors, in_blocks, split
from drake_leg.kinematics.task import Floats, Task, singular_posture
from drake_leg.quantities import require_positive
from drake_leg.robot import Robot

# sin(q3), or the reach over the leg's length, below which the closed form no longer divides.
SINGULAR_BELOW = 1e-12
AT_REST = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class LegGeometry:
    """What the closed forms need of a leg."""

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
        """Read the lengths and the sign off a leg's Khalil table.

        Parameters
        ----------
        robot : Robot
            A leg as ``robots.hexabot_leg`` makes it.

        Raises
        ------
        InvalidValueError
            If the table is not that of the reports' leg.
        """
        rows = robot.rows
        alphas = tuple(row.alpha for row in rows)
        if (
            tuple(row.joint for row in rows) != ("revolute", "revolute", "revolute", "fixed")
            or any(row.r or row.theta for row in rows)
            or rows[0].d
            or abs(alphas[1]) != math.pi / 2
            or any(alphas[:1] + alphas[2:])
        ):
            raise InvalidValueError(f"{robot.name!r} has not the table of the reports' leg")
        sign = int(math.copysign(1, alphas[1]))
        return cls(l1=rows[1].d, l2=rows[2].d, l3=rows[3].d, sign=sign)


def is_hexabot_leg(robot: Robot) -> bool:
    """Tell whether a robot has the table of the reports' leg, whatever its lengths."""
    try:
        LegGeometry.from_robot(robot)
    except InvalidValueError:
        return False
    return True


def foot_position(leg: LegGeometry, q: ArrayLike) -> Array:
    """Position of the foot F in the base frame B.

    Parameters
    ----------
    q : (..., 3) array_like
        Hip, knee, ankle angles [rad].

    Returns
    -------
    p_BF : (..., 3) ndarray
        [m].

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in 3, or is not finite.

    References
    ----------
    Report A, eq. 8; report B, 2.5.1 (printed with q2 - q3 for q2 + q3).
    """
    (q1, q2, q3), cos, sin = split("q", q, 3)
    reach = leg.l1 + leg.l2 * cos(q2) + leg.l3 * cos(q2 + q3)
    depth = leg.l2 * sin(q2) + leg.l3 * sin(q2 + q3)
    return assemble((cos(q1) * reach, sin(q1) * reach, leg.sign * depth))


def foot_and_jacobian(leg: LegGeometry, q: ArrayLike) -> tuple[Array, Array]:
    """Position of the foot and its translational Jacobian at once: they share most of the work.

    Parameters
    ----------
    q : (..., 3) array_like
        Hip, knee, ankle angles [rad].

    Returns
    -------
    p_BF : (..., 3) ndarray
        [m], as ``foot_position``.
    Jv_BF : (..., 3, 3) ndarray
        [m/rad], as ``foot_jacobian``.

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in 3, or is not finite.
    """
    angles = finite_vectors("q", q, 3)
    if angles.ndim == 1:
        return _foot_and_jacobian(leg, angles)
    p_BF, Jv_BF = in_blocks(partial(_foot_and_jacobian, leg), angles, (3,), (3, 3))
    return p_BF, Jv_BF


def _foot_and_jacobian(leg: LegGeometry, q: Array) -> tuple[Array, Array]:
    (q1, q2, q3), cos, sin = split("q", q, 3)
    c1, s1, q23, s = cos(q1), sin(q1), q2 + q3, leg.sign
    x3, z3 = leg.l3 * cos(q23), leg.l3 * sin(q23)
    x2, depth = leg.l2 * cos(q2) + x3, leg.l2 * sin(q2) + z3
    reach = leg.l1 + x2
    x, y = c1 * reach, s1 * reach
    rows = ((-y, -c1 * depth, -c1 * z3), (x, -s1 * depth, -s1 * z3), (0.0, s * x2, s * x3))
    return assemble((x, y, s * depth)), assemble(rows)


def foot_rotation(leg: LegGeometry, q: ArrayLike) -> Array:
    """Rotation of the foot frame F in the base frame B.

    ``R_BF = Rz(q1) Rx(s pi/2) Rz(q2 + q3)``.

    Parameters
    ----------
    q : (..., 3) array_like
        Hip, knee, ankle angles [rad].

    Returns
    -------
    R_BF : (..., 3, 3) ndarray
        Rotation matrices.

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in 3, or is not finite.

    References
    ----------
    Report A, eq. 8; report B, 2.4.
    """
    (q1, q2, q3), cos, sin = split("q", q, 3)
    c1, s1, c23, s23 = cos(q1), sin(q1), cos(q2 + q3), sin(q2 + q3)
    s = leg.sign
    return assemble(
        (
            (c1 * c23, -c1 * s23, s * s1),
            (s1 * c23, -s1 * s23, -s * c1),
            (s * s23, s * c23, 0.0),
        )
    )


def foot_jacobian(leg: LegGeometry, q: ArrayLike) -> Array:
    """Translational Jacobian of the foot F in the base frame B.

    ``v_BF = Jv_BF @ qdot``.

    Parameters
    ----------
    q : (..., 3) array_like
        Hip, knee, ankle angles [rad].

    Returns
    -------
    Jv_BF : (..., 3, 3) ndarray
        [m/rad]; singular where sin(q3) = 0 or the foot is on the hip axis.

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in 3, or is not finite.

    References
    ----------
    Report A, eq. 15.
    """
    return foot_and_jacobian(leg, q)[1]


def determinant(leg: LegGeometry, q: ArrayLike) -> Array:
    """Determinant of the foot's translational Jacobian, factored.

    ``det J = -s l2 l3 sin(q3) (l1 + l2 c2 + l3 c23)``.

    Parameters
    ----------
    q : (..., 3) array_like
        Hip, knee, ankle angles [rad].

    Returns
    -------
    (...) ndarray
        [m^3/rad^3]; zero on both singular families.

    Raises
    ------
    InvalidValueError
        If ``q`` does not end in 3, or is not finite.

    References
    ----------
    Report A, eq. 17 (printed unfactored, the family on the hip axis left out).
    """
    (_, q2, q3), cos, sin = split("q", q, 3)
    reach = leg.l1 + leg.l2 * cos(q2) + leg.l3 * cos(q2 + q3)
    return np.asarray(-leg.sign * leg.l2 * leg.l3 * sin(q3) * reach)


def jacobian_rate_bias(leg: LegGeometry, q: ArrayLike, qdot: ArrayLike) -> Array:
    """Foot acceleration that is there without joint acceleration.

    ``a_BF = Jv_BF @ qddot + bias`` with ``bias = dJv_BF/dt @ qdot``.

    Parameters
    ----------
    q, qdot : (..., 3) array_like
        Joint angles [rad] and rates [rad/s].

    Returns
    -------
    (..., 3) ndarray
        [m/s^2], in the base frame.

    Raises
    ------
    InvalidValueError
        If ``q`` or ``qdot`` does not end in 3, or is not finite.
    """
    (q1, q2, q3), cos, sin = split("q", q, 3)
    (w1, w2, w3), _, _ = split("qdot", qdot, 3)
    q23, w23 = q2 + q3, w2 + w3
    c1, s1 = cos(q1), sin(q1)
    c2, s2, c23, s23 = cos(q2), sin(q2), cos(q23), sin(q23)
    reach = leg.l1 + leg.l2 * c2 + leg.l3 * c23
    reach_rate = -leg.l2 * s2 * w2 - leg.l3 * s23 * w23
    radial = -leg.l2 * c2 * w2**2 - leg.l3 * c23 * w23**2 - reach * w1**2
    tangential = 2.0 * reach_rate * w1
    vertical = -leg.sign * (leg.l2 * s2 * w2**2 + leg.l3 * s23 * w23**2)
    return assemble((c1 * radial - s1 * tangential, s1 * radial + c1 * tangential, vertical))


def leg_task(leg: LegGeometry) -> Task:
    """Make the task of the foot's velocity, with the Jacobian inverted in closed form.

    In the leg's own plane the foot moves radially and vertically, across it tangentially:
    ``qdot1 = v_t / reach``, and the knee and the ankle solve the two-link arm,
    ``qdot2 = (c23 v_r + s23 v_z) / (l2 s3)`` and so on, with ``v_z`` signed by the variant.

    Returns
    -------
    Task
        Velocities in m/s, base frame; angles in rad.

    References
    ----------
    Report A, eq. 19.
    """
    l1, l2, l3, sign = leg.l1, leg.l2, leg.l3, leg.sign
    nearest_reach = SINGULAR_BELOW * (l1 + l2 + l3)
    factor = -sign * l2 * l3
    jacobian = partial(foot_jacobian, leg)

    def rates(q: Floats, v: Floats) -> Floats:
        return solve(q, v, AT_REST, AT_REST)

    def accelerations(q: Floats, qdot: Floats, a: Floats, v: Floats = (), w: Floats = ()) -> Floats:
        return solve(q, a, qdot, w or qdot)

    def plain_determinant(q: Floats) -> float:
        _, q2, q3 = q
        return factor * math.sin(q3) * (l1 + l2 * math.cos(q2) + l3 * math.cos(q2 + q3))

    def solve(q: Floats, a: Floats, qdot: Floats, w: Floats) -> Floats:
        """Return ``J^-1 (a - dJ/dt qdot)`` with J changing along w."""
        q1, q2, q3 = q
        u1, u2, u3 = qdot
        w1, w2, w3 = w
        q23, u23, w23 = q2 + q3, u2 + u3, w2 + w3
        c1, s1, s3 = math.cos(q1), math.sin(q1), math.sin(q3)
        c23, s23 = math.cos(q23), math.sin(q23)
        x2, z2 = l2 * math.cos(q2), l2 * math.sin(q2)
        x3, z3 = l3 * c23, l3 * s23
        reach = l1 + x2 + x3
        if abs(s3) <= SINGULAR_BELOW or abs(reach) <= nearest_reach:
            raise singular_posture(jacobian, q)
        w2_2, w23_2 = u2 * w2, u23 * w23
        radial = c1 * a[0] + s1 * a[1] + x2 * w2_2 + x3 * w23_2 + reach * u1 * w1
        tangential = c1 * a[1] - s1 * a[0] + (z2 * w2 + z3 * w23) * u1 + (z2 * u2 + z3 * u23) * w1
        vertical = sign * a[2] + z2 * w2_2 + z3 * w23_2
        return (
            tangential / reach,
            (c23 * radial + s23 * vertical) / (l2 * s3),
            -((x2 + x3) * radial + (z2 + z3) * vertical) / (l2 * l3 * s3),
        )

    return Task(
        jacobian=jacobian,
        bias=partial(jacobian_rate_bias, leg),
        determinant=plain_determinant,
        rates=rates,
        accelerations=accelerations,
        determinant_scale=l2 * l3 * (l1 + l2 + l3),
        length=l1 + l2 + l3,
    )


def foot_rotation_angles(leg: LegGeometry, R_BF: ArrayLike) -> Array:
    """Angles of the foot's rotation in the leg's own Z-X-Z sequence.

    ``R_BF = Rz(a) Rx(b) Rz(c)``: for a foot rotated by the leg, a = q1, b = s pi/2 and
    c = q2 + q3, so the sequence is regular wherever the leg goes.

    Parameters
    ----------
    leg : LegGeometry
        Lengths and variant; the sign chooses between the two solutions.
    R_BF : (..., 3, 3) array_like
        Rotation matrices.

    Returns
    -------
    (..., 3) ndarray
        a, b, c [rad], a and c in (-pi, pi].

    Raises
    ------
    InvalidValueError
        If the last axis is not 3 long, or a value is not finite.
    """
    R = finite_vectors("R_BF", R_BF, 3)
    if R.ndim < 2 or R.shape[-2] != 3:
        raise InvalidValueError(f"R_BF has shape {R.shape}; it must end in 3, 3")
    s = leg.sign
    a = np.arctan2(s * R[..., 0, 2], -s * R[..., 1, 2])
    b = s * np.arccos(np.clip(R[..., 2, 2], -1.0, 1.0))
    c = np.arctan2(s * R[..., 2, 0], s * R[..., 2, 1])
    return np.stack([a, b, c], axis=-1)
