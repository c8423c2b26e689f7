"""Writes a robot as SDF, as in the folder ``sdf``, for Drake and Gazebo; or as a leg of thighs.

Every link's frame is the DH frame of its row. There are also the frames ``frame_0`` ...
``frame_n`` of the table, and for every link ``NAME_base``, ``NAME_cog`` and ``NAME_end``.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import row_transform
from drake_leg.models.sdf_parts import (
    CENTRED,
    DRAKE,
    add_inertial,
    add_text,
    comment,
    document,
    number,
    numbers,
    set_transform,
)
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import (
    BASE_WELD,
    PLACES,
    Link,
    Robot,
    Row,
    Segment,
    frame_name,
    place_name,
)
from drake_leg.robot.robots import LEG_B
from drake_leg.robot.solids import Brick, Cylinder, Shape, mass_properties

PACKAGE = "drake_leg"
Vector = tuple[float, float, float]


def sdf_text(robot: Robot, *, origin: str = "drake_leg.robot.robots") -> str:
    """Write a robot as an SDF 1.9 document with one model.

    Its base is welded to the world, unless it floats. ``origin`` names the source in the document's
    comment. At a closed loop, the document has the two frames of the cut; SDF has no joint that
    closes it.
    """
    sdf = ET.Element("sdf", version="1.9")
    about = f"{robot.title} ({robot.source}). Generated from {origin}."
    sdf.append(ET.Comment(comment(about)))
    model = ET.SubElement(sdf, "model", name=robot.name)
    _add_base(model, robot)
    # Of every row, 0 being the base: the link that carries it, and the name of its frame.
    carriers, frames = [robot.base_name], [robot.base_name]
    for index, (segment, antecedent) in enumerate(
        zip(robot.segments, robot.antecedents, strict=True), start=1
    ):
        carrier, before = carriers[antecedent], frames[antecedent]
        if segment.link is None:
            _add_frame(model, frame_name(index), before, segment.row)
        else:
            model.append(ET.Comment(comment(f"Row {index}: {_row_text(segment.row)}")))
            _add_link(model, segment.link, segment.row, before, index)
            _add_joint(model, segment, carrier)
        carriers.append(carrier if segment.link is None else segment.link.name)
        frames.append(frame_name(index) if segment.link is None else segment.link.name)
    return document(sdf)


def package_text() -> str:
    """Write the ``package.xml`` that makes ``package://drake_leg/`` known to parsers."""
    package = ET.Element("package", format="2")
    for tag, text in (
        ("name", PACKAGE),
        ("version", "0.0.0"),
        ("description", "The pendulum, the hexabot leg and the SCARA arm of two lab reports."),
        ("license", "BSD-3-Clause"),
    ):
        ET.SubElement(package, tag).text = text
    ET.SubElement(package, "maintainer", email="drake-leg@example.org").text = "drake-leg"
    return document(package)


def _row_text(row: Row) -> str:
    sigma = "~" if row.sigma is None else row.sigma
    angles = f"alpha={math.degrees(row.alpha):g} deg, r={row.r:g} m"
    tree = "" if row.antecedent is None else f", antecedent={row.antecedent}"
    if row.gamma or row.b:
        tree += f", gamma={math.degrees(row.gamma):g} deg, b={row.b:g} m"
    return f"sigma={sigma}, d={row.d:g} m, {angles}, theta={math.degrees(row.theta):g} deg{tree}"


def set_pose(pose: ET.Element, row: Row) -> None:
    """Write the pose of a row's frame at joint position 0."""
    set_transform(
        pose,
        row_transform(row),
        lambda: (
            math.sin(row.alpha / 2) * math.cos((row.theta - row.gamma) / 2),
            -math.sin(row.alpha / 2) * math.sin((row.theta - row.gamma) / 2),
            math.cos(row.alpha / 2) * math.sin((row.theta + row.gamma) / 2),
            math.cos(row.alpha / 2) * math.cos((row.theta + row.gamma) / 2),
        ),
    )


def _add_frame(model: ET.Element, name: str, parent: str, row: Row | None = None) -> None:
    """Add a frame on a link or on another frame, at the place of a fixed row's frame."""
    frame = ET.SubElement(model, "frame", name=name, attached_to=parent)
    if row is not None:
        set_pose(ET.SubElement(frame, "pose"), row)


def _add_place(model: ET.Element, link: str, place: str, position: Sequence[float]) -> None:
    frame = ET.SubElement(model, "frame", name=place_name(link, place), attached_to=link)
    if any(position):
        add_text(frame, "pose", numbers((*position, 0.0, 0.0, 0.0)))


def _add_base(model: ET.Element, robot: Robot) -> None:
    """Add the base: a link welded to the world, or one that floats."""
    if not robot.floating:
        model.append(ET.Comment(" Welded to the world: the inertia of the base never acts. "))
    link = ET.SubElement(model, "link", name=robot.base_name)
    if robot.base_pose is not None:
        X_W0 = np.array(robot.base_pose)
        set_transform(ET.SubElement(link, "pose"), X_W0)
    if robot.base_link is None:
        add_inertial(link, CENTRED, 1.0, (1.0, 1.0, 1.0))
    else:
        _add_body(link, robot.base_link)
    if not robot.floating:
        joint = ET.SubElement(model, "joint", name=BASE_WELD, type="fixed")
        add_text(joint, "parent", "world")
        add_text(joint, "child", robot.base_name)
    _add_frame(model, frame_name(0), robot.base_name)


def _add_link(model: ET.Element, link: Link, row: Row, before: str, index: int) -> None:
    element = ET.SubElement(model, "link", name=link.name)
    set_pose(ET.SubElement(element, "pose", relative_to=before), row)
    _add_body(element, link)
    _add_frame(model, frame_name(index), link.name)
    for place, position in zip(PLACES, (CENTRED, link.centre_of_mass, link.end), strict=True):
        _add_place(model, link.name, place, position)


def _add_body(element: ET.Element, link: Link) -> None:
    """Add a link's mass properties and its shape."""
    _add_mass(element, link)
    solid = link.solid
    if solid is not None:
        visual = ET.SubElement(element, "visual", name=f"{link.name}_visual")
        add_text(visual, "pose", numbers((*solid.centre, 0.0, 0.0, 0.0)))
        _add_geometry(visual, solid.shape)
        material = ET.SubElement(visual, "material")
        add_text(material, "diffuse", numbers((*solid.colour, 1.0)))


def _add_mass(element: ET.Element, link: Link) -> None:
    body, solid = link.inertial, link.solid
    if body is not None and body.is_thin:
        # The parser computes principal moments with rounding, and refuses negative ones.
        R_LP, moments = body.along_principal_axes()
        add_inertial(element, body.centre, body.mass, moments, show=number, R_LP=R_LP)
    elif body is not None:
        add_inertial(element, body.centre, body.mass, body.moments, body.products, show=number)
    elif solid is not None:
        properties = mass_properties(solid)
        add_inertial(element, solid.centre, properties.mass, properties.moments)
    else:
        add_inertial(element, CENTRED, 0.0, CENTRED)


def _add_geometry(visual: ET.Element, shape: Shape) -> None:
    geometry = ET.SubElement(visual, "geometry")
    if isinstance(shape, Brick):
        box = ET.SubElement(geometry, "box")
        add_text(box, "size", numbers((shape.length, shape.width, shape.height)))
    elif isinstance(shape, Cylinder):
        cylinder = ET.SubElement(geometry, "cylinder")
        add_text(cylinder, "radius", number(shape.radius))
        add_text(cylinder, "length", number(shape.length))
    else:
        sphere = ET.SubElement(geometry, "sphere")
        add_text(sphere, "radius", number(shape.radius))


def _add_joint(model: ET.Element, segment: Segment, parent: str) -> None:
    if segment.joint is None or segment.link is None:
        return
    joint = ET.SubElement(model, "joint", name=segment.joint, type=segment.row.joint)
    add_text(joint, "parent", parent)
    add_text(joint, "child", segment.link.name)
    if segment.row.joint != "fixed":
        _add_axis(joint, segment.mechanics)
        _add_rotor(joint, segment.mechanics)


def _add_axis(joint: ET.Element, mechanics: JointMechanics) -> None:
    axis = ET.SubElement(joint, "axis")
    add_text(axis, "xyz", "0 0 1")
    _add_limits(axis, mechanics)
    dynamics = ET.SubElement(axis, "dynamics")
    add_text(dynamics, "damping", number(mechanics.damping))
    if mechanics.spring_stiffness:
        add_text(dynamics, "spring_reference", number(mechanics.equilibrium_position))
        add_text(dynamics, "spring_stiffness", number(mechanics.spring_stiffness))


def _add_rotor(joint: ET.Element, mechanics: JointMechanics) -> None:
    """Add the inertia of the rotor, seen at the joint, and say what a joint of Drake has not."""
    if mechanics.rotor_inertia:
        ET.register_namespace("drake", DRAKE)
        add_text(joint, f"{{{DRAKE}}}rotor_inertia", number(mechanics.rotor_inertia))
        add_text(joint, f"{{{DRAKE}}}gear_ratio", "1")
    if mechanics.dry_friction:
        said = f"Dry friction {mechanics.dry_friction:g} N*m or N is left out: Drake has none."
        joint.append(ET.Comment(comment(said)))


def _add_limits(axis: ET.Element, mechanics: JointMechanics) -> None:
    """Add the limits that exist; an effort of 0 means a joint without actuator."""
    limits = {
        "lower": mechanics.lower,
        "upper": mechanics.upper,
        "effort": mechanics.effort if mechanics.actuated else 0.0,
        "velocity": mechanics.velocity,
    }
    if all(value is None for value in limits.values()):
        return
    limit = ET.SubElement(axis, "limit")
    for tag, value in limits.items():
        if value is not None:
            add_text(limit, tag, number(value))


# --- the thigh subsystem of report B, figure 5 -----------------------------------------------

ENDS_TOGETHER = 1e-12  # [m], how far a link's end may be from the next row's beginning
THIGH_FILE = "thigh.sdf"
LEG_FILE = "hexabot_leg_of_thighs.sdf"
NOWHERE = "0 0 0 0 0 0"

_ORIGINAL = "femur"  # of leg B: the thigh without any setting
_EXPERIMENTAL = "http://sdformat.org/schemas/experimental"


class _Setting(NamedTuple):
    """An element of the thigh that a leg may set: its children, or all of a frame."""

    tag: str
    element_id: str
    children: Sequence[ET.Element]
    attached_to: str = ""  # of a frame


def thigh_text() -> str:
    """Write the thigh as an SDF 1.9 document of its own, without joints.

    Its model ``thigh`` has the link ``link`` and the frames ``base``, ``cog``, ``end``, ``solid``.
    """
    sdf = ET.Element("sdf", version="1.9")
    about = f"Thigh subsystem (Report B, figure 5): the {_ORIGINAL} of {LEG_B.title}."
    sdf.append(ET.Comment(f" {about} Generated from drake_leg.robot.robots. "))
    model = ET.SubElement(sdf, "model", name="thigh")
    inertial, visual, cog, end, solid = _settings(LEG_B)[_ORIGINAL]
    link = ET.SubElement(model, "link", name="link")
    link.extend(inertial.children)
    brick = ET.SubElement(link, "visual", name="brick")
    ET.SubElement(brick, "pose", relative_to="solid").text = NOWHERE
    brick.extend(visual.children)
    ET.SubElement(model, "frame", name="base", attached_to="link")
    for frame in (cog, end, solid):
        placed = {"name": frame.element_id, "attached_to": frame.attached_to}
        ET.SubElement(model, "frame", placed).extend(frame.children)
    return document(sdf)


def thigh_leg_text(robot: Robot) -> str:
    """Write a leg as an SDF 1.9 document that includes the thigh once for every joint.

    Joints, base, foot and the table's frames are named as in the robot's own document; the links
    are the nested models ``coxa``, ``femur``, ``tibia``. The parser must know ``package.xml``,
    because Drake looks for a bare file name in the working directory.

    Raises
    ------
    InvalidValueError
        If the robot is not a chain of bricks, or a link does not end where the next row begins.
    """
    if not robot.is_plain:
        raise InvalidValueError(
            f"{robot.name!r} is not a chain on a base at rest; only a chain of bricks is made of "
            "thighs"
        )
    ET.register_namespace("experimental", _EXPERIMENTAL)
    sdf = ET.Element("sdf", version="1.9")
    sdf.append(ET.Comment(f" A leg that includes {THIGH_FILE} once for every joint. Generated. "))
    model = ET.SubElement(sdf, "model", name=LEG_FILE.removesuffix(".sdf"))
    settings = _settings(robot)
    own_places = {place_name(link, place) for link in settings for place in PLACES}
    for element in robot_model(robot):
        name = element.get("name", "")
        if element.tag == "link" and name in settings:
            model.append(_include(element, settings))
        elif name not in own_places:
            model.append(_connected(element, settings))
    return document(sdf)


def _settings(robot: Robot) -> dict[str, tuple[_Setting, ...]]:
    """For every thigh of a robot: its inertial, its brick, its frames cog, end and solid."""
    model = robot_model(robot)
    found = {}
    for index, segment in enumerate(robot.segments, start=1):
        if segment.row.joint != "fixed":
            link, offsets = _thigh_of(robot, segment, robot.segments[index:])
            turn = _end_turn(model, index + 1, robot.segments[index:])
            found[link.name] = _thigh_settings(model, link.name, offsets, turn)
    return found


def _thigh_of(
    robot: Robot, segment: Segment, after: Sequence[Segment]
) -> tuple[Link, tuple[Vector, Vector, Vector]]:
    """Find a thigh's link, and its offsets: base to cog, cog to end, cog to solid [m]."""
    link = segment.link
    if link is None or link.solid is None or not isinstance(link.solid.shape, Brick):
        name = link.name if link else segment.joint
        raise InvalidValueError(
            f"the link {name!r} of {robot.name!r} is not a brick; only a leg of bricks is made "
            "of thighs"
        )
    cog, end = link.centre_of_mass, link.end
    start = tuple(row_transform(after[0].row)[:3, 3].tolist()) if after else (end[0], 0.0, 0.0)
    if math.dist(start, end) > ENDS_TOGETHER:
        raise InvalidValueError(
            f"the link {link.name!r} of {robot.name!r} ends at {end} m and the next row "
            f"begins at {start} m in its frame; a thigh must end where the next one begins"
        )
    return link, (cog, _between(cog, end), _between(cog, link.solid.centre))


def _between(start: Vector, end: Vector) -> Vector:
    return (end[0] - start[0], end[1] - start[1], end[2] - start[2])


def _thigh_settings(
    model: ET.Element, name: str, offsets: Sequence[Vector], end_turn: ET.Element
) -> tuple[_Setting, ...]:
    inertial = _child(model, f"link[@name='{name}']/inertial")
    if inertial.find("pose") is None:
        inertial.insert(0, _pose(NOWHERE))
    visual = _child(model, f"link[@name='{name}']/visual")
    cog, end, solid = map(numbers, offsets)
    turn = " ".join((end_turn.text or NOWHERE).split()[3:])
    written = {key: end_turn.attrib[key] for key in ("rotation_format",) if key in end_turn.attrib}
    return (
        _Setting("link", "link", [inertial]),
        _Setting("visual", "link::brick", [_child(visual, "geometry"), _child(visual, "material")]),
        _Setting("frame", "cog", [_pose(f"{cog} 0 0 0")], "base"),
        _Setting("frame", "end", [_pose(f"{end} {turn}", **written)], "cog"),
        _Setting("frame", "solid", [_pose(f"{solid} 0 0 0")], "cog"),
    )


def _end_turn(model: ET.Element, index: int, after: Sequence[Segment]) -> ET.Element:
    """Pose of the row after a link's, which has the rotation of the link's end."""
    if not after:
        return _pose(NOWHERE)
    link = after[0].link
    path = f"link[@name='{link.name}']" if link else f"frame[@name='{frame_name(index)}']"
    return _child(model, f"{path}/pose")


def _include(link: ET.Element, settings: dict[str, tuple[_Setting, ...]]) -> ET.Element:
    name, pose = link.get("name", ""), _child(link, "pose")
    before = pose.get("relative_to", "")
    include = ET.Element("include")
    ET.SubElement(include, "uri").text = f"package://{PACKAGE}/{THIGH_FILE}"
    ET.SubElement(include, "name").text = name
    ET.SubElement(include, "placement_frame").text = "base"
    include.append(_placed(pose, before, settings))
    original = _settings(LEG_B)[_ORIGINAL]
    mask = ET.Element(f"{{{_EXPERIMENTAL}}}params")
    for mine, theirs in zip(settings[name], original, strict=True):
        different = [
            child
            for child, other in zip(mine.children, theirs.children, strict=True)
            if ET.tostring(child) != ET.tostring(other)
        ]
        if different:
            ET.SubElement(mask, mine.tag, _action(mine)).extend(different)
    if len(mask):
        include.append(mask)
    return include


def _action(setting: _Setting) -> dict[str, str]:
    """Modify what is inside a link or visual; replace a frame, so that any rotation may be set."""
    element_id = setting.element_id
    if not setting.attached_to:
        return {"element_id": element_id, "action": "modify"}
    frame = {"name": element_id, "attached_to": setting.attached_to}
    return {"element_id": element_id, "action": "replace", **frame}


def _connected(element: ET.Element, settings: dict[str, tuple[_Setting, ...]]) -> ET.Element:
    """Connect a link, frame or joint to the frames of the thighs instead of their links."""
    pose = element.find("pose")
    carrier = element.get("attached_to", pose.get("relative_to", "") if pose is not None else "")
    if pose is not None and carrier in settings:
        element.remove(pose)
        element.insert(0, _placed(pose, carrier, settings))
    if element.get("attached_to") in settings:
        element.set("attached_to", f"{carrier}::base")
    for tag, place in (("parent", "end"), ("child", "base")):
        body = element.find(tag)
        if body is not None and body.text in settings:
            body.text = f"{body.text}::{place}"
    return element


def _placed(
    pose: ET.Element, carrier: str, settings: dict[str, tuple[_Setting, ...]]
) -> ET.Element:
    """Place an element at the end of the thigh that carries it; leave others in place."""
    if carrier not in settings:
        return pose
    return _pose(NOWHERE, relative_to=f"{carrier}::end")


def robot_model(robot: Robot) -> ET.Element:
    """Return the model in a robot's document."""
    return _child(ET.fromstring(sdf_text(robot)), "model")


def _child(element: ET.Element, path: str) -> ET.Element:
    found = element.find(path)
    assert found is not None, path
    return found


def _pose(text: str, **attributes: str) -> ET.Element:
    pose = ET.Element("pose", attributes)
    pose.text = text
    return pose
