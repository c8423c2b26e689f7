"""The SDF text: what it names, and that it says what the table says."""

import itertools
import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.kinematics.khalil import base_transforms
from drake_leg.models.sdf import package_text, sdf_text
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import PENDULUM, ROBOTS
from drake_leg.robot.solids import Solid, Sphere

BALL = Solid(shape=Sphere(radius=0.01), density=1e3, centre=(0.0,) * 3, colour=(0.0,) * 3)


def chain(*rows, mere=()):
    """Make a robot of a table; the rows of the given indices carry no link."""
    segments = [
        Segment(row=row)
        if i in mere
        else Segment(row=row, joint=f"joint_{i}", link=Link(name=f"link_{i}", solid=BALL))
        for i, row in enumerate(rows)
    ]
    return Robot(name="chain", title="Chain", source="test", segments=tuple(segments))


def assert_drake_has_the_chains_frames(robot, q, drake_frames):
    expected = base_transforms(robot.rows, q)
    np.testing.assert_allclose(drake_frames(robot, q), expected, rtol=0, atol=1e-12)


def model_of(robot):
    return ET.fromstring(sdf_text(robot)).find("model")


def names(model, tag):
    return [element.get("name") for element in model.findall(tag)]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_every_link_joint_and_frame_is_named_as_in_the_reports(robot):
    model = model_of(robot)
    links = [s.link.name for s in robot.segments if s.link]
    joints = [s.joint for s in robot.segments if s.joint]
    numbered = [f"frame_{i}" for i in range(len(robot.rows) + 1)]
    placed = [f"{link}_{place}" for link in links for place in ("base", "cog", "end")]
    assert model.get("name") == robot.name
    assert names(model, "link") == ["base", *links]
    assert names(model, "joint") == ["base_weld", *joints]
    assert sorted(names(model, "frame")) == sorted(numbered + placed)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_every_link_has_frames_at_its_base_its_centre_and_its_end(robot, posed):
    q = np.linspace(0.3, 0.9, len(robot.moving))
    plant, context = posed(robot, q)
    for link in (s.link for s in robot.segments if s.link):
        body = plant.GetFrameByName(link.name)
        for place, position in (
            ("base", (0.0, 0.0, 0.0)),
            ("cog", link.solid.centre if link.solid else (0.0, 0.0, 0.0)),
            ("end", link.end),
        ):
            frame = plant.GetFrameByName(f"{link.name}_{place}")
            X_LF = frame.CalcPose(context, body)
            np.testing.assert_allclose(X_LF.translation(), position, rtol=0, atol=1e-15)
            assert X_LF.rotation().IsNearlyIdentity(1e-15)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_a_links_end_is_the_base_of_the_next(robot, posed):
    q = np.linspace(0.3, 0.9, len(robot.moving))
    plant, context = posed(robot, q)
    links = [s.link.name for s in robot.segments if s.link]
    for link, following in itertools.pairwise(links):
        if following == "tool":  # carried by the lift, which starts from the quill's end
            continue
        end, base = (plant.GetFrameByName(n) for n in (f"{link}_end", f"{following}_base"))
        apart = end.CalcPose(context, base).translation()
        np.testing.assert_allclose(apart, 0.0, rtol=0, atol=1e-15)


def test_the_pendulums_second_frame_is_its_centre_of_gravity(posed):
    plant, context = posed(PENDULUM, [0.4])
    frame, cog = plant.GetFrameByName("frame_2"), plant.GetFrameByName("link_cog")
    assert frame.CalcPose(context, cog).IsNearlyIdentity(1e-15)


def test_any_table_has_its_frames_where_the_chain_has_them(rng, drake_frames):
    for _ in range(30):
        kinds = ["revolute", *rng.choice(["revolute", "prismatic", "fixed"], 4).tolist()]
        numbers = rng.uniform(-4.0, 4.0, (5, 4)).tolist()
        robot = chain(
            *(
                Row(joint=kind, d=d, alpha=alpha, r=r, theta=theta)
                for kind, (d, alpha, r, theta) in zip(kinds, numbers, strict=True)
            )
        )
        assert_drake_has_the_chains_frames(
            robot, rng.uniform(-2.0, 2.0, len(robot.moving)), drake_frames
        )


@pytest.mark.parametrize("alpha", [-180, -90, 0, 90, 180])
@pytest.mark.parametrize("theta", [-90, 0, 90, 180])
@pytest.mark.parametrize("off", [0.0, 1e-8])
def test_right_angles_in_a_table_are_no_special_case(alpha, theta, off, drake_frames):
    row = Row(
        joint="revolute", d=0.1, r=0.2, alpha=math.radians(alpha) + off, theta=math.radians(theta)
    )
    assert_drake_has_the_chains_frames(chain(row), [0.3], drake_frames)


@pytest.mark.parametrize("mere", [(1,), (0,), (1, 2), (3,)], ids=str)
def test_a_mere_frame_anywhere_in_the_table_counts(mere, drake_frames):
    turning, fixed = Row(joint="revolute", d=0.2), Row(joint="fixed", d=0.1, alpha=0.3)
    rows = [fixed if i in mere else turning for i in range(4)]
    robot = chain(*rows, mere=mere)
    assert_drake_has_the_chains_frames(robot, [0.3] * len(robot.moving), drake_frames)


def test_the_text_says_what_it_is_generated_from():
    assert "Generated from drake_leg.robot.robots." in sdf_text(PENDULUM)
    assert "Generated from arm.yaml." in sdf_text(PENDULUM, origin="arm.yaml")


def test_hyphens_in_a_title_do_not_end_the_comment():
    robot = replace(PENDULUM, title="--> left -- right ---")
    assert model_of(robot).get("name") == "pendulum"


def test_the_text_is_xml_that_ends_with_a_line():
    for text in (sdf_text(PENDULUM), package_text()):
        assert text.startswith('<?xml version="1.0"?>\n<')
        assert text.endswith(">\n")
        assert text.isascii()


def test_the_package_has_the_name_that_urls_use():
    assert ET.fromstring(package_text()).findtext("name") == "drake_leg"
