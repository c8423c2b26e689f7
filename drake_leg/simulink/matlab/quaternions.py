"""Quaternions (w, x, y, z) and direction cosines of the Aerospace Toolbox, one in each row.

Direction cosines turn the axes, not the vector: they are the transpose of the rotation's matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import numbers_of, settled
from drake_leg.simulink.matlab.numeric import MatlabError, measure
from drake_leg.simulink.matlab.rotations import eul2rotm, quat2rotm, rotm2eul, rotm2quat

# ruff: noqa: ANN401 - any value of a script
Array = NDArray[np.float64]


def _rows(value: Any, width: int = 4) -> Array:
    rows = numbers_of(value)
    if rows.ndim != 2 or rows.shape[1] != width:
        raise MatlabError(f"rows of {width} numbers are needed, not an array of {measure(rows)}")
    return rows


def _product(p: Any, q: Any) -> Array:
    """Hamilton's product, row by row."""
    a, b = np.broadcast_arrays(_rows(p), _rows(q))
    scalar = a[:, :1] * b[:, :1] - np.sum(a[:, 1:] * b[:, 1:], axis=1, keepdims=True)
    vector = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.hstack([scalar, vector])


def _conjugate(q: Any) -> Array:
    conjugate: Array = _rows(q) * np.array([1.0, -1.0, -1.0, -1.0])
    return conjugate


def _square(q: Any) -> Array:
    square: Array = np.sum(_rows(q) ** 2, axis=1, keepdims=True)
    return square


def _inverse(q: Any) -> Array:
    return _conjugate(q) / _square(q)


def _unit(q: Any) -> Array:
    return _rows(q) / np.sqrt(_square(q))


def _rotated(q: Any, vector: Any) -> Array:
    """``quatrotate``: the vector in the axes that the quaternion turns."""
    given = _rows(vector, 3)
    pure = np.hstack([np.zeros((len(given), 1)), given])
    unit = _unit(q)
    return _product(_product(_conjugate(unit), pure), unit)[:, 1:]


def _cosines(q: Any) -> Array:
    return np.stack([quat2rotm(one).T for one in _rows(q)], axis=-1)


def _pages(dcm: Any) -> list[Array]:
    given = numbers_of(dcm)
    return [given] if given.ndim == 2 else list(np.moveaxis(given, 2, 0))


def _of_cosines(dcm: Any) -> Array:
    return np.concatenate([rotm2quat(page.T) for page in _pages(dcm)])


def _angles(first: Any, second: Any, third: Any) -> Array:
    return np.stack(
        np.broadcast_arrays(*(numbers_of(each).ravel() for each in (first, second, third))), axis=1
    )


def _angle2dcm(first: Any, second: Any, third: Any, order: Any = "ZYX") -> Array:
    rows = _angles(first, second, third)
    return np.stack([eul2rotm(row, order).T for row in rows], axis=-1)


def _dcm2angle(dcm: Any, order: Any = "ZYX") -> tuple[Any, ...]:
    rows = np.concatenate([rotm2eul(page.T, order) for page in _pages(dcm)])
    return tuple(settled(column.reshape(-1, 1)) for column in rows.T)


QUATERNIONS: dict[str, Callable[..., Any]] = {
    name: lambda *given, function=function: settled(function(*given))
    for name, function in {
        "quatmultiply": _product,
        "quatconj": _conjugate,
        "quatinv": _inverse,
        "quatnorm": _square,  # as the toolbox calls the square
        "quatmod": lambda q: np.sqrt(_square(q)),
        "quatnormalize": _unit,
        "quatrotate": _rotated,
        "quat2dcm": _cosines,
        "dcm2quat": _of_cosines,
        "angle2dcm": _angle2dcm,
        "angle2quat": lambda a, b, c, order="ZYX": _of_cosines(_angle2dcm(a, b, c, order)),
    }.items()
} | {
    "dcm2angle": _dcm2angle,
    "quat2angle": lambda q, order="ZYX": _dcm2angle(_cosines(q), order),
}
