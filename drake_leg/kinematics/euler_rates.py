"""How Euler angles change: a Bushing or Gimbal joint's rates against an angular velocity."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array, finite_vectors
from drake_leg.kinematics.euler import LOCK, euler_rotation


def rate_matrix(sequence: str, angles: ArrayLike) -> Array:
    """The matrix E of ``w_BF = E rates`` at Euler angles (..., 3) [rad], (..., 3, 3).

    **Angle rates are not an angular velocity.** The rates are derivatives of the three angles,
    about three axes that are not at right angles; an angular velocity has components along the
    three axes of one frame. The columns of E are the three axes of rotation in the base frame; E
    is singular at gimbal lock.
    ``R_BF.T @ E`` is the one in the follower's axes.
    """
    R_BF = euler_rotation(sequence, angles)
    first, second, third = ("XYZ".index(letter) for letter in sequence)
    # The second axis has been through the first rotation, the third through all of them.
    turned = euler_rotation(sequence, np.asarray(angles) * (1.0, 0.0, 0.0))
    E = np.empty_like(R_BF)
    E[..., 0] = np.eye(3)[first]
    E[..., 1] = turned[..., second]
    E[..., 2] = R_BF[..., third]
    return E


def angle_rates(sequence: str, angles: ArrayLike, angular_velocity: ArrayLike) -> Array:
    """Derivatives of the Euler angles (..., 3) [rad/s]: a Bushing or Gimbal joint's rates.

    ``rates = E(angles)^-1 w_BF``, with w_BF (..., 3) in the axes of the base frame [rad/s]. They
    grow without bound towards gimbal lock, as the angles truly turn ever faster there. Within
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
