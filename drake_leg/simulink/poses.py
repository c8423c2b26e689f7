"""Poses as 4 x 4 matrices, and what a Rigid Transform block says."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block
from drake_leg.simulink.values import senseless

Array = NDArray[np.float64]

AXES = {
    sign + name: factor * np.eye(3)[index]
    for sign, factor in (("+", 1.0), ("-", -1.0))
    for index, name in enumerate("XYZ")
}
ROUNDING = 1e-12  # of the entries of a rotation matrix


def pose(R: Array | None = None, p: Sequence[float] | Array | None = None) -> Array:
    """Put a pose together.

    Parameters
    ----------
    R : (3, 3), optional
        Rotation; none by default.
    p : (3,), optional
        Translation [m]; none by default.

    Returns
    -------
    (4, 4) ndarray
    """
    X = np.eye(4)
    if R is not None:
        X[:3, :3] = R
    if p is not None:
        X[:3, 3] = p
    return X


def inverse(X: Array) -> Array:
    """Turn a pose round.

    Parameters
    ----------
    X : (4, 4)
        A pose.

    Returns
    -------
    (4, 4) ndarray
    """
    R = X[:3, :3].T
    return pose(R, -R @ X[:3, 3])


def about(axis: str, angle: float) -> Array:
    """Rotate about an axis.

    Parameters
    ----------
    angle : float
        [rad].

    Returns
    -------
    (4, 4) ndarray
    """
    return pose(Rotation.from_euler(axis, angle).as_matrix())


def rigid_transform(block: Block) -> Array:
    """Pose of the follower frame F in the base frame B of a Rigid Transform block.

    Parameters
    ----------
    block : Block
        Its parameters in SI.

    Returns
    -------
    X_BF : (4, 4) ndarray

    Raises
    ------
    InvalidValueError
        If it uses a method that is not known here, or its numbers make no rotation.
    """
    return pose(_rotation(block), _translation(block))


def rotation_text(R: Array) -> str:
    """Write a rotation as an angle about an axis.

    Parameters
    ----------
    R : (3, 3)
        The rotation.

    Returns
    -------
    str
        ``90 deg about +x``.
    """
    vector = Rotation.from_matrix(R).as_rotvec(degrees=True)
    angle = float(np.linalg.norm(vector))
    if angle < 1e-9:
        return "no rotation"
    axis = vector / angle
    for name, unit in AXES.items():
        if np.allclose(axis, unit, atol=1e-9):
            return f"{angle:.9g} deg about {name.lower()}"
    return f"{angle:.9g} deg about ({', '.join(f'{value:.6g}' for value in axis)})"


def _translation(block: Block) -> Array:
    method = block.parameters.get("TranslationMethod", "None")
    if method == "None":
        return np.zeros(3)
    if method == "StandardAxis":
        return _number(block, "TranslationStandardOffset") * _axis(block, "TranslationStandardAxis")
    if method == "Cartesian":
        return _vector(block, "TranslationCartesianOffset", 3)
    if method == "Cylindrical":
        radius = _number(block, "TranslationCylindricalRadius")
        theta = _number(block, "TranslationCylindricalTheta")
        height = _number(block, "TranslationCylindricalZOffset")
        return np.array([radius * math.cos(theta), radius * math.sin(theta), height])
    raise _unknown(block, "TranslationMethod", method)


def _rotation(block: Block) -> Array:
    method = block.parameters.get("RotationMethod", "None")
    if method == "None":
        return np.eye(3)
    if method == "StandardAxis":
        return _about(_axis(block, "RotationStandardAxis"), _number(block, "RotationAngle"))
    if method == "ArbitraryAxis":
        axis = _vector(block, "RotationArbitraryAxis", 3)
        length = np.linalg.norm(axis)
        if length == 0.0:
            raise senseless(block, "RotationArbitraryAxis", "it must not be zero")
        return _about(axis / length, _number(block, "RotationAngle"))
    if method == "AlignedAxes":
        return _aligned(block)
    if method == "RotationSequence":
        sequence = str(block.parameters.get("RotationSequence", "XYZ"))
        if block.parameters.get("RotationSequenceAxes", "FollowerAxes") == "BaseAxes":
            sequence = sequence.lower()
        angles = _vector(block, "RotationSequenceAngles", 3)
        try:
            return _clean(Rotation.from_euler(sequence, angles).as_matrix())
        except ValueError:
            raise _unknown(block, "RotationSequence", sequence) from None
    if method == "RotationMatrix":
        return _proper(block)
    if method == "Quaternion":
        quaternion = _vector(block, "RotationQuaternion", 4)
        if not np.any(quaternion):
            raise senseless(block, "RotationQuaternion", "it must not be zero")
        return _clean(Rotation.from_quat(np.roll(quaternion, -1)).as_matrix())
    raise _unknown(block, "RotationMethod", method)


def _aligned(block: Block) -> Array:
    """Two axes of the follower along two axes of the base; the third follows."""
    pairs = [
        (_axis(block, f"FollAlignAxis{letter}"), _axis(block, f"BaseAlignAxis{letter}"))
        for letter in "AB"
    ]
    (f1, b1), (f2, b2) = pairs
    if abs(f1 @ f2) > 0.5 or abs(b1 @ b2) > 0.5:
        raise senseless(block, "BaseAlignAxisB", "the two axes must be at a right angle")
    base = np.column_stack([b1, b2, np.cross(b1, b2)])
    follower = np.column_stack([f1, f2, np.cross(f1, f2)])
    R: Array = base @ follower.T
    return R


def _proper(block: Block) -> Array:
    rows = block.parameters.get("RotationMatrix")
    R = np.array(rows, dtype=float) if isinstance(rows, tuple) else np.zeros(0)
    if R.shape != (3, 3) or not np.allclose(R @ R.T, np.eye(3), atol=1e-6) or np.linalg.det(R) < 0:
        raise senseless(block, "RotationMatrix", "it must be a proper rotation, 3 x 3")
    return R


def _about(axis: Array, angle: float) -> Array:
    return _clean(Rotation.from_rotvec(angle * axis).as_matrix())


def _clean(R: Array) -> Array:
    """Make right angles exact."""
    nearest = np.round(R)
    cleaned: Array = np.where(np.abs(R - nearest) < ROUNDING, nearest, R)
    return cleaned


def _axis(block: Block, name: str) -> Array:
    text = str(block.parameters.get(name, "")).upper()
    if text not in AXES:
        raise _unknown(block, name, text)
    axis: Array = AXES[text]
    return axis


def _number(block: Block, name: str) -> float:
    value = block.parameters.get(name, 0.0)
    if not isinstance(value, float | int):
        raise _unknown(block, name, value)
    return float(value)


def _vector(block: Block, name: str, size: int) -> Array:
    value = block.parameters.get(name)
    if not isinstance(value, tuple) or np.shape(value) != (size,):
        raise senseless(block, name, f"it must be {size} numbers")
    return np.array(value, dtype=float)


def _unknown(block: Block, name: str, value: object) -> InvalidValueError:
    return InvalidValueError(
        f"the block {block.name!r} (SID {block.sid}) has {name} {value!r}, which is not "
        "known here: choose another setting that says the same"
    )
