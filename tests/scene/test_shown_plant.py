from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Box, Cylinder, Role, SceneGraph, Sphere
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.robot import LINK_COLOURS, Link, Robot, Row, Segment
from drake_leg.robot.robots import LEG_B, ROBOTS, SCARA, SCARA_HEIGHT
from drake_leg.robot.solids import Brick, Solid
from drake_leg.scene.motion import PlantMotion, at_rest
from drake_leg.scene.parts import LEAST_SIZE, size_of
from drake_leg.scene.scene import scene_of
from drake_leg.scene.showable import shown


def sizes(shape):
    if isinstance(shape, Box):
        return tuple(shape.size())
    return (shape.radius(), shape.length()) if isinstance(shape, Cylinder) else (shape.radius(),)


def drake_visuals(robot):
    """Shape, pose on its link and link of every visual that Drake reads from the SDF."""
    graph, plant = SceneGraph(), MultibodyPlant(time_step=0.0)
    plant.RegisterAsSourceForSceneGraph(graph)
    Parser(plant).AddModelsFromString(sdf_text(robot), "sdf")
    plant.Finalize()
    inspector = graph.model_inspector()
    for frame in inspector.GetAllFrameIds():
        for geometry in inspector.GetGeometries(frame, Role.kIllustration):
            link = inspector.GetName(frame).rpartition("::")[2]
            yield link, inspector.GetShape(geometry), inspector.GetPoseInFrame(geometry)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_solids_are_those_that_drake_reads_from_the_sdf(robot):
    rows = {s.link.name: i for i, s in enumerate(robot.segments, start=1) if s.link}
    ours = {part.frame: part for part in shown(robot).parts(0.2) if part.path.startswith("solid")}
    theirs = {rows[link]: (shape, pose) for link, shape, pose in drake_visuals(robot)}
    assert ours.keys() == theirs.keys()
    for frame, (shape, pose) in theirs.items():
        assert isinstance(ours[frame].shape, type(shape))
        assert sizes(ours[frame].shape) == pytest.approx(sizes(shape))
        np.testing.assert_allclose(ours[frame].X_FP, pose.GetAsMatrix4(), atol=1e-15)


def arm(*rows):
    """A robot of rows that are given as (Row, Link or None)."""
    return Robot(
        name="arm",
        title="Arm",
        source="none",
        segments=tuple(
            Segment(row=row, joint=None if link is None else f"joint_{link.name}", link=link)
            for row, link in rows
        ),
    )


def rods(robot):
    """Frame, end and color of every rod."""
    for part in shown(robot).parts(0.2):
        if part.path.startswith("rod"):
            end = part.X_FP[:3, 3] + part.X_FP[:3, 2] * part.shape.length() / 2.0
            yield part.frame, tuple(np.round(end, 9).tolist()), part.colour


def test_the_reports_robots_have_no_rods():
    assert not [rod for robot in ROBOTS for rod in rods(robot)]


def test_a_link_without_a_solid_is_a_rod_to_its_end_or_to_the_next_joint():
    turn = Row(joint="revolute", d=0.1)
    ending = arm((turn, Link(name="a", end=(0.1, 0.0, 0.0))), (turn, Link(name="b")))
    assert list(rods(ending)) == [(1, (0.1, 0.0, 0.0), LINK_COLOURS[0])]
    endless = arm((turn, Link(name="a")), (Row(joint="revolute", r=0.2), Link(name="b")))
    assert list(rods(endless)) == [(1, (0.0, 0.0, 0.2), LINK_COLOURS[0])]


def test_a_tool_row_is_a_rod_where_no_solid_leads_to_it():
    turn, tool = Row(joint="revolute"), Row(joint="fixed", d=0.2)
    long, short = (
        Link(
            name="bar",
            solid=Solid(
                shape=Brick(length=length, width=0.01, height=0.01),
                density=1e3,
                centre=(length / 2.0, 0.0, 0.0),
                colour=(1.0, 0.0, 0.0),
            ),
        )
        for length in (0.2, 0.1)
    )
    assert not list(rods(arm((turn, long), (tool, None))))
    assert list(rods(arm((turn, short), (tool, None)))) == [(1, (0.2, 0.0, 0.0), (1.0, 0.0, 0.0))]
    two = arm((turn, Link(name="bare")), (tool, None), (tool, None))
    assert [frame for frame, *_ in rods(two)] == [1, 2]


def test_a_post_leads_to_a_first_joint_wherever_it_is():
    (post,) = (part for part in shown(SCARA).parts(0.5) if part.path.startswith("post"))
    assert post.shape.length() == pytest.approx(SCARA_HEIGHT)
    aside = arm((Row(joint="revolute", d=0.3, r=0.4), Link(name="a")))
    (post,) = (part for part in shown(aside).parts(0.5) if part.path.startswith("post"))
    assert post.shape.length() == pytest.approx(0.5)
    np.testing.assert_allclose(post.X_FP[:3, 3], [0.15, 0.0, 0.2])


def test_a_ball_stays_a_ball():
    foot = next(part for part in shown(LEG_B).parts(0.2) if part.frame == 4)
    assert isinstance(foot.shape, Sphere)


def test_the_outline_holds_the_ends_and_the_foots_ball():
    points = shown(LEG_B).outline(at_rest(LEG_B, [0.0, 0.0, 0.0]).poses())
    np.testing.assert_allclose(points.max(axis=0), [0.256, 0.006, 0.006], atol=1e-12)
    assert points[:, 0].min() == pytest.approx(0.0, abs=1e-12)


def test_a_robot_without_any_size_has_a_scene():
    wheel = Robot(name="wheel", title="Wheel", source="none", segments=LEG_B.segments[:1])
    bare = Robot(
        name="bare",
        title="Bare",
        source="none",
        segments=(Segment(row=Row(joint="revolute"), joint="turn", link=Link(name="l")),),
    )
    assert scene_of(at_rest(wheel, [0.3])).size > 0.04
    scene = scene_of(at_rest(bare, [0.0]))
    assert scene.size == size_of(np.zeros((2, 3))) == LEAST_SIZE


def test_a_scene_holds_its_motion():
    q = np.array([[1.5, -0.9, -1.6], [0.0, -0.5, -1.2]])
    motion = PlantMotion(shown=shown(LEG_B), time=np.array([0.0, 1.0]), q=q)
    scene = scene_of(motion)
    seen = motion.poses()[..., :3, 3].reshape(-1, 3)
    assert (scene.points.min(axis=0) <= seen.min(axis=0)).all()
    assert (scene.points.max(axis=0) >= seen.max(axis=0)).all()
    wide = scene_of(motion, room=0.5)
    gained = np.ptp(wide.points, axis=0) - np.ptp(scene.points, axis=0)
    np.testing.assert_allclose(gained, scene.size)


@pytest.mark.parametrize("what", [None, 3, Robot, ["leg-b"], np.zeros(3)])
def test_what_cannot_be_shown_is_refused_with_what_can(what):
    with pytest.raises(InvalidValueError, match="cannot be shown: give a Robot, such as LEG_B"):
        shown(what)


@pytest.mark.parametrize("what", ["leg-b", "", "nowhere.sdf", Path("nowhere.urdf"), "x" * 9999])
def test_a_model_file_that_is_not_there_is_named(what):
    with pytest.raises(InvalidValueError, match=r"no model file '.*': give a Robot, such as LEG_B"):
        shown(what)


@pytest.mark.parametrize("q", ["a", [[1.0], [1.0, 2.0]], {}])
def test_positions_are_numbers(q):
    with pytest.raises(InvalidValueError, match=r"q is .*; it must be real numbers"):
        at_rest(LEG_B, q)


def test_a_plant_rests_in_one_posture():
    with pytest.raises(InvalidValueError, match="must be one vector of 3"):
        at_rest(LEG_B, np.zeros((2, 3)))
