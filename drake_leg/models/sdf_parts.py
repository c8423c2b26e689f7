"""Elements of SDF documents: numbers, poses, inertias."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence

import numpy as np

from drake_leg.kinematics.euler import euler_angles, quaternions
from drake_leg.kinematics.khalil import Array
from drake_leg.units import LEAST

CENTRED = (0.0, 0.0, 0.0)
DRAKE = "drake.mit.edu"  # the namespace of Drake's own elements
STEEP = 0.99  # sine of the pitch beyond which roll, pitch, yaw lose digits


def document(root: ET.Element) -> str:
    """Write an XML document."""
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def number(value: float) -> str:
    """Write a number with all its digits."""
    # Parsers fail on numbers that are smaller than any quantity of a robot.
    return repr(0.0 if abs(value) < LEAST else float(value)).removesuffix(".0")


def quantity(value: float) -> str:
    """Write a quantity that was computed: its last digit is left out."""
    return f"{value:.15g}"


def numbers(values: Sequence[float]) -> str:
    """Write numbers with spaces between."""
    return " ".join(number(value) for value in values)


def comment(text: str) -> str:
    """Text of an XML comment, in which two hyphens must not be adjacent."""
    return f" {re.sub('-(?=-)', '- ', text)} "


def set_transform(
    pose: ET.Element, X_PC: Array, quaternion: Callable[[], tuple[float, ...]] | None = None
) -> None:
    """Write a pose: x, y, z [m] and its rotation.

    The rotation is roll, pitch, yaw [rad], or a quaternion (x, y, z, w) where these lose digits:
    near a pitch of 90 degrees. The quaternion is that of the pose unless an exacter one is given.
    """
    position = [0.0 if abs(value) < 1e-15 else float(value) for value in X_PC[:3, 3]]
    R_PC = np.where(np.abs(X_PC[:3, :3]) < 1e-15, 0.0, X_PC[:3, :3])
    if abs(R_PC[2, 0]) < STEEP:
        yaw_pitch_roll = euler_angles("ZYX", R_PC).tolist()
        angles = [math.pi if angle == -math.pi else angle for angle in reversed(yaw_pitch_roll)]
        pose.text = numbers((*position, *angles))
    else:
        pose.set("rotation_format", "quat_xyzw")
        pose.text = numbers((*position, *(quaternion() if quaternion else xyzw(X_PC))))


def xyzw(X: Array) -> tuple[float, ...]:
    """Compute the quaternion (x, y, z, w) of a pose."""
    w, x, y, z = quaternions(X[:3, :3]).tolist()
    return x, y, z, w


def add_text(parent: ET.Element, tag: str, text: str) -> None:
    """Add an element with a text."""
    ET.SubElement(parent, tag).text = text


def add_inertial(
    link: ET.Element,
    centre: Sequence[float],
    mass: float,
    moments: Sequence[float],
    products: Sequence[float] = CENTRED,
    *,
    show: Callable[[float], str] = quantity,
    R_LP: Array | None = None,
) -> None:
    """Add mass [kg], center of mass [m] and inertia about it [kg*m^2], along the axes of R_LP."""
    inertial = ET.SubElement(link, "inertial")
    if R_LP is not None:
        X_LP = np.eye(4)
        X_LP[:3, :3], X_LP[:3, 3] = R_LP, centre
        set_transform(ET.SubElement(inertial, "pose"), X_LP, lambda: xyzw(X_LP))
    elif any(centre):
        add_text(inertial, "pose", numbers((*centre, 0.0, 0.0, 0.0)))
    add_text(inertial, "mass", show(mass))
    inertia = ET.SubElement(inertial, "inertia")
    for tag, value in zip(("ixx", "iyy", "izz"), moments, strict=True):
        add_text(inertia, tag, show(value))
    for tag, value in zip(("ixy", "ixz", "iyz"), products, strict=True):
        add_text(inertia, tag, show(value))
