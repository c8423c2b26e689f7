"""Plants that are none of ours: a pendulum from an SDF text, a floating body with six legs."""

import base64
import io
import json
import re

import numpy as np
import pytest
from PIL import Image
from pydrake.geometry import Box, Cylinder, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, LogVectorOutput

from drake_leg.errors import InvalidValueError
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.robots import LEG_B
from drake_leg.scene.media import still, write_video
from drake_leg.scene.motion import PlantMotion, at_rest
from drake_leg.scene.parts import SOLID_OPACITY
from drake_leg.scene.replays import replay
from drake_leg.scene.scene import scene_of
from drake_leg.scene.showable import shown
from drake_leg.scene.viewer import joint_sliders

PENDULUM = """<?xml version="1.0"?>
<sdf version="1.7"><model name="swing">
  <link name="bob">
    <pose>0 0 1 0 0 0</pose>
    <inertial><pose>0 0 -0.5 0 0 0</pose><mass>1</mass>
      <inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
    <visual name="rod"><pose>0 0 -0.25 0 0 0</pose>
      <geometry><cylinder><radius>0.01</radius><length>0.5</length></cylinder></geometry>
      <material><diffuse>0.9 0.1 0.1 1</diffuse></material></visual>
    <visual name="ball"><pose>0 0 -0.5 0 0 0</pose>
      <geometry><sphere><radius>0.05</radius></sphere></geometry></visual>
  </link>
  <joint name="pin" type="revolute"><parent>world</parent><child>bob</child>
    <axis><xyz>0 1 0</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis></joint>
</model></sdf>"""
HEIGHT = 0.2  # of the trunk above the ground [m]


def hexapod(time_step=0.0):
    """A trunk that floats, with six legs of one joint each, over a ground of ten meters."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step)
    plant.set_name("hexapod")
    inertia = SpatialInertia(0.1, np.zeros(3), UnitInertia.SolidBox(0.1, 0.1, 0.1))
    trunk = plant.AddRigidBody("trunk", inertia)
    red, grey = [0.8, 0.2, 0.2, 1.0], [0.5, 0.5, 0.5, 1.0]
    plant.RegisterVisualGeometry(trunk, RigidTransform(), Box(0.3, 0.16, 0.04), "trunk", red)
    ground = RigidTransform([0.0, 0.0, -0.05])
    world = plant.world_body()
    plant.RegisterVisualGeometry(world, ground, Box(10.0, 10.0, 0.1), "ground", grey)
    plant.RegisterCollisionGeometry(
        world, ground, Box(10.0, 10.0, 0.1), "ground", CoulombFriction(0.9, 0.8)
    )
    for number in range(6):
        side, row = (-1) ** number, number // 2 - 1
        leg = plant.AddRigidBody(f"leg_{number}", inertia)
        down = RigidTransform([0.0, 0.0, -0.06])
        plant.RegisterVisualGeometry(leg, down, Cylinder(0.01, 0.12), f"leg_{number}", grey)
        place = RigidTransform([0.1 * row, 0.08 * side, 0.0])
        hip = plant.AddFrame(FixedOffsetFrame(f"hip_{number}", trunk.body_frame(), place))
        plant.AddJoint(RevoluteJoint(f"hip_{number}", hip, leg.body_frame(), [0.0, 1.0, 0.0]))
    plant.SetDefaultFloatingBaseBodyPose(trunk, RigidTransform([0.0, 0.0, HEIGHT]))
    plant.Finalize()
    log = LogVectorOutput(plant.get_state_output_port(), builder)
    return builder.Build(), plant, log


@pytest.fixture(scope="module")
def walker():
    return hexapod()


@pytest.fixture(scope="module")
def fall(walker):
    """The log of its free fall, for 0.1 s."""
    diagram, _, log = walker
    simulator = Simulator(diagram)
    simulator.get_mutable_integrator().set_maximum_step_size(0.002)
    simulator.AdvanceTo(0.1)
    return log.FindLog(simulator.get_context())


def pixels(picture):
    return np.asarray(Image.open(io.BytesIO(picture.png)).convert("RGB")).astype(float)


def data_of(page):
    return json.loads(re.search(r'id="page-data">(.*?)</script>', page.html, re.DOTALL)[1])


def parts_of(plant):
    return {part.path: part for part in plant.parts(0.5)}


def test_a_pendulums_shapes_come_from_its_sdf():
    plant = shown(PENDULUM)
    parts = parts_of(plant)
    assert plant.title == "swing"
    assert plant.names == ("world", "bob")
    rod, ball = parts["solid/swing.bob_0"], parts["solid/swing.bob_1"]
    assert rod.colour == pytest.approx((0.9, 0.1, 0.1))
    assert (rod.opacity, ball.opacity) == (SOLID_OPACITY, 1.0)
    np.testing.assert_allclose(rod.X_FP[:3, 3], [0.0, 0.0, -0.25], atol=1e-12)
    (post,) = (
        part for path, part in parts.items() if path.startswith("post")
    )  # from the world's origin to where the pin is
    assert post.shape.length() == pytest.approx(1.0)


def test_a_pendulums_centre_of_mass_leaves_the_trace():
    q = np.linspace(-1.0, 1.0, 9)
    motion = PlantMotion(shown=shown(PENDULUM), time=q + 1.0, q=q[:, np.newaxis])
    (path,) = motion.paths()
    along = np.column_stack([-0.5 * np.sin(q), 0.0 * q, 1.0 - 0.5 * np.cos(q)])
    np.testing.assert_allclose(path, along, atol=1e-12)


def test_what_leaves_the_trace_can_be_chosen():
    motion = at_rest(shown(PENDULUM, trace=("bob",)), [0.4])
    np.testing.assert_allclose(motion.paths()[0], [[0.0, 0.0, 1.0]], atol=1e-12)
    with pytest.raises(InvalidValueError, match="no frame 'bib'"):
        shown(PENDULUM, trace=("bib",))


def test_a_model_file_is_shown_as_its_text(tmp_path):
    (tmp_path / "swing.sdf").write_text(PENDULUM)
    for what in (tmp_path / "swing.sdf", str(tmp_path / "swing.sdf")):
        assert parts_of(shown(what)).keys() == parts_of(shown(PENDULUM)).keys()


MESH = """v 0 0 0
v 0.3 0 0
v 0 0.2 0
v 0 0 0.4
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""
EVERY_SHAPE = """<sdf version="1.7"><model name="toys"><link name="body">
  <inertial><mass>1</mass></inertial>
  <visual name="wedge"><geometry><mesh><uri>wedge.obj</uri></mesh></geometry></visual>
  <visual name="egg"><pose>1 0 0 0 0 0</pose>
    <geometry><ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid></geometry></visual>
  <visual name="pill"><pose>-1 0 0 0 0 0</pose>
    <geometry><capsule><radius>0.1</radius><length>0.3</length></capsule></geometry></visual>
  <visual name="ground"><geometry><plane><normal>0 0 1</normal></plane></geometry></visual>
</link></model></sdf>"""


@pytest.mark.slow
@pytest.mark.usefixtures("rendering")
def test_meshes_and_all_other_shapes_are_shown(tmp_path, monkeypatch):
    (tmp_path / "wedge.obj").write_text(MESH)
    (tmp_path / "toys.sdf").write_text(EVERY_SHAPE)
    plant = shown(tmp_path / "toys.sdf")
    low, high = (getattr(np.concatenate(plant.held()), end)(axis=0) for end in ("min", "max"))
    np.testing.assert_allclose(
        [low[0], high[0], high[1], high[2]], [-1.1, 1.1, 0.2, 0.4], atol=0.05
    )
    assert np.ptp(pixels(still(plant))) > 100.0
    assert len(replay(plant, at_rest(plant)).html) > 1e6
    monkeypatch.setattr("drake_leg.scene.media.rendering_fault", lambda: "no light")
    assert np.ptp(pixels(still(plant))) > 100.0


@pytest.mark.parametrize("model", ["<sdf>nothing</sdf>", "broken.sdf", "text.txt"])
def test_what_drake_cannot_read_is_refused_in_a_sentence(model, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("broken.sdf", "text.txt"):
        (tmp_path / name).write_text("<sdf")
    with pytest.raises(InvalidValueError, match="Drake refuses the model"):
        shown(model)


def test_six_legs_are_six_traces_and_a_trunk_that_floats_needs_no_base(walker):
    diagram, plant, _ = walker
    seen = shown(diagram)
    assert seen.title == "hexapod"
    assert seen.names == ("world", "trunk", *(f"leg_{number}" for number in range(6)))
    assert len(at_rest(seen).paths()) == 6
    kinds = {path.partition("/")[0] for path in parts_of(seen)}
    assert kinds == {"solid"}  # the hips are on the trunk's box
    assert len(seen.quaternions) == 1
    poses = at_rest(seen).poses()[0]
    np.testing.assert_allclose(poses[1, :3, 3], [0.0, 0.0, HEIGHT], atol=1e-15)
    assert plant.num_positions() == len(seen.coordinates) == 13


def test_two_models_of_one_kind_are_told_apart():
    plant, graph = MultibodyPlant(time_step=0.0), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(graph)
    parser = Parser(plant)
    parser.SetAutoRenaming(True)
    legs = [parser.AddModelsFromString(sdf_text(LEG_B), "sdf")[0] for _ in range(2)]
    plant.Finalize()
    seen = shown(plant)
    assert seen.names == ("world", *2 * ("frame_1", "frame_2", "frame_3", "frame_4"))
    motion = at_rest(seen, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    assert len(motion.paths()) == len(legs) == 2
    np.testing.assert_allclose(motion.poses()[0, 4, :3, 3], [0.25, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(motion.poses()[0, 8, 0, 3], 0.25 * np.cos(1.0), atol=1e-12)
    paths = [(part.frame, part.path) for part in scene_of(motion).parts]
    assert len(set(paths)) == len(paths)


def test_a_ground_of_any_size_leaves_the_picture_to_the_plant(walker):
    assert scene_of(at_rest(walker[0])).size < 0.6


def test_a_plant_without_shapes_is_thin_rods():
    bare = MultibodyPlant(time_step=0.0)
    Parser(bare).AddModelsFromString(PENDULUM, "sdf")
    bare.Finalize()
    plant = shown(bare)
    assert {path.partition("/")[0] for path in parts_of(plant)} == {"block", "post", "rod"}


def test_a_plant_without_joints_stands_and_plays():
    fixed = shown(PENDULUM.replace('type="revolute"', 'type="fixed"'))
    assert fixed.poses(None).shape == (len(fixed.frames), 4, 4)
    played = PlantMotion(shown=fixed, time=np.array([0.0, 0.5]), q=np.empty((2, 0)))
    assert played.sampled(10.0).poses().shape == (6, len(fixed.frames), 4, 4)


def test_a_plant_that_is_not_finalized_is_refused():
    with pytest.raises(InvalidValueError, match="not finalized"):
        shown(MultibodyPlant(time_step=0.0))


def test_a_diagram_without_a_plant_is_refused():
    builder = DiagramBuilder()
    builder.AddSystem(ConstantVectorSource([1.0]))
    with pytest.raises(InvalidValueError, match="the diagram has 0 plants"):
        shown(builder.Build())


@pytest.mark.slow
@pytest.mark.parametrize("view", ["3d", pytest.param("top", marks=pytest.mark.slow)])
@pytest.mark.usefixtures("rendering")
def test_both_can_be_stilled(walker, view):
    for picture in (still(walker[0], view=view), still(PENDULUM, [0.5], view=view)):
        image = pixels(picture)
        assert image.shape == (720, 960, 3)
        red = (image[..., 0] > image[..., 1] + 60.0) & (image[..., 0] > image[..., 2] + 60.0)
        assert red.sum() > 200


@pytest.mark.slow
def test_both_can_be_drawn_where_nothing_can_be_rendered(walker, monkeypatch):
    monkeypatch.setattr("drake_leg.scene.media.rendering_fault", lambda: "no light")
    for picture in (still(walker[0]), still(PENDULUM, [0.5])):
        assert np.ptp(pixels(picture)) > 100.0


def test_a_log_of_the_state_becomes_a_replay(walker, fall):
    data = data_of(replay(walker[0], fall))
    rows = np.frombuffer(base64.b64decode(data["poses"]), "<f4").reshape(-1, len(data["paths"]), 7)
    assert data["frames"][1:3] == ["trunk", "leg_0"]
    times = np.arange(len(rows)) / data["rate"]
    np.testing.assert_allclose(rows[:, 0, 2], HEIGHT - 9.81 / 2.0 * times**2, atol=2e-3)
    np.testing.assert_allclose(rows[:, 0, 3:], [[1.0, 0.0, 0.0, 0.0]] * len(rows), atol=1e-6)


def test_a_turn_between_opposite_quaternions_is_short(walker):
    plant = shown(walker[0])
    q = np.tile(plant.default, (2, 1))
    q[1, :4] *= -1.0  # the same turn
    motion = PlantMotion(shown=plant, time=np.array([0.0, 1.0]), q=q).sampled(4.0)
    np.testing.assert_allclose(motion.poses()[:, 1], [motion.poses()[0, 1]] * 5, atol=1e-12)


def test_the_page_of_times_and_positions_is_named(walker):
    page = replay(PENDULUM, ([0.0, 1.0], [[0.5], [-0.5]]), title="Swing <1>", note="stopped")
    assert "<h1>Swing &lt;1&gt;</h1>" in page.html
    assert data_of(page)["duration"] == 1.0
    with pytest.raises(InvalidValueError, match="one row of 13 at each time"):
        replay(walker[0], ([0.0, 1.0], [[0.5], [-0.5]]))


@pytest.mark.slow
@pytest.mark.usefixtures("rendering")
def test_both_can_be_filmed(walker, fall, tmp_path):
    assert write_video(tmp_path / "fall.gif", walker[0], fall) == 3
    swing = (np.linspace(0.0, 0.5, 6), np.linspace(0.5, -0.5, 6)[:, np.newaxis])
    assert write_video(tmp_path / "swing.gif", PENDULUM, swing, view="front") == 11
    with Image.open(tmp_path / "swing.gif") as gif:
        first = np.asarray(gif.convert("RGB")).astype(float)
        gif.seek(10)
        last = np.asarray(gif.convert("RGB")).astype(float)
    assert np.abs(last - first).max() > 50.0


@pytest.mark.slow
def test_six_legs_play_in_a_browser(walker, fall, open_page, tmp_path):
    replay(walker[0], fall).write(tmp_path / "fall.html")
    visit = open_page((tmp_path / "fall.html").as_uri())
    np.testing.assert_allclose(visit.frame(1), [0.0, 0.0, HEIGHT], atol=1e-6)
    visit.click("Play")
    visit.page.wait_for_function("document.getElementById('replay-play').textContent === 'Play'")
    np.testing.assert_allclose(visit.frame(1)[2], HEIGHT - 9.81 / 2.0 * 0.1**2, atol=1e-4)
    names = visit.page.locator(".axis-name:visible").all_inner_texts()
    assert {"z0", "z1", "z7"} <= {name.replace("\n", "") for name in names}
    assert "1 trunk, 2 leg_0" in visit.page.get_by_role("button", name="Frames").get_attribute(
        "title"
    )


def test_sliders_move_all_joints_but_what_floats(walker):
    (pin,) = joint_sliders(shown(PENDULUM))
    assert (pin.joint, pin.symbol) == ("pin", "deg")
    assert (pin.low, pin.high) == pytest.approx((-np.degrees(2.0), np.degrees(2.0)))
    sliders = joint_sliders(shown(walker[0]))
    assert [slider.symbol for slider in sliders] == ["mm"] * 3 + ["deg"] * 6
    assert [slider.joint for slider in sliders][:4] == ["trunk x", "trunk y", "trunk z", "hip_0"]
