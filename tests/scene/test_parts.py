import numpy as np
import pytest
from pydrake.geometry import Box, Cylinder, Role, SceneGraph, Sphere
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.models.sdf import sdf_text
from drake_leg.robot import Robot, Row, Segment
from drake_leg.robots import LEG_B, ROBOTS
from drake_leg.scene.motion import Motion, still
from drake_leg.scene.parts import LEAST_SIZE, outline, size_of, solid_parts
from drake_leg.scene.scene import scene_of
from drake_leg.scene.shapes import drake_shape


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
    ours = {part.frame: part for part in solid_parts(robot, 0.2) if part.path == "solid"}
    theirs = {rows[link]: (shape, pose) for link, shape, pose in drake_visuals(robot)}
    assert ours.keys() == theirs.keys()
    for frame, (shape, pose) in theirs.items():
        assert isinstance(drake_shape(ours[frame].shape), type(shape))
        assert sizes(drake_shape(ours[frame].shape)) == pytest.approx(sizes(shape))
        np.testing.assert_allclose(ours[frame].X_FP, pose.GetAsMatrix4(), atol=1e-15)


def test_a_ball_stays_a_ball():
    foot = next(part for part in solid_parts(LEG_B, 0.2) if part.frame == 4)
    assert isinstance(drake_shape(foot.shape), Sphere)


def test_the_outline_holds_the_ends_and_the_foots_ball():
    points = outline(LEG_B, still(LEG_B, [0.0, 0.0, 0.0]).poses())
    np.testing.assert_allclose(points.max(axis=0), [0.256, 0.006, 0.006], atol=1e-12)
    assert points[:, 0].min() == 0.0


def test_a_robot_without_any_size_has_a_scene():
    wheel = Robot(name="wheel", title="Wheel", source="none", segments=LEG_B.segments[:1])
    bare = Robot(
        name="bare",
        title="Bare",
        source="none",
        segments=(
            Segment(
                row=Row(joint="revolute"), joint="turn", link=type(LEG_B.segments[0].link)(name="l")
            ),
        ),
    )
    assert scene_of(still(wheel, [0.3])).size > 0.04
    scene = scene_of(still(bare, [0.0]))
    assert scene.size == size_of(np.zeros((2, 3))) == LEAST_SIZE


def test_a_scene_holds_its_motion():
    q = np.array([[1.5, -0.9, -1.6], [0.0, -0.5, -1.2]])
    motion = Motion(robot=LEG_B, time=np.array([0.0, 1.0]), q=q)
    scene = scene_of(motion)
    seen = motion.poses()[..., :3, 3].reshape(-1, 3)
    assert (scene.points.min(axis=0) <= seen.min(axis=0)).all()
    assert (scene.points.max(axis=0) >= seen.max(axis=0)).all()
    wide = scene_of(motion, room=0.5)
    gained = np.ptp(wide.points, axis=0) - np.ptp(scene.points, axis=0)
    np.testing.assert_allclose(gained, scene.size)
