"""Rotations of MATLAB's toolboxes: angles, quaternions (w, x, y, z) and matrices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import numbers_of, settled
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script


def about(axis: int, angle: float) -> Any:
    """Rotation matrix about a coordinate axis [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[j, i], matrix[i, j] = s, -s
    return matrix


def _in_degrees(axis: int) -> Callable[[Any], Any]:
    def rotation(angle: Any) -> Any:
        degrees = float(numbers_of(angle).flat[0])
        if degrees % 90 == 0:  # exact, as MATLAB's
            return np.round(about(axis, np.deg2rad(degrees))) + 0.0
        return about(axis, np.deg2rad(degrees))

    return rotation


def _angles(order: Any) -> list[int]:
    axes = ["XYZ".find(letter) for letter in str(order).upper()]
    if len(axes) != 3 or -1 in axes:
        raise MatlabError(f"the order of angles {order!r} is not known")
    return axes


def eul2rotm(angles: Any, order: Any = "ZYX") -> Any:
    """Matrix of three angles about axes that move along."""
    first, second, third = numbers_of(angles).ravel()
    a, b, c = _angles(order)
    return about(a, first) @ about(b, second) @ about(c, third)


def rotm2eul(matrix: Any, order: Any = "ZYX") -> Any:
    """Three angles of a matrix."""
    r = numbers_of(matrix)
    if order == "ZYX":
        flat = np.hypot(r[0, 0], r[1, 0])
        if flat < 1e-12:
            return np.array([[0.0, np.arctan2(-r[2, 0], flat), np.arctan2(-r[1, 2], r[1, 1])]])
        angles = (
            np.arctan2(r[1, 0], r[0, 0]),
            np.arctan2(-r[2, 0], flat),
            np.arctan2(r[2, 1], r[2, 2]),
        )
        return np.array([angles])
    if order == "XYZ":
        flat = np.hypot(r[0, 0], r[0, 1])
        angles = (
            np.arctan2(-r[1, 2], r[2, 2]),
            np.arctan2(r[0, 2], flat),
            np.arctan2(-r[0, 1], r[0, 0]),
        )
        return np.array([angles])
    raise MatlabError(f"the order of angles {order!r} is not known here")


def quat2rotm(quaternion: Any) -> Any:
    """Matrix of a quaternion."""
    q = numbers_of(quaternion).ravel()
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotm2quat(matrix: Any) -> Any:
    """Quaternion of a matrix; its first part is not negative."""
    r = numbers_of(matrix)
    k = np.array(
        [
            [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0],
            [r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
            [r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1], 0],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], np.trace(r)],
        ]
    )
    x, y, z, w = np.linalg.eigh(k / 3.0)[1][:, -1]
    quaternion = np.array([[w, x, y, z]])
    return -quaternion if w < 0 else quaternion


def axang2rotm(value: Any) -> Any:
    """Matrix of an axis and an angle."""
    given = numbers_of(value).ravel()
    x, y, z = given[:3] / np.linalg.norm(given[:3])
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(given[3]) * k + (1 - np.cos(given[3])) * k @ k


def rotm2axang(matrix: Any) -> Any:
    """Axis and angle of a matrix."""
    w, *axis = rotm2quat(matrix).ravel()
    length = np.linalg.norm(axis)
    unit = np.array(axis) / length if length > 1e-14 else np.array([0.0, 0.0, 1.0])
    return np.array([[*unit, 2 * np.arctan2(length, w)]])


def _framed(rotation: Any) -> Any:
    frame = np.eye(4)
    frame[:3, :3] = rotation
    return frame


def trvec2tform(vector: Any) -> Any:
    """Frame that is moved by a vector."""
    frame = np.eye(4)
    frame[:3, 3] = numbers_of(vector).ravel()
    return frame


ROTATIONS: dict[str, Callable[..., Any]] = {
    "rotx": _in_degrees(0),
    "roty": _in_degrees(1),
    "rotz": _in_degrees(2),
    "eul2rotm": eul2rotm,
    "rotm2eul": rotm2eul,
    "quat2rotm": quat2rotm,
    "rotm2quat": rotm2quat,
    "axang2rotm": axang2rotm,
    "rotm2axang": rotm2axang,
    "eul2quat": lambda angles, order="ZYX": rotm2quat(eul2rotm(angles, order)),
    "quat2eul": lambda quaternion, order="ZYX": rotm2eul(quat2rotm(quaternion), order),
    "axang2quat": lambda value: rotm2quat(axang2rotm(value)),
    "eul2tform": lambda angles, order="ZYX": _framed(eul2rotm(angles, order)),
    "rotm2tform": lambda matrix: _framed(numbers_of(matrix)),
    "quat2tform": lambda quaternion: _framed(quat2rotm(quaternion)),
    "axang2tform": lambda value: _framed(axang2rotm(value)),
    "tform2rotm": lambda frame: settled(numbers_of(frame)[:3, :3]),
    "tform2trvec": lambda frame: numbers_of(frame)[:3, 3][np.newaxis, :],
    "trvec2tform": trvec2tform,
}
