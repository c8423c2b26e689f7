"""Plants with another gravity, a ground of their own, or missing shapes."""

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from drake_leg.scene.furniture import TRIAD_LENGTH, triad_lengths
from drake_leg.scene.motion import at_rest
from drake_leg.scene.scene import scene_of
from drake_leg.scene.showable import shown
from drake_leg.scene.shown_plant import upright
from drake_leg.scene.views import VIEWS
from drake_leg.scene.web_page import stage_data

SLIDER = """<sdf version="1.7"><model name="m">
  <link name="track"><visual name="v"><geometry><box><size>{track} 0.1 1</size></box></geometry>
  </visual></link>
  <joint name="weld" type="fixed"><parent>world</parent><child>track</child></joint>
  <link name="car"><pose>0 1 0 0 0 0</pose><visual name="v"><geometry><box><size>0.2 0.2 0.2</size>
  </box></geometry></visual></link>
  <joint name="slide" type="prismatic"><parent>world</parent><child>car</child>
    <axis><xyz>1 0 0</xyz></axis></joint>
</model></sdf>"""


def slider(track=100.0):
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    Parser(plant).AddModelsFromString(SLIDER.format(track=track), "sdf")
    plant.mutable_gravity_field().set_gravity_vector([0.0, -9.81, 0.0])
    plant.Finalize()
    return shown(builder.Build())


@pytest.mark.parametrize("gravity", [(0, -9.81, 0), (3, 0, 0), (0, 0, 9.81), (1, 2, -3)])
def test_up_is_against_gravity(gravity):
    X = upright(gravity)
    up = -np.array(gravity) / np.linalg.norm(gravity)
    np.testing.assert_allclose(X[:3, :3] @ up, [0.0, 0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(X[:3, :3] @ X[:3, :3].T, np.eye(3), atol=1e-15)
    assert np.linalg.det(X[:3, :3]) == pytest.approx(1.0)


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (0, 0, 0)])
def test_without_another_gravity_z_is_up(gravity):
    assert np.array_equal(upright(gravity), np.eye(4))


def test_the_picture_turns_and_the_model_does_not():
    motion = at_rest(slider())
    scene, X_WF = scene_of(motion), motion.poses()[0]
    np.testing.assert_allclose(X_WF[1, :3, 3], [0.0, 1.0, 0.0])
    np.testing.assert_allclose(scene.followed(X_WF)[1, :3, 3], [0.0, 0.0, 1.0], atol=1e-15)
    floors = [part for part in scene.parts if part.path.startswith("floor/")]
    heights = [(motion.shown.X_UW @ part.X_FP)[2, 3] for part in floors]
    np.testing.assert_allclose(heights, scene.floor[0, 2], atol=1e-12)


def test_a_long_ground_does_not_size_the_picture_and_is_told():
    scene = scene_of(at_rest(slider()))
    assert scene.size < 2.0
    assert any("not shown: track" in note for note in scene.notes)
    assert not any("track" in part.path for part in scene.parts)
    shorter = scene_of(at_rest(slider(track=3.0)))
    assert shorter.size == pytest.approx(3.0)
    assert shorter.notes == ()


def test_axes_are_at_most_half_as_long_as_links():
    scene = scene_of(at_rest(slider(track=3.0)))
    assert triad_lengths(2, scene.triad_size)[1] == pytest.approx(0.1)
    assert scene.size * TRIAD_LENGTH > 0.4


def test_hidden_axes_are_not_drawn_and_a_page_can_show_them():
    plain, framed = (scene_of(at_rest(slider()), frames=shows) for shows in (False, True))
    assert not any(part.path.startswith("triad/") for part in plain.drawn)
    assert sum(part.path.startswith("triad/") for part in framed.drawn) == 6
    assert any(part.path.startswith("triad/") for part in plain.parts)
    assert [stage_data(one, VIEWS["3d"])["framed"] for one in (plain, framed)] == [False, True]
    assert np.ptp(plain.points, axis=0).prod() < np.ptp(framed.points, axis=0).prod()
