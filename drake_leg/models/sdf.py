"""A robot as SDF text: what lies in ``sdf/``, readable by Drake and by Gazebo.

Every link's frame is the DH frame of its row. Beside it stand the frames ``frame_0`` ...
``frame_n`` of the table, and for every link ``NAME_base``, ``NAME_cog`` and ``NAME_end``.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.kinematics.khalil import row_transform
from drake_leg.models.solids import mass_properties
from drake_leg.robot import Brick, Cylinder, JointMechanics, Link, Robot, Row, Segment, Shape

PACKAGE = "drake_leg"
BASE = "base"
CENTRED = (0.0, 0.0, 0.0)


def sdf_text(robot: Robot) -> str:
    """Write a robot as an SDF document.

    Parameters
    ----------
    robot : Robot
        Rows, links, solids, joint mechanics.

    Returns
    -------
    str
        An SDF 1.9 document with one model, its base welded to the world.
    """
    sdf = ET.Element("sdf", version="1.9")
    sdf.append(ET.Comment(f" {robot.title} ({robot.source}). Generated from drake_leg.robots. "))
    model = ET.SubElement(sdf, "model", name=robot.name)
    _add_base(model)
    parent = BASE
    for index, segment in enumerate(robot.segments, start=1):
        if segment.link is None:
            _add_frame(model, f"frame_{index}", parent, _pose_of(segment.row))
            continue
        model.append(ET.Comment(f" Row {index}: {_row_text(segment.row)} "))
        _add_link(model, segment.link, segment.row, parent, index)
        _add_joint(model, segment, parent)
        parent = segment.link.name
    ET.indent(sdf)
    return '<?xml version="1.0"?>\n' + ET.tostring(sdf, encoding="unicode") + "\n"


def package_text() -> str:
    """Write the ``package.xml`` that makes ``package://drake_leg/`` known to parsers.

    Returns
    -------
    str
        An XML document.
    """
    package = ET.Element("package", format="2")
    for tag, text in (
        ("name", PACKAGE),
        ("version", "0.0.0"),
        ("description", "The pendulum, the hexabot leg and the SCARA arm of two lab reports."),
        ("license", "BSD-3-Clause"),
    ):
        ET.SubElement(package, tag).text = text
    ET.SubElement(package, "maintainer", email="drake-leg@example.org").text = "drake-leg"
    ET.indent(package)
    return '<?xml version="1.0"?>\n' + ET.tostring(package, encoding="unicode") + "\n"


def _number(value: float) -> str:
    return repr(0.0 if value == 0.0 else float(value)).removesuffix(".0")


def _quantity(value: float) -> str:
    return f"{value:.15g}"


def _numbers(values: Sequence[float]) -> str:
    return " ".join(_number(value) for value in values)


def _row_text(row: Row) -> str:
    sigma = "~" if row.sigma is None else row.sigma
    angles = f"alpha={math.degrees(row.alpha):g} deg, r={row.r:g} m"
    return f"sigma={sigma}, d={row.d:g} m, {angles}, theta={math.degrees(row.theta):g} deg"


def _pose_of(row: Row) -> tuple[float, ...]:
    """Return x, y, z [m] and roll, pitch, yaw [rad] of a row's frame at joint position 0."""
    X_PC = row_transform(row)
    x, y, z = X_PC[:3, 3]
    snapped = np.where(np.abs(X_PC[:3, :3]) < 1e-15, 0.0, X_PC[:3, :3])
    roll, pitch, yaw = Rotation.from_matrix(snapped).as_euler("xyz")
    cleaned = (0.0 if abs(value) < 1e-15 else float(value) for value in (x, y, z))
    return (*cleaned, float(roll), float(pitch), float(yaw))


def _add_text(parent: ET.Element, tag: str, text: str) -> None:
    ET.SubElement(parent, tag).text = text


def _add_frame(model: ET.Element, name: str, link: str, pose: Sequence[float] = (0.0,) * 6) -> None:
    frame = ET.SubElement(model, "frame", name=name, attached_to=link)
    if any(pose):
        _add_text(frame, "pose", _numbers(pose))


def _add_base(model: ET.Element) -> None:
    model.append(ET.Comment(" Welded to the world: the inertia of the base never acts. "))
    link = ET.SubElement(model, "link", name=BASE)
    _add_inertial(link, CENTRED, 1.0, (1.0, 1.0, 1.0))
    joint = ET.SubElement(model, "joint", name=f"{BASE}_weld", type="fixed")
    _add_text(joint, "parent", "world")
    _add_text(joint, "child", BASE)
    _add_frame(model, "frame_0", BASE)


def _add_link(model: ET.Element, link: Link, row: Row, parent: str, index: int) -> None:
    element = ET.SubElement(model, "link", name=link.name)
    pose = ET.SubElement(element, "pose", relative_to=parent)
    pose.text = _numbers(_pose_of(row))
    solid = link.solid
    if solid is None:
        _add_inertial(element, CENTRED, 0.0, CENTRED)
    else:
        properties = mass_properties(solid)
        _add_inertial(element, solid.centre, properties.mass, properties.moments)
        visual = ET.SubElement(element, "visual", name=f"{link.name}_visual")
        _add_text(visual, "pose", _numbers((*solid.centre, 0.0, 0.0, 0.0)))
        _add_geometry(visual, solid.shape)
        material = ET.SubElement(visual, "material")
        _add_text(material, "diffuse", _numbers((*solid.colour, 1.0)))
    _add_frame(model, f"frame_{index}", link.name)
    for place, position in (
        ("base", CENTRED),
        ("cog", solid.centre if solid else CENTRED),
        ("end", link.end),
    ):
        _add_frame(model, f"{link.name}_{place}", link.name, (*position, 0.0, 0.0, 0.0))


def _add_inertial(
    link: ET.Element, centre: Sequence[float], mass: float, moments: Sequence[float]
) -> None:
    inertial = ET.SubElement(link, "inertial")
    if any(centre):
        _add_text(inertial, "pose", _numbers((*centre, 0.0, 0.0, 0.0)))
    _add_text(inertial, "mass", _quantity(mass))
    inertia = ET.SubElement(inertial, "inertia")
    for tag, value in zip(("ixx", "iyy", "izz"), moments, strict=True):
        _add_text(inertia, tag, _quantity(value))
    for tag in ("ixy", "ixz", "iyz"):
        _add_text(inertia, tag, "0")


def _add_geometry(visual: ET.Element, shape: Shape) -> None:
    geometry = ET.SubElement(visual, "geometry")
    if isinstance(shape, Brick):
        box = ET.SubElement(geometry, "box")
        _add_text(box, "size", _numbers((shape.length, shape.width, shape.height)))
    elif isinstance(shape, Cylinder):
        cylinder = ET.SubElement(geometry, "cylinder")
        _add_text(cylinder, "radius", _number(shape.radius))
        _add_text(cylinder, "length", _number(shape.length))
    else:
        sphere = ET.SubElement(geometry, "sphere")
        _add_text(sphere, "radius", _number(shape.radius))


def _add_joint(model: ET.Element, segment: Segment, parent: str) -> None:
    if segment.joint is None or segment.link is None:
        return
    joint = ET.SubElement(model, "joint", name=segment.joint, type=segment.row.joint)
    _add_text(joint, "parent", parent)
    _add_text(joint, "child", segment.link.name)
    if segment.row.joint != "fixed":
        _add_axis(joint, segment.mechanics)


def _add_axis(joint: ET.Element, mechanics: JointMechanics) -> None:
    axis = ET.SubElement(joint, "axis")
    _add_text(axis, "xyz", "0 0 1")
    if not mechanics.actuated:
        limit = ET.SubElement(axis, "limit")
        _add_text(limit, "effort", "0")
    dynamics = ET.SubElement(axis, "dynamics")
    _add_text(dynamics, "damping", _number(mechanics.damping))
    if mechanics.spring_stiffness:
        _add_text(dynamics, "spring_reference", _number(mechanics.equilibrium_position))
        _add_text(dynamics, "spring_stiffness", _number(mechanics.spring_stiffness))
