"""The thigh subsystem of report B as data and SDF, and a leg that includes it three times."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import PACKAGE, sdf_text
from drake_leg.robot.robot import PLACES, Brick, Robot, Row, Segment, Solid, frame_name, place_name
from drake_leg.robot.robots import LEG_B

FRAMES = ("base", "cog", "end", "solid")  # of every thigh: three to connect, one of the solid
ENDS_TOGETHER = 1e-12  # [m], how far a link's end may be from the next row's beginning

Vector = tuple[float, float, float]

FILE = "thigh.sdf"
LEG_FILE = "hexabot_leg_of_thighs.sdf"
NOWHERE = "0 0 0 0 0 0"

_ORIGINAL = "femur"  # of leg B: the thigh without any setting
_EXPERIMENTAL = "http://sdformat.org/schemas/experimental"


@dataclass(frozen=True, kw_only=True)
class RigidTransform:
    """The pose of one frame of a thigh in another: an offset, then two rotations."""

    base: str
    follower: str
    offset: Vector  # [m], in the base's axes
    turn_x: float = 0.0  # [rad], about x
    turn_z: float = 0.0  # [rad], then about z


@dataclass(frozen=True, kw_only=True)
class ThighSubsystem:
    """A link with its four frames, as drawn in report B's figure 5."""

    name: str  # of the link: coxa, femur, tibia
    solid: Solid  # a brick
    transforms: tuple[RigidTransform, ...]  # base to cog, cog to end, cog to solid

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the four frames."""
        return FRAMES


def thighs(robot: Robot) -> tuple[ThighSubsystem, ...]:
    """Describe a robot's moving links as thigh subsystems, from base to tip.

    Raises
    ------
    InvalidValueError
        If a link is not a brick, or does not end where the next row begins.
    """
    nexts = [*(segment.row for segment in robot.segments[1:]), None]
    return tuple(
        _thigh(robot, segment, following)
        for segment, following in zip(robot.segments, nexts, strict=True)
        if segment.row.joint != "fixed"
    )


def _thigh(robot: Robot, segment: Segment, following: Row | None) -> ThighSubsystem:
    link = segment.link
    if link is None or link.solid is None or not isinstance(link.solid.shape, Brick):
        name = link.name if link else segment.joint
        raise InvalidValueError(
            f"the link {name!r} of {robot.name!r} is not a brick; only a leg of bricks is made "
            "of thighs"
        )
    row = following or Row(joint="fixed", d=link.end[0])
    cos, sin = math.cos(row.alpha), math.sin(row.alpha)
    start = (row.d, -row.r * sin, row.r * cos)
    if math.dist(start, link.end) > ENDS_TOGETHER:
        raise InvalidValueError(
            f"the link {link.name!r} of {robot.name!r} ends at {link.end} m and the next row "
            f"begins at {start} m in its frame; a thigh must end where the next one begins"
        )
    cog, centre = link.centre_of_mass, link.solid.centre
    return ThighSubsystem(
        name=link.name,
        solid=link.solid,
        transforms=(
            RigidTransform(base="base", follower="cog", offset=cog),
            RigidTransform(
                base="cog",
                follower="end",
                offset=_between(cog, link.end),
                turn_x=row.alpha,
                turn_z=row.theta,
            ),
            RigidTransform(base="cog", follower="solid", offset=_between(cog, centre)),
        ),
    )


def _between(start: Vector, end: Vector) -> Vector:
    return (end[0] - start[0], end[1] - start[1], end[2] - start[2])


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
    return _document(sdf)


def thigh_leg_text(robot: Robot) -> str:
    """Write a leg as an SDF 1.9 document that includes the thigh once for every joint.

    Joints, base, foot and the table's frames are named as in the robot's own document; the links
    are the nested models ``coxa``, ``femur``, ``tibia``. The parser must know ``package.xml``,
    because Drake looks for a bare file name in the working directory.

    Raises
    ------
    InvalidValueError
        If a link is not a brick, or does not end where the next row begins.
    """
    ET.register_namespace("experimental", _EXPERIMENTAL)
    sdf = ET.Element("sdf", version="1.9")
    sdf.append(ET.Comment(f" A leg that includes {FILE} once for every joint. Generated. "))
    model = ET.SubElement(sdf, "model", name=LEG_FILE.removesuffix(".sdf"))
    settings = _settings(robot)
    own_places = {place_name(link, place) for link in settings for place in PLACES}
    for element in _robot_model(robot):
        name = element.get("name", "")
        if element.tag == "link" and name in settings:
            model.append(_include(element, settings))
        elif name not in own_places:
            model.append(_connected(element, settings))
    return _document(sdf)


def _settings(robot: Robot) -> dict[str, tuple[_Setting, ...]]:
    """For every thigh of a robot: its inertial, its brick, its frames cog, end and solid."""
    model = _robot_model(robot)
    return {
        thigh.name: _thigh_settings(model, thigh, _end_turn(model, robot, thigh.name))
        for thigh in thighs(robot)
    }


def _thigh_settings(
    model: ET.Element, thigh: ThighSubsystem, end_turn: ET.Element
) -> tuple[_Setting, ...]:
    inertial = _child(model, f"link[@name='{thigh.name}']/inertial")
    if inertial.find("pose") is None:
        inertial.insert(0, _pose(NOWHERE.split()))
    visual = _child(model, f"link[@name='{thigh.name}']/visual")
    cog, end, solid = (_words(transform.offset) for transform in thigh.transforms)
    turn = (end_turn.text or NOWHERE).split()[3:]
    written = {key: end_turn.attrib[key] for key in ("rotation_format",) if key in end_turn.attrib}
    return (
        _Setting("link", "link", [inertial]),
        _Setting("visual", "link::brick", [_child(visual, "geometry"), _child(visual, "material")]),
        _Setting("frame", "cog", [_pose([*cog, "0", "0", "0"])], "base"),
        _Setting("frame", "end", [_pose([*end, *turn], **written)], "cog"),
        _Setting("frame", "solid", [_pose([*solid, "0", "0", "0"])], "cog"),
    )


def _end_turn(model: ET.Element, robot: Robot, name: str) -> ET.Element:
    """Pose of the row after a link's, which has the rotation of the link's end."""
    names = [segment.link.name if segment.link else None for segment in robot.segments]
    index = names.index(name) + 1
    if index == len(names):
        return _pose(NOWHERE.split())
    tag, following = ("link", names[index]) if names[index] else ("frame", frame_name(index + 1))
    return _child(model, f"{tag}[@name='{following}']/pose")


def _include(link: ET.Element, settings: dict[str, tuple[_Setting, ...]]) -> ET.Element:
    name, pose = link.get("name", ""), _child(link, "pose")
    before = pose.get("relative_to", "")
    include = ET.Element("include")
    ET.SubElement(include, "uri").text = f"package://{PACKAGE}/{FILE}"
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
    return _pose(NOWHERE.split(), relative_to=f"{carrier}::end")


def _robot_model(robot: Robot) -> ET.Element:
    return _child(ET.fromstring(sdf_text(robot)), "model")


def _child(element: ET.Element, path: str) -> ET.Element:
    found = element.find(path)
    assert found is not None, path
    return found


def _pose(words: Sequence[str], **attributes: str) -> ET.Element:
    pose = ET.Element("pose", attributes)
    pose.text = " ".join(words)
    return pose


def _words(offset: Sequence[float]) -> list[str]:
    return [repr(float(value)).removesuffix(".0") for value in offset]


def _document(sdf: ET.Element) -> str:
    ET.indent(sdf)
    return '<?xml version="1.0"?>\n' + ET.tostring(sdf, encoding="unicode") + "\n"
