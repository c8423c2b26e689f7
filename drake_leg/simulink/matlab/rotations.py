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


def _axes(order: Any) -> tuple[int, int, int]:
    i, j, k = (["XYZ".find(letter) for letter in str(order).upper()] + [-1] * 3)[:3]
    if len(str(order)) != 3 or -1 in (i, j, k) or j in (i, k):
        raise MatlabError(f"the order of angles {str(order)[:40]!r} is not known")
    return i, j, k


def eul2rotm(angles: Any, order: Any = "ZYX") -> Any:
    """Matrix of three angles about axes that move along."""
    first, second, third = numbers_of(angles).ravel()
    a, b, c = _axes(order)
    return about(a, first) @ about(b, second) @ about(c, third)


def rotm2eul(matrix: Any, order: Any = "ZYX") -> Any:
    """Three angles of a matrix (K. Shoemake, Euler Angle Conversion, 1994).

    Where the first and the third axis agree, the first angle is zero.
    """
    r = numbers_of(matrix)
    first, second, i = _axes(order)
    twice = first == i
    odd = second != (i + 1) % 3
    j, k = (second, first) if not twice else (second, 3 - i - second)
    if twice:
        flat = np.hypot(r[i, j], r[i, k])
        middle = np.arctan2(flat, r[i, i])
        ends = np.arctan2(r[j, i], -r[k, i]), np.arctan2(r[i, j], r[i, k])
    else:
        flat = np.hypot(r[i, i], r[j, i])
        middle = np.arctan2(-r[k, i], flat)
        ends = np.arctan2(r[j, i], r[i, i]), np.arctan2(r[k, j], r[k, k])
    if flat < 10.0 * np.finfo(float).eps:
        ends = 0.0, np.arctan2(-r[j, k], r[j, j])
    angles = np.array([[ends[0], middle, ends[1]]])
    return (-angles if odd else angles) + 0.0


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


def _in_rows(function: Callable[..., Any], *, rows: int = 1) -> Callable[..., Any]:
    """Apply a function to each row, or page of a matrix of so many rows, and put them together."""

    def applied(value: Any, *options: Any) -> Any:
        given = numbers_of(value)
        if rows == 1:
            several = [] if given.size and 1 in given.shape else list(given)
        else:
            several = [] if given.ndim == 2 else list(np.moveaxis(given, 2, 0))
        if not several:
            return settled(np.asarray(function(given, *options)))
        found = [np.asarray(function(one, *options)) for one in several]
        if found[0].shape[0] == 1:
            return settled(np.concatenate(found))
        return settled(np.stack(found, axis=-1))

    return applied


_OF_ROWS: dict[str, Callable[..., Any]] = {
    "eul2rotm": eul2rotm,
    "quat2rotm": quat2rotm,
    "axang2rotm": axang2rotm,
    "eul2quat": lambda angles, order="ZYX": rotm2quat(eul2rotm(angles, order)),
    "quat2eul": lambda quaternion, order="ZYX": rotm2eul(quat2rotm(quaternion), order),
    "quat2axang": lambda quaternion: rotm2axang(quat2rotm(quaternion)),
    "axang2quat": lambda value: rotm2quat(axang2rotm(value)),
    "eul2tform": lambda angles, order="ZYX": _framed(eul2rotm(angles, order)),
    "quat2tform": lambda quaternion: _framed(quat2rotm(quaternion)),
    "axang2tform": lambda value: _framed(axang2rotm(value)),
    "trvec2tform": trvec2tform,
}
_OF_PAGES: dict[str, Callable[..., Any]] = {
    "rotm2eul": rotm2eul,
    "rotm2quat": rotm2quat,
    "rotm2axang": rotm2axang,
    "rotm2tform": lambda matrix: _framed(numbers_of(matrix)),
    "tform2rotm": lambda frame: numbers_of(frame)[:3, :3],
    "tform2eul": lambda frame, order="ZYX": rotm2eul(numbers_of(frame)[:3, :3], order),
    "tform2quat": lambda frame: rotm2quat(numbers_of(frame)[:3, :3]),
    "tform2axang": lambda frame: rotm2axang(numbers_of(frame)[:3, :3]),
    "tform2trvec": lambda frame: numbers_of(frame)[:3, 3][np.newaxis, :],
}
ROTATIONS: dict[str, Callable[..., Any]] = {
    "rotx": _in_degrees(0),
    "roty": _in_degrees(1),
    "rotz": _in_degrees(2),
    **{name: _in_rows(function) for name, function in _OF_ROWS.items()},
    **{name: _in_rows(function, rows=3) for name, function in _OF_PAGES.items()},
}
