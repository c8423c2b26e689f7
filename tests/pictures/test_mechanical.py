"""The mechanism inside a plant, read from the plant."""

import math
from dataclasses import replace

import pytest
from pydrake.systems.framework import DiagramBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.models.walker import add_walker
from drake_leg.pictures.block_diagram import run_pictures
from drake_leg.pictures.drawing import draw
from drake_leg.pictures.layout import lay_out
from drake_leg.pictures.mechanical import link_picture, mechanism_picture
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, LEG_B, ROBOTS, pendulum


def captions(picture, glyph):
    return [block.caption for block in picture.blocks if block.glyph == glyph]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_all_joints_and_solids_are_drawn(robot, require_clean):
    picture = mechanism_picture(build_plant(robot), title=robot.title)
    names = {block.name for block in picture.blocks}
    for segment in robot.segments:
        if segment.row.joint != "fixed":
            assert segment.joint in names
        if segment.link is not None and segment.link.solid is not None:
            assert f"Solid of {segment.link.name}" in names
    require_clean(lay_out(picture))


def test_the_leg_is_the_chain_of_the_reports(require_clean):
    """Per link a joint, half a link, the solid, the other half; the first one also turns."""
    picture = mechanism_picture(build_plant(LEG_B), title="leg", sensed="frame_4")
    assert captions(picture, "transform") == [
        ("25 mm", "along x"),
        ("25 mm", "along x", "90° about x"),
        *[("50 mm", "along x")] * 4,
    ]
    assert [c[0] for c in captions(picture, "revolute")] == ["hip", "knee", "ankle"]
    assert len(captions(picture, "world")) == 2
    assert len(captions(picture, "six_dof")) == 1
    labels = [net.label for net in picture.nets if net.label]
    assert labels == [f"frame {index}" for index in range(5)]
    require_clean(lay_out(picture))


def test_a_tool_frame_without_a_body_is_where_the_sensor_hangs(require_clean):
    end = replace(LEG_B.segments[3], joint=None, link=None)
    bare = replace(LEG_B, name="bare", segments=(*LEG_B.segments[:3], end))
    picture = mechanism_picture(build_plant(bare), title="bare", sensed="frame_4")
    (sensor,) = (i for i, block in enumerate(picture.blocks) if block.glyph == "six_dof")
    (net,) = (net for net in picture.nets if (sensor, 0) in net.targets)
    assert net.label == "frame 4"
    assert captions(picture, "transform")[-1] == ("50 mm", "along x")
    require_clean(lay_out(picture))


def test_the_other_leg_turns_the_other_way():
    picture = mechanism_picture(build_plant(LEG_A), title="leg")
    assert captions(picture, "transform")[1][-1] == "90° about −x"


def test_gravity_and_joint_mechanics_are_the_plants_own():
    mechanics = JointMechanics(
        damping=0.01, spring_stiffness=5.0, equilibrium_position=math.radians(30), actuated=False
    )
    plant = build_plant(pendulum(mechanics=mechanics), gravity=1.62)
    picture = mechanism_picture(plant, title="pendulum")
    (joint,) = captions(picture, "revolute")
    assert joint[2:] == ("damping 0.01", "N·m·s/rad", "spring 5 N·m/rad", "at rest at 30°")
    assert "−1.62" in " ".join(captions(picture, "configuration")[0])


def test_a_link_has_frames_at_base_centre_and_end(require_clean):
    picture = link_picture(build_plant(LEG_B), "femur", title="thigh", shape="brick")
    assert [b.name for b in picture.blocks if b.glyph == "connection"] == [
        "femur_base",
        "femur_cog",
        "femur_end",
    ]
    assert captions(picture, "transform") == [("50 mm", "along x")] * 2
    assert captions(picture, "brick") == [("femur", "Brick Solid", "4 g")]
    require_clean(lay_out(picture))


def test_an_unknown_link_is_refused_with_the_links_that_there_are():
    with pytest.raises(InvalidValueError, match="no link 'thigh'; its links are coxa, femur"):
        link_picture(build_plant(LEG_B), "thigh", title="")


def test_diagrams_are_drawings():
    plant = build_plant(LEG_B)
    assert draw(mechanism_picture(plant, title="m")).svg.startswith("<svg")
    assert draw(link_picture(plant, "femur", title="t")).svg.startswith("<svg")


def test_the_parts_of_a_run(run_diagram):
    def titles(part):
        pictures = run_pictures(run_diagram("leg-b"), LEG_B, title="leg", part=part)
        return [picture.title for picture in pictures]

    assert titles("signals") == ["leg: signals"]
    assert titles("all") == ["leg: signals", "leg: mechanism, inside the plant"]
    assert titles("tibia") == ["leg: the link tibia"]


def test_joints_with_servos_are_driven_by_torques():
    builder = DiagramBuilder()
    plant = add_walker(builder, HEXABOT).plant
    joints = captions(mechanism_picture(plant, title="hexabot"), "revolute")
    assert len(joints) == 18
    assert all("torque of a servo" in caption for caption in joints)
