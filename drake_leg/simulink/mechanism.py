"""What bodies are: poses, Rigid Transforms, and solids with their shape, size, mass and colour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block, invalid_parameter, number, vector

Array = NDArray[np.float64]

AXES = {
    sign + name: factor * np.eye(3)[index]
    for sign, factor in (("+", 1.0), ("-", -1.0))
    for index, name in enumerate("XYZ")
}
ROUNDING = 1e-12  # of the entries of a rotation matrix


def pose(R: Array | None = None, p: Sequence[float] | Array | None = None) -> Array:
    """Put a pose together of a rotation and a translation [m]."""
    X = np.eye(4)
    if R is not None:
        X[:3, :3] = R
    if p is not None:
        X[:3, 3] = p
    return X


def inverse(X: Array) -> Array:
    """Invert a pose."""
    R = X[:3, :3].T
    return pose(R, -R @ X[:3, 3])


def about(axis: str, angle: float) -> Array:
    """Make the pose of a rotation about ``x``, ``y`` or ``z`` [rad]."""
    return pose(Rotation.from_euler(axis, angle).as_matrix())


def rigid_transform(block: Block) -> Array:
    """Pose X_BF of the follower frame F in the base frame B of a Rigid Transform block in SI."""
    return pose(_rotation(block), _translation(block))


def rotation_text(R: Array) -> str:
    """Write a rotation as an angle about an axis: ``90 deg about +x``."""
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
            raise invalid_parameter(block, "RotationArbitraryAxis", "it must not be zero")
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
            raise invalid_parameter(block, "RotationQuaternion", "it must not be zero")
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
        raise invalid_parameter(block, "BaseAlignAxisB", "the two axes must be at a right angle")
    base = np.column_stack([b1, b2, np.cross(b1, b2)])
    follower = np.column_stack([f1, f2, np.cross(f1, f2)])
    R: Array = base @ follower.T
    return R


def _proper(block: Block) -> Array:
    rows = block.parameters.get("RotationMatrix")
    R = np.array(rows, dtype=float) if isinstance(rows, tuple) else np.zeros(0)
    if R.shape != (3, 3) or not np.allclose(R @ R.T, np.eye(3), atol=1e-6) or np.linalg.det(R) < 0:
        raise invalid_parameter(block, "RotationMatrix", "it must be a proper rotation, 3 x 3")
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
        raise invalid_parameter(block, name, f"it must be {size} numbers")
    return np.array(value, dtype=float)


def _unknown(block: Block, name: str, value: object) -> InvalidValueError:
    return InvalidValueError(
        f"the block {block.name!r} (SID {block.sid}) has {name} {value!r}, which is not "
        "supported: choose another setting that means the same"
    )


SHAPES = {"Brick Solid": "brick", "Cylindrical Solid": "cylinder", "Spherical Solid": "sphere"}
DIMENSIONS = {
    "brick": ("BrickDimensions",),
    "cylinder": ("CylinderRadius", "CylinderLength"),
    "sphere": ("SphereRadius",),
}
OTHER = "other"
SOLIDS = (
    *SHAPES,
    "Solid",
    "Ellipsoidal Solid",
    "Extruded Solid",
    "File Solid",
    "Inertia",
    "Revolved Solid",
)


@dataclass(frozen=True, kw_only=True)
class SolidProperties:
    """A solid, homogeneous or with its mass given."""

    shape: str  # "brick", "cylinder", "sphere", "other"
    size: tuple[float, ...]  # [m]: three edges; radius and length; radius
    density: float | None  # [kg/m^3]; None where the mass is given
    mass: float  # [kg]; 0 where it follows from a shape that is not known
    moments: tuple[float, ...] = ()  # [kg*m^2], given, or of a plant's body
    offsets: tuple[float, ...] = ()  # centre of mass [m] and products [kg*m^2]; none means zero
    colour: tuple[float, ...] = ()  # red, green, blue in 0...1


def read_solid(block: Block) -> SolidProperties:
    """Read a block of a kind in ``SOLIDS`` as it is: sizes may be zero or less, or too few."""
    get = block.parameters.get
    shape = _shape(block)
    size = _size(block, shape)
    unsaid = "PointMass" if block.kind == "Inertia" else "CalculateFromGeometry"
    outright = get("InertiaType", unsaid) != "CalculateFromGeometry"
    weighed = outright or get("BasedOnType") == "Mass"
    density = None if weighed else number(get("Density"))
    moments, offsets = _inertia(block) if outright else ((), ())
    return SolidProperties(
        shape=shape,
        size=size,
        density=density,
        mass=number(get("Mass")) if density is None else density * volume(shape, size),
        moments=moments,
        offsets=offsets,
        colour=vector(get("GraphicDiffuseColor"))[:3],
    )


def volume(shape: str, size: tuple[float, ...]) -> float:
    """Volume [m^3] of a shape; 0 of another one, infinite where it is beyond all numbers."""
    try:
        if shape == "brick":
            return math.prod(size)
        if shape == "cylinder":
            radius, length = size
            return math.pi * radius**2 * length
        if shape == "sphere":
            (radius,) = size
            return 4.0 / 3.0 * math.pi * radius**3
    except OverflowError:
        return math.inf
    return 0.0


def _shape(block: Block) -> str:
    """Name the shape of a solid; files of about R2016 have one kind of block for all shapes."""
    if block.kind != "Solid":
        return SHAPES.get(block.kind, OTHER)
    shape = str(block.parameters.get("GeometryShape")).lower()
    return shape if shape in DIMENSIONS else OTHER


def _size(block: Block, shape: str) -> tuple[float, ...]:
    if shape == "brick":
        return vector(block.parameters.get("BrickDimensions"))
    return tuple(number(block.parameters.get(name)) for name in DIMENSIONS.get(shape, ()))


def _inertia(block: Block) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Read moments and offsets that are given; a point mass has no moments."""
    get = block.parameters.get
    centre = vector(get("CenterOfMass"))
    if get("InertiaType") != "Custom":
        return (0.0, 0.0, 0.0), centre
    return vector(get("MomentsOfInertia")), centre + vector(get("ProductsOfInertia"))
