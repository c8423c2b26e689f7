"""How Euler angles change: a Bushing or Gimbal joint's rates against an angular velocity.

**Angle rates are not an angular velocity.** The rates are derivatives of the three angles, about
three axes that are not at right angles; an angular velocity has components along the three axes
of one frame. ``w_BF = E(angles) rates``, and E is singular at gimbal lock.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array, finite_vectors
from drake_leg.kinematics.euler import LOCK, euler_rotation


def rate_matrix(sequence: str, angles: ArrayLike) -> Array:
    """The matrix E of ``w_BF = E rates``: its columns are the three axes of rotation.

    Parameters
    ----------
    sequence : str
        One of ``euler.SEQUENCES``, body-fixed.
    angles : (..., 3) array_like
        [rad].

    Returns
    -------
    (..., 3, 3) ndarray
        In the base frame; singular at gimbal lock. ``R_BF.T @ E`` is the one in the follower's
        axes.

    Raises
    ------
    InvalidValueError
        If the sequence is unknown, or the angles are not three finite numbers.
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
    """Derivatives of the Euler angles: a Bushing or Gimbal joint's rates.

    ``rates = E(angles)^-1 w_BF``. They grow without bound towards gimbal lock, as the angles do
    truly turn ever faster there. Within ``euler.LOCK`` of it they are the smallest rates that
    give the part of w_BF that any rates can give; never NaN or infinite.

    Parameters
    ----------
    sequence : str
        One of ``euler.SEQUENCES``, body-fixed.
    angles : (..., 3) array_like
        [rad].
    angular_velocity : (..., 3) array_like
        w_BF in the axes of the base frame [rad/s].

    Returns
    -------
    (..., 3) ndarray
        [rad/s].

    Raises
    ------
    InvalidValueError
        If the sequence is unknown, or a vector is not three finite numbers.
    """
    w = finite_vectors("the angular velocity", angular_velocity, 3)
    return _solve(rate_matrix(sequence, angles), w)


def angle_accelerations(
    sequence: str, angles: ArrayLike, rates: ArrayLike, angular_acceleration: ArrayLike
) -> Array:
    """Second derivatives of the Euler angles: a Bushing or Gimbal joint's accelerations.

    ``E^-1 (alpha_BF - dE/dt rates)``; near gimbal lock as ``angle_rates``.

    Parameters
    ----------
    sequence : str
        One of ``euler.SEQUENCES``, body-fixed.
    angles : (..., 3) array_like
        [rad].
    rates : (..., 3) array_like
        Their derivatives [rad/s].
    angular_acceleration : (..., 3) array_like
        alpha_BF, the derivative of w_BF in the base frame, in its axes [rad/s^2].

    Returns
    -------
    (..., 3) ndarray
        [rad/s^2].

    Raises
    ------
    InvalidValueError
        If the sequence is unknown, or a vector is not three finite numbers.
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
