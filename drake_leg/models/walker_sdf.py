"""Writes a walking robot as SDF: one file of a leg, and a body that includes it once for each hip.

The leg has all that lets it walk: servos with their gains, and a foot that touches the ground. The
parsed robot is the one of ``add_walker``; the ground is not in it.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import PACKAGE, robot_model, set_pose
from drake_leg.models.sdf_parts import DRAKE, comment, document
from drake_leg.models.walker import POINT_FEET, Contact
from drake_leg.robot.ground import FLAT
from drake_leg.robot.robot import BASE, BASE_WELD, Link, Robot, Row, Segment
from drake_leg.robot.servos import IDEAL, Servo

POINT = 1e-12  # [m], radius of a point: SDF's parser takes a radius of 0 for 1 m


def body_text(robot: Robot, *, leg_file: str) -> str:
    """Write a walking robot as an SDF 1.9 document that includes a leg at every hip.

    The legs are nested models, named ``left_front`` and so on. The parser must know
    ``package.xml``.

    Raises
    ------
    InvalidValueError
        If the legs are not alike.
    """
    sdf = ET.Element("sdf", version="1.9")
    about = f"{robot.title} ({robot.source}): a body that includes {leg_file} at every hip."
    sdf.append(ET.Comment(comment(f"{about} Generated from drake_leg.robot.hexapods.")))
    model = ET.SubElement(sdf, "model", name=robot.name)
    body = robot_model(robot).find(f"link[@name='{robot.base_name}']")
    assert body is not None
    model.append(body)
    ET.SubElement(model, "frame", name="frame_0", attached_to=robot.base_name)
    for name, leg in _alike(robot).items():
        include = ET.SubElement(model, "include")
        ET.SubElement(include, "uri").text = f"package://{PACKAGE}/{leg_file}"
        ET.SubElement(include, "name").text = name
        ET.SubElement(include, "placement_frame").text = BASE
        set_pose(ET.SubElement(include, "pose", relative_to=robot.base_name), leg[0].row)
        weld = ET.SubElement(model, "joint", name=f"{name}_weld", type="fixed")
        ET.SubElement(weld, "parent").text = robot.base_name
        ET.SubElement(weld, "child").text = f"{name}::{BASE}"
    return document(sdf)


def leg_text(
    robot: Robot,
    *,
    servo: Servo = IDEAL,
    contact: Contact = POINT_FEET,
    friction: float = FLAT.friction,
) -> str:
    """Write a leg of a walking robot as an SDF 1.9 document, with its servos and its contact.

    Its base has no mass, and its joints are ``hip``, ``knee`` and ``ankle``.

    Raises
    ------
    InvalidValueError
        If the legs are not alike, or the servo's gear rubs: SDF has no dry friction for Drake.
    """
    if servo.friction:
        raise InvalidValueError(
            f"the gear of the servo {servo.name!r} has a friction of {servo.friction:g} N*m, which "
            "SDF does not bring to Drake; give a servo with `friction=0.0`, or build the plant "
            "with `add_walker`"
        )
    leg = _one_leg(robot, servo)
    ET.register_namespace("drake", DRAKE)
    sdf = ET.Element("sdf", version="1.9")
    about = f"A leg of {robot.title} ({robot.source}), with the servo {servo.name}."
    sdf.append(ET.Comment(comment(f"{about} Generated from drake_leg.robot.hexapods.")))
    model = robot_model(leg)
    for element in model.findall(f"joint[@name='{BASE_WELD}']"):
        model.remove(element)
    for joint in model.findall("joint[@type='revolute']"):
        ET.SubElement(joint, _own("rotor_inertia")).text = repr(servo.rotor_inertia)
        ET.SubElement(joint, _own("gear_ratio")).text = "1"
        gains = {"p": repr(servo.stiffness), "d": repr(servo.damping)}
        ET.SubElement(joint, _own("controller_gains"), gains)
    foot = model.find(f"link[@name='{next(iter(leg.tips))}']")
    assert foot is not None
    foot.append(_touching(contact, friction))
    sdf.append(model)
    return document(sdf)


def _own(tag: str) -> str:
    return f"{{{DRAKE}}}{tag}"


def _touching(contact: Contact, friction: float) -> ET.Element:
    """The point or the ball that touches the ground."""
    collision = ET.Element("collision", name="contact")
    sphere = ET.SubElement(ET.SubElement(collision, "geometry"), "sphere")
    ET.SubElement(sphere, "radius").text = repr(max(contact.foot_radius, POINT))
    properties = ET.SubElement(collision, _own("proximity_properties"))
    for tag, value in (
        ("point_contact_stiffness", contact.stiffness),
        ("mu_dynamic", friction),
        ("mu_static", friction),
    ):
        ET.SubElement(properties, _own(tag)).text = repr(value)
    return collision


def _one_leg(robot: Robot, servo: Servo) -> Robot:
    """A leg of the robot on a base without mass, with the servo at its joints."""
    segments = next(iter(_alike(robot).values()))
    hip = replace(segments[0], row=Row(joint="revolute"))
    return Robot(
        name=f"{robot.name}_leg",
        title=robot.title,
        source=robot.source,
        segments=tuple(_driven(segment, servo) for segment in (hip, *segments[1:])),
        base_link=Link(name=BASE),
    )


def _driven(segment: Segment, servo: Servo) -> Segment:
    if segment.row.joint == "fixed":
        return segment
    damping = segment.mechanics.damping + servo.back_emf_damping
    mechanics = replace(
        segment.mechanics, damping=damping, effort=servo.stall_torque, rotor_inertia=0.0
    )
    return replace(segment, mechanics=mechanics)


def _alike(robot: Robot) -> dict[str, list[Segment]]:
    """The legs by their names; the names of their links and joints are without them."""
    legs: dict[str, list[Segment]] = {}
    for tip, row in robot.tips.items():
        name = tip.removesuffix("_foot")
        legs[name] = [_without(f"{name}_", robot.segments[index - 1]) for index in robot.path(row)]
    first, *others = legs.values()
    for name, leg in zip(list(legs)[1:], others, strict=True):
        if [_shared(one) for one in leg] != [_shared(one) for one in first]:
            raise InvalidValueError(
                f"the legs of {robot.name!r} are not alike: {name} is not as {next(iter(legs))}; "
                "only a robot of equal legs includes one file for all"
            )
    return legs


def _without(prefix: str, segment: Segment) -> Segment:
    if segment.link is None or segment.joint is None:
        return segment
    link = replace(segment.link, name=segment.link.name.removeprefix(prefix))
    return replace(segment, joint=segment.joint.removeprefix(prefix), link=link)


def _shared(segment: Segment) -> Segment:
    """What the same segment of another leg must have: all but its place on the body, its color."""
    row, link = segment.row, segment.link
    if row.antecedent == 0:
        row = Row(joint=row.joint)
    if link is not None and link.solid is not None:
        link = replace(link, solid=replace(link.solid, colour=(0.0, 0.0, 0.0)))
    return replace(segment, row=row, link=link)
