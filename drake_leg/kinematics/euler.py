"""Rotations: quaternions, Euler angles of all twelve sequences, their rates and accelerations."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, assemble, finite_vectors

# A sequence such as "ZXZ" is body-fixed (intrinsic), as Simscape's rotation sequences and its
# Bushing and Gimbal joints ("XYZ") are: R_BF = R_z(a) R_x(b) R_z(c). Space-fixed angles are the
# same numbers read backwards: roll, pitch, yaw about the base's x, y, z are "ZYX" angles yaw,
# pitch, roll. At gimbal lock the first and the third axis are parallel.
TAIT_BRYAN = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
PROPER = ("XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ")
SEQUENCES = TAIT_BRYAN + PROPER

# Nearer to gimbal lock than this, rounding of the rotation leaves fewer than four digits of the
# first and the third angle and of the rates.
LOCK = 1e-12  # [rad]
_ORTHOGONAL = 1e-6  # how far R R^T may be from the identity


def rotation_matrices(quaternions: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions w, x, y, z (..., 4); q and -q have one."""
    w, x, y, z = np.moveaxis(finite_vectors("the quaternion", quaternions, 4), -1, 0)
    return assemble(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    )


def quaternions(R: Array) -> Array:
    """Unit quaternions w, x, y, z with w not negative of rotation matrices (..., 3, 3), (..., 4).

    That they are rotations is not checked. Each is a column of ``4 q q^T``, the one that has the
    greatest diagonal entry.
    """
    x, y, z = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    wx, wy, wz = (R[..., k, j] - R[..., j, k] for j, k in ((1, 2), (2, 0), (0, 1)))
    xy, yz, zx = (R[..., j, k] + R[..., k, j] for j, k in ((0, 1), (1, 2), (2, 0)))
    columns = np.stack(
        [
            np.stack([1.0 + x + y + z, wx, wy, wz], axis=-1),
            np.stack([wx, 1.0 + x - y - z, xy, zx], axis=-1),
            np.stack([wy, xy, 1.0 - x + y - z, yz], axis=-1),
            np.stack([wz, zx, yz, 1.0 - x - y + z], axis=-1),
        ],
        axis=-2,
    )
    diagonal = np.diagonal(columns, axis1=-2, axis2=-1)
    best = diagonal.argmax(axis=-1)[..., np.newaxis, np.newaxis]
    chosen = np.take_along_axis(columns, best, axis=-2)[..., 0, :]
    chosen = np.where(chosen[..., :1] < 0.0, -chosen, chosen)
    unit: Array = chosen / np.linalg.norm(chosen, axis=-1, keepdims=True)
    return unit


class _Axes(NamedTuple):
    """First axis i, second axis j, the axis k that is neither; i, j, k are right-handed or not."""

    i: int
    j: int
    k: int
    hand: float  # +1 right-handed, -1 left-handed
    proper: bool  # the third rotation is about i again, otherwise about k


@cache
def _axes(sequence: str) -> _Axes:
    if sequence not in SEQUENCES:
        raise InvalidValueError(
            f"the rotation sequence is {sequence!r}; it must be one of {', '.join(SEQUENCES)}"
        )
    i, j = "XYZ".index(sequence[0]), "XYZ".index(sequence[1])
    return _Axes(i, j, 3 - i - j, 1.0 if (j - i) % 3 == 1 else -1.0, sequence[2] == sequence[0])


def require_sequence(sequence: str) -> None:
    """Refuse, with an ``InvalidValueError``, what is not one of the twelve ``SEQUENCES``."""
    _axes(sequence)


def euler_rotation(sequence: str, angles: ArrayLike) -> Array:
    """Rotation matrices R_BF (..., 3, 3) of body-fixed Euler angles (..., 3) [rad]."""
    axes = _axes(sequence)
    first, second, third = np.moveaxis(finite_vectors("the Euler angles", angles, 3), -1, 0)
    last = axes.i if axes.proper else axes.k
    return _turn(axes.i, first) @ _turn(axes.j, second) @ _turn(last, third)


def euler_angles(sequence: str, rotations: ArrayLike) -> Array:
    """Euler angles (..., 3) [rad] of rotation matrices R_BF (..., 3, 3): principal values.

    The first and third are in -pi ... pi; the second is in -pi/2 ... pi/2 for the six Tait-Bryan
    sequences and in 0 ... pi for the six proper ones. They reproduce the matrix everywhere, to
    rounding. Within ``LOCK`` of gimbal lock only the sum or difference of the first and the third
    is determined; the first is then 0. A series of them jumps where a principal range ends:
    ``continuous_angles`` removes the jumps.
    """
    i, j, k, hand, proper = _axes(sequence)
    R = _rotations(rotations)
    if proper:
        sine, cosine = np.hypot(R[..., i, j], R[..., i, k]), R[..., i, i]
        leads, follows, gap = R[..., j, i], -hand * R[..., k, i], sine
    else:
        sine, cosine = hand * R[..., i, k], np.hypot(R[..., i, i], R[..., i, j])
        leads, follows, gap = -hand * R[..., j, k], R[..., k, k], cosine
    first = np.where(gap < LOCK, 0.0, np.arctan2(leads, follows))
    # The middle row of R_BF with the first rotation undone: only the third one is left in it.
    c, s = np.cos(first)[..., None], hand * np.sin(first)[..., None]
    row = c * R[..., j, :] + s * R[..., k, :]
    swept = -hand * row[..., k] if proper else hand * row[..., i]
    return np.stack([first, np.arctan2(sine, cosine), np.arctan2(swept, row[..., j])], axis=-1)


def gimbal_distance(sequence: str, angles: ArrayLike) -> Array:
    """Distance of the second of Euler angles (..., 3) from gimbal lock, (...) [rad].

    It is 0 at gimbal lock, and pi/2 where the first and the third axis are at right angles.
    """
    _, across = _third_axis(_axes(sequence), finite_vectors("the Euler angles", angles, 3))
    distance: Array = np.arcsin(np.abs(across))
    return distance


def continuous_angles(sequence: str, series: ArrayLike) -> Array:
    """Recorded Euler angles (n, 3) [rad] without jumps: each sample nearest to the one before.

    Every rotation has two triples of angles, up to whole turns: ``(a, b, c)`` and ``(a + pi,
    pi - b, c + pi)`` for Tait-Bryan sequences, ``(a + pi, -b, c + pi)`` for proper ones; at
    gimbal lock it has a whole line of them. The result is the same rotation at every sample
    and passes straight through gimbal lock. Two samples must be less than about a quarter turn
    apart. The first sample is unchanged.
    """
    axes = _axes(sequence)
    checked = finite_vectors("the Euler angles", series, 3)
    if checked.ndim != 2:
        raise InvalidValueError(f"the Euler angles have shape {checked.shape}; it must be (n, 3)")
    result = checked.copy()
    along, across = _third_axis(axes, checked)
    mirror = 0.0 if axes.proper else math.pi
    for n in range(1, len(checked)):
        before = result[n - 1].tolist()
        if abs(across[n]) < LOCK:
            result[n] = _nearest_locked(checked[n].tolist(), before, round(float(along[n])))
        else:
            result[n] = _nearest(checked[n].tolist(), before, mirror=mirror)
    return result


def _nearest(angles: list[float], before: list[float], *, mirror: float) -> list[float]:
    first, second, third = angles
    triples = (angles, [first + math.pi, mirror - second, third + math.pi])
    wound = [[_wind(x, b) for x, b in zip(t, before, strict=True)] for t in triples]
    return min(wound, key=lambda triple: math.dist(triple, before))


def _nearest_locked(angles: list[float], before: list[float], along: int) -> list[float]:
    """At lock only ``first + along * third`` is determined: split its change between the two."""
    first, second, third = before
    change = _wind(angles[0] + along * angles[2] - first - along * third, 0.0)
    return [first + change / 2, _wind(angles[1], second), third + along * change / 2]


def _wind(angle: float, near: float) -> float:
    return angle + math.tau * round((near - angle) / math.tau)


def _turn(axis: int, angle: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    R = np.zeros((*np.shape(angle), 3, 3))
    ahead, behind = (axis + 1) % 3, (axis + 2) % 3
    R[..., axis, axis] = 1.0
    R[..., ahead, ahead] = R[..., behind, behind] = c
    R[..., ahead, behind], R[..., behind, ahead] = -s, s
    return R


def _rotations(matrices: ArrayLike) -> Array:
    R = np.asarray(matrices, dtype=np.float64)
    if R.shape[-2:] != (3, 3):
        raise InvalidValueError(f"a rotation matrix has shape {R.shape}; it must be (..., 3, 3)")
    off = np.abs(R @ np.swapaxes(R, -1, -2) - np.eye(3))
    if not (np.all(off < _ORTHOGONAL) and np.all(np.linalg.det(R) > 0.0)):
        raise InvalidValueError(
            "a matrix is not a rotation: its columns must be a right-handed set of unit vectors at "
            f"right angles, and R R^T is off the identity by {np.max(off):.3g}"
        )
    return R


def _third_axis(axes: _Axes, angles: Array) -> tuple[Array, Array]:
    """Components along i and k of the third axis, with the first rotation undone."""
    c, s = np.cos(angles[..., 1]), axes.hand * np.sin(angles[..., 1])
    return (c, -s) if axes.proper else (s, c)


def rate_matrix(sequence: str, angles: ArrayLike) -> Array:
    """The matrix E of ``w_BF = E rates`` at Euler angles (..., 3) [rad], (..., 3, 3).

    **Angle rates are not an angular velocity.** The rates are derivatives of the three angles,
    about three axes that are not at right angles; an angular velocity has components along the
    three axes of one frame. The columns of E are the three axes of rotation in the base frame; E
    is singular at gimbal lock. ``R_BF.T @ E`` is the matrix for the follower's axes.
    """
    R_BF = euler_rotation(sequence, angles)
    first, second, third = ("XYZ".index(letter) for letter in sequence)
    # The second axis is turned by the first rotation, the third by all of them.
    turned = euler_rotation(sequence, np.asarray(angles) * (1.0, 0.0, 0.0))
    E = np.empty_like(R_BF)
    E[..., 0] = np.eye(3)[first]
    E[..., 1] = turned[..., second]
    E[..., 2] = R_BF[..., third]
    return E


def angle_rates(sequence: str, angles: ArrayLike, angular_velocity: ArrayLike) -> Array:
    """Derivatives of the Euler angles (..., 3) [rad/s]: a Bushing or Gimbal joint's rates.

    ``rates = E(angles)^-1 w_BF``, with w_BF (..., 3) in the axes of the base frame [rad/s]. They
    grow without bound toward gimbal lock, as the angles truly turn ever faster there. Within
    ``LOCK`` of it they are the smallest rates for the part of w_BF that any rates can make; they
    are never NaN or infinite.
    """
    w = finite_vectors("the angular velocity", angular_velocity, 3)
    return _solve(rate_matrix(sequence, angles), w)


def angle_accelerations(
    sequence: str, angles: ArrayLike, rates: ArrayLike, angular_acceleration: ArrayLike
) -> Array:
    """Second derivatives of the Euler angles (..., 3): a Bushing or Gimbal joint's accelerations.

    ``E^-1 (alpha_BF - dE/dt rates)`` [rad/s^2], with alpha_BF (..., 3) the derivative of w_BF in
    the base frame [rad/s^2]; near gimbal lock as ``angle_rates``.
    """
    alpha = finite_vectors("the angular acceleration", angular_acceleration, 3)
    checked = finite_vectors("the rates", rates, 3)
    E = rate_matrix(sequence, angles)
    turn_1, turn_2, turn_3 = np.moveaxis(E * checked[..., None, :], -1, 0)
    # dE/dt rates: every axis turns with the rotations before it.
    drift = np.cross(turn_1, turn_2) + np.cross(turn_1 + turn_2, turn_3)
    return _solve(E, alpha - drift)


def _solve(E: Array, vectors: Array) -> Array:
    """Rates about the columns of E that add up to a vector; the least ones at gimbal lock.

    The second axis is at right angles to the other two, which leaves two equations in the plane
    of the first axis and the normal to both: ``[1, along; 0, across] [first; third]``.
    """
    axis_1, axis_2, axis_3 = np.moveaxis(E, -1, 0)
    normal = np.cross(axis_1, axis_2)
    along, across = _dot(axis_1, axis_3), _dot(normal, axis_3)
    locked = np.abs(across) < LOCK
    wanted = _dot(axis_1, vectors)
    least = along * wanted / (1.0 + along**2)
    third = np.where(locked, least, _dot(normal, vectors) / np.where(locked, 1.0, across))
    return np.stack([wanted - along * third, _dot(axis_2, vectors), third], axis=-1)


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.sum(a * b, axis=-1)
    return product
