"""Frames of Corke's Robotics Toolbox: homogeneous matrices of angles [rad] and positions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import numbers_of, settled
from drake_leg.simulink.matlab.inputs import scalar
from drake_leg.simulink.matlab.numeric import MatlabError, measure
from drake_leg.simulink.matlab.rotations import about

# ruff: noqa: ANN401 - any value of a script
Array = NDArray[np.float64]


def _frame(rotation: Array, position: Any = (0.0, 0.0, 0.0)) -> Array:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation, position
    return frame


def _turned(axis: int) -> Callable[..., Array]:
    def frame(angle: Any, unit: Any = "rad") -> Array:
        theta = scalar(angle)
        return _frame(about(axis, np.deg2rad(theta) if unit == "deg" else theta))

    return frame


def _moved(*given: Any) -> Any:
    """``transl``: the frame of a position, or the position of a frame."""
    first = numbers_of(given[0])
    if len(given) == 3:
        return _frame(np.eye(3), [scalar(each) for each in given])
    if first.shape == (4, 4):
        return first[:3, 3].reshape(3, 1)
    if first.size == 3:
        return _frame(np.eye(3), first.ravel())
    if first.ndim == 2 and first.shape[1] == 3:
        return np.stack([_frame(np.eye(3), row) for row in first], axis=-1)
    raise MatlabError(f"'transl' takes a position or a frame, not an array of {measure(first)}")


def _rotation_of(frame: Any) -> Array:
    return numbers_of(frame)[:3, :3]


def _skew(vector: Any) -> Array:
    v = numbers_of(vector).ravel()
    if v.size == 1:
        return np.array([[0.0, -v[0]], [v[0], 0.0]])
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _vex(matrix: Any) -> Any:
    """Vector of a skew-symmetric matrix."""
    m = numbers_of(matrix)
    if m.shape == (2, 2):
        return 0.5 * (m[1, 0] - m[0, 1])
    return 0.5 * np.array([[m[2, 1] - m[1, 2]], [m[0, 2] - m[2, 0]], [m[1, 0] - m[0, 1]]])


ROBOT_FRAMES: dict[str, Callable[..., Any]] = {
    name: lambda *given, function=function: settled(np.asarray(function(*given)))
    for name, function in {
        "transl": _moved,
        "trotx": _turned(0),
        "troty": _turned(1),
        "trotz": _turned(2),
        "r2t": lambda rotation: _frame(numbers_of(rotation)),
        "t2r": _rotation_of,
        "rt2tr": lambda rotation, p: _frame(numbers_of(rotation), numbers_of(p).ravel()),
        "skew": _skew,
        "vex": _vex,
    }.items()
} | {
    "tr2rt": lambda frame: (
        settled(_rotation_of(frame)),
        settled(numbers_of(frame)[:3, 3].reshape(3, 1)),
    ),
}
